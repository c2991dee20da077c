/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the exit line takes away from the bases: cut tables brought from one exit line to another (eq. 36), and kept at
 * some of them, so that no solve starts far from one. */
#ifndef EHD_REDUCED_CUT_H
#define EHD_REDUCED_CUT_H

#include "romrun/model/reduced_model.h"

/* Neighbouring nodes of the band by which two exit lines differ. */
typedef struct cut_run {
    size_t first, count; // places in the band
    size_t line, column; // of the first one
    double sign;         // 1: they get pressure, -1: they lose it
} cut_run;

/* By which nodes `to` differs from exit line `from`; at most one run a line. Returns their number. */
size_t reduced_model_runs(
    // output:
    cut_run *runs, // [num_lines]
    // input:
    const reduced_model *model, const size_t *from, const size_t *to);

/* Brings a cut table to another exit line: eq. (36) in blocks of rank CUT_BLOCK. */
enum { CUT_BLOCK = 64 };
void reduced_model_change_cut(
    // in and out:
    double *cut, // [num_cut, num_pressure]
    // input:
    const reduced_model *model, const cut_run *runs, size_t num_runs,
    double *work); // [CUT_BLOCK, num_cut + num_pressure]; not touched on a line contact

/* Checkpoint of an exit line: of a line contact the largest one not behind the exit, else the nearest. */
size_t reduced_model_checkpoint(const reduced_model *model, const size_t *exit);

/* Chooses the checkpoints of a model that has everything else, and fills their tables. EHD_MEMORY. */
ehd_status reduced_model_make_checkpoints(reduced_model *model, ehd_error *error);

/* The table of its control rows, for the same checkpoints. EHD_MEMORY. */
ehd_status reduced_model_make_control_checkpoints(reduced_model *model, ehd_error *error);

#endif
