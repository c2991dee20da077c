/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/calibrate/fallback.h"

#include "common/program/program.h"
#include "fullrun/full_result.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void fallback_free(fallback *self) {
    full_state_free(&self->state);
    free(self->exits);
    *self = (fallback){0};
}

ehd_status fallback_load(full_state *state, online_solver *solver, const online_result *result,
                         const ehd_contact *contact, ehd_error *error) {
    const ehd_grid *grid = &contact->grid;
    const double last = (double)(grid_width(grid) - 1);
    ehd_status status = online_fields(state->pressure, state->film, solver, error);

    // takes the node at or behind the exit, since the exit may lie between nodes
    const double column = (result->scalars.exit_position - grid->x_min) / grid->step;
    const double exit = fmin(fmax(ceil(column - 1e-6) + 1, 2), last);
    state->rigid_approach = result->scalars.rigid_approach;
    full_state_set_zone(state, grid, isnan(exit) ? (size_t)last : (size_t)exit);
    return status;
}

/* Checks whether a state is physical: finite pressures within the limit of the viscosity law, and
 * positive films. */
static bool is_plausible(const full_state *state, const ehd_contact *contact) {
    for (size_t k = 0; k < contact->grid.num_nodes; k++)
        if (!isfinite(state->pressure[k]) || !(state->film[k] > 0 && isfinite(state->film[k])))
            return false;
    return isfinite(state->rigid_approach) && !full_beyond_law(state, contact);
}

/* Solves from the state `first`. If `first` is NULL or leads to no usable solution, solves from a
 * cold start. */
static ehd_status solve_once(fallback *self, full_solver *solver, const full_state *first,
                             const ehd_contact *contact, ehd_error *error) {
    const double before = program_seconds();
    const ehd_grid *grid = &contact->grid;
    full_info cold;
    ehd_status status = EHD_OK;

    self->from_reduced = first && is_plausible(first, contact);
    self->status = EHD_NOT_CONVERGED;
    self->info = (full_info){.status = EHD_NOT_CONVERGED};
    if (self->from_reduced) {
        full_state_copy(&self->state, first, grid);
        status = full_solve(&self->info, &self->state, solver, contact, NULL, error);
        if (!status) self->status = full_judge(self->reason, &self->info, &self->state, contact);
    }
    if (!status && self->status == EHD_NOT_CONVERGED) {
        const full_info tried = self->info;
        self->from_reduced = false;
        full_state_fill(&self->state, grid);
        status = full_solve_cold(&cold, &self->state, solver, contact, error);
        self->info = cold;
        self->info.newton_iterations += tried.newton_iterations;
        self->info.gmres_iterations += tried.gmres_iterations;
        solve_seconds_add(&self->info.seconds, &tried.seconds);
        if (!status) self->status = full_judge(self->reason, &self->info, &self->state, contact);
    }
    self->info.seconds.total = program_seconds() - before;
    return status;
}

/* Solves `repeats` times. self->info becomes the info of the solution with the median time. */
static ehd_status solve(fallback *self, full_solver *solver, const full_state *first,
                        const ehd_contact *contact, size_t repeats, ehd_error *error) {
    full_info *runs = calloc(repeats, sizeof *runs);
    ehd_status status = runs ? EHD_OK : ehd_no_memory(error, "--repeat");

    for (size_t i = 0; i < repeats && !status; i++) {
        status = solve_once(self, solver, first, contact, error);
        runs[i] = self->info;
    }
    if (!status) self->info = full_median_run(runs, repeats);
    free(runs);
    return status;
}

ehd_status fallback_solve(fallback *self, online_solver *solver, const online_result *result,
                          const ehd_contact *contact, size_t repeats, ehd_error *error) {
    const full_settings settings = full_default_settings();
    // Mean times of the full model: 15 ms from a reduced solution that has converged but is not
    // trusted, 29 ms from a cold start. From a reduced solution that has not converged the full
    // model takes 153 ms, from a cold start 36 ms (150 random scenes in and around a trained range,
    // M 3 to 200, L 0.5 to 16).
    const bool converged = result->status != EHD_NOT_CONVERGED;
    full_solver *full = NULL;
    full_state first = {0};

    *self = (fallback){0};
    ehd_status status = full_state_init(&self->state, &contact->grid, error);
    if (!status) status = full_state_init(&first, &contact->grid, error);
    if (!status && converged) status = fallback_load(&first, solver, result, contact, error);
    if (!status)
        status = full_solver_create(&full, contact->kind, &contact->grid, &settings, error);
    if (!status) status = solve(self, full, converged ? &first : NULL, contact, repeats, error);
    if (!status) status = full_exits(&self->exits, &self->state, &contact->grid, error);
    full_solver_free(full);
    full_state_free(&first);
    return status;
}

run_result fallback_result(const fallback *self, const ehd_contact *contact, bool with_fields) {
    run_result result = full_result(&self->info, &self->state, contact, with_fields);

    result.exits = self->exits;
    result.status = self->status;
    memcpy(result.reason, self->reason, sizeof self->reason);
    return result;
}
