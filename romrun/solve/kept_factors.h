/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Holds the factorised Jacobian of an earlier step, which the iterations of later steps use
 * (romrun/online/README.md, In time).
 * Called by reduced_solver.c, and by romrun/trust/time_indicator.c for its reach. */
#ifndef EHD_KEPT_FACTORS_H
#define EHD_KEPT_FACTORS_H

#include "romrun/solve/row_system.h"

typedef struct kept_factors {
    bool valid;
    size_t number; // number of the Jacobian (step_problem)
    least_squares *factors;
    double *matrix;      // [rows + num_deformation + 1, num_unknowns] the Jacobian
    size_t *exit;        // [num_lines] exit line at which it was evaluated
    size_t num_rows;     // Reynolds rows in the matrix, which come first
    size_t *row;         // [num_rows] indices of the Reynolds rows in the model
    double weight;       // weight of the closure
    double rate;         // rate of the time derivative
    reduced_state start; // start of the present iteration, to return to on failure
} kept_factors;

/* Initialises with memory from an arena; factors and state have memory of their own. */
void kept_factors_init(kept_factors *self, const reduced_model *model, arena *memory);
void kept_factors_free(kept_factors *self);

/* Copies and factorises the Jacobian that the system holds. */
void kept_factors_set(kept_factors *self, const row_system *system, const node_state *nodes,
                      double closure_weight);

/* Returns by how many nodes the exit of a line may differ from that of the Jacobian. */
size_t kept_factors_reach(const reduced_model *model);

/* Checks whether the exit of each line is near that of the Jacobian. Farther away the stored
 * factorisation does not match the active rows. */
bool kept_factors_are_near(const kept_factors *self, const reduced_model *model,
                           const reduced_state *state);

#endif
