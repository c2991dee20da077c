/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/reynolds.h"

#include "common/physics/eyring_flow.h"
#include "common/physics/traction.h"

#include <math.h>
#include <string.h>

// ---- stencils

/* Returns the node that lies `lines` lines away across the entrainment. On a half grid the lines
 * are mirrored at y = 0. Returns NO_NODE beyond the boundary. */
static size_t node_across(const ehd_grid *grid, size_t node, ptrdiff_t lines) {
    const ptrdiff_t width = (ptrdiff_t)grid_width(grid);
    ptrdiff_t line = (ptrdiff_t)node / width + lines;

    if (grid->half && line < 0) line = -line;
    if (line < 0 || line >= (ptrdiff_t)grid_lines(grid)) return NO_NODE;
    return (size_t)(line * width + (ptrdiff_t)node % width);
}

size_t reynolds_reach_back(const ehd_grid *grid) {
    return grid->discretization != DISCRETIZATION_PUBLISHED ? 3 : 2;
}

size_t reynolds_reach_ahead(const ehd_grid *grid) {
    return grid->discretization != DISCRETIZATION_PUBLISHED ? 2 : 1;
}

reynolds_stencil reynolds_stencil_at(const ehd_grid *grid, size_t node) {
    const bool wide = grid->discretization != DISCRETIZATION_PUBLISHED;
    size_t width = grid_width(grid), column = grid->inner_lines > 1 ? node % width : node;
    reynolds_stencil stencil = {
        .node = {[NODE_BACK3] = wide && column > 2 ? node - 3 : NO_NODE,
                 [NODE_BACK2] = column > 1 ? node - 2 : NO_NODE,
                 [NODE_BACK] = node - 1,
                 [NODE_HERE] = node,
                 [NODE_AHEAD] = node + 1,
                 [NODE_AHEAD2] = wide && column + 2 < width ? node + 2 : NO_NODE,
                 [NODE_LEFT2] = NO_NODE,
                 [NODE_LEFT] = NO_NODE,
                 [NODE_RIGHT] = NO_NODE,
                 [NODE_RIGHT2] = NO_NODE,
                 [NODE_BACK_LEFT] = NO_NODE,
                 [NODE_BACK_RIGHT] = NO_NODE,
                 [NODE_AHEAD_LEFT] = NO_NODE,
                 [NODE_AHEAD_RIGHT] = NO_NODE}};

    if (grid->inner_lines == 1) return stencil;
    stencil.node[NODE_LEFT] = node_across(grid, node, -1);
    stencil.node[NODE_RIGHT] = node_across(grid, node, 1);
    if (!wide) return stencil;
    stencil.node[NODE_LEFT2] = node_across(grid, node, -2);
    stencil.node[NODE_RIGHT2] = node_across(grid, node, 2);
    if (grid->discretization != DISCRETIZATION_CROSS_FLUX) return stencil;
    stencil.node[NODE_BACK_LEFT] = node_across(grid, node - 1, -1);
    stencil.node[NODE_BACK_RIGHT] = node_across(grid, node - 1, 1);
    stencil.node[NODE_AHEAD_LEFT] = node_across(grid, node + 1, -1);
    stencil.node[NODE_AHEAD_RIGHT] = node_across(grid, node + 1, 1);
    return stencil;
}

reynolds_stencil reynolds_stencil_reversed(const ehd_grid *grid, size_t node) {
    const bool wide = grid->discretization != DISCRETIZATION_PUBLISHED;
    const size_t width = grid_width(grid), column = grid->inner_lines > 1 ? node % width : node;
    reynolds_stencil stencil = reynolds_stencil_at(grid, node);

    stencil.node[NODE_BACK3] = wide && column + 3 < width ? node + 3 : NO_NODE;
    stencil.node[NODE_BACK2] = column + 2 < width ? node + 2 : NO_NODE;
    stencil.node[NODE_BACK] = node + 1;
    stencil.node[NODE_AHEAD] = node - 1;
    stencil.node[NODE_AHEAD2] = wide && column > 1 ? node - 2 : NO_NODE;
    if (grid->discretization != DISCRETIZATION_CROSS_FLUX) return stencil;
    stencil.node[NODE_BACK_LEFT] = node_across(grid, node + 1, -1);
    stencil.node[NODE_BACK_RIGHT] = node_across(grid, node + 1, 1);
    stencil.node[NODE_AHEAD_LEFT] = node_across(grid, node - 1, -1);
    stencil.node[NODE_AHEAD_RIGHT] = node_across(grid, node - 1, 1);
    return stencil;
}

// ---- fluid

/* Returns the factor of the flow across the entrainment: (a/b)^2, divided by the square of the
 * ratio of width to length of a cell. The factor multiplies second differences from line to line,
 * divided by the square of the step along. */
static inline double flow_across(const contact_shape *shape) {
    return shape->flow_across / (shape->cell * shape->cell);
}

reynolds_fluid reynolds_fluid_in(double *memory, size_t num_nodes, const ehd_contact *contact) {
    const bool compressible = contact->lubricant.density != NULL;
    const bool accurate = contact->grid.discretization != DISCRETIZATION_PUBLISHED;
    const flow_thinning thinning = traction_thinning(contact);

    return (reynolds_fluid){
        .mobility = memory,
        .mobility_slope = memory + num_nodes,
        .log_mobility = accurate ? memory + 2 * num_nodes : NULL,
        .density = compressible ? memory + 3 * num_nodes : NULL,
        .density_slope = compressible ? memory + 4 * num_nodes : NULL,
        .between = accurate && !contact->lubricant.viscosity->exponential ? contact : NULL,
        .thinned = traction_thins_flow(contact) ? contact : NULL,
        .thinning = thinning.sliding / contact->lambda,
        .gradient_thinning = thinning.gradient / contact->grid.step,
        .gradient_across = sqrt(flow_across(&contact->grid.shape))};
}

reynolds_fluid reynolds_fluid_from(const reynolds_fluid *fluid, size_t first_node) {
    reynolds_fluid from = *fluid;
    double **arrays[] = {&from.mobility, &from.mobility_slope, &from.log_mobility, &from.density,
                         &from.density_slope};

    for (size_t i = 0; i < NUM_FLUID_ARRAYS; i++)
        if (*arrays[i]) *arrays[i] += first_node;
    return from;
}

void reynolds_fluid_evaluate(reynolds_fluid *fluid, const ehd_contact *contact,
                             const double *pressure, size_t num_nodes) {
    lubricant_evaluate(fluid->mobility, fluid->mobility_slope, fluid->density, fluid->density_slope,
                       &contact->lubricant, contact->hertz_pressure, pressure, num_nodes);
    for (size_t i = 0; i < num_nodes; i++) {
        double inverse = exp(-fluid->mobility[i]) / contact->lambda; // 1/(eta lambda)
        double inverse_slope = -fluid->mobility_slope[i] * inverse;
        if (fluid->log_mobility)
            fluid->log_mobility[i] =
                (fluid->density ? log(fluid->density[i]) : 0) - fluid->mobility[i];
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

// ---- the state at the nodes of a stencil

typedef struct row_nodes {
    const reynolds_stencil *stencil;
    const reynolds_fluid *fluid;
    const double *pressure, *film;
} row_nodes;

/* rho H at a node and its derivatives. */
typedef struct mass {
    double value, by_pressure, by_film;
} mass;

static inline mass mass_at(const row_nodes *at, int a) {
    const size_t node = at->stencil->node[a];
    const reynolds_fluid *fluid = at->fluid;
    const double h = at->film[node];

    if (!fluid->density) return (mass){h, 0, 1};
    return (mass){fluid->density[node] * h, fluid->density_slope[node] * h, fluid->density[node]};
}

static inline void add_mass(reynolds_row *row, int a, double weight, const row_nodes *at) {
    const size_t node = at->stencil->node[a];
    const reynolds_fluid *fluid = at->fluid;
    const double h = at->film[node];

    if (fluid->density) {
        row->residual += weight * fluid->density[node] * h;
        row->by_pressure[a] += weight * fluid->density_slope[node] * h;
        row->by_film[a] += weight * fluid->density[node];
    } else {
        row->residual += weight * h;
        row->by_film[a] += weight;
    }
}

// ---- the published discretisation

/* Flow coefficient eps = mobility H^3 at a node and its derivatives. */
typedef struct conductance {
    double value, by_pressure, by_film;
} conductance;

static inline conductance conductance_at(const row_nodes *at, int a) {
    size_t node = at->stencil->node[a];
    double h = at->film[node], h2 = h * h, mobility = at->fluid->mobility[node];
    conductance eps = {mobility * h2 * h, at->fluid->mobility_slope[node] * h2 * h,
                       3 * mobility * h2};
    return eps;
}

/* Adds scale * eps dP between stencil nodes `a` and `b`, with the mean of the nodal eps. */
static inline void add_mean_flow(reynolds_row *row, int a, int b, double scale,
                                 const conductance eps[NUM_STENCIL], const row_nodes *at) {
    const size_t *node = at->stencil->node;
    double drop = at->pressure[node[b]] - at->pressure[node[a]];
    double mean = (eps[a].value + eps[b].value) / 2;

    row->residual += scale * mean * drop;
    row->by_pressure[b] += scale * (mean + eps[b].by_pressure / 2 * drop);
    row->by_pressure[a] += scale * (-mean + eps[a].by_pressure / 2 * drop);
    row->by_film[b] += scale * eps[b].by_film / 2 * drop;
    row->by_film[a] += scale * eps[a].by_film / 2 * drop;
}

static inline void add_published_row(reynolds_row *row, const ehd_grid *grid, double entrainment,
                                     const row_nodes *at) {
    const double step = grid->step, flow = 1 / (step * step);
    const size_t *node = at->stencil->node;
    conductance eps[NUM_STENCIL];

    for (int a = NODE_BACK; a <= NODE_AHEAD; a++)
        eps[a] = conductance_at(at, a);
    add_mean_flow(row, NODE_HERE, NODE_AHEAD, flow, eps, at);
    add_mean_flow(row, NODE_BACK, NODE_HERE, -flow, eps, at);
    if (node[NODE_LEFT] != NO_NODE) {
        eps[NODE_LEFT] = conductance_at(at, NODE_LEFT);
        eps[NODE_RIGHT] = conductance_at(at, NODE_RIGHT);
        add_mean_flow(row, NODE_LEFT, NODE_HERE, -flow * flow_across(&grid->shape), eps, at);
        add_mean_flow(row, NODE_HERE, NODE_RIGHT, flow * flow_across(&grid->shape), eps, at);
    }
    if (node[NODE_BACK2] == NO_NODE) {
        add_mass(row, NODE_HERE, -entrainment / step, at);
        add_mass(row, NODE_BACK, entrainment / step, at);
    } else {
        add_mass(row, NODE_HERE, -1.5 * entrainment / step, at);
        add_mass(row, NODE_BACK, 2 * entrainment / step, at);
        add_mass(row, NODE_BACK2, -0.5 * entrainment / step, at);
    }
}

static void add_published_flux(reynolds_row *flux, double step, double entrainment,
                               const row_nodes *at) {
    conductance eps[NUM_STENCIL];

    add_mass(flux, NODE_BACK, 0.5 * entrainment, at);
    add_mass(flux, NODE_HERE, 0.5 * entrainment, at);
    eps[NODE_BACK] = conductance_at(at, NODE_BACK);
    eps[NODE_HERE] = conductance_at(at, NODE_HERE);
    add_mean_flow(flux, NODE_BACK, NODE_HERE, -1 / step, eps, at);
}

// ---- the accurate discretisation

/* Mobility at a pressure, with the data that mean values between nodes need. */
typedef struct mobility {
    double value, slope, logarithm, pressure;
    double density, density_slope; // for a thinned flow
    // for a thinned flow: derivatives of ln mobility with respect to the film and to the logarithm
    // of the gradient
    double log_by_film, log_by_gradient;
} mobility;

static inline mobility mobility_at(const row_nodes *at, int a) {
    const reynolds_fluid *fluid = at->fluid;
    const size_t node = at->stencil->node[a];

    return (mobility){.value = fluid->mobility[node],
                      .slope = fluid->mobility_slope[node],
                      .logarithm = fluid->log_mobility[node],
                      .pressure = at->pressure[node]};
}

/* Returns the link with the logarithmic mean of two mobilities. `logarithm` is the logarithm of
 * their ratio, before over after. `thinned`: the mobilities depend on the film. */
static inline reynolds_link logarithmic_link(const mobility *before, const mobility *after,
                                             double logarithm, bool thinned) {
    const double a = before->value, b = after->value;
    const double drop = after->pressure - before->pressure;
    double mean, by_log_a, by_log_b;

    // if the viscosity is very large, the mobility is zero in floating point, and nothing flows
    if (!(a > 0 && b > 0)) return (reynolds_link){0};
    if (fabs(logarithm) < 1) {
        // sqrt(a b) sinh(y)/y with y = ln(a/b)/2, by the series of sinh
        double y = logarithm / 2, s = y * y, geometric = a * sqrt(b / a);
        double ratio =
            1 + s * (1. / 6 +
                     s * (1. / 120 +
                          s * (1. / 5040 +
                               s * (1. / 362880 + s * (1. / 39916800 + s * (1. / 6227020800))))));
        double slope =
            y * (1. / 3 +
                 s * (1. / 30 + s * (1. / 840 + s * (1. / 45360 +
                                                     s * (1. / 3991680 + s * (1. / 518918400))))));
        mean = geometric * ratio;
        by_log_a = geometric * (ratio + slope) / 2;
        by_log_b = geometric * (ratio - slope) / 2;
    } else {
        mean = (a - b) / logarithm;
        by_log_a = (a - mean) / logarithm;
        by_log_b = (mean - b) / logarithm;
    }
    return (reynolds_link){
        mean * drop, -mean + by_log_a / a * before->slope * drop,
        mean + by_log_b / b * after->slope * drop,
        thinned ? (by_log_a * before->log_by_film + by_log_b * after->log_by_film) * drop : 0,
        thinned ? (by_log_a * before->log_by_gradient + by_log_b * after->log_by_gradient) * drop
                : 0};
}

static reynolds_link exponential_link(const mobility *before, const mobility *after) {
    return logarithmic_link(before, after, before->logarithm - after->logarithm, false);
}

/* Returns the mobility at the mean pressure of two nodes. `with_logarithm`: also computes its
 * logarithm. */
static inline mobility mobility_between(const mobility *before, const mobility *after,
                                        const ehd_contact *contact, bool with_logarithm) {
    mobility middle = {.pressure = (before->pressure + after->pressure) / 2, .density = 1};
    const bool compressible = contact->lubricant.density != NULL;
    reynolds_fluid fluid = {.mobility = &middle.value,
                            .mobility_slope = &middle.slope,
                            .log_mobility = with_logarithm ? &middle.logarithm : NULL,
                            .density = compressible ? &middle.density : NULL,
                            .density_slope = compressible ? &middle.density_slope : NULL};

    reynolds_fluid_evaluate(&fluid, contact, &middle.pressure, 1);
    return middle;
}

/* Logarithms of ratios of mobilities: before over middle, middle over after, before over after. */
typedef struct mobility_falls {
    double first, second, whole;
} mobility_falls;

/* Returns the link with the mobility at the mean pressure, extrapolated to fourth order from the
 * links of the two halves and of the whole. If the mobility falls with the pressure, the sum of the
 * two halves is more than half of the link of the whole. The flow then always has the direction of
 * the pressure difference. */
static inline reynolds_link link_with_middle(const mobility *before, const mobility *middle,
                                             const mobility *after, mobility_falls falls,
                                             bool thinned) {
    const reynolds_link whole = logarithmic_link(before, after, falls.whole, thinned);
    const reynolds_link first = logarithmic_link(before, middle, falls.first, thinned);
    const reynolds_link second = logarithmic_link(middle, after, falls.second, thinned);
    // contribution of the pressure in the middle to the derivative with respect to the pressure at
    // either node
    const double by_middle = (first.by_after + second.by_before) / 2;

    return (reynolds_link){
        (4 * (first.value + second.value) - whole.value) / 3,
        (4 * (first.by_before + by_middle) - whole.by_before) / 3,
        (4 * (second.by_after + by_middle) - whole.by_after) / 3,
        thinned ? (4 * (first.by_film + second.by_film) - whole.by_film) / 3 : 0,
        thinned ? (4 * (first.by_gradient + second.by_gradient) - whole.by_gradient) / 3 : 0,
    };
}

static reynolds_link link_between(const row_nodes *at, int before, int after) {
    const mobility a = mobility_at(at, before), b = mobility_at(at, after);

    if (!at->fluid->between) return exponential_link(&a, &b);
    const mobility middle = mobility_between(&a, &b, at->fluid->between, true);
    const mobility_falls falls = {a.logarithm - middle.logarithm, middle.logarithm - b.logarithm,
                                  a.logarithm - b.logarithm};
    return link_with_middle(&a, &middle, &b, falls, false);
}

/* Returns the mobility at a node, with the density that the thinning needs. */
static inline mobility thinned_mobility_at(const row_nodes *at, int a) {
    const reynolds_fluid *fluid = at->fluid;
    const size_t node = at->stencil->node[a];
    mobility found = mobility_at(at, a);

    found.density = fluid->density ? fluid->density[node] : 1;
    if (fluid->density) found.density_slope = fluid->density_slope[node];
    return found;
}

/* Converts the mobility of a Newtonian fluid, except its logarithm, to the mobility of a
 * shear-thinning Eyring fluid in a film of thickness `film`. */
static inline void thin(mobility *self, const reynolds_fluid *fluid, double film,
                        const eyring_gradient *gradient, bool along) {
    // if the viscosity is infinite in floating point, nothing flows, and nothing is thinned
    if (!(self->value > 0)) return;
    // ln eta = ln rho - ln mobility
    const double viscosity_slope = self->density_slope / self->density - self->slope / self->value;
    const double rate = fluid->thinning * self->density / (self->value * film);
    const eyring_factor by = along ? eyring_along(gradient, rate) : eyring_across(gradient, rate);

    self->slope = by.value * (self->slope + self->value * by.by_log_rate * viscosity_slope);
    self->value *= by.value;
    self->log_by_film = (by.by_log_gradient - by.by_log_rate) / film;
    self->log_by_gradient = by.by_log_gradient;
}

/* Returns the link of a flow that an Eyring fluid thins, along or across the sliding. `film` is the
 * film at the half node. Two logarithms of ratios are computed in place of the logarithms of all
 * mobilities and factors. */
static reynolds_link thinned_link(const row_nodes *at, int before, int after, double film,
                                  bool along) {
    const reynolds_fluid *fluid = at->fluid;
    mobility a = thinned_mobility_at(at, before), b = thinned_mobility_at(at, after);
    const double drop = b.pressure - a.pressure;
    const double of_drop = fluid->gradient_thinning * film * (along ? 1 : fluid->gradient_across);
    const eyring_gradient gradient = eyring_gradient_of(fabs(of_drop * drop));

    // this case is frequent behind the exit, where the search for the exit evaluates rows
    if (drop == 0 && a.value == b.value) {
        thin(&a, fluid, film, &gradient, along);
        return (reynolds_link){.by_before = -a.value, .by_after = a.value};
    }
    mobility middle = mobility_between(&a, &b, fluid->thinned, false);
    thin(&a, fluid, film, &gradient, along);
    thin(&b, fluid, film, &gradient, along);
    thin(&middle, fluid, film, &gradient, along);
    const double first = log(a.value / middle.value), second = log(middle.value / b.value);
    reynolds_link link =
        link_with_middle(&a, &middle, &b, (mobility_falls){first, second, first + second}, true);
    if (drop != 0) {
        link.by_before -= link.by_gradient / drop;
        link.by_after += link.by_gradient / drop;
    }
    return link;
}

/* Stencil nodes around the half node between i and i + 1: i - 2 … i + 2. For half nodes across the
 * entrainment HALF_BACK2 is not used. */
enum { HALF_BACK2, HALF_BACK, HALF_BEFORE, HALF_AFTER, HALF_AHEAD, NUM_HALF };

/* Returns the weights of the film at a half node: the weights of the cubic, or of the mean beside
 * the boundary. */
static const double *film_weights(const int of[NUM_HALF], const row_nodes *at) {
    static const double inside[NUM_HALF] = {0, -1. / 16, 9. / 16, 9. / 16, -1. / 16};
    static const double beside[NUM_HALF] = {0, 0, 0.5, 0.5, 0};
    const size_t *node = at->stencil->node;

    return node[of[HALF_BACK]] != NO_NODE && node[of[HALF_AHEAD]] != NO_NODE ? inside : beside;
}

static double film_at_half(const int of[NUM_HALF], const double weights[NUM_HALF],
                           const row_nodes *at) {
    double film = 0;

    for (int k = 0; k < NUM_HALF; k++)
        if (weights[k] != 0) film += weights[k] * at->film[at->stencil->node[of[k]]];
    return film;
}

/* Returns the weights of rho H at a half node: the weights of the cubic through three nodes
 * upstream and one node downstream of the half node. Near the inlet end of the grid, where upstream
 * nodes are missing, they are the weights of a parabola or of the mean. */
static const double *mass_weights(const int of[NUM_HALF], const row_nodes *at) {
    static const double inside[NUM_HALF] = {1. / 16, -5. / 16, 15. / 16, 5. / 16, 0};
    static const double near[NUM_HALF] = {0, -1. / 8, 6. / 8, 3. / 8, 0};
    static const double beside[NUM_HALF] = {0, 0, 0.5, 0.5, 0};
    const size_t *node = at->stencil->node;

    return node[of[HALF_BACK]] == NO_NODE    ? beside
           : node[of[HALF_BACK2]] == NO_NODE ? near
                                             : inside;
}

/* step * (U rho H - eps dP/dx) through a half node along the entrainment, and its derivatives. */
typedef struct half_flux {
    double value, by_pressure[NUM_HALF], by_film[NUM_HALF];
} half_flux;

/* Returns the flux through a half node along the entrainment. The pressure flow g = eps dP/dx is
 * not constant between the nodes: if no fluid flows across, g rises as U rho H does. The reduced
 * pressure changes by int g/H^3 dx. Simpson's rule evaluates this integral at both nodes and the
 * half node between them (the complete flux of J. H. M. ten Thije Boonkkamp, M. J. H. Anthonissen,
 * J. Sci. Comput. 46, 2011). */
static half_flux flux_along(const int of[NUM_HALF], double step, double entrainment,
                            const row_nodes *at) {
    const int a = of[HALF_BEFORE], b = of[HALF_AFTER];
    const double *film_weight = film_weights(of, at), *mass_weight = mass_weights(of, at);
    const double film = film_at_half(of, film_weight, at);
    const reynolds_link change =
        at->fluid->thinned ? thinned_link(at, a, b, film, true) : link_between(at, a, b);
    // 1/H and 1/H^3
    const double inverse_a = 1 / at->film[at->stencil->node[a]];
    const double inverse_b = 1 / at->film[at->stencil->node[b]];
    const double inverse = 1 / film;
    const double cube_a = inverse_a * inverse_a * inverse_a;
    const double cube_b = inverse_b * inverse_b * inverse_b;
    const double cube = inverse * inverse * inverse;
    const bool entrained = entrainment != 0; // false with transport along the path
    mass masses[NUM_HALF] = {{0}}, here = {0};
    half_flux flux = {0};

    for (int k = 0; k < NUM_HALF && entrained; k++) {
        if (mass_weight[k] == 0) continue;
        masses[k] = mass_at(at, of[k]);
        here.value += mass_weight[k] * masses[k].value;
    }
    const double over_a = masses[HALF_BEFORE].value - here.value;
    const double over_b = masses[HALF_AFTER].value - here.value;
    // change = flow / over_sum + rise (over_a / H_a^3 + over_b / H_b^3), where `flow` is step * g
    const double over_sum = 6 / (cube_a + 4 * cube + cube_b);
    const double rise = step * entrainment / 6;
    const double flow = (change.value - rise * (over_a * cube_a + over_b * cube_b)) * over_sum;
    // derivatives of the flow with respect to rho H at the half node, and at the two nodes
    const double by_here = rise * (cube_a + cube_b) * over_sum;
    const double by_mass_a = -rise * cube_a * over_sum, by_mass_b = -rise * cube_b * over_sum;

    flux.value = step * entrainment * here.value - flow;
    for (int k = 0; k < NUM_HALF; k++) {
        flux.by_film[k] = -(2 * flow * cube * inverse + change.by_film) * over_sum * film_weight[k];
        if (!entrained || mass_weight[k] == 0) continue;
        double by_mass = mass_weight[k] * (step * entrainment - by_here);
        if (k == HALF_BEFORE) by_mass -= by_mass_a;
        if (k == HALF_AFTER) by_mass -= by_mass_b;
        flux.by_pressure[k] = by_mass * masses[k].by_pressure;
        flux.by_film[k] += by_mass * masses[k].by_film;
    }
    flux.by_film[HALF_BEFORE] -= (flow / 2 + 3 * rise * over_a) * cube_a * inverse_a * over_sum;
    flux.by_film[HALF_AFTER] -= (flow / 2 + 3 * rise * over_b) * cube_b * inverse_b * over_sum;
    flux.by_pressure[HALF_BEFORE] -= change.by_before * over_sum;
    flux.by_pressure[HALF_AFTER] -= change.by_after * over_sum;
    return flux;
}

static void add_flux(reynolds_row *row, const int of[NUM_HALF], double scale,
                     const half_flux *flux) {
    row->residual += scale * flux->value;
    for (int k = 0; k < NUM_HALF; k++) {
        row->by_pressure[of[k]] += scale * flux->by_pressure[k];
        row->by_film[of[k]] += scale * flux->by_film[k];
    }
}

/* Adds scale * step * eps dP/dy through a half node across. */
static void add_flow_across(reynolds_row *row, const int of[NUM_HALF], double scale,
                            const row_nodes *at) {
    const double *film_weight = film_weights(of, at);
    const double film = film_at_half(of, film_weight, at), cube = film * film * film;
    const int a = of[HALF_BEFORE], b = of[HALF_AFTER];
    const reynolds_link change =
        at->fluid->thinned ? thinned_link(at, a, b, film, false) : link_between(at, a, b);

    row->residual += scale * cube * change.value;
    row->by_pressure[of[HALF_BEFORE]] += scale * cube * change.by_before;
    row->by_pressure[of[HALF_AFTER]] += scale * cube * change.by_after;
    for (int k = 0; k < NUM_HALF; k++)
        if (film_weight[k] != 0)
            row->by_film[of[k]] +=
                scale * film_weight[k] * (3 * film * film * change.value + cube * change.by_film);
}

static const int half_back[NUM_HALF] = {NODE_BACK3, NODE_BACK2, NODE_BACK, NODE_HERE, NODE_AHEAD};
static const int half_ahead[NUM_HALF] = {NODE_BACK2, NODE_BACK, NODE_HERE, NODE_AHEAD, NODE_AHEAD2};
static const int half_left[NUM_HALF] = {NODE_LEFT2, NODE_LEFT2, NODE_LEFT, NODE_HERE, NODE_RIGHT};
static const int half_right[NUM_HALF] = {NODE_LEFT, NODE_LEFT, NODE_HERE, NODE_RIGHT, NODE_RIGHT2};

// ---- cross fluxes

/* Derivative of a flow at the middle of three nodes, times step^2, to leading order. */
typedef struct net_flow {
    int node[3]; // of the stencil
    double value, by_pressure[3], by_film[3];
} net_flow;

/* Adds scale * step * eps dP/dx between two neighbouring nodes, with the mean of their films. */
static inline void add_flow(net_flow *net, int before, double scale, const row_nodes *at) {
    const int a = net->node[before], b = net->node[before + 1];
    const double *film = at->film;
    const double mean = (film[at->stencil->node[a]] + film[at->stencil->node[b]]) / 2;
    const double square = scale * mean * mean, cube = square * mean;
    const reynolds_link change = link_between(at, a, b);

    net->value += cube * change.value;
    net->by_pressure[before] += cube * change.by_before;
    net->by_pressure[before + 1] += cube * change.by_after;
    net->by_film[before] += 1.5 * square * change.value;
    net->by_film[before + 1] += 1.5 * square * change.value;
}

static net_flow net_pressure_flow(int left, int here, int right, double scale,
                                  const row_nodes *at) {
    net_flow net = {.node = {left, here, right}};

    add_flow(&net, 1, scale, at);
    add_flow(&net, 0, -scale, at);
    return net;
}

/* Pressure below which a node is taken as near the exit, in Hertz pressures. Below this pressure
 * the net flow along is reduced in proportion to the pressure (net_along). If the net flow jumped
 * instead, Newton's iteration would cycle (k = 0.5, M = 4.83, L = 10; discretization.bats, "cross
 * fluxes fade in at the exit"). Measured on 24 cold starts (k = 0.5, 0.7 and 1): with an
 * EXIT_PRESSURE of 1e-2 the slowest start takes 13 iterations. With 1e-3 two of the starts take
 * 71. */
static const double EXIT_PRESSURE = 1e-2;

/* Returns the net flow of U rho H - eps dP/dx, which equals the inflow from across. The net flow
 * is zero where the film has ruptured. Near the exit it is multiplied by the pressure over
 * EXIT_PRESSURE. */
static net_flow net_along(int back, int here, int ahead, double entrained, const row_nodes *at) {
    const double part = at->pressure[at->stencil->node[here]] / EXIT_PRESSURE;
    net_flow net = {.node = {back, here, ahead}};

    if (!(part > 0)) return net;
    net = net_pressure_flow(back, here, ahead, -1, at);
    for (int i = 0; i < 3; i += 2) {
        const mass of = mass_at(at, net.node[i]);
        const double half = (i - 1) * entrained / 2;
        net.value += half * of.value;
        net.by_pressure[i] += half * of.by_pressure;
        net.by_film[i] += half * of.by_film;
    }
    if (part >= 1) return net;
    for (int i = 0; i < 3; i++) {
        net.by_pressure[i] *= part;
        net.by_film[i] *= part;
    }
    net.by_pressure[1] += net.value / EXIT_PRESSURE;
    net.value *= part;
    return net;
}

/* A net flow at or beside the node of a row, and its weight in the row. */
typedef struct weighted_net {
    net_flow flow;
    double weight;
} weighted_net;

static void add_net(reynolds_row *row, const weighted_net *net) {
    row->residual += net->weight * net->flow.value;
    for (int i = 0; i < 3; i++) {
        row->by_pressure[net->flow.node[i]] += net->weight * net->flow.by_pressure[i];
        row->by_film[net->flow.node[i]] += net->weight * net->flow.by_film[i];
    }
}

/* Adds scale times the pressure flow g through a half node to the row and to the weights of the net
 * flows at the two nodes beside it. The flow follows from
 *
 *     int g/H^3 = flow_scale * change        g' = -sign * net
 *
 * Between the two nodes the net flow is linear. Simpson's rule uses both nodes and the half node.
 * If `change` is NULL, only the effect of the net flows is added. */
static void add_crossed_flow(reynolds_row *row, const int of[NUM_HALF], double scale, double sign,
                             const reynolds_link *change, double flow_scale, weighted_net *before,
                             weighted_net *after, const row_nodes *at) {
    const int a = of[HALF_BEFORE], b = of[HALF_AFTER];
    const double *film_weight = film_weights(of, at);
    const double inverse = 1 / film_at_half(of, film_weight, at);
    const double inverse_a = 1 / at->film[at->stencil->node[a]];
    const double inverse_b = 1 / at->film[at->stencil->node[b]];
    const double cube_a = inverse_a * inverse_a * inverse_a;
    const double cube_b = inverse_b * inverse_b * inverse_b;
    const double cube = inverse * inverse * inverse;
    const double over_sum = 6 / (cube_a + 4 * cube + cube_b);
    // a sixth of the integrals of the net flow from the half node to either node
    const double to_a = -sign * (3 * before->flow.value + after->flow.value) / 48;
    const double to_b = sign * (before->flow.value + 3 * after->flow.value) / 48;
    const double factor = scale * over_sum, by_link = factor * flow_scale;
    const double flow =
        factor * ((change ? flow_scale * change->value : 0) + to_a * cube_a + to_b * cube_b);

    before->weight += factor * sign / 48 * (cube_b - 3 * cube_a);
    after->weight += factor * sign / 48 * (3 * cube_b - cube_a);
    if (change) {
        row->residual += by_link * change->value;
        row->by_pressure[a] += by_link * change->by_before;
        row->by_pressure[b] += by_link * change->by_after;
    }
    row->by_film[a] += (flow * over_sum / 2 - 3 * factor * to_a) * cube_a * inverse_a;
    row->by_film[b] += (flow * over_sum / 2 - 3 * factor * to_b) * cube_b * inverse_b;
    for (int k = 0; k < NUM_HALF; k++)
        row->by_film[of[k]] += 2 * flow * over_sum * cube * inverse * film_weight[k];
}

/* Adds to an accurate row the flow across and the effect of the net flow across on the fluxes
 * along. Between two nodes, the flow in each direction changes by the net flow in the other
 * direction. The mean of a flow over a side of the cell is its value at the middle of the side plus
 * a term with its curvature (README.md, Cross fluxes). */
static void add_cross_fluxes(reynolds_row *row, const ehd_grid *grid, double entrainment,
                             const row_nodes *at) {
    const double scale = 1 / (grid->step * grid->step), across = flow_across(&grid->shape);
    const double entrained = grid->step * entrainment;
    enum { BEFORE, MIDDLE, AFTER };
    weighted_net out[3] = {
        {net_pressure_flow(NODE_BACK_LEFT, NODE_BACK, NODE_BACK_RIGHT, across, at), scale / 24},
        {net_pressure_flow(NODE_LEFT, NODE_HERE, NODE_RIGHT, across, at), -scale / 12},
        {net_pressure_flow(NODE_AHEAD_LEFT, NODE_AHEAD, NODE_AHEAD_RIGHT, across, at), scale / 24}};
    weighted_net in[3] = {
        {net_along(NODE_BACK_LEFT, NODE_LEFT, NODE_AHEAD_LEFT, entrained, at), -scale / 24},
        {net_along(NODE_BACK, NODE_HERE, NODE_AHEAD, entrained, at), scale / 12},
        {net_along(NODE_BACK_RIGHT, NODE_RIGHT, NODE_AHEAD_RIGHT, entrained, at), -scale / 24}};
    const reynolds_link left = link_between(at, NODE_LEFT, NODE_HERE);
    const reynolds_link right = link_between(at, NODE_HERE, NODE_RIGHT);

    // along: g' = U (rho H)' - net flow across
    add_crossed_flow(row, half_ahead, scale, 1, NULL, 0, &out[MIDDLE], &out[AFTER], at);
    add_crossed_flow(row, half_back, -scale, 1, NULL, 0, &out[BEFORE], &out[MIDDLE], at);
    // across: g' = net flow along
    add_crossed_flow(row, half_right, scale, -1, &right, across, &in[MIDDLE], &in[AFTER], at);
    add_crossed_flow(row, half_left, -scale, -1, &left, across, &in[BEFORE], &in[MIDDLE], at);
    for (int i = 0; i < 3; i++) {
        add_net(row, &out[i]);
        add_net(row, &in[i]);
    }
}

/* Adds a row of the accurate discretisation. If `known`, *ahead holds on input the flux between
 * BACK and HERE, from the row before. On return it holds the flux between HERE and AHEAD. */
static void add_accurate_row(reynolds_row *row, half_flux *ahead, bool known, const ehd_grid *grid,
                             double entrainment, const row_nodes *at) {
    const double step = grid->step, scale = 1 / (step * step);

    const half_flux back = known ? *ahead : flux_along(half_back, step, entrainment, at);
    *ahead = flux_along(half_ahead, step, entrainment, at);
    add_flux(row, half_ahead, -scale, ahead);
    add_flux(row, half_back, scale, &back);
    if (at->stencil->node[NODE_LEFT] == NO_NODE) return;
    if (grid->discretization == DISCRETIZATION_CROSS_FLUX) {
        add_cross_fluxes(row, grid, entrainment, at);
        return;
    }
    add_flow_across(row, half_left, -scale * flow_across(&grid->shape), at);
    add_flow_across(row, half_right, scale * flow_across(&grid->shape), at);
}

// ---- rows

/* Checks whether the half node between BACK and HERE of this row is the half node between HERE and
 * AHEAD of the row before. */
static bool follows(const reynolds_stencil *stencil, const reynolds_stencil *before) {
    return before->node[NODE_HERE] == stencil->node[NODE_BACK] &&
           before->node[NODE_AHEAD] == stencil->node[NODE_HERE];
}

void reynolds_rows(reynolds_row *rows, const ehd_grid *grid, double entrainment,
                   const reynolds_squeeze *squeeze, const reynolds_stencil *stencils,
                   size_t num_rows, const reynolds_fluid *fluid, const double *pressure,
                   const double *film) {
    half_flux ahead = {0};

    // each row: d/dx(eps dP/dx) + d/dy(eps dP/dy) - U d(rho H)/dx
    for (size_t r = 0; r < num_rows; r++) {
        const row_nodes at = {&stencils[r], fluid, pressure, film};
        reynolds_row *row = &rows[r];

        memset(row, 0, sizeof *row);
        if (grid->discretization != DISCRETIZATION_PUBLISHED)
            add_accurate_row(row, &ahead, r > 0 && follows(&stencils[r], &stencils[r - 1]), grid,
                             entrainment, &at);
        else
            add_published_row(row, grid, entrainment, &at);
        if (squeeze) {
            add_mass(row, NODE_HERE, -squeeze->rate, &at);
            row->residual -= squeeze->previous[r];
        }
    }
}

reynolds_row reynolds_flux(const ehd_grid *grid, double entrainment,
                           const reynolds_stencil *stencil, const reynolds_fluid *fluid,
                           const double *pressure, const double *film) {
    const row_nodes at = {stencil, fluid, pressure, film};
    reynolds_row flux = {0};

    if (grid->discretization != DISCRETIZATION_PUBLISHED) {
        const half_flux back = flux_along(half_back, grid->step, entrainment, &at);
        add_flux(&flux, half_back, 1 / grid->step, &back);
    } else
        add_published_flux(&flux, grid->step, entrainment, &at);
    return flux;
}

reynolds_link reynolds_link_ahead(const reynolds_stencil *stencil, const reynolds_fluid *fluid,
                                  const double *pressure, const double *film) {
    const row_nodes at = {stencil, fluid, pressure, film};

    if (fluid->thinned)
        return thinned_link(&at, NODE_HERE, NODE_AHEAD, film[stencil->node[NODE_HERE]], true);
    return link_between(&at, NODE_HERE, NODE_AHEAD);
}

// ---- error bound of thinned flows

/* Pressure flow times the step, computed from the central difference between two nodes of a
 * stencil, and the square of the Eyring gradient Sigma. */
typedef struct nodal_flow {
    double flow, square;
} nodal_flow;

/* Returns the pressure flow of a shear-thinned film at the node HERE of a stencil, from the
 * pressures at the nodes `before` and `after`. `along`: the flow along the entrainment, else
 * across. `own`: mobility at HERE without thinning. */
static nodal_flow thinned_flow_at(const mobility *own, const row_nodes *at, int before, int after,
                                  bool along) {
    const size_t *node = at->stencil->node;
    const double film = at->film[node[NODE_HERE]], to_side = at->fluid->gradient_across;
    const double drop = (at->pressure[node[after]] - at->pressure[node[before]]) / 2;
    // |pressure gradient| in the direction of the flow, times the grid step along the entrainment
    const double change = fabs(drop) * (along ? 1 : to_side);
    const eyring_gradient gradient =
        eyring_gradient_of(at->fluid->gradient_thinning * film * change);
    mobility found = *own;

    thin(&found, at->fluid, film, &gradient, along);
    return (nodal_flow){found.value * film * film * film * change, gradient.square};
}

/* Returns the error bound of the thinned flow at HERE of a stencil. */
static double flow_doubt_at(const ehd_contact *contact, const row_nodes *at) {
    const size_t here = at->stencil->node[NODE_HERE];
    const mobility pressure_only = {.pressure = at->pressure[here]};
    const mobility own = mobility_between(&pressure_only, &pressure_only, contact, false);
    const nodal_flow along = thinned_flow_at(&own, at, NODE_BACK, NODE_AHEAD, true);
    const nodal_flow across = thinned_flow_at(&own, at, NODE_LEFT, NODE_RIGHT, false);
    const double off =
        EYRING_DOUBT_ALONG * across.square * along.flow +
        (EYRING_DOUBT_ACROSS * along.square + EYRING_DOUBT_ACROSS_OWN * across.square) *
            across.flow;
    const double entrained =
        fabs(contact->far_speed) * contact->grid.step * own.density * at->film[here];

    return off > 0 ? off / fmax(entrained, hypot(along.flow, across.flow)) : 0;
}

double reynolds_flow_doubt(const ehd_contact *contact, const reynolds_stencil *stencils,
                           const size_t *node, size_t num_rows, const double *pressure,
                           const double *film) {
    double memory[NUM_FLUID_ARRAYS], most = 0;

    if (!traction_thins_flow(contact) || contact->kind->dimensions == 1) return 0;
    const reynolds_fluid fluid = reynolds_fluid_in(memory, 1, contact);
    for (size_t r = 0; r < num_rows; r++) {
        const row_nodes at = {&stencils[r], &fluid, pressure, film};
        const bool before = grid_x(&contact->grid, node[r]) * contact->far_speed <= 0;
        if (before && pressure[stencils[r].node[NODE_HERE]] > 0)
            most = fmax(most, flow_doubt_at(contact, &at));
    }
    return most;
}

const char flow_doubt_reason[] =
    "a thinned flow whose pressure gradients along and across affect each "
    "other by more than 1 % of the flow in the inlet";
