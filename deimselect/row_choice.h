/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Selects rows from residual snapshots and measures their stability (README.md, Methods; Maier et
 * al. (2015), section 3.2).
 * Called by main.c, and by snapgen/trial.c in adaptive training. */
#ifndef EHD_ROW_CHOICE_H
#define EHD_ROW_CHOICE_H

#include "common/program/arena.h"
#include "deimselect/given_rows.h"
#include "deimselect/residual_snapshots.h"
#include "deimselect/selection.h"
#include "romrun/model/reduced_model.h"
#include "romrun/model/weighting.h"

// num_control = CONTROL_BY_ITSELF selects the default number of control rows: a tenth of num_rows,
// at least 8
#define CONTROL_BY_ITSELF ((size_t)-1)

typedef struct row_choice {
    size_t num_rows;
    size_t *rows; // [num_rows] grid nodes in order of selection
    size_t num_control;
    size_t *control;           // [num_control] grid nodes in order of choice
    double *factors;           // [num_rows] factors of the row weights, in addition to D
    size_t num_jacobian_modes; // min(unknowns, POD modes); 0 if the factors are given
    double *jacobian_modes;    // [num_rows, num_jacobian_modes] modes of the Jacobian products at
                               // the rows
    // smallest singular values of the bases sampled at the rows
    double sigma_min_residual, sigma_min_jacobian;
    double sigma_min_over_exits; // smallest value of sigma_min_by_exit
    double stability;          // 1/sigma_min relative to all rows, at the worst exit (stability.h)
    double *sigma_min_by_exit; // [num_states] sigma_min of the rows before the exit of each state
    arena memory;
} row_choice;

typedef struct row_settings {
    const given_rows *given;        // NULL: the method selects the rows
    const selection_method *method; // if rows are given, `method`, `num_rows` and `stability` are
                                    // not used
    const weighting *weights;       // not used if factors are given
    size_t num_rows;    // number of rows to select; 0: two rows for each pressure mode, or fewer if
                        // the snapshots do not support so many
    double stability;   // largest allowed stability, reached with the fewest rows; 0: num_rows is
                        // the number of rows
    size_t num_control; // number of control rows; CONTROL_BY_ITSELF: the default number, or fewer
                        // if the snapshots do not support so many
} row_settings;

void row_choice_free(row_choice *choice);

/* Returns the largest number of modes of either POD (residuals, products) from which rows are
 * selected. With --stability the number may grow later. */
size_t row_choice_num_modes(const reduced_basis *basis, const row_settings *settings);

/* Returns the exits of the training states in ascending order, equal exits only once. The result is
 * [num_exits, inner lines of the grid]. Each entry is the number of rows before the exit on the
 * line. Returns NULL if there is no memory. */
size_t *row_choice_exits(size_t *num_exits, const reduced_basis *basis); // free()

/* Computes the PODs of the residuals and of the products. Selects rows by the method or copies the
 * given rows, computes the weights of the rows, and selects control rows.
 *
 * Also measures the smallest singular values of the bases sampled at the rows: for all selected
 * rows, and for each training state for the rows before the exit of this state. Rows behind the
 * exit have no effect. The measurement uses as many leading modes as the basis has pressure modes.
 *
 * EHD_DATA: there are fewer rows than pressure modes, more rows or control rows than the snapshots
 * support, or the method does not reach the stability. Other errors: EHD_MEMORY, EHD_INTERNAL. */
ehd_status row_choice_make(
    // output:
    row_choice *choice, // free with row_choice_free
    // input:
    const residual_snapshots *snapshots, const reduced_basis *basis, const row_settings *settings,
    ehd_error *error);

/* Builds the model with the chosen rows, their weights and the control rows. Errors: EHD_DATA,
 * EHD_MEMORY. */
ehd_status row_choice_model(
    // output:
    reduced_model *model, // free with reduced_model_free
    // input:
    const row_choice *choice, const reduced_basis *basis, ehd_error *error);

#endif
