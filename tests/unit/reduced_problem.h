/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A reduced model with its solver and state. */
#ifndef EHD_REDUCED_PROBLEM_H
#define EHD_REDUCED_PROBLEM_H

#include "romrun/solve/reduced_solver.h"
#include "tests/unit/trained.h"

typedef struct reduced_problem {
    reduced_model model;
    reduced_solver *solver;
    reduced_state state;
    reduced_info info;
} reduced_problem;

/* Settings with which a solver converges as far as round-off allows. */
extern const reduced_settings strict_settings;

/* Builds model and solver, with `rows` as in reduced_model_build. The test fails on errors. */
void reduced_problem_init(
    // output:
    reduced_problem *self, // free with reduced_problem_free
    // input:
    const reduced_basis *basis, const size_t *rows, size_t num_rows,
    const reduced_settings *settings);
void reduced_problem_free(reduced_problem *self);

/* Solves a contact, starting from the state of `self`. The test fails if the solution does not
 * converge or is not trusted. */
void reduced_problem_solve(reduced_problem *self, const ehd_contact *contact);

/* Computes P and H of a state, [num_nodes], from the modes [num_nodes, num_pressure]. The test
 * fails if no memory can be allocated. */
void fields_of(double *pressure, double *film, const reduced_state *state,
               const reduced_model *model, const double *pressure_basis);

/* Returns a basis with a pressure mode for each inner node and, if independent, a deformation mode
 * for each node. The reduced model of this basis equals the full model. */
reduced_basis identity_basis(
    // input:
    const snapshot_set *set, deformation_kind kind,
    const double *weight); // [num_nodes]

/* Returns the basis of a half grid, extended to the whole grid by symmetry. A row and its mirrored
 * row together have the weight of the single row on the half grid. */
reduced_basis mirrored_basis(const reduced_basis *half);

/* Builds a model with some or all rows and writes its file, as deimselect would. */
void rows_model_write(const reduced_basis *basis, const size_t *rows, size_t num_rows,
                      const char *path);
void whole_model_write(const reduced_basis *basis, const char *path);

#endif
