/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes films, pressure, load (eq. 9 of Maier et al. 2015), exits and traction of a solution.
 * Interpolates between the nodes by polynomials (minimum.h).
 * Called by main.c, training.c, full_march.c and resolution.c, and by romrun/calibrate. */
#include "fullrun/full_solver.h"

#include "common/physics/far_field.h"
#include "common/physics/minimum.h"

#include <math.h>

/* Returns the value on a grid line at X = 0. If no node lies there, interpolates by the cubic
 * through the four nearest nodes. */
static double central_value(const double *values, const ehd_grid *grid) {
    double column = -grid->x_min / grid->step + 1;
    double nearest = round(column);

    if (fabs(column - nearest) < 1e-6) return values[(size_t)nearest];
    size_t k = (size_t)floor(column);
    double t = column - (double)k;
    return -t * (t - 1) * (t - 2) / 6 * values[k - 1] +
           (t + 1) * (t - 1) * (t - 2) / 2 * values[k] - (t + 1) * t * (t - 2) / 2 * values[k + 1] +
           (t + 1) * t * (t - 1) / 6 * values[k + 2];
}

static double film_at(const void *film, size_t node) {
    return ((const double *)film)[node];
}

/* Returns the smallest film, and its node in *node. On a point contact, interpolates around the
 * node with the smallest film. On a line contact, interpolates around each node whose film is not
 * thicker than the films of its two neighbours, since the node with the smallest film need not lie
 * in the deepest valley. */
static double smallest_film(size_t *node, const double *film, const ehd_grid *grid) {
    size_t lowest = grid_node_of_row(grid, 0);

    for (size_t r = 1; r < grid->num_inner; r++)
        if (film[grid_node_of_row(grid, r)] < film[lowest]) lowest = grid_node_of_row(grid, r);
    double smallest = minimum_around(grid, lowest, film_at, film);
    *node = lowest;
    for (size_t k = 1; k <= grid->num_inner && grid->inner_lines == 1; k++) {
        if (film[k] > film[k - 1] || film[k] > film[k + 1]) continue;
        const double here = minimum_around(grid, k, film_at, film);
        if (!(here < smallest)) continue;
        smallest = here;
        *node = k;
    }
    return smallest;
}

/* Checks the interpolated film. If a film nearly closes between nodes, the grid does not resolve
 * it, and the interpolated film may be below zero. */
bool full_film_closes(const full_state *state, const ehd_grid *grid) {
    size_t node;

    return !(smallest_film(&node, state->film, grid) > 0);
}

double full_exit_position(const full_state *state, const ehd_grid *grid) {
    if (isnan(state->exit_offset)) return grid_x(grid, state->exit);
    return grid_x(grid, state->exit - 1) + state->exit_offset * grid->step;
}

/* `exit` is the first node without pressure behind an interval of the pressurised zone. Moves
 * `exit` upstream to the node behind the last positive pressure of this interval. The pressures
 * that it passes are not positive: they are noise of the active set. Returns false if the interval
 * has no positive pressure. */
static bool find_end_of_pressure(size_t *exit, const full_state *state, bool backwards) {
    size_t before = backwards ? *exit + 1 : *exit - 1;

    for (; full_has_pressure(state, before); before = backwards ? before + 1 : before - 1) {
        if (state->pressure[before] > 0) return true;
        *exit = before;
    }
    return false;
}

static void list_exits_of_line(double *positions, const full_state *state, const ehd_grid *grid,
                               size_t first, bool backwards) {
    const size_t last = grid_width(grid) - 1;
    size_t count = 0;

    for (size_t i = last; i > 0 && count < GRID_EXITS; i--) {
        size_t exit = first + (backwards ? last - i : i);
        if (!full_has_pressure(state, exit) && find_end_of_pressure(&exit, state, backwards))
            positions[count++] = grid_x(grid, exit);
    }
    while (count < GRID_EXITS)
        positions[count++] = NAN;
}

void full_list_exits(double *positions, const full_state *state, const ehd_grid *grid,
                     bool backwards) {
    const ehd_grid whole = grid_whole(grid);
    const size_t first = grid_first_line(grid);

    for (size_t l = 0; l < whole.inner_lines; l++) {
        const size_t own = first + grid_row_of_whole(grid, l * grid->inner_x) / grid->inner_x;
        list_exits_of_line(positions + l * GRID_EXITS, state, grid, own * grid_width(grid),
                           backwards);
    }
}

contact_scalars full_evaluate_scalars(const full_state *state, const ehd_contact *contact) {
    const ehd_grid *grid = &contact->grid;
    size_t line = grid_central_line(grid), exit = state->exit, lowest;
    const double minimum = smallest_film(&lowest, state->film, grid);
    const double beyond = far_field_load(contact, state->rigid_approach).value;
    double sum = 0;

    for (size_t r = 0; r < grid->num_inner; r++) {
        size_t k = grid_node_of_row(grid, r);
        sum += grid_weight(grid, k) * state->pressure[k];
    }
    if (grid->inner_lines > 1)
        for (exit = line + grid->inner_x + 1;
             exit > line + 1 && !full_has_pressure(state, exit - 1);)
            exit--;
    contact_scalars scalars = {
        .central_film_thickness = central_value(state->film + line, grid),
        .minimum_film_thickness = minimum > 0 ? minimum : state->film[lowest],
        .minimum_position = grid_x(grid, lowest),
        .central_pressure = central_value(state->pressure + line, grid),
        .rigid_approach = state->rigid_approach,
        .exit_position =
            grid->inner_lines > 1 ? grid_x(grid, exit) : full_exit_position(state, grid),
        .load = (sum * grid_cell(grid) + beyond) / contact->kind->load};
    return scalars;
}

contact_traction full_evaluate_traction(const full_state *state, const ehd_contact *contact) {
    const contact_scalars scalars = full_evaluate_scalars(state, contact);

    return contact_traction_of(contact, state->pressure, state->film, &scalars);
}
