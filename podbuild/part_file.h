/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads and writes files that hold a part of a training in compressed form: the POD of its
 * snapshots (pod.h), and its states in the coordinates of these modes (README.md, Parts).
 * Called by main.c to write, and by snapshot_set.c, bases.c and readers.c to read. */
#ifndef EHD_PART_FILE_H
#define EHD_PART_FILE_H

#include "common/artefact/artefact.h"
#include "common/program/program.h"
#include "romrun/model/reduced_model.h"

/* Source and omitted energy of a part file. */
typedef struct part_origin {
    size_t num_snapshots; // number of snapshots that the modes were computed from
    size_t num_left_out;  // number of states that had not converged or were not trusted
    double energy;        // sum of the squares of the snapshots
    double discarded;     // upper bound of the energy that the modes omit, relative to `energy`
    // [num_pressure of the basis], descending; not read by part_read_origin
    const double *singular_values;
} part_origin;

/* Writes the file caller->output. `inputs`: paths of the snapshot files, NULL at the end. */
ehd_status part_write(const reduced_basis *basis, const part_origin *origin, const program *caller,
                      const char *settings_text, const char *const *inputs, ehd_error *error);

/* Reads the origin from an open file. EHD_DATA: energy_discarded is above 1. */
ehd_status part_read_origin(part_origin *origin, artefact *file, ehd_error *error);

/* Reads the states from an open file. Errors as states_read. */
ehd_status part_read_states(
    // output:
    reduced_states *states, // free with reduced_states_free
    // input:
    artefact *file, const ehd_grid *grid, ehd_error *error);

/* Checks a part for --check. Reads all data except the modes, which artefact_check reads. */
ehd_status part_check(const char *path, ehd_error *error);

#endif
