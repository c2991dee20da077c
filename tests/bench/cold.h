/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures cold solutions of the full model. The time includes the creation of solver and state, as
 * in a program. */
#ifndef EHD_COLD_H
#define EHD_COLD_H

#include "fullrun/full_solver.h"
#include "tests/bench/measure.h"

typedef struct cold_task {
    ehd_contact contact;
    full_settings settings;
    size_t repeats; // 0: solves nothing and measures the memory of the program itself
} cold_task;

typedef struct cold_record {
    spread seconds;
    size_t newton, gmres; // iterations on the finest grid
    contact_scalars scalars;
} cold_record;

/* Solves `task` (a cold_task) and fills `record` (a cold_record). Can be passed to run_apart. */
void cold_solve(void *record, const void *task);

/* Ends the program if a solution has not converged. */
void must_converge(const full_info *info);

#endif
