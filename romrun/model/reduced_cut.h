/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cut tables: updates from one exit line to another (Maier et al. (2015), eq. 36), and checkpoints,
 * exit lines for which they are stored, so that updates are small. */
#ifndef EHD_REDUCED_CUT_H
#define EHD_REDUCED_CUT_H

#include "romrun/model/reduced_model.h"

/* Neighbouring nodes of the band by which two exit lines differ. */
typedef struct cut_run {
    size_t first, count; // indices in the band
    size_t line, column; // of the first one
    double sign;         // 1: they get pressure, -1: they lose it
} cut_run;

/* Lists the runs by which exit line `to` differs from `from`; returns their number. */
size_t reduced_model_runs(
    // output:
    cut_run *runs, // [num_lines]
    // input:
    const reduced_model *model, const size_t *from, const size_t *to);

/* Updates a cut table to another exit line: eq. 36 in blocks of rank CUT_BLOCK. */
enum { CUT_BLOCK = 64 };
void reduced_model_change_cut(
    // in and out:
    double *cut, // [rows of the cut table, num_pressure]
    // input:
    const reduced_model *model, const cut_run *runs, size_t num_runs,
    double *work); // [CUT_BLOCK, rows of the cut table + num_pressure]; unused on a line contact

/* Checkpoint for an exit line: the nearest; of a line contact the last one not behind it. */
size_t reduced_model_checkpoint(const reduced_model *model, const size_t *exit);

/* Chooses the checkpoints of an otherwise complete model and fills their tables. EHD_MEMORY. */
ehd_status reduced_model_place_checkpoints(reduced_model *model, ehd_error *error);
ehd_status reduced_model_make_checkpoints(reduced_model *model, ehd_error *error);

/* The control rows' table for the same checkpoints. EHD_MEMORY. */
ehd_status reduced_model_make_control_checkpoints(reduced_model *model, ehd_error *error);

#endif
