/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The factorised Jacobian of an earlier step, with which the iterations of later steps go on. */
#ifndef EHD_KEPT_FACTORS_H
#define EHD_KEPT_FACTORS_H

#include "romrun/online/row_system.h"

typedef struct kept_factors {
    bool valid;
    size_t number; // of the Jacobian (step_problem)
    least_squares *factors;
    double *matrix;      // [rows + num_deformation + 1, num_unknowns] the Jacobian
    size_t *exit;        // [num_lines] at which it was evaluated
    size_t num_rows;     // Reynolds rows in it, the first of its rows
    size_t *row;         // [num_rows] which rows of the model these are
    double weight;       // of its closure
    double rate;         // of its time derivative
    reduced_state start; // of the present iteration, to return to where it fails
} kept_factors;

/* Memory from an arena, but for the factors and the state. */
void kept_factors_init(kept_factors *self, const reduced_model *model, arena *memory);
void kept_factors_free(kept_factors *self);

/* Copies and factorises the Jacobian that the system holds. */
void kept_factors_set(kept_factors *self, const row_system *system, const node_state *nodes,
                      double closure_weight);

/* Nodes by which the exit of a line may differ from that of the Jacobian. */
size_t kept_factors_reach(const reduced_model *model);

/* Whether the exit of each line is near that of the Jacobian: farther away the stored
 * factorisation no longer matches the active rows. */
bool kept_factors_are_near(const kept_factors *self, const reduced_model *model,
                           const reduced_state *state);

#endif
