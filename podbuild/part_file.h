/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A part of a training in place of its snapshots: their POD, and their states in its coordinates. */
#ifndef EHD_PART_FILE_H
#define EHD_PART_FILE_H

#include "common/artefact/artefact.h"
#include "common/program/program.h"
#include "podbuild/pod.h"
#include "romrun/model/reduced_model.h"

/* Of what it was made, and what it has lost. */
typedef struct part_origin {
    size_t num_snapshots; // that the modes are of
    size_t num_left_out;  // states that had not converged
    double energy;        // sum of the squares of these snapshots
    double discarded;     // part of it that their distance from the modes has at most
} part_origin;

/* Writes and finishes caller->output. `basis` has grid and states, in the coordinates of the modes.
 * `inputs`: the snapshot files, NULL at the end. */
ehd_status part_write(const reduced_basis *basis, const pod_basis *modes, const part_origin *origin,
                      const program *caller, const char *settings_text, const char *const *inputs,
                      ehd_error *error);

/* Of an open file. EHD_DATA: an energy left out that is more than all. */
ehd_status part_read_origin(part_origin *origin, artefact *file, ehd_error *error);

/* States of an open file. Errors as states_read. */
ehd_status part_read_states(
    // output:
    reduced_states *states, // free with reduced_states_free
    // input:
    artefact *file, const ehd_grid *grid, ehd_error *error);

/* For --check: reads it but for the modes. */
ehd_status part_check(const char *path, ehd_error *error);

#endif
