/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A contact with a full solver and its solution, and checks of the solution. */
#ifndef EHD_PROBLEM_H
#define EHD_PROBLEM_H

#include "fullrun/full_solver.h"

typedef struct problem {
    ehd_contact contact;
    full_solver *solver;
    full_state state;
    full_info info;
} problem;

void problem_init(problem *self, const ehd_contact *contact, const full_settings *settings);
void problem_solve_cold(problem *self, const ehd_contact *contact, const full_settings *settings);
void problem_free(problem *self);

void check_same_state(const problem *actual, const problem *expected);

/* Evaluates the Reynolds rows [num_inner] of a solution, independently of the solver. */
void problem_rows(reynolds_row *rows, const problem *solved);
/* Evaluates the Reynolds rows of a transient solution. */
void problem_rows_in_time(reynolds_row *rows, const problem *solved,
                          const reynolds_squeeze *squeeze);
double row_size(const reynolds_row *row);

/* A linear solver for tests. Computes each Newton step by GMRES and by LAPACK's dgesv, and checks
 * that both give the same step. */
full_linear_solver compare_linear_solvers;

#endif
