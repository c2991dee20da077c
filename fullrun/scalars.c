/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fullrun/full_solver.h"

#include <math.h>

/* Value at X = 0: nodal where a node lies there, else by the cubic through the four nodes around. */
static double central_value(const double *values, const ehd_grid *grid) {
    double place = -grid->x_min / grid->step + 1; // in nodes
    double nearest = round(place);

    if (fabs(place - nearest) < 1e-6) return values[(size_t)nearest];
    size_t k = (size_t)floor(place);
    double t = place - (double)k;
    return -t * (t - 1) * (t - 2) / 6 * values[k - 1] +
           (t + 1) * (t - 1) * (t - 2) / 2 * values[k] - (t + 1) * t * (t - 2) / 2 * values[k + 1] +
           (t + 1) * t * (t - 1) / 6 * values[k + 2];
}

contact_scalars full_evaluate_scalars(const full_state *state, const ehd_contact *contact) {
    const ehd_grid *grid = &contact->grid;
    double least = INFINITY, sum = 0;

    for (size_t k = 1; k <= grid->num_inner; k++) {
        least = fmin(least, state->film[k]);
        sum += state->pressure[k];
    }
    contact_scalars scalars = {.central_film_thickness = central_value(state->film, grid),
                               .minimum_film_thickness = least,
                               .central_pressure = central_value(state->pressure, grid),
                               .rigid_approach = state->rigid_approach,
                               .exit_position = grid_x(grid, state->exit),
                               .load = sum * grid->step / contact->kind->load};
    return scalars;
}
