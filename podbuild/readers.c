/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "podbuild/readers.h"

#include "common/output/check.h"
#include "common/program/arena.h"
#include "podbuild/part_file.h"
#include "podbuild/snapshot_set.h"

#include "romrun/model/readers.h"
#include <stdlib.h>

static ehd_status check_snapshots(const char *path, ehd_error *error) {
    snapshot_set files;
    ehd_status status = snapshot_set_open(&files, &path, 1, error);

    if (status) return status;
    // read one field at a time, so that a large file needs little memory
    const snapshot_source *source = files.sources;
    double *field = array_new(files.grid.num_nodes, 1, sizeof *field);
    if (!field) status = ehd_no_memory(error, path);
    for (size_t s = 0; s < source->num_states && !status; s++)
        status = snapshot_set_state(field, &files, 0, s, error);
    for (size_t row = source->num_stationary; row < source->num_rows && !status; row++)
        status = snapshot_set_row(field, &files, 0, row, error);
    free(field);
    snapshot_set_close(&files);
    return status;
}

static const output_reader readers[] = {{&schema_basis, basis_check},
                                        {&schema_part, part_check},
                                        {&schema_model, model_check},
                                        {&schema_snapshots, check_snapshots},
                                        {0}};

ehd_status training_check(const char *path, ehd_error *error) {
    return output_check(path, readers, error);
}
