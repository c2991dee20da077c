/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "podbuild/readers.h"

#include "common/program/arena.h"
#include "podbuild/part_file.h"
#include "podbuild/snapshot_files.h"

#include "romrun/model/readers.h"
#include <stdlib.h>

static ehd_status check_snapshots(const char *path, ehd_error *error) {
    snapshot_files files;
    ehd_status status = snapshot_files_open(&files, &path, 1, error);

    if (status) return status;
    // read one field at a time, so that a large file needs little memory
    const file_states *states = &files.files[0].states;
    double *field = array_new(files.grid.num_nodes, 1, sizeof *field);
    if (!field) status = ehd_no_memory(error, path);
    for (size_t i = 0; i < states->count && !status; i++)
        if (states->outcome[i] == 0) status = snapshot_file_state(field, &files, 0, i, error);
    for (size_t i = 0; i < snapshot_file_compressed(&files, 0) && !status; i++)
        status = snapshot_file_row(field, &files, 0, i, error);
    free(field);
    snapshot_files_close(&files);
    return status;
}

const output_reader training_readers[] = {{&schema_basis, basis_check},
                                          {&schema_part, part_check},
                                          {&schema_model, model_check},
                                          {&schema_snapshots, check_snapshots},
                                          {0}};
