/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/exit.h"

#include <math.h>
#include <string.h>

double exit_multiplier(const reynolds_row *row) {
    return -row->residual;
}

double exit_violation(bool has_pressure, double pressure, double multiplier) {
    return has_pressure ? -pressure : -multiplier;
}

// ---- the exit within the cell of a node

bool exit_is_within_node(const ehd_grid *grid) {
    return grid->inner_lines == 1 && grid->discretization == DISCRETIZATION_ACCURATE;
}

/* The cubic through four neighbouring nodes, evaluated at a distance of t grid steps from the
 * second node. */
typedef struct cubic {
    double weight[4], slope[4]; // slope: derivatives of the weights with respect to t
} cubic;

static cubic cubic_at(double t) {
    return (cubic){.weight = {-t * (t - 1) * (t - 2) / 6, (t + 1) * (t - 1) * (t - 2) / 2,
                              -(t + 1) * t * (t - 2) / 2, (t + 1) * t * (t - 1) / 6},
                   .slope = {-(3 * t * t - 6 * t + 2) / 6, (3 * t * t - 4 * t - 1) / 2,
                             -(3 * t * t - 2 * t - 2) / 2, (3 * t * t - 1) / 6}};
}

/* A number, such as the film at the exit, with its derivatives. The number is stored in
 * row.residual. Its derivatives with respect to the pressures and films of a stencil are stored in
 * the other members of `row`. `by_offset` is its derivative with respect to the distance, in grid
 * steps, from the last node before the exit to the exit. */
typedef struct quantity {
    reynolds_row row;
    double by_offset;
} quantity;

/* Returns the film at a distance of `share` * `offset` grid steps downstream of NODE_HERE. */
static quantity film_behind(double offset, double share, const reynolds_stencil *stencil,
                            const double *film) {
    const cubic interpolation = cubic_at(share * offset);
    quantity result = {0};

    for (int i = 0; i < 4; i++) {
        const int a = NODE_BACK + i;
        result.row.residual += interpolation.weight[i] * film[stencil->node[a]];
        result.row.by_film[a] = interpolation.weight[i];
        result.by_offset += share * interpolation.slope[i] * film[stencil->node[a]];
    }
    return result;
}

/* Returns rho H half way between the node NODE_HERE and the exit. Interpolates between the four
 * nodes from which a Reynolds row computes rho H at the half node ahead. */
static quantity mass_half_way(double offset, const reynolds_stencil *stencil,
                              const reynolds_fluid *fluid, const double *film) {
    const cubic interpolation = cubic_at(1 + offset / 2);
    quantity result = {0};

    for (int i = 0; i < 4; i++) {
        const int a = NODE_BACK2 + i;
        const size_t node = stencil->node[a];
        const double density = fluid->density ? fluid->density[node] : 1;
        const double slope = fluid->density ? fluid->density_slope[node] : 0;
        result.row.residual += interpolation.weight[i] * density * film[node];
        result.row.by_film[a] = interpolation.weight[i] * density;
        result.row.by_pressure[a] = interpolation.weight[i] * slope * film[node];
        result.by_offset += interpolation.slope[i] / 2 * density * film[node];
    }
    return result;
}

static void add_row(reynolds_row *target, double factor, const reynolds_row *source) {
    target->residual += factor * source->residual;
    for (int a = 0; a < NUM_LINE_STENCIL; a++) {
        target->by_pressure[a] += factor * source->by_pressure[a];
        target->by_film[a] += factor * source->by_film[a];
    }
}

/* Returns (q - q_exit) / H^3 with its derivatives. */
static quantity rise_over_cube(const quantity *q, const quantity *at_exit, const quantity *film) {
    const double h = film->row.residual, cube = 1 / (h * h * h);
    const double rise = q->row.residual - at_exit->row.residual;
    quantity result = {0};

    add_row(&result.row, cube, &q->row);
    add_row(&result.row, -cube, &at_exit->row);
    add_row(&result.row, -3 * rise * cube / h, &film->row);
    result.by_offset = cube * (q->by_offset - at_exit->by_offset - 3 * rise / h * film->by_offset);
    result.row.residual = rise * cube;
    return result;
}

void exit_cell_at(exit_cell *cell, const ehd_grid *grid, double entrainment, double offset,
                  double flux, const reynolds_stencil *stencil, const reynolds_fluid *fluid,
                  const double *pressure, const double *film) {
    const size_t here = stencil->node[NODE_HERE], ahead = stencil->node[NODE_AHEAD];
    const double step = grid->step, h = film[here], scale = h * h * h / (step * step);
    const double density = fluid->density ? fluid->density[ahead] : 1; // without pressure
    const reynolds_link drop = reynolds_link_ahead(stencil, fluid, pressure, film);

    // q = rho H at the exit, at the node before the exit, and half way between both
    quantity at_exit = film_behind(offset, 1, stencil, film);
    const quantity film_between = film_behind(offset, 0.5, stencil, film);
    const quantity between = mass_half_way(offset, stencil, fluid, film);
    const quantity film_here = {.row = {.residual = h, .by_film[NODE_HERE] = 1}};
    quantity mass_here = {0};
    add_row(&mass_here.row, fluid->density ? fluid->density[here] : 1, &film_here.row);
    if (fluid->density) mass_here.row.by_pressure[NODE_HERE] = fluid->density_slope[here] * h;
    for (int a = 0; a < NUM_LINE_STENCIL; a++)
        at_exit.row.by_film[a] *= density;
    at_exit.row.residual *= density;
    at_exit.by_offset *= density;

    // first equation: flux - U q_exit = 0, divided by U dq_exit/d offset
    const double slope = entrainment * at_exit.by_offset;
    memset(&cell->offset, 0, sizeof cell->offset);
    add_row(&cell->offset, -entrainment / slope, &at_exit.row);
    cell->offset.residual += flux / slope;
    cell->offset_by_flux = 1 / slope;
    cell->flux_residual = cell->offset.residual * slope / step;

    // second equation: int mobility dP = int U (q - q_exit)/H^3 dx from the node to the exit, by
    // Simpson's rule
    const quantity first = rise_over_cube(&mass_here, &at_exit, &film_here);
    const quantity second = rise_over_cube(&between, &at_exit, &film_between);
    const double length = offset * step * entrainment / 6;
    const double sum = first.row.residual + 4 * second.row.residual;
    reynolds_row *row = &cell->row;
    memset(row, 0, sizeof *row);
    add_row(row, -length * scale, &first.row);
    add_row(row, -4 * length * scale, &second.row);
    row->residual += scale * drop.value;
    row->by_pressure[NODE_HERE] += scale * drop.by_before;
    row->by_film[NODE_HERE] += 3 * row->residual / h + scale * drop.by_film;
    const double by_offset =
        -scale * (step * entrainment / 6 * sum + length * (first.by_offset + 4 * second.by_offset));
    add_row(row, by_offset, &cell->offset);
    cell->row_by_flux = by_offset / slope;

    cell->curvature = slope * step / (2 * fluid->mobility[ahead] * h * h * h);
}

void exit_cell_add_flux(exit_cell *cell, const reynolds_row *flux) {
    reynolds_row *rows[] = {&cell->row, &cell->offset};
    const double factors[] = {cell->row_by_flux, cell->offset_by_flux};

    for (int i = 0; i < 2; i++) {
        const double residual = rows[i]->residual;
        add_row(rows[i], factors[i], flux);
        rows[i]->residual = residual;
    }
}

// ---- the position of the exit within a cell, for solutions with exits at nodes

/* A value and its derivative with respect to the offset. */
typedef struct flow {
    double value, slope;
} flow;

/* Returns U rho H at the distance `offset` downstream of HERE, where there is no pressure. */
static flow carried_at(double offset, double entrainment, const reynolds_stencil *stencil,
                       const reynolds_fluid *fluid, const double *film) {
    const quantity at_exit = film_behind(offset, 1, stencil, film);
    const double density = fluid->density ? fluid->density[stencil->node[NODE_AHEAD]] : 1;

    return (flow){entrainment * density * at_exit.row.residual,
                  entrainment * density * at_exit.by_offset};
}

/* Returns the rate at which the film stores fluid between the half node before HERE and the offset
 * t, divided by the grid step. A whole cell is integrated by the midpoint rule. Beyond whole cells
 * d(rho H)/dT is linear. For an exit at HERE the straight line passes through the values at BACK
 * and HERE, for an exit at AHEAD through the values at HERE and AHEAD. The result is therefore
 * continuous when the exit passes a node. */
static flow taken_up_to(double t, const reynolds_squeeze *squeeze, const reynolds_stencil *stencil,
                        const reynolds_fluid *fluid, const double *film) {
    double rate[3]; // d(rho H)/dT at BACK, HERE and AHEAD

    for (int i = 0; i < 3; i++) {
        const size_t node = stencil->node[NODE_BACK + i];
        const double density = fluid->density ? fluid->density[node] : 1;
        rate[i] = squeeze->rate * density * film[node] + squeeze->previous[i];
    }
    const double part = (t * t - 0.25) / 2, back = rate[1] - rate[0], ahead = rate[2] - rate[1];
    return (flow){(t + 0.5) * rate[1] + part * ((1 - t) * back + t * ahead),
                  rate[1] + t * ((1 - t) * back + t * ahead) + part * (ahead - back)};
}

double exit_place(const ehd_grid *grid, double entrainment, double flux,
                  const reynolds_squeeze *squeeze, const reynolds_stencil *stencil,
                  const reynolds_fluid *fluid, const double *film) {
    double place = 0.5, change = INFINITY, last_change;

    do { // Newton's iteration, until round-off ends the decrease of its steps
        flow leaving = carried_at(place, entrainment, stencil, fluid, film);
        if (squeeze) {
            const flow taken = taken_up_to(place, squeeze, stencil, fluid, film);
            leaving.value += grid->step * taken.value;
            leaving.slope += grid->step * taken.slope;
        }
        if (!(leaving.slope > 0)) return NAN;
        const double next = fmin(fmax(place + (flux - leaving.value) / leaving.slope, -0.5), 1.5);
        last_change = change;
        change = fabs(next - place);
        place = next;
    } while (change < last_change);
    return place;
}
