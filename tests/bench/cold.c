/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/bench/cold.h"
#include "common/program/program.h"

#include <stdio.h>
#include <stdlib.h>

void must_converge(const full_info *info) {
    if (info->status == EHD_OK) return;
    fprintf(stderr, "bench: %s\n", info->reason);
    exit(1);
}

static double solve_once(cold_record *record, const cold_task *task) {
    const ehd_contact *contact = &task->contact;
    full_solver *solver;
    full_state state;
    full_info info;
    ehd_error error;
    double before = program_seconds();

    must(full_solver_create(&solver, contact->kind, &contact->grid, &task->settings, &error),
         &error);
    must(full_state_init(&state, &contact->grid, &error), &error);
    must(full_solve_cold(&info, &state, solver, contact, &error), &error);
    must_converge(&info);
    record->newton = info.newton_iterations;
    record->gmres = info.gmres_iterations;
    record->scalars = full_evaluate_scalars(&state, contact);
    full_state_free(&state);
    full_solver_free(solver);
    return program_seconds() - before;
}

void cold_solve(void *record, const void *task) {
    const cold_task *of = task;
    cold_record *measured = record;

    if (of->repeats == 0) return;
    double *seconds = must_allocate(of->repeats * sizeof *seconds);
    for (size_t i = 0; i < of->repeats; i++)
        seconds[i] = solve_once(measured, of);
    measured->seconds = spread_of(seconds, of->repeats);
    free(seconds);
}
