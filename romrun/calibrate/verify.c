/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/calibrate/verify.h"

#include "common/program/program.h"
#include "fullrun/full_solver.h"
#include "romrun/calibrate/fallback.h"

#include <math.h>

/* Takes num_steps Newton steps of the full model. If num_steps is 0, evaluates only the
 * residual. */
static ehd_status newton_steps(full_info *info, full_state *state, const ehd_contact *contact,
                               size_t num_steps, ehd_error *error) {
    full_settings settings = full_default_settings();
    full_solver *solver = NULL;

    settings.max_iterations = num_steps;
    ehd_status status =
        full_solver_create(&solver, contact->kind, &contact->grid, &settings, error);
    if (!status) status = full_solve(info, state, solver, contact, NULL, error);
    full_solver_free(solver);
    return status;
}

ehd_status verify(verification *outcome, online_solver *solver, const online_result *result,
                  const ehd_contact *contact, ehd_error *error) {
    full_state state = {0};
    full_info info = {0};
    ehd_status status = full_state_init(&state, &contact->grid, error);

    if (!status) status = fallback_load(&state, solver, result, contact, error);
    double before = program_seconds();
    if (!status) status = newton_steps(&info, &state, contact, 0, error);
    double between = program_seconds();
    if (!status) outcome->residual = info.residual;
    if (!status) status = newton_steps(&info, &state, contact, 1, error);
    if (!status) {
        const contact_scalars scalars = full_evaluate_scalars(&state, contact);
        outcome->tolerance = full_default_settings().tolerance;
        outcome->residual_seconds = between - before;
        outcome->step_seconds = program_seconds() - between;
        outcome->film_change =
            info.newton_iterations == 1
                ? scalars.central_film_thickness / result->scalars.central_film_thickness - 1
                : NAN;
    }
    full_state_free(&state);
    return status;
}
