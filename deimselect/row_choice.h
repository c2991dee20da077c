/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From residual snapshots to selected rows and how well posed they are. */
#ifndef EHD_ROW_CHOICE_H
#define EHD_ROW_CHOICE_H

#include "deimselect/given_rows.h"
#include "deimselect/residual_snapshots.h"
#include "deimselect/selection.h"
#include "romrun/model/reduced_model.h"
#include "romrun/model/weighting.h"

#define CONTROL_BY_ITSELF ((size_t)-1) // number of control rows: a tenth of the rows, at least 8

typedef struct row_choice {
    size_t num_rows;
    size_t *rows; // [num_rows] grid nodes in order of selection
    size_t num_control;
    size_t *control;           // [num_control] grid nodes in order of choice
    double *factors;           // [num_rows] of the row weights, besides D
    size_t num_jacobian_modes; // as many as unknowns, where there are; 0 with given factors
    double *jacobian_modes;    // [num_rows, num_jacobian_modes] at the rows
    double sigma_min_residual, sigma_min_jacobian; // of the bases sampled at the rows
    double sigma_min_over_exits;
    double stability;          // 1/sigma_min against all rows, worst exit (stability.h)
    double *sigma_min_by_exit; // [num_states]
} row_choice;

typedef struct row_settings {
    const given_rows *given;        // NULL: the method selects the rows
    const selection_method *method; // without given rows, as num_rows and stability
    const weighting *weights;       // without given factors
    size_t num_rows;  // 0: two a pressure mode, fewer where the snapshots do not tell so many apart
    double stability; // at most, by as few rows as that takes; 0: num_rows says how many
    size_t num_control; // CONTROL_BY_ITSELF: also fewer where the snapshots do not
} row_settings;

void row_choice_free(row_choice *choice);

/* How many modes of either set the rows are selected with at most; of --stability at first. */
size_t row_choice_num_modes(const reduced_basis *basis, const row_settings *settings);

/* The exits of training, each once and in order, as numbers of rows before them on each inner line.
 * NULL: no memory. */
size_t *row_choice_exits(size_t *num_exits, const reduced_basis *basis); // free()

/* PODs of both snapshot sets, the method's or the given rows and their weights, and the smallest
 * singular values of the bases sampled there: over all rows, and for the exit of each training
 * state with the rows before it and as many leading modes as the basis has pressure modes (film
 * rupture takes the other rows away). EHD_DATA: fewer rows than pressure modes, more rows or
 * control rows than the snapshots support, a stability that the method does not reach. */
ehd_status row_choice_make(
    // output:
    row_choice *choice, // free with row_choice_free
    // input:
    const residual_snapshots *snapshots, const reduced_basis *basis, const row_settings *settings,
    ehd_error *error);

/* The model of these rows, with their weights and control rows. EHD_DATA, EHD_MEMORY. */
ehd_status row_choice_model(
    // output:
    reduced_model *model, // free with reduced_model_free
    // input:
    const row_choice *choice, const reduced_basis *basis, ehd_error *error);

#endif
