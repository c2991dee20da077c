/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fullrun/resolution.h"

#include "common/physics/exit.h"
#include "common/physics/far_field.h"
#include "common/physics/grid_choice.h"
#include "fullrun/continuation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A solution at Y = 0. On a line contact it is the whole solution. */
typedef struct central_line {
    const double *pressure, *film; // [num_nodes], boundary nodes included
    size_t num_nodes;
    size_t centre; // node at X = 0, or the first node behind X = 0
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

/* Source: P. J. Roache (J. Fluids Eng. 116, 1994) gives 1.25 for three grids. This factor turns an
 * estimate into a bound. */
static const double SAFETY = 1.25;

/* Factor that turns the error estimate for the domain of a point or elliptic contact into a bound.
 * The estimate compares two domains; for two grids Roache gives a factor of 3. With the factor 1.25
 * the estimates of six of 434 random point contacts and of two of 167 random ellipses are below the
 * error, with 1.5 those of four point contacts and of one ellipse (README.md, Estimates of inlet
 * and step; boundary.bats, "the effect of the domain is found"). */
static const double SAFETY_OF_DOMAIN = 1.5;

const double resolution_limit = 0.03;

/* Longest grid step, in half widths, on which the effect of a point contact's domain is estimated.
 * Estimates were compared with the true effect in 67 random scenes (scenes/studies/discretization).
 * On grids with a step of 1 two of the estimates were only 0.3 and 0.7 times the effect. On grids
 * with a step of 0.5 these two estimates are 0.9 and 1.2 times the effect (boundary.bats, "the
 * effect of the domain is found"). */
static const double COARSEST_FOR_DOMAIN = 0.5;

/* Films, and the rolling moment, to which the rolling resistance is proportional. */
typedef struct film_pair {
    double central, minimum, rolling;
} film_pair;

static const film_pair no_films = {NAN, NAN, NAN};

/* Sets half width and radius if none are given. Both determine how far away the film around a point
 * contact ends. The values can be rough, since only the logarithm of this distance matters. */
static void give_size(ehd_contact *contact) {
    if (!isnan(contact->half_width)) return;
    contact->half_width = 0.01;
    contact->radius = 1;
}

static film_pair films_of(const full_state *state, const ehd_contact *contact) {
    const contact_scalars scalars = full_evaluate_scalars(state, contact);

    return (film_pair){scalars.central_film_thickness, scalars.minimum_film_thickness,
                       full_evaluate_traction(state, contact).rolling_moment};
}

// ---- the inlet

/* Computes the viscous pressure, the integral of dP / viscosity ratio from the inlet on. Between
 * two nodes the viscosity may grow by decades, so its logarithm is taken as linear in P. */
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

/* For an inlet that begins at minus infinity, returns the pressure at `start` and the load upstream
 * of `start`, from dP/dX = viscosity lambda (H - H_exit)/H^3. H is the gap of the dry contact plus
 * a constant. The midpoint rule integrates over s, with X = start / s. */
static inlet_tail tail_before(const central_line *line, const ehd_contact *contact, double start) {
    const double stride = 1. / INLET_INTERVALS, flux = line->film[line->exit];
    const contact_kind *kind = contact->kind;
    const contact_shape *shape = &contact->grid.shape;
    const double first = grid_x(&contact->grid, 0);
    inlet_tail tail = {0, 0};

    for (int i = 0; i < INLET_INTERVALS; i++) {
        const double s = (i + 0.5) * stride, x = start / s, length = fabs(x) / s * stride;
        const double film = line->film[0] + kind->dry_gap(shape, x) - kind->dry_gap(shape, first);
        const double slope = contact->lambda * fmax(film - flux, 0) / (film * film * film);
        double log_viscosity, unused[3], middle = tail.pressure + slope * length / 2;
        lubricant_evaluate(&log_viscosity, unused, unused + 1, unused + 2, &contact->lubricant,
                           contact->hertz_pressure, &middle, 1);
        const double rise = exp(log_viscosity) * slope * length;
        tail.load += (tail.pressure + rise / 2) * length;
        tail.pressure += rise;
    }
    return tail;
}

static size_t count_inlet(const double *viscous, size_t centre) {
    size_t count = 0;

    for (size_t k = 1; k <= centre; k++)
        count += viscous[k] > 0.1 * viscous[centre] && viscous[k] < 0.9 * viscous[centre];
    return count;
}

static ehd_status count_inlet_nodes(full_resolution *self, const central_line *line,
                                    const ehd_contact *contact, ehd_error *error) {
    size_t num_nodes = line->num_nodes;
    double *memory = malloc(5 * num_nodes * sizeof *memory);
    if (!memory) return ehd_no_memory(error, "resolution");
    double *log_viscosity = memory, *viscous = memory + num_nodes, *unused = memory + 2 * num_nodes;

    lubricant_evaluate(log_viscosity, unused, unused + num_nodes, unused + 2 * num_nodes,
                       &contact->lubricant, contact->hertz_pressure, line->pressure, num_nodes);
    viscous_pressure(viscous, log_viscosity, line->pressure, num_nodes);
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
    if (valley == 0) return 0; // only one maximum: no spike
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

// ---- the grid step

/* Returns the node of a grid at the place of an inner node of a coarse grid, whose step is `stride`
 * times as long. NO_NODE: this place lies beside the grid. */
static size_t node_of_coarse(const ehd_grid *grid, const ehd_grid *coarse, size_t node,
                             size_t stride) {
    size_t column = node % grid_width(coarse), line = 0;

    if (grid->inner_lines > 1)
        line = (size_t)lround((grid_y(coarse, node) - grid_y(grid, 0)) / grid_step_across(grid));
    return line < grid_lines(grid) ? line * grid_width(grid) + stride * (column - 1) + 1 : NO_NODE;
}

/* Sets a coarse state to the solution at every `stride`-th inner node of the fine grid. */
static void restrict_state(full_state *coarse, const ehd_grid *grid, const full_state *solution,
                           const ehd_grid *fine, size_t stride) {
    for (size_t r = 0; r < grid->num_inner; r++) {
        size_t k = grid_node_of_row(grid, r), node = node_of_coarse(fine, grid, k, stride);
        coarse->pressure[k] = node != NO_NODE ? solution->pressure[node] : 0;
    }
    full_state_set_zone(coarse, grid, (solution->exit + 2 * stride - 2) / stride);
    coarse->rigid_approach = solution->rigid_approach;
}

/* A contact on a grid whose step is a multiple of the original step, and its solution there. */
typedef struct coarse_grid {
    ehd_contact contact;
    bool as_large;
    team *threads; // threads that share the work; NULL: one thread does all work
    full_solver *solver;
    full_state state;
} coarse_grid;

/* Solves the contact from its present state. The films are NaN if the solver does not converge. */
static ehd_status solve_on(film_pair *films, coarse_grid *self, ehd_error *error) {
    full_info info;
    ehd_status status = full_solve(&info, &self->state, self->solver, &self->contact, NULL, error);

    *films = no_films;
    if (!status && info.status == EHD_OK) *films = films_of(&self->state, &self->contact);
    return status;
}

/* Computes the relative changes of the film at the node with the smallest film and at its
 * neighbours. Returns the mean magnitude of these changes, with the sign of their mean. */
static double change_of_minimum(const double *film, const double *before, const ehd_grid *grid) {
    const size_t width = grid_width(grid);
    size_t lowest = grid_node_of_row(grid, 0);
    double sum = 0, sizes = 0;

    for (size_t r = 1; r < grid->num_inner; r++)
        if (before[grid_node_of_row(grid, r)] < before[lowest]) lowest = grid_node_of_row(grid, r);
    const size_t below = lowest >= width ? lowest - width : lowest + width; // or mirror image
    const size_t nodes[] = {lowest, lowest - 1, lowest + 1, lowest + width, below};
    const int count = grid->inner_lines > 1 ? 5 : 3;
    for (int i = 0; i < count; i++) {
        const double change = film[nodes[i]] / before[nodes[i]] - 1;
        sum += change;
        sizes += fabs(change);
    }
    return copysign(sizes / count, sum);
}

static ehd_status create_coarse(coarse_grid *self, ehd_error *error) {
    full_settings settings = full_default_settings();

    settings.threads = self->threads;
    settings.as_large = self->as_large;
    settings.tolerance = 1e-8;
    ehd_status status = full_solver_create(&self->solver, self->contact.kind, &self->contact.grid,
                                           &settings, error);
    return status ? status : full_state_init(&self->state, &self->contact.grid, error);
}

static void free_coarse(coarse_grid *self) {
    full_state_free(&self->state);
    full_solver_free(self->solver);
}

/* Relative changes of the films if a domain with its boundary node at `start` becomes endless. NaN:
 * the changes are not known. Infinite: the contact with an endless domain has no solution. */
typedef struct inlet_change {
    double central, minimum, start;
    // Change of the rolling resistance. Valid only if both solutions are on the same grid and
    // differ in its boundary pressures alone.
    double rolling;
} inlet_change;

/* Computes the change between two solutions, whose films are given on the same nodes. */
static void set_change(inlet_change *change, const film_pair *after, const film_pair *before,
                       const double *film_after, const double *film_before, const ehd_grid *grid) {
    const bool solved = !isnan(after->central);

    change->central = solved ? after->central / before->central - 1 : INFINITY;
    if (!solved)
        change->minimum = INFINITY;
    else if (exit_is_within_node(grid)) // the lowest film then varies smoothly
        change->minimum = after->minimum / before->minimum - 1;
    else
        change->minimum = change_of_minimum(film_after, film_before, grid);
    change->start = grid_x(grid, 0);
    change->rolling = solved ? after->rolling / before->rolling - 1 : INFINITY;
}

/* Solves a contact again on the same grid, after the caller has changed the pressure around the
 * grid. Sets the change of the films. */
static ehd_status solve_surrounded(inlet_change *change, coarse_grid *self, const film_pair *films,
                                   ehd_error *error) {
    const ehd_grid *grid = &self->contact.grid;
    film_pair found;
    double *before = malloc(grid->num_nodes * sizeof *before);
    if (!before) return ehd_no_memory(error, "resolution");

    memcpy(before, self->state.film, grid->num_nodes * sizeof *before);
    ehd_status status = solve_on(&found, self, error);
    if (!status) set_change(change, &found, films, self->state.film, before, grid);
    free(before);
    return status;
}

/* Finds how much an endless inlet changes the films of a solved line contact. For this, adds the
 * pressure and the load of the inlet upstream of the grid. */
static ehd_status solve_with_tail(inlet_change *change, coarse_grid *self, const film_pair *films,
                                  ehd_error *error) {
    const ehd_grid *grid = &self->contact.grid;
    const central_line line = central_line_of(&self->state, grid);
    inlet_tail *tail = &self->contact.tail;

    *tail = tail_before(&line, &self->contact, grid_x(grid, 0));
    tail->load += tail->pressure * grid->step / 2; // adds the load from the boundary node to
                                                   // the cell of the first inner node
    return solve_surrounded(change, self, films, error);
}

/* Finds how much the far field around the grid changes the films of a solved point contact. */
static ehd_status solve_unbounded(inlet_change *change, coarse_grid *self, const film_pair *films,
                                  ehd_error *error) {
    self->contact.grid.boundary = BOUNDARY_OPEN;
    return solve_surrounded(change, self, films, error);
}

/* A grid of twice the size of another grid, and the numbers of columns and lines that are added. */
typedef struct twice_as_large {
    ehd_grid grid;
    size_t before, beside; // columns added before column 0, lines added before line 0
} twice_as_large;

static twice_as_large twice_the_size(const ehd_grid *of) {
    const grid_extent extent = grid_extent_of(of);
    const size_t before = (size_t)lround(-extent.x_min / extent.step);
    const size_t behind = (size_t)lround(extent.x_max / extent.step);
    const size_t beside = (size_t)lround(extent.y_max / grid_step_across(of));
    const double x_min = of->x_min - (double)before * of->step;

    return (twice_as_large){grid_like(of, x_min, of->step, of->inner_x + before + behind,
                                      of->inner_lines + (of->half ? 1 : 2) * beside),
                            before, of->half ? 0 : beside};
}

static size_t node_in_larger(const twice_as_large *larger, const ehd_grid *of, size_t node) {
    const size_t line = node / grid_width(of) + larger->beside;

    return line * grid_width(&larger->grid) + node % grid_width(of) + larger->before;
}

/* Sets a start on the larger grid: the smaller grid's solution, and the far field around it. */
static void enlarge_state(full_state *target, const twice_as_large *larger,
                          const coarse_grid *smaller) {
    const ehd_grid *grid = &larger->grid, *of = &smaller->contact.grid;
    const full_state *source = &smaller->state;

    for (size_t r = 0; r < grid->num_inner; r++)
        target->pressure[grid_node_of_row(grid, r)] = NAN;
    for (size_t r = 0; r < of->num_inner; r++) {
        const size_t k = grid_node_of_row(of, r);
        target->pressure[node_in_larger(larger, of, k)] = source->pressure[k];
    }
    for (size_t r = 0; r < grid->num_inner; r++) {
        const size_t k = grid_node_of_row(grid, r);
        if (!isnan(target->pressure[k])) continue;
        target->pressure[k] = far_field_pressure(&smaller->contact, source->rigid_approach,
                                                 grid_x(grid, k), grid_y(grid, k))
                                  .value;
    }
    full_state_set_zone(target, grid, grid->num_nodes - 1);
    target->rigid_approach = source->rigid_approach;
}

/* Estimates how much the films of a solved point contact would change on an infinite domain, with
 * the far field around the grid. The estimate is 4/3 of the change on a domain of twice the size.
 * The effect falls with the second to fourth power of the size. For the second power, the slowest,
 * all further doublings together add a third of the first change. */
static ehd_status solve_larger(inlet_change *change, coarse_grid *smaller, const film_pair *films,
                               ehd_error *error) {
    const ehd_grid *of = &smaller->contact.grid;
    const twice_as_large larger = twice_the_size(of);
    coarse_grid self = {
        .contact = smaller->contact, .as_large = smaller->as_large, .threads = smaller->threads};
    film_pair found;
    double *film = malloc(of->num_nodes * sizeof *film);

    self.contact.grid = larger.grid;
    ehd_status status = create_coarse(&self, error);
    if (!status && !film) status = ehd_no_memory(error, "resolution");
    if (!status) {
        enlarge_state(&self.state, &larger, smaller);
        status = solve_on(&found, &self, error);
    }
    if (!status) {
        for (size_t k = 0; k < of->num_nodes; k++)
            film[k] = self.state.film[node_in_larger(&larger, of, k)];
        set_change(change, &found, films, film, smaller->state.film, of);
        change->central *= 4. / 3;
        change->minimum *= 4. / 3;
    }
    free(film);
    free_coarse(&self);
    return status;
}

/* Solves the contact on a grid with `stride` times the step of the solution. The films are NaN if
 * the solver does not converge. Also sets the change of the films that an endless domain causes, if
 * this change is not known yet, the solver converges, and the grid is fine enough. */
static ehd_status solve_coarse(film_pair *films, inlet_change *change, const ehd_contact *contact,
                               const full_state *solution, const ehd_grid *fine, size_t stride,
                               team *threads, ehd_error *error) {
    coarse_grid coarse = {.contact = *contact, .as_large = full_is_large(fine), .threads = threads};
    const ehd_grid *grid = &coarse.contact.grid;

    ehd_status status = create_coarse(&coarse, error);
    if (!status) {
        restrict_state(&coarse.state, grid, solution, fine, stride);
        status = solve_on(films, &coarse, error);
    }
    const bool fine_enough =
        grid->inner_lines == 1 || grid->step <= COARSEST_FOR_DOMAIN || stride == 1;
    if (!status && fine_enough && isnan(change->central) && !isnan(films->central))
        status = (grid->inner_lines == 1     ? solve_with_tail
                  : far_field_is_there(grid) ? solve_larger
                                             : solve_unbounded)(change, &coarse, films, error);
    free_coarse(&coarse);
    return status;
}

double full_observed_order(const double films[3]) {
    const double coarser = films[1] - films[0];
    const double ratio = coarser != 0 ? (films[2] - films[1]) / coarser : NAN;

    return isgreater(ratio, 0) ? log2(ratio) : NAN;
}

/* If films alternate, the estimate is at least the change from 4h to 2h divided by this number,
 * because the films on the steps 2h and h may agree by chance. With 4 an ellipse on a grid with an
 * error of 0.2 % has an estimate above resolution_limit and is refused (ellipse.bats, "Y has the
 * half width across"). */
static const double ALTERNATING = 8;

double full_step_effect(const double films[3], double order, double limit) {
    const double change = (films[0] - films[1]) / films[0];
    const double before = (films[1] - films[2]) / films[0];
    const double observed = log2(fabs(before / change));

    if (isnan(films[1])) return INFINITY;
    if (!(observed > 0)) return fabs(change) > limit ? INFINITY : fabs(change);
    if (change * before < 0) return fmax(fabs(change), fabs(before) / ALTERNATING);
    const double larger = fmax(fabs(change), fabs(before) / exp2(order));
    return larger / (exp2(fmax(1, fmin(observed, order))) - 1);
}

/* Returns a number to which the effect of the domain on the films is proportional if the domain
 * begins at `start`:
 * - line contact: the load upstream of `start`, plus the pressure at `start` times the distance
 *   from `start` to the centre
 * - point contact with a far field: 1/H^2 at `start`, to which the terms that the far field omits
 *   are proportional. H is the gap of the dry contact plus the central film.
 * - point contact with zero pressure around the grid: 1/`start` */
static double lacking_before(const central_line *line, const ehd_contact *contact, double start) {
    const contact_kind *kind = contact->kind;

    if (far_field_is_there(&contact->grid))
        return pow(kind->dry_gap(&contact->grid.shape, start) + line->film[line->centre], -2);
    if (kind->dimensions > 1) return 1 / start;
    const inlet_tail tail = tail_before(line, contact, start);

    return tail.load - tail.pressure * start;
}

/* Returns the error estimate of one film for the grid step. The estimate is the sum of two
 * magnitudes: the effect of the discretisation, and the known effect of the place where the domain
 * begins.
 * beginnings: relative effects of four domains on the film. The first domain begins at x_min. The
 * others begin, like the three grids, one, two and four grid steps upstream of x_min. */
static double step_effect(const double films[3], const double beginnings[4], double order,
                          double limit) {
    double same[3] = {films[0], films[1], films[2]}; // films if all grids began like the first one

    if (!isfinite(beginnings[0])) return full_step_effect(films, order, limit);
    for (int g = 1; g < 3; g++)
        same[g] *= 1 + beginnings[g + 1] - beginnings[1];
    return full_step_effect(same, order, limit) + fabs(beginnings[1] - beginnings[0]);
}

static void set_effects(full_resolution *self, const film_pair films[3], const inlet_change *change,
                        const central_line *line, const ehd_contact *contact) {
    const ehd_grid *grid = &contact->grid;
    const double central[3] = {films[0].central, films[1].central, films[2].central};
    const double minimum[3] = {films[0].minimum, films[1].minimum, films[2].minimum};
    const bool is_published = grid->discretization == DISCRETIZATION_PUBLISHED;
    const bool is_line = contact->kind->dimensions == 1;
    const double order = is_line && !is_published ? 3 : 2;
    double of_central[4], of_minimum[4];

    for (int i = 0; i < 4; i++) {
        const double start = grid->x_min - (i ? exp2(i - 1) : 0) * grid->step;
        const double part =
            lacking_before(line, contact, start) / lacking_before(line, contact, change->start);
        // an inlet tail whose pressure grows without bound has no solution
        of_central[i] = isfinite(part) ? part * change->central : INFINITY;
        of_minimum[i] = isfinite(part) ? part * change->minimum : INFINITY;
    }
    self->order = full_observed_order(central);
    const double safety = is_line ? SAFETY : SAFETY_OF_DOMAIN;
    self->effects.of[EFFECT_INLET] = safety * fabs(of_central[1]);
    // The minimum may move to another node of the coarse grid. The change of the minimum film may
    // then be too small by chance.
    self->effects.of[EFFECT_INLET_MINIMUM] =
        fmax(self->effects.of[EFFECT_INLET], safety * fabs(of_minimum[1]));
    const double step = SAFETY * step_effect(central, of_central, order, default_accuracy);
    // on coarse steps the films of point contacts converge too irregularly for an estimate, except
    // with the published rows
    const bool is_known = is_line || is_published || step <= resolution_limit;
    self->effects.of[EFFECT_STEP] = is_known ? step : INFINITY;
    // the minimum films of the three grids may agree by chance
    self->effects.of[EFFECT_STEP_MINIMUM] =
        fmax(self->effects.of[EFFECT_STEP],
             SAFETY * step_effect(minimum, of_minimum, 2, resolution_limit));
}

/* Sets the error estimates of the rolling resistance. For a line contact the resistance includes
 * the part upstream of the grid, and the error estimate of the film is an upper bound of the error.
 * For a point contact with a far field the resistance includes the far field, whose own error is
 * added. */
static void set_rolling_effects(full_resolution *self, const film_pair films[3],
                                const inlet_change *change, const full_state *state,
                                const ehd_contact *contact) {
    const double rolling[3] = {films[0].rolling, films[1].rolling, films[2].rolling};
    double *effect = &self->effects.of[EFFECT_INLET_ROLLING];

    self->effects.of[EFFECT_STEP_ROLLING] = SAFETY * full_step_effect(rolling, 2, INFINITY);
    *effect = self->effects.of[EFFECT_INLET];
    if (far_field_is_there(&contact->grid))
        *effect += far_field_rolling_error(contact, state->rigid_approach) /
                   (contact->kind->load * fabs(films[0].rolling));
    else if (contact->kind->dimensions > 1)
        *effect = SAFETY * fabs(change->rolling);
}

ehd_status full_resolution_estimate(full_resolution *self, const full_state *state,
                                    const ehd_contact *contact, team *threads, ehd_error *error) {
    const ehd_grid *grid = &contact->grid;
    ehd_contact on[3] = {*contact}; // on grids with the steps h, 2h and 4h
    film_pair films[3] = {no_films, no_films, no_films};
    inlet_change change = {NAN, NAN, grid->x_min, NAN};
    const central_line line = central_line_of(state, grid);
    // With a far field, the effect of the domain comes from the coarsest grid that has a solution
    // and is fine enough. So this grid is solved first.
    const bool coarsest_first = far_field_is_there(grid);

    give_size(&on[0]);
    films[0] = films_of(state, &on[0]);
    self->spike_nodes = count_spike(&line);
    self->outlet_nodes = count_outlet(&line);
    ehd_status status = count_inlet_nodes(self, &line, contact, error);
    for (size_t g = 1; g < 3; g++) {
        on[g] = on[g - 1];
        on[g].grid = full_coarser_grid(&on[g - 1].grid);
    }
    for (size_t i = 1; i < 3 && !status; i++) {
        const size_t g = coarsest_first ? 3 - i : i;
        status =
            solve_coarse(&films[g], &change, &on[g], state, grid, (size_t)1 << g, threads, error);
    }
    if (!status && isnan(change.central) && (grid->inner_lines == 1 || !isnan(films[1].central))) {
        film_pair own;
        status = solve_coarse(&own, &change, &on[0], state, grid, 1, threads, error);
    }
    if (status) return status;
    set_effects(self, films, &change, &line, contact);
    set_rolling_effects(self, films, &change, state, contact);
    return EHD_OK;
}
