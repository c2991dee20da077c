/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A contact with what it takes to solve it with the full model, and what a solution is checked
 * by. */
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

/* Reynolds rows of a solution, evaluated apart from the solver; [num_inner]. */
void problem_rows(reynolds_row *rows, const problem *solved);
/* The same of a solution in time. */
void problem_rows_in_time(reynolds_row *rows, const problem *solved,
                          const reynolds_squeeze *squeeze);
double row_size(const reynolds_row *row);

/* A linear solver that takes the step by GMRES and by dgesv, which have to agree. */
full_linear_solver compare_linear_solvers;

#endif
