/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fullrun/judge.h"

#include "common/physics/reynolds.h"
#include "common/physics/traction.h"

#include <math.h>
#include <stdio.h>

/* Returns the highest pressure in Pa. */
static double highest_pressure(const full_state *state, const ehd_contact *contact) {
    double highest = 0;

    for (size_t k = 0; k < contact->grid.num_nodes; k++)
        highest = fmax(highest, state->pressure[k] * contact->hertz_pressure);
    return highest;
}

bool full_beyond_law(const full_state *state, const ehd_contact *contact) {
    return highest_pressure(state, contact) > contact->lubricant.pressure_limit;
}

double full_flow_doubt(const full_state *state, const ehd_contact *contact) {
    const ehd_grid *grid = &contact->grid;
    double most = 0;

    if (!traction_thins_flow(contact)) return 0;
    for (size_t r = 0; r < grid->num_inner; r++) {
        const size_t node = grid_node_of_row(grid, r);
        const reynolds_stencil stencil = reynolds_stencil_at(grid, node);
        most = fmax(most,
                    reynolds_flow_doubt(contact, &stencil, &node, 1, state->pressure, state->film));
    }
    return most;
}

ehd_status full_judge(char reason[JUDGE_REASON], const full_info *info, const full_state *state,
                      const ehd_contact *contact) {
    const ehd_grid *grid = &contact->grid;
    const ehd_lubricant *lubricant = &contact->lubricant;
    const bool backwards = contact->entrainment < 0;
    double highest = highest_pressure(state, contact);
    int length = 0;

    if (info->status != EHD_OK)
        length =
            snprintf(reason, JUDGE_REASON, "found %s after %zu Newton iterations, residual %.1e",
                     info->reason, info->newton_iterations, info->residual);
    else if (full_is_cut(state, grid, backwards))
        length =
            snprintf(reason, JUDGE_REASON,
                     "found the exit boundary outside the domain, expected it before X = %g "
                     "(grid.%s)",
                     grid_x(grid, backwards ? 1 : grid->inner_x), backwards ? "x_min" : "x_max");
    // a pressure beyond the limit of the viscosity law is reported even after a failed iteration,
    // because it is the likely cause of the failure
    if (full_beyond_law(state, contact))
        length += snprintf(reason + length, JUDGE_REASON - (size_t)length,
                           "%sfound a pressure of %.4g GPa, expected at most %.4g GPa, the limit "
                           "of the %s law",
                           length > 0 ? "; " : "", highest * 1e-9, lubricant->pressure_limit * 1e-9,
                           lubricant->viscosity->name);
    reason[length] = '\0';
    if (length > 0) return EHD_NOT_CONVERGED;
    if (!(full_flow_doubt(state, contact) > default_accuracy)) return EHD_OK;
    snprintf(reason, JUDGE_REASON, "%s", flow_doubt_reason);
    return EHD_UNTRUSTED;
}
