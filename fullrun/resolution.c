/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fullrun/resolution.h"

#include "common/physics/far_field.h"
#include "fullrun/continuation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A solution at Y = 0; of a line contact the whole. */
typedef struct central_line {
    const double *pressure, *film; // [num_nodes], boundary nodes included
    size_t num_nodes;
    size_t centre; // node at X = 0 or the first behind it
    size_t exit;   // first node behind the pressurised zone
} central_line;

static central_line central_line_of(const full_state *state, const ehd_grid *grid) {
    size_t first = grid_central_line(grid), width = grid_width(grid);
    central_line line = {.pressure = state->pressure + first,
                         .film = state->film + first,
                         .num_nodes = width,
                         .centre = (size_t)ceil(-grid->x_min / grid->step) + 1,
                         .exit = width - 1};

    while (line.exit > line.centre && !full_has_pressure(state, first + line.exit - 1))
        line.exit--;
    return line;
}

typedef struct film_pair {
    double central, minimum;
} film_pair;

static film_pair films_of(const full_state *state, const ehd_contact *contact) {
    const contact_scalars scalars = full_evaluate_scalars(state, contact);

    return (film_pair){scalars.central_film_thickness, scalars.minimum_film_thickness};
}

// ---- the inlet

/* Viscous pressure, the integral of dP / viscosity ratio from the inlet on. Between two nodes, over
 * which the viscosity may grow by decades, its logarithm is taken as linear in P. */
static void viscous_pressure(double *viscous, const double *log_viscosity, const double *pressure,
                             size_t num_nodes) {
    viscous[0] = 0;
    for (size_t k = 1; k < num_nodes; k++) {
        double rise = log_viscosity[k] - log_viscosity[k - 1];
        double mean = fabs(rise) < 1e-9 ? 1 : -expm1(-rise) / rise;
        viscous[k] =
            viscous[k - 1] + (pressure[k] - pressure[k - 1]) * mean * exp(-log_viscosity[k - 1]);
    }
}

/* Pressure at `start` of an inlet from minus infinity, where a grid that begins there has zero: the
 * integral of lambda (H - H_exit) / H^3, with the gap and the far field of the load, -ln|X| / 2 and
 * a constant, as film. X = start / s, midpoint rule in s. Over nine contacts (M 2 to 40, L 0 to 10,
 * from -200 to -1.5) 5, 20, 50, 200 intervals are at most 3e-2, 2e-3, 3e-4, 2e-5 off. */
static double missing_pressure(const central_line *line, const ehd_contact *contact, double start) {
    const int num_intervals = 200;
    const contact_shape *shape = &contact->grid.shape;
    const double first = grid_x(&contact->grid, 0);
    double flux = line->film[line->exit], sum = 0;

    for (int i = 0; i < num_intervals; i++) {
        double s = (i + 0.5) / num_intervals, x = start / s;
        double film = line->film[0] + contact_gap(shape, x, 0) - contact_gap(shape, first, 0) +
                      0.5 * log(fabs(first / x));
        sum += contact->lambda * fmax(film - flux, 0) / (film * film * film) * fabs(x) / s;
    }
    return sum / num_intervals;
}

/* The film follows the viscous pressure that the inlet builds up with the exponent 8/11 (Ertel and
 * Grubin), of which an inlet that begins at `start` lacks missing_pressure. */
static double inlet_effect(const central_line *line, const ehd_contact *contact,
                           const double *viscous, double start) {
    const double film_exponent = 8. / 11;

    if (contact->kind->dimensions > 1) return NAN;
    return film_exponent * missing_pressure(line, contact, start) / viscous[line->centre];
}

static size_t count_inlet(const double *viscous, size_t centre) {
    size_t count = 0;

    for (size_t k = 1; k <= centre; k++)
        count += viscous[k] > 0.1 * viscous[centre] && viscous[k] < 0.9 * viscous[centre];
    return count;
}

/* beginnings: effects of inlets that begin at x_min, and one, two and four steps before it, as those
 * of the grids on which the step's effect is estimated do. */
static ehd_status estimate_inlet(full_resolution *self, double beginnings[4],
                                 const central_line *line, const ehd_contact *contact,
                                 ehd_error *error) {
    const ehd_grid *grid = &contact->grid;
    size_t num_nodes = line->num_nodes;
    double *memory = malloc(5 * num_nodes * sizeof *memory);
    if (!memory)
        return ehd_fail(error, EHD_MEMORY, "resolution: found no memory for %zu nodes", num_nodes);
    double *log_viscosity = memory, *viscous = memory + num_nodes, *unused = memory + 2 * num_nodes;

    lubricant_evaluate(log_viscosity, unused, unused + num_nodes, unused + 2 * num_nodes,
                       &contact->lubricant, contact->hertz_pressure, line->pressure, num_nodes);
    viscous_pressure(viscous, log_viscosity, line->pressure, num_nodes);
    for (int i = 0; i < 4; i++)
        beginnings[i] =
            inlet_effect(line, contact, viscous, grid->x_min - (i ? exp2(i - 1) : 0) * grid->step);
    self->effects.of[EFFECT_INLET] = beginnings[1];
    self->effects.of[EFFECT_INLET_MINIMUM] = beginnings[1];
    self->inlet_nodes = count_inlet(viscous, line->centre);
    free(memory);
    return EHD_OK;
}

// ---- spike and outlet

static size_t count_spike(const central_line *line) {
    const double *pressure = line->pressure;
    size_t peak = line->exit - 1, count = 0;

    while (peak > 0 && pressure[peak - 1] > pressure[peak])
        peak--;
    size_t valley = peak;
    while (valley > 0 && pressure[valley - 1] <= pressure[valley])
        valley--;
    if (valley == 0) return 0; // the only maximum: no spike
    double half = (pressure[peak] + pressure[valley]) / 2;
    for (size_t k = valley; k < line->exit; k++)
        count += pressure[k] > half;
    return count;
}

static size_t count_outlet(const central_line *line) {
    size_t thinnest = line->centre;

    for (size_t k = thinnest; k < line->exit; k++)
        if (line->film[k] < line->film[thinnest]) thinnest = k;
    return line->exit - thinnest;
}

// ---- the step

/* Node of a grid where an inner node of one with `stride` times its step lies; NO_NODE where the
 * coarse grid reaches farther to the side. */
static size_t node_of_coarse(const ehd_grid *grid, const ehd_grid *coarse, size_t node,
                             size_t stride) {
    size_t column = node % grid_width(coarse), line = 0;

    if (grid->inner_lines > 1)
        line = (size_t)lround((grid_y(coarse, node) - grid_y(grid, 0)) / grid_step_across(grid));
    return line < grid_lines(grid) ? line * grid_width(grid) + stride * (column - 1) + 1 : NO_NODE;
}

/* The solution at every `stride`-th of its inner nodes. */
static void restrict_state(full_state *coarse, const ehd_grid *grid, const full_state *solution,
                           const ehd_grid *fine, size_t stride) {
    for (size_t r = 0; r < grid->num_inner; r++) {
        size_t k = grid_node_of_row(grid, r), node = node_of_coarse(fine, grid, k, stride);
        coarse->pressure[k] = node != NO_NODE ? solution->pressure[node] : 0;
    }
    full_state_set_zone(coarse, grid, (solution->exit + 2 * stride - 2) / stride);
    coarse->rigid_approach = solution->rigid_approach;
}

/* A grid with a multiple of the step. */
typedef struct coarse_grid {
    ehd_contact contact;
    bool as_large;
    team *threads; // NULL: none
    full_solver *solver;
    full_state state;
} coarse_grid;

/* Solves from the state as it is; NaN: not converged. */
static ehd_status solve_on(film_pair *films, coarse_grid *self, ehd_error *error) {
    full_info info;
    ehd_status status = full_solve(&info, &self->state, self->solver, &self->contact, NULL, error);

    *films = (film_pair){NAN, NAN};
    if (!status && info.status == EHD_OK) *films = films_of(&self->state, &self->contact);
    return status;
}

/* Mean size of the relative changes of a point contact's film at the lowest node and those beside it,
 * with the sign of their mean. */
static double change_of_minimum(const double *film, const double *before, const ehd_grid *grid) {
    const size_t width = grid_width(grid);
    size_t lowest = grid_node_of_row(grid, 0);
    double sum = 0, sizes = 0;

    for (size_t r = 1; r < grid->num_inner; r++)
        if (before[grid_node_of_row(grid, r)] < before[lowest]) lowest = grid_node_of_row(grid, r);
    const size_t below = lowest >= width ? lowest - width : lowest + width; // of a mirror line
    const size_t nodes[] = {lowest, lowest - 1, lowest + 1, lowest + width, below};
    for (int i = 0; i < 5; i++) {
        const double change = film[nodes[i]] / before[nodes[i]] - 1;
        sum += change;
        sizes += fabs(change);
    }
    return copysign(sizes / 5, sum);
}

static ehd_status create_coarse(coarse_grid *self, ehd_error *error) {
    full_settings settings = full_default_settings();

    settings.threads = self->threads;
    settings.as_large = self->as_large;
    settings.tolerance = 1e-8;
    settings.max_iterations = 20; // more are needed only where the grid is too coarse
    ehd_status status = full_solver_create(&self->solver, self->contact.kind, &self->contact.grid,
                                           &settings, error);
    return status ? status : full_state_init(&self->state, &self->contact.grid, error);
}

static void free_coarse(coarse_grid *self) {
    full_state_free(&self->state);
    full_solver_free(self->solver);
}

/* Of films before and after something was changed, the second to the first times a factor. The
 * lowest film follows the place of the exit, which jumps by nodes, so that it is not of the
 * minimum itself. */
static void set_inlet_effect(film_effects *effects, double factor, const film_pair *after,
                             const film_pair *before, const coarse_grid *self,
                             const double *film_before) {
    const bool solved = !isnan(after->central);

    effects->of[EFFECT_INLET] = solved ? factor * (after->central / before->central - 1) : INFINITY;
    effects->of[EFFECT_INLET_MINIMUM] =
        solved ? factor * change_of_minimum(self->state.film, film_before, &self->contact.grid)
               : INFINITY;
}

/* The effect of the domain's length where the far field is around: by what a domain shorter by a
 * fourth does to a solved point contact. It falls with the power 3 to 6 of the length (M 1 to 100,
 * L 0 to 25), taken as 4. */
static ehd_status solve_shorter(film_effects *effects, coarse_grid *longer, const film_pair *films,
                                ehd_error *error) {
    const double shorter = 0.75, factor = -1 / (pow(shorter, -4) - 1);
    const ehd_grid *of = &longer->contact.grid;
    const grid_extent extent = grid_extent_of(of);
    const size_t columns = (size_t)lround((1 - shorter) * -extent.x_min / extent.step);
    const size_t lines = (size_t)lround((1 - shorter) * extent.y_max / grid_step_across(of));
    coarse_grid self = {
        .contact = longer->contact, .as_large = longer->as_large, .threads = longer->threads};
    film_pair found = {NAN, NAN};

    self.contact.grid =
        grid_like(of, of->x_min + (double)columns * of->step, of->step, of->inner_x - columns,
                  of->inner_lines - (of->half ? 1 : 2) * lines);
    const ehd_grid *grid = &self.contact.grid;
    double *before = malloc(grid->num_nodes * sizeof *before);
    ehd_status status = create_coarse(&self, error);
    if (!status && !before)
        status = ehd_fail(error, EHD_MEMORY, "resolution: found no memory for %zu nodes",
                          grid->num_nodes);
    if (!status) {
        for (size_t k = 0; k < grid->num_nodes; k++) {
            const size_t line = k / grid_width(grid) + (of->half ? 0 : lines);
            const size_t node = line * grid_width(of) + k % grid_width(grid) + columns;
            before[k] = longer->state.film[node];
            self.state.pressure[k] = far_field_is_at(grid, k) ? 0 : longer->state.pressure[node];
        }
        full_state_set_zone(&self.state, grid, grid->num_nodes - 1);
        self.state.rigid_approach = longer->state.rigid_approach;
        status = solve_on(&found, &self, error);
    }
    if (!status) set_inlet_effect(effects, factor, &found, films, &self, before);
    free(before);
    free_coarse(&self);
    return status;
}

/* What the far field around the grid of a solved point contact does to its films. */
static ehd_status solve_unbounded(film_effects *effects, coarse_grid *self, const film_pair *films,
                                  ehd_error *error) {
    const ehd_grid *grid = &self->contact.grid;
    film_pair unbounded;
    double *before = malloc(grid->num_nodes * sizeof *before);
    if (!before)
        return ehd_fail(error, EHD_MEMORY, "resolution: found no memory for %zu nodes",
                        grid->num_nodes);

    memcpy(before, self->state.film, grid->num_nodes * sizeof *before);
    self->contact.grid.boundary = BOUNDARY_OPEN;
    ehd_status status = solve_on(&unbounded, self, error);
    if (!status) set_inlet_effect(effects, 1, &unbounded, films, self, before);
    free(before);
    return status;
}

/* Films of the contact on a grid with `stride` times the solution's step; NaN: not converged. And
 * effects of the inlet of a point contact, unless NULL. */
static ehd_status solve_coarse(film_pair *films, film_effects *of_inlet, const ehd_contact *contact,
                               const full_state *solution, const ehd_grid *fine, size_t stride,
                               team *threads, ehd_error *error) {
    coarse_grid coarse = {.contact = *contact, .as_large = full_is_large(fine), .threads = threads};
    const ehd_grid *grid = &coarse.contact.grid;
    const bool open = far_field_is_there(grid);

    ehd_status status = create_coarse(&coarse, error);
    if (!status) {
        restrict_state(&coarse.state, grid, solution, fine, stride);
        status = solve_on(films, &coarse, error);
    }
    if (!status && of_inlet && !isnan(films->central))
        status = (open ? solve_shorter : solve_unbounded)(of_inlet, &coarse, films, error);
    free_coarse(&coarse);
    return status;
}

double full_observed_order(const double films[3]) {
    double order = log2((films[2] - films[1]) / (films[1] - films[0]));

    return isfinite(order) ? order : NAN;
}

double full_step_effect(const double films[3]) {
    const double order = full_observed_order(films);
    const double used = isnan(order) ? 2 : fmin(fmax(order, 1), 2);

    if (isnan(films[1])) return INFINITY;
    return (films[0] - films[1]) / films[0] / (exp2(used) - 1);
}

double full_step_effect_minimum(const double films[3]) {
    const double effect = full_step_effect(films);
    const double left = (films[1] - films[2]) / films[0] / 4 / 3; // of second order

    return isnan(left) ? fabs(effect) : fmax(fabs(effect), fabs(left));
}

double full_step_effect_accurate(const double films[3], double least, double most) {
    const double order = full_observed_order(films);
    const double used = isnan(order) ? 2 : fmin(fmax(order, least), most);
    const double effect = (films[0] - films[1]) / films[0] / (exp2(used) - 1);
    const double left = (films[1] - films[2]) / films[0] / 16 / 15; // of fourth order

    if (isnan(films[1])) return INFINITY;
    return copysign(isnan(left) ? fabs(effect) : fmax(fabs(effect), fabs(left)), effect);
}

/* Effect of the step on one film with the accurate rows, whose error has two parts: by where the
 * zero before the inlet lies, which is known, and of higher order. They are not trusted to cancel. */
static double accurate_effect(const double films[3], const double beginnings[4], double least,
                              double most) {
    const double beginning = isnan(beginnings[0]) ? 0 : beginnings[1] - beginnings[0];
    double same[3] = {films[0], films[1], films[2]}; // with the beginning of the first

    for (int g = 1; g < 3 && !isnan(beginnings[0]); g++)
        same[g] *= 1 + beginnings[g + 1] - beginnings[1];
    const double rest = full_step_effect_accurate(same, least, most);
    return copysign(fabs(rest) + fabs(beginning), fabs(rest) > fabs(beginning) ? rest : beginning);
}

static void extrapolate(full_resolution *self, const film_pair films[3], const double beginnings[4],
                        ehd_discretization discretization) {
    const double central[3] = {films[0].central, films[1].central, films[2].central};
    const double minimum[3] = {films[0].minimum, films[1].minimum, films[2].minimum};
    const bool published = discretization == DISCRETIZATION_PUBLISHED;

    self->order = full_observed_order(central);
    self->effects.of[EFFECT_STEP] =
        published ? full_step_effect(central) : accurate_effect(central, beginnings, 3, 4);
    self->effects.of[EFFECT_STEP_MINIMUM] = published
                                                ? full_step_effect_minimum(minimum)
                                                : fabs(accurate_effect(minimum, beginnings, 2, 2));
}

ehd_status full_resolution_estimate(full_resolution *self, const full_state *state,
                                    const ehd_contact *contact, team *threads, ehd_error *error) {
    film_pair films[3] = {films_of(state, contact), {NAN, NAN}, {NAN, NAN}};
    ehd_contact coarse = *contact;
    double beginnings[4];
    const bool is_point = contact->kind->dimensions > 1;

    const central_line line = central_line_of(state, &contact->grid);

    self->spike_nodes = count_spike(&line);
    self->outlet_nodes = count_outlet(&line);
    ehd_status status = estimate_inlet(self, beginnings, &line, contact, error);
    for (size_t g = 1; g < 3 && !status; g++) {
        coarse.grid = full_coarser_grid(&coarse.grid);
        status = solve_coarse(&films[g], g == 1 && is_point ? &self->effects : NULL, &coarse, state,
                              &contact->grid, (size_t)1 << g, threads, error);
        if (isnan(films[g].central)) break;
    }
    if (!status) extrapolate(self, films, beginnings, contact->grid.discretization);
    return status;
}
