/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fullrun/far_field.h"

#include <math.h>

/* S(phi), zero behind the exit at tan(phi) = -3 tanh(3 phi), where tanh is 1 - 2e-5. */
static double shape(double phi) {
    const double exit = M_PI - atan(3);

    return phi < exit ? 0.8 * (cos(phi) - cos(exit) * cosh(3 * phi) / cosh(3 * exit)) : 0;
}

static double pressure_at(const ehd_contact *contact, double film, double x, double y) {
    return contact->lambda * shape(atan2(fabs(y), -x)) * hypot(x, y) / (4 * film * film);
}

/* Distance of the end of what the sum over the nodes counts, half a step beyond the boundary nodes. */
static double distance_of_end(const ehd_grid *grid, double phi) {
    const size_t last = grid->num_nodes - 1;
    const double half = 0.5 * grid->step;
    const double along = cos(phi) > 0 ? half - grid_x(grid, 0) : half + grid_x(grid, last);

    return fmin(along / fabs(cos(phi)), (grid_y(grid, last) + half) / sin(phi));
}

/* The integral of P beyond the boundary nodes: midpoint rule in phi and in s = end / r. */
static double load_beyond(const ehd_contact *contact, double film_at_inlet) {
    enum { ANGLES = 400, DISTANCES = 20 };
    const ehd_grid *grid = &contact->grid;
    const double twice_c = 2 * film_at_inlet - pow(grid_x(grid, 0), 2);
    double sum = 0;

    for (int i = 0; i < ANGLES; i++) {
        const double phi = M_PI * (i + 0.5) / ANGLES, end = distance_of_end(grid, phi);
        for (int j = 0; j < DISTANCES; j++) {
            const double s = (j + 0.5) / DISTANCES, film = end * end + twice_c * s * s;
            sum += shape(phi) * end * end * end / (film * film);
        }
    }
    return 2 * contact->lambda * sum * M_PI / ANGLES / DISTANCES;
}

void far_field_join(full_state *state, ehd_contact *contact) {
    const ehd_grid *grid = &contact->grid;
    const size_t width = grid_width(grid);

    for (size_t k = 0; k < grid->num_nodes; k++) {
        const size_t column = k % width;
        const bool inner = column > 0 && column + 1 < width && grid_is_inner_line(grid, k / width);
        if (!inner)
            state->pressure[k] =
                pressure_at(contact, state->film[k], grid_x(grid, k), grid_y(grid, k));
    }
    contact->closure.value -=
        contact->closure.by_load * load_beyond(contact, state->film[grid_central_line(grid)]);
}
