/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A reduced model with what it takes to solve it. */
#ifndef EHD_REDUCED_PROBLEM_H
#define EHD_REDUCED_PROBLEM_H

#include "romrun/online/reduced_solver.h"
#include "tests/unit/trained.h"

typedef struct reduced_problem {
    reduced_model model;
    reduced_solver *solver;
    reduced_state state;
    reduced_info info;
} reduced_problem;

/* As far as rounding lets it converge. */
extern const reduced_settings strict_settings;

/* `rows` as in reduced_model_build; the test fails where that does. */
void reduced_problem_init(
    // output:
    reduced_problem *self, // free with reduced_problem_free
    // input:
    const reduced_basis *basis, const size_t *rows, size_t num_rows,
    const reduced_settings *settings);
void reduced_problem_free(reduced_problem *self);

/* Solves from the state that it has; the test fails where it does not converge or is not to be
 * trusted. */
void reduced_problem_solve(reduced_problem *self, const ehd_contact *contact);

/* P and H of a state, [num_nodes], from the modes [num_nodes, num_pressure]; the test fails where
 * there is no memory for them. */
void fields_of(double *pressure, double *film, const reduced_state *state,
               const reduced_model *model, const double *pressure_basis);

/* Every inner node is a pressure mode of its own and, independent, every node a deformation mode:
 * the reduced model is the full one. */
reduced_basis identity_basis(
    // input:
    const snapshot_set *set, deformation_kind kind,
    const double *weight); // [num_nodes]

/* The basis of a half grid on the whole one, where both rows of a pair together count as the one of
 * the half. */
reduced_basis mirrored_basis(const reduced_basis *half);

/* Builds a model of some rows, or of all, and writes it, as deimselect would. */
void rows_model_write(const reduced_basis *basis, const size_t *rows, size_t num_rows,
                      const char *path);
void whole_model_write(const reduced_basis *basis, const char *path);

#endif
