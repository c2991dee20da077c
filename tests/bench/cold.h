/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cold solves of the full model, measured: everything included that a program would do for one. */
#ifndef EHD_COLD_H
#define EHD_COLD_H

#include "fullrun/full_solver.h"
#include "tests/bench/measure.h"

typedef struct cold_task {
    ehd_contact contact;
    full_settings settings;
    size_t repeats; // 0: nothing is solved, which shows what the program itself takes
} cold_task;

typedef struct cold_record {
    spread seconds;
    size_t newton, gmres; // iterations on the finest grid
    contact_scalars scalars;
} cold_record;

/* Solves the task (a cold_task) into the record (a cold_record); for run_apart. */
void cold_solve(void *record, const void *task);

/* Ends the program where a solve has not converged. */
void must_converge(const full_info *info);

#endif
