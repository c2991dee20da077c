/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Iterations in time with the factors of an earlier Jacobian. */
#ifndef EHD_KEPT_FACTORS_H
#define EHD_KEPT_FACTORS_H

#include "romrun/online/row_system.h"

typedef struct kept_factors {
    bool valid;
    least_squares *factors;
    double *matrix;      // [rows + num_deformation + 1, num_unknowns] the Jacobian
    size_t *exit;        // [num_lines] that it was made at
    size_t num_rows;     // of its rows the first num_rows are Reynolds rows
    size_t *row;         // [rows of the model]
    double weight;       // of its closure
    reduced_state start; // that iterations with them began from
} kept_factors;

/* Memory from an arena, but for the factors. */
void kept_factors_init(kept_factors *self, const reduced_model *model, arena *memory);
void kept_factors_free(kept_factors *self);

/* Keeps the Jacobian that the system holds, and its factors; closure_weight is that of its closure. */
void kept_factors_set(kept_factors *self, const row_system *system, const node_state *nodes,
                      double closure_weight);

/* Whether no line's exit lies farther from where the Jacobian has it than the stored factorisation
 * can stand for. */
bool kept_factors_are_near(const kept_factors *self, const reduced_model *model,
                           const reduced_state *state);

#endif
