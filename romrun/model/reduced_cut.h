/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Updates cut tables from one exit line to another (Maier et al. (2015), eq. 36). An exit line is
 * the list of exits, one on each grid line. Also makes checkpoints, which are stored tables of some
 * exit lines: an update from the nearest checkpoint is small. Called by reduced_model.c for
 * checkpoints, and by the folders state, solve and trust. */
#ifndef EHD_REDUCED_CUT_H
#define EHD_REDUCED_CUT_H

#include "romrun/model/reduced_model.h"

/* A run: the neighbouring nodes of a grid line that lie between two exit lines. All these nodes are
 * in the band. */
typedef struct cut_run {
    size_t first, count; // index of the first node in the band, and number of nodes
    size_t line, column; // line and column of the first node
    double sign;         // 1: these nodes get pressure; -1: these nodes lose their pressure
} cut_run;

/* Lists the runs between the exit lines `from` and `to`. Returns the number of runs. */
size_t reduced_model_runs(
    // output:
    cut_run *runs, // [num_lines]
    // input:
    const reduced_model *model, const size_t *from, const size_t *to);

/* Updates a cut table to another exit line, by eq. 36 in blocks of rank CUT_BLOCK. */
enum { CUT_BLOCK = 64 };
void reduced_model_change_cut(
    // in and out:
    double *cut, // [rows of the cut table, num_pressure]
    // input:
    const reduced_model *model, const cut_run *runs, size_t num_runs,
    double *work); // [CUT_BLOCK, rows of the cut table + num_pressure]; unused on a line contact

/* Returns the checkpoint for an exit line. For a point contact this is the nearest checkpoint. For
 * a line contact this is the last checkpoint that does not lie behind the exit. */
size_t reduced_model_checkpoint(const reduced_model *model, const size_t *exit);

/* Choose the checkpoints of an otherwise complete model; reduced_model_make_checkpoints also fills
 * their tables. Errors: EHD_MEMORY. */
ehd_status reduced_model_place_checkpoints(reduced_model *model, ehd_error *error);
ehd_status reduced_model_make_checkpoints(reduced_model *model, ehd_error *error);

/* Fills the tables of the control rows for the checkpoints that reduced_model_make_checkpoints has
 * made. Errors: EHD_MEMORY. */
ehd_status reduced_model_make_control_checkpoints(reduced_model *model, ehd_error *error);

#endif
