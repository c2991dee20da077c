/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fullrun/previous.h"

#include "common/physics/deflection.h"
#include "common/time/surface.h"

#include <cblas.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- memory

enum { POINTS = 6 }; // nodes per direction from which deflection_beyond interpolates

/* Returns the grid with a margin around it. The margin covers the growth of the contact
 * (frame_most_growth), or the movement of fluid within a few time steps. */
static ehd_grid wide_grid(const ehd_contact *reference, size_t *margin, size_t *side) {
    const ehd_grid *grid = &reference->grid;
    const double growth = frame_most_growth(reference->kind, &grid->shape);
    const double x = fmax(fabs(grid_x(grid, 0)), fabs(grid_x(grid, grid->inner_x + 1)));
    const double y = grid->inner_lines > 1 ? grid_y(grid, grid->num_nodes - 1) : 0;

    *margin = (size_t)ceil(growth * x / grid->step) + POINTS;
    *side = grid->inner_lines > 1 ? (size_t)ceil(growth * y / grid_step_across(grid)) + POINTS : 0;
    return grid_like(grid, grid->x_min - (double)*margin * grid->step, grid->step,
                     grid->inner_x + 2 * *margin, grid->inner_lines + (grid->half ? 1 : 2) * *side);
}

ehd_status previous_init(previous_state *self, const ehd_contact *reference, ehd_error *error) {
    const ehd_grid *grid = &reference->grid;
    bool compressible = reference->lubricant.density != NULL;
    size_t margin, side;
    const ehd_grid wide = wide_grid(reference, &margin, &side);
    ehd_status status = full_state_init(&self->state, grid, error);

    if (status) return status;
    self->beyond = malloc(wide.num_nodes * sizeof *self->beyond);
    self->filtered = malloc(grid->num_nodes * sizeof *self->filtered);
    self->num_lines = grid_lines(grid);
    self->deflection = splines_create(self->num_lines, grid_width(grid));
    self->pressure = compressible ? splines_create(self->num_lines, grid_width(grid)) : NULL;
    if (self->beyond && self->filtered && self->deflection && (self->pressure || !compressible))
        return EHD_OK;
    previous_free(self);
    return ehd_no_memory(error, "previous state");
}

void previous_free(previous_state *self) {
    full_state_free(&self->state);
    free(self->beyond);
    free(self->filtered);
    self->beyond = self->filtered = NULL;
    self->deflection = splines_free(self->deflection, self->num_lines);
    self->pressure = splines_free(self->pressure, self->num_lines);
}

double previous_bytes(const ehd_contact *reference, size_t num_states) {
    const double of_spline = spline_bytes(1000) / 1000;
    const double of_state = sizeof(full_state) + 3 * sizeof(double),
                 of_carrier = 6 * sizeof(double) + of_spline;
    const double of_wide_state = sizeof(double), of_deflection = 15 * sizeof(double);
    double splines = reference->lubricant.density ? 2 : 1;
    size_t margin, side;
    const ehd_grid wide = wide_grid(reference, &margin, &side);

    return (double)reference->grid.num_nodes *
               ((double)num_states * (of_state + splines * of_spline) + of_carrier) +
           (double)wide.num_nodes * ((double)num_states * of_wide_state + of_deflection);
}

/* Sets Y of all lines of the whole grid, to which the values of a half grid are mirrored. */
static void set_line_positions(previous_carrier *self) {
    const ehd_grid whole = grid_whole(&self->reference.grid);

    for (size_t l = 0; l < self->num_across; l++)
        self->lines[l] = grid_y(&whole, l * grid_width(&whole));
}

ehd_status previous_carrier_init(previous_carrier *self, const ehd_contact *reference,
                                 ehd_error *error) {
    const ehd_grid *grid = &reference->grid, whole = grid_whole(grid);
    size_t width = grid_width(grid);

    arena *memory = &self->memory;
    memset(self, 0, sizeof *self);
    self->reference = *reference;
    self->num_across = grid_lines(&whole);
    self->nodes = arena_array(memory, width, sizeof(double));
    self->values = arena_array(memory, grid->num_nodes, sizeof(double));
    self->film = arena_array(memory, grid->num_inner, sizeof(double));
    self->pressure = arena_array(memory, grid->num_inner, sizeof(double));
    self->along = arena_array(memory, grid_lines(grid) * grid->inner_x, sizeof(double));
    self->lines = arena_array(memory, self->num_across, sizeof(double));
    self->base_film = arena_array(memory, grid->num_nodes, sizeof(double));
    self->across_values = arena_array(memory, self->num_across, sizeof(double));
    bool across = grid->inner_lines > 1;
    if (across) self->across = spline_create(self->num_across);
    self->errors = splines_create(grid_lines(grid), width);
    self->wide = wide_grid(reference, &self->margin, &self->side);
    self->deflection = deflection_create(reference->kind, &self->wide);
    if (memory->failed || (across && !self->across) || !self->errors || !self->deflection) {
        previous_carrier_free(self);
        return ehd_no_memory(error, "previous states");
    }
    for (size_t k = 0; k < width; k++)
        self->nodes[k] = grid_x(grid, k);
    if (across) set_line_positions(self);
    if (reference->transport != TRANSPORT_PATH) return EHD_OK;
    ehd_status status = path_filter_init(&self->filter, grid, path_filter_length(reference), error);
    if (status) previous_carrier_free(self);
    return status;
}

void previous_carrier_free(previous_carrier *self) {
    arena_free(&self->memory);
    spline_free(self->across);
    splines_free(self->errors, grid_lines(&self->reference.grid));
    deflection_free(self->deflection);
    path_filter_free(&self->filter);
    memset(self, 0, sizeof *self);
}

// ---- splines

static void fit_lines(spline **splines, const double *field, const previous_carrier *carrier) {
    const ehd_grid *grid = &carrier->reference.grid;
    size_t width = grid_width(grid), num_lines = grid_lines(grid);

    for (size_t l = 0; l < num_lines; l++)
        spline_fit(splines[l], carrier->nodes, field + l * width);
}

/* Computes the film of a state minus the heights of a surface. `surface`: NULL if smooth. */
static void smooth_film(double *film, const previous_state *state, const ehd_surface *surface,
                        const ehd_grid *grid) {
    memcpy(film, state->state.film, grid->num_nodes * sizeof *film);
    for (size_t k = 0; surface && k < grid->num_nodes; k++)
        film[k] -= surface_height(surface, &state->frame, grid_x(grid, k), grid_y(grid, k));
}

/* Checks whether the entrainment of a frame is opposite to the entrainment of the initial state. An
 * initial state at rest counts as entrainment towards larger X. */
static bool is_reversed(const previous_carrier *self, const contact_frame *frame) {
    return self->base && (self->base->frame.speed < 0 ? frame->speed > 0 : frame->speed < 0);
}

const previous_state *previous_base(const previous_carrier *self, const contact_frame *frame) {
    return frame->time < self->base_until && !is_reversed(self, frame) ? self->base : NULL;
}

void previous_watch_base(previous_carrier *self, const contact_frame *frame) {
    if (is_reversed(self, frame)) self->base_until = fmin(self->base_until, frame->time);
}

/* Copies a field to carrier->values. With transport along the path, applies the fraction `share` of
 * the filter to the difference from the base, or to the whole field if `base` is NULL. */
static void set_values(previous_carrier *self, const double *field, const double *base,
                       double share) {
    const size_t width = grid_width(&self->reference.grid);
    const size_t num_nodes = self->reference.grid.num_nodes;

    memcpy(self->values, field, num_nodes * sizeof *field);
    if (self->reference.transport != TRANSPORT_PATH) return;
    for (size_t k = 0; k < num_nodes && base; k++)
        self->values[k] -= base[k];
    for (size_t l = 0; l < self->filter.num_lines; l++)
        path_filter_apply(&self->filter, self->values + l * width, l, 1, share);
    for (size_t k = 0; k < num_nodes && base; k++)
        self->values[k] += base[k];
}

void previous_prepare(previous_state *self, double share, previous_carrier *carrier) {
    const ehd_grid *grid = &carrier->reference.grid;
    const previous_state *base = previous_base(carrier, &self->frame);

    self->beyond[0] = NAN;
    // only the film without the heights of a surface is interpolated and filtered
    smooth_film(self->filtered, self, carrier->reference.surface, grid);
    set_values(carrier, self->filtered, base ? carrier->base_film : NULL, share);
    for (size_t k = 0; k < grid->num_nodes; k++) {
        self->filtered[k] = carrier->values[k] - self->filtered[k];
        // natural splines fit the film minus the gap well, because this difference bends little at
        // the ends of the grid
        carrier->values[k] -= grid_gap(grid, k);
    }
    fit_lines(self->deflection, carrier->values, carrier);
    if (!self->pressure) return;
    set_values(carrier, self->state.pressure, base ? base->state.pressure : NULL, share);
    fit_lines(self->pressure, carrier->values, carrier);
}

void previous_set_base(previous_carrier *self, previous_state *base) {
    const ehd_surface *surface = self->reference.surface;

    self->base = base;
    self->base_until = INFINITY;
    // if the surface moves, the base was solved with smooth surfaces
    smooth_film(self->base_film, base, surface_rests(surface) ? surface : NULL,
                &self->reference.grid);
    previous_prepare(base, 1, self);
}

static bool is_on_grid(const previous_carrier *self, double x, double y) {
    const double *nodes = self->nodes, *lines = self->lines;
    size_t last = grid_width(&self->reference.grid) - 1;

    if (!(x >= nodes[0] && x <= nodes[last])) return false;
    return !self->across || (y >= lines[0] && y <= lines[self->num_across - 1]);
}

/* The place in the frame of a previous state that belongs to X in the current frame: stretch X -
 * shift. With frame_shift it is the place from which the fluid at X comes. With a shift of 0 it is
 * the same physical place as X. */
typedef struct origin {
    double stretch, shift;
} origin;

/* Returns the value of a spline at x. *near is the interval that is tried first, and becomes the
 * interval of x. */
static double value_near(const spline *self, double x, size_t *near) {
    *near = spline_interval(self, x, *near);
    return spline_value(self, x, *near);
}

/* Interpolates a field along every line, at the places that `from` gives for the inner nodes. */
static void resample_along(double *along, spline *const *splines, origin from,
                           const previous_carrier *self) {
    const ehd_grid *grid = &self->reference.grid;
    size_t num_lines = grid_lines(grid);

    for (size_t l = 0; l < num_lines; l++) {
        size_t near = 0;
        for (size_t i = 0; i < grid->inner_x; i++) {
            double x = from.stretch * self->nodes[i + 1] - from.shift;
            if (is_on_grid(self, x, 0))
                along[l * grid->inner_x + i] = value_near(splines[l], x, &near);
        }
    }
}

/* Copies column `i` of `along` to across_values, which covers a whole grid. On a half grid, adds
 * the mirror image of each value. */
static void gather_column(previous_carrier *self, size_t i) {
    const ehd_grid *grid = &self->reference.grid;
    size_t num_lines = grid_lines(grid), mirror = grid->half ? num_lines - 1 : 0;

    for (size_t l = 0; l < num_lines; l++) {
        double value = self->along[l * grid->inner_x + i];
        self->across_values[mirror + l] = value;
        if (grid->half) self->across_values[mirror - l] = value;
    }
}

/* Interpolates a field of a previous state at the inner nodes of the current frame. `from` gives
 * the place in the state's frame for each node. If this place lies outside of the state's grid, the
 * value of the node in `inner` stays as it is. */
static void resample(double *inner, spline *const *splines, origin from, previous_carrier *self) {
    const ehd_grid *grid = &self->reference.grid;

    resample_along(self->across ? self->along : inner, splines, from, self);
    for (size_t i = 0; self->across && i < grid->inner_x; i++) {
        double x = from.stretch * self->nodes[i + 1] - from.shift;
        size_t near = 0;
        if (!is_on_grid(self, x, 0)) continue;
        gather_column(self, i);
        spline_fit(self->across, self->lines, self->across_values);
        for (size_t r = i; r < grid->num_inner; r += grid->inner_x) {
            double y = from.stretch * grid_y(grid, grid_node_of_row(grid, r));
            if (is_on_grid(self, x, y)) inner[r] = value_near(self->across, y, &near);
        }
    }
}

/* Returns H0 plus deflection at any point, computed as a sum over the nodes. */
static double deflection_at(const previous_state *self, const ehd_contact *reference, double x,
                            double y) {
    const ehd_grid *grid = &reference->grid;
    double sum = self->state.rigid_approach;

    for (size_t k = 1; k < self->state.exit; k++) {
        double pressure = self->state.pressure[k], along = fabs(x - grid_x(grid, k));
        if (pressure == 0) continue;
        double kernel =
            deflection_influence(reference->kind, grid, along, fabs(y - grid_y(grid, k)));
        if (grid_weight(grid, k) > 1) // adds the mirrored node
            kernel += deflection_influence(reference->kind, grid, along, fabs(y + grid_y(grid, k)));
        sum += pressure * kernel;
    }
    return sum;
}

/* Computes a state's deflection on the wide grid. */
static void look_beyond(const previous_state *self, const previous_carrier *carrier) {
    const ehd_grid *grid = &carrier->reference.grid;
    const size_t width = grid_width(grid), wide = grid_width(&carrier->wide);
    const size_t before = grid->half ? 0 : carrier->side;

    memset(self->beyond, 0, carrier->wide.num_nodes * sizeof *self->beyond);
    for (size_t k = 1; k < self->state.exit; k++)
        self->beyond[(k / width + before) * wide + carrier->margin + k % width] =
            self->state.pressure[k];
    deflection_apply(self->beyond, carrier->deflection, self->beyond);
}

/* Sets the Lagrange weights of the POINTS nodes around a place, and returns the number of the first
 * of these nodes. `place` is the distance from node 0 in grid steps. */
static ptrdiff_t lagrange(double weight[POINTS], double place) {
    const double below = floor(place);

    for (int i = 0; i < POINTS; i++) {
        const double at = place - below + POINTS / 2 - 1;
        weight[i] = 1;
        for (int j = 0; j < POINTS; j++)
            if (j != i) weight[i] *= (at - j) / (i - j);
    }
    return (ptrdiff_t)below - (POINTS / 2 - 1);
}

/* Returns H0 plus deflection at a point beyond the grid. All pressures are so far away that the
 * interpolation between six points of the wide grid has an error of only 1e-8 with a grid step of
 * 0.19 (test_previous.c). Beyond the wide grid the function sums over the nodes, which takes a
 * hundred times as long. */
static double deflection_beyond(const previous_state *self, const previous_carrier *carrier,
                                double x, double y) {
    const ehd_grid *wide = &carrier->wide;
    const ptrdiff_t width = (ptrdiff_t)grid_width(wide), lines = (ptrdiff_t)grid_lines(wide);
    const bool point = wide->inner_lines > 1;
    double along[POINTS], across[POINTS] = {1}, sum = self->state.rigid_approach;
    const ptrdiff_t column = lagrange(along, (x - grid_x(wide, 0)) / wide->step);
    const ptrdiff_t line =
        point ? lagrange(across, (y - grid_y(wide, 0)) / grid_step_across(wide)) : 0;
    const ptrdiff_t num_lines = point ? POINTS : 1;

    if (column < 0 || column + POINTS > width || line + num_lines > lines ||
        (line < 0 && !wide->half))
        return deflection_at(self, &carrier->reference, x, y);
    if (isnan(self->beyond[0])) look_beyond(self, carrier);
    for (ptrdiff_t l = 0; l < num_lines; l++) {
        const double *at = self->beyond + labs(line + l) * width + column;
        for (int i = 0; i < POINTS; i++)
            sum += across[l] * along[i] * at[i];
    }
    return sum;
}

/* Adds `weight` times rho H of a state, at the places that `from` gives for the inner nodes.
 * `surface`: NULL if smooth. */
static void add_mass(double *mass, double weight, const previous_state *self,
                     const ehd_surface *surface, origin from, previous_carrier *carrier) {
    const ehd_contact *reference = &carrier->reference;
    const ehd_grid *grid = &reference->grid;
    const lubricant_law *law = reference->lubricant.density;
    double hertz = reference->hertz_pressure * self->frame.hertz_pressure;

    resample(carrier->film, self->deflection, from, carrier);
    if (law) resample(carrier->pressure, self->pressure, from, carrier);
    for (size_t r = 0; r < grid->num_inner; r++) {
        size_t k = grid_node_of_row(grid, r);
        double x = from.stretch * grid_x(grid, k) - from.shift, y = from.stretch * grid_y(grid, k);
        bool inside = is_on_grid(carrier, x, y);
        double film = inside ? carrier->film[r] : deflection_beyond(self, carrier, x, y);
        double density = 1;
        if (law && inside)
            density = lubricant_density(&reference->lubricant, carrier->pressure[r] * hertz);
        if (surface) film += surface_height(surface, &self->frame, x, y);
        mass[r] += weight * density * (film + contact_gap(&grid->shape, x, y));
    }
}

void previous_mass(double *mass, const previous_state *self, const contact_frame *now,
                   previous_carrier *carrier) {
    const double ratio = frame_film_ratio(now, &self->frame);
    const origin here = {frame_stretch(now, &self->frame), 0};
    const origin before = {here.stretch, frame_shift(now, &self->frame)};

    const ehd_surface *surface = carrier->reference.surface;

    memset(mass, 0, carrier->reference.grid.num_inner * sizeof *mass);
    if (carrier->reference.transport != TRANSPORT_PATH) {
        add_mass(mass, ratio, self, surface, here, carrier);
        return;
    }
    const previous_state *base = previous_base(carrier, now);
    add_mass(mass, ratio, self, surface, before, carrier);
    if (!base) return;
    // if the surface moves, the base was solved with smooth surfaces
    const ehd_surface *of_base = surface_rests(surface) ? surface : NULL;
    add_mass(mass, -ratio, base, of_base, before, carrier);
    add_mass(mass, ratio, base, of_base, here, carrier);
}

void previous_errors(double *carried, const double *errors, const contact_frame *then,
                     const contact_frame *now, previous_carrier *carrier) {
    const ehd_grid *grid = &carrier->reference.grid;
    const double ratio = frame_film_ratio(now, then);
    const origin before = {frame_stretch(now, then), frame_shift(now, then)};

    fit_lines(carrier->errors, errors, carrier);
    memset(carried, 0, grid->num_inner * sizeof *carried);
    resample(carried, carrier->errors, before, carrier);
    cblas_dscal((int)grid->num_inner, ratio, carried, 1);
}
