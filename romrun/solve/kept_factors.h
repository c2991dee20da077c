/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Holds the factorised Jacobian of an earlier time step, which the iterations of later time steps
 * use (romrun/online/README.md, In time). Called by reduced_solver.c, and by
 * romrun/trust/time_indicator.c for kept_factors_reach. */
#ifndef EHD_KEPT_FACTORS_H
#define EHD_KEPT_FACTORS_H

#include "romrun/solve/row_system.h"

typedef struct kept_factors {
    bool valid;
    size_t number; // serial number of the Jacobian (solved_system)
    least_squares *factors;
    double *matrix;      // [rows + num_deformation + 1, num_unknowns] the Jacobian
    size_t *exit;        // [num_lines] exit line at which the Jacobian was evaluated
    size_t num_rows;     // number of Reynolds rows, the first rows of the matrix
    size_t *row;         // [num_rows] indices of the Reynolds rows in the model
    double weight;       // weight of the closure
    double rate;         // rate of the squeeze term (reduced_squeeze)
    reduced_state start; // initial state of the present iteration, restored on failure
} kept_factors;

/* Initialises with memory from an arena; factors and state allocate their own memory. */
void kept_factors_init(kept_factors *self, const reduced_model *model, arena *memory);
void kept_factors_free(kept_factors *self);

/* Copies and factorises the Jacobian that the system holds. */
void kept_factors_set(kept_factors *self, const row_system *system, const node_state *nodes,
                      double closure_weight);

/* Returns the largest allowed distance, in nodes, between the exit of a grid line and the exit at
 * which the Jacobian was evaluated. */
size_t kept_factors_reach(const reduced_model *model);

/* Checks whether the exit of each grid line is near the exit at which the Jacobian was evaluated.
 * If an exit is not near, the factors do not match the rows before the exit. */
bool kept_factors_are_near(const kept_factors *self, const reduced_model *model,
                           const reduced_state *state);

#endif
