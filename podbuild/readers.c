/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "podbuild/readers.h"

#include "podbuild/snapshot_set.h"
#include "romrun/model/readers.h"

static ehd_status check_snapshots(const char *path, ehd_error *error) {
    snapshot_files files;
    snapshot_set set = {0};
    ehd_status status = snapshot_files_open(&files, &path, 1, error);

    if (status) return status;
    status = snapshot_set_read(&set, &files, error);
    snapshot_set_free(&set);
    snapshot_files_close(&files);
    return status;
}

const output_reader training_readers[] = {{&schema_basis, basis_check},
                                          {&schema_model, model_check},
                                          {&schema_snapshots, check_snapshots},
                                          {0}};
