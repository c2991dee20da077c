/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/reynolds.h"

#include <math.h>
#include <string.h>

reynolds_stencil reynolds_stencil_at(const ehd_grid *grid, size_t node) {
    size_t width = grid_width(grid), column = grid->inner_lines > 1 ? node % width : node;
    reynolds_stencil stencil = {
        {column > 1 ? node - 2 : NO_NODE, node - 1, node, node + 1, NO_NODE, NO_NODE}};

    if (grid->inner_lines > 1) {
        stencil.node[NODE_LEFT] = node < width ? node + width : node - width;
        stencil.node[NODE_RIGHT] = node + width;
    }
    return stencil;
}

void reynolds_fluid_evaluate(reynolds_fluid *fluid, const ehd_contact *contact,
                             const double *pressure, size_t num_nodes) {
    lubricant_evaluate(fluid->mobility, fluid->mobility_slope, fluid->density, fluid->density_slope,
                       &contact->lubricant, contact->hertz_pressure, pressure, num_nodes);
    for (size_t i = 0; i < num_nodes; i++) {
        double inverse = exp(-fluid->mobility[i]) / contact->lambda; // 1/(eta lambda)
        double inverse_slope = -fluid->mobility_slope[i] * inverse;
        if (fluid->density) {
            fluid->mobility[i] = fluid->density[i] * inverse;
            fluid->mobility_slope[i] =
                fluid->density[i] * inverse_slope + fluid->density_slope[i] * inverse;
        } else {
            fluid->mobility[i] = inverse;
            fluid->mobility_slope[i] = inverse_slope;
        }
    }
}

/* Flow coefficient eps = mobility H^3 at a node and its derivatives. */
typedef struct conductance {
    double value, by_pressure, by_film;
} conductance;

static conductance conductance_at(const reynolds_fluid *fluid, const double *film, size_t node) {
    double h = film[node], h2 = h * h, mobility = fluid->mobility[node];
    conductance eps = {mobility * h2 * h, fluid->mobility_slope[node] * h2 * h, 3 * mobility * h2};
    return eps;
}

/* Adds the part of d/dx(eps dP/dx) that comes from the flow between stencil nodes `a` and HERE. */
static void add_flow(reynolds_row *row, int a, double scale, const reynolds_stencil *stencil,
                     const conductance *eps, const double *pressure) {
    double drop = pressure[stencil->node[a]] - pressure[stencil->node[NODE_HERE]];
    double mean = (eps[a].value + eps[NODE_HERE].value) / 2;

    row->residual += scale * mean * drop;
    row->by_pressure[a] += scale * (mean + eps[a].by_pressure / 2 * drop);
    row->by_pressure[NODE_HERE] += scale * (-mean + eps[NODE_HERE].by_pressure / 2 * drop);
    row->by_film[a] += scale * eps[a].by_film / 2 * drop;
    row->by_film[NODE_HERE] += scale * eps[NODE_HERE].by_film / 2 * drop;
}

/* Adds weight * rho H at stencil node `a`. */
static void add_mass(reynolds_row *row, int a, double weight, const reynolds_stencil *stencil,
                     const reynolds_fluid *fluid, const double *film) {
    size_t node = stencil->node[a];
    double h = film[node];

    if (fluid->density) {
        row->residual += weight * fluid->density[node] * h;
        row->by_pressure[a] += weight * fluid->density_slope[node] * h;
        row->by_film[a] += weight * fluid->density[node];
    } else {
        row->residual += weight * h;
        row->by_film[a] += weight;
    }
}

void reynolds_rows(reynolds_row *rows, double step, double entrainment,
                   const reynolds_squeeze *squeeze, const reynolds_stencil *stencils,
                   size_t num_rows, const reynolds_fluid *fluid, const double *pressure,
                   const double *film) {
    const double flow = 1 / (step * step);

    for (size_t r = 0; r < num_rows; r++) {
        const reynolds_stencil *stencil = &stencils[r];
        reynolds_row *row = &rows[r];
        conductance eps[NUM_STENCIL];

        memset(row, 0, sizeof *row);
        for (int a = NODE_BACK; a <= NODE_AHEAD; a++)
            eps[a] = conductance_at(fluid, film, stencil->node[a]);
        add_flow(row, NODE_AHEAD, flow, stencil, eps, pressure);
        add_flow(row, NODE_BACK, flow, stencil, eps, pressure);
        for (int a = NODE_LEFT; a <= NODE_RIGHT && stencil->node[a] != NO_NODE; a++) {
            eps[a] = conductance_at(fluid, film, stencil->node[a]);
            add_flow(row, a, flow, stencil, eps, pressure);
        }

        if (stencil->node[NODE_BACK2] == NO_NODE) {
            add_mass(row, NODE_HERE, -entrainment / step, stencil, fluid, film);
            add_mass(row, NODE_BACK, entrainment / step, stencil, fluid, film);
        } else {
            add_mass(row, NODE_HERE, -1.5 * entrainment / step, stencil, fluid, film);
            add_mass(row, NODE_BACK, 2 * entrainment / step, stencil, fluid, film);
            add_mass(row, NODE_BACK2, -0.5 * entrainment / step, stencil, fluid, film);
        }
        if (squeeze) {
            add_mass(row, NODE_HERE, -squeeze->rate, stencil, fluid, film);
            row->residual -= squeeze->previous[r];
        }
    }
}
