/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/state/node_state.h"

#include "common/algebra/product.h"
#include "common/algebra/vectors.h"
#include "common/physics/far_field.h"
#include "common/physics/minimum.h"
#include "romrun/state/band_minimum.h"

#include <math.h>
#include <string.h>

static void fields_init(node_fields *fields, const reduced_model *model, arena *memory) {
    fields->values =
        (reduced_values){.checkpoint = model->checkpoints.num, // means: no checkpoint
                         .pressure = arena_array(memory, model->rows.num_needed, sizeof(double)),
                         .cut = arena_array(memory, model->cut.num_rows, sizeof(double))};
    fields->pressure = arena_array(memory, model->rows.num_needed, sizeof(double));
    fields->film = arena_array(memory, model->rows.num_needed, sizeof(double));
    fields->cut = arena_array(memory, model->cut.num_rows, sizeof(double));
}

void nodes_init(node_state *self, const reduced_model *model, arena *memory) {
    self->model = model;
    self->exit = arena_array(memory, model->band.num_lines, sizeof *self->exit);
    self->pressurised = arena_array(memory, model->rows.num_needed, sizeof *self->pressurised);
    self->runs = arena_array(memory, model->band.num_lines, sizeof *self->runs);
    self->band_pressure = arena_array(memory, model->band.num_nodes, sizeof(double));
    fields_init(&self->now, model, memory);
    fields_init(&self->step, model, memory);
}

// ---- the exit's cut

void nodes_move_exit(node_state *self, const size_t *exit) {
    const reduced_model *model = self->model;
    size_t num_lines = model->band.num_lines, bytes = num_lines * sizeof *exit;

    if (memcmp(self->exit, exit, bytes) == 0) return;
    memcpy(self->exit, exit, bytes);
    for (size_t q = 0; q < model->rows.num_needed; q++) {
        size_t node = model->rows.needed_node[q];
        self->pressurised[q] =
            reduced_model_column(model, node) < exit[reduced_model_line(model, node)];
    }
    self->checkpoint = reduced_model_checkpoint(model, exit);
    self->num_runs = reduced_model_runs(
        self->runs, model, model->checkpoints.exit + self->checkpoint * num_lines, exit);
}

const double *nodes_checkpoint_table(const node_state *self) {
    const reduced_model *model = self->model;

    return model->checkpoints.cut + self->checkpoint * model->cut.num_rows * model->num_pressure;
}

// ---- the state at the needed nodes

void nodes_expand(node_fields *fields, node_state *self, const reduced_values *known,
                  const double *z) {
    const reduced_model *model = self->model;
    size_t num_cut = model->cut.num_rows, num_needed = model->rows.num_needed;

    if (!known || known->checkpoint != self->checkpoint) {
        reduced_values_at(&fields->values, model, z, self->checkpoint);
        known = &fields->values;
    }
    for (size_t q = 0; q < num_needed; q++)
        fields->pressure[q] = self->pressurised[q] ? known->pressure[q] : 0;
    memcpy(fields->cut, known->cut, num_cut * sizeof(double));
    nodes_expand_runs(self, z);
    for (size_t r = 0; r < self->num_runs; r++) {
        const cut_run *run = &self->runs[r];
        add_transposed_product(fields->cut, run->sign, model->cut.left + run->first * num_cut,
                               run->count, num_cut, self->band_pressure + run->first);
    }
    if (model->deformation == DEFORMATION_COUPLED) {
        memcpy(fields->film, fields->cut, num_needed * sizeof(double));
    } else {
        memset(fields->film, 0, num_needed * sizeof(double));
        add_product(fields->film, model->rows.film, model->num_deformation, num_needed,
                    model->num_deformation, z + model->num_pressure);
    }
    for (size_t q = 0; q < num_needed; q++)
        fields->film[q] += z[model->num_unknowns - 1];
}

void nodes_expand_state(node_state *self, const reduced_values *known, const double *z) {
    nodes_expand(&self->now, self, known, z);
    for (size_t q = 0; q < self->model->rows.num_needed; q++)
        self->now.film[q] += self->model->rows.gap[q];
}

void nodes_add_step(node_state *self, double factor) {
    const reduced_values *step = &self->step.values;
    reduced_values *now = &self->now.values;

    axpy(now->pressure, factor, step->pressure, self->model->rows.num_needed);
    axpy(now->cut, factor, step->cut, self->model->cut.num_rows);
}

double nodes_at_centre(const reduced_model *model, const double *values) {
    const centre_nodes *centre = &model->centre;
    double sum = 0;

    for (size_t i = 0; i < 4; i++)
        if (centre->weight[i] != 0) sum += centre->weight[i] * values[centre->index[i]];
    return sum;
}

double nodes_load(const node_state *self) {
    return self->now.cut[self->model->cut.num_rows - 1];
}

// ---- the state in the band

void nodes_expand_range(node_state *self, const double *z, size_t first, size_t count) {
    reduced_band_pressure(self->band_pressure + first, self->model, z, first, count);
}

void nodes_expand_band(node_state *self, const double *z, size_t from, size_t to) {
    if (to > from) nodes_expand_range(self, z, from - self->model->band.lines[0].begin, to - from);
}

void nodes_expand_runs(node_state *self, const double *z) {
    for (size_t r = 0; r < self->num_runs; r++)
        nodes_expand_range(self, z, self->runs[r].first, self->runs[r].count);
}

/* Returns the modes of the film at the nodes of the band from `node` on, [nodes, *width]. For a
 * coupled basis they do not contain the deflection by the runs. */
static const double *band_film_modes(size_t *width, const node_state *self, size_t node) {
    const reduced_model *model = self->model;
    const bool coupled = model->deformation == DEFORMATION_COUPLED;
    const double *modes = coupled
                              ? model->checkpoints.band +
                                    self->checkpoint * model->band.num_nodes * model->num_pressure
                              : model->band.film;

    *width = coupled ? model->num_pressure : model->num_deformation;
    return modes + reduced_model_band_index(model, node) * *width;
}

void nodes_band_films(double *film, const node_state *self, const double *z, size_t node,
                      size_t count) {
    const reduced_model *model = self->model;
    const size_t num_pressure = model->num_pressure;
    const bool coupled = model->deformation == DEFORMATION_COUPLED;
    size_t width;
    const double *basis = band_film_modes(&width, self, node);
    const grid_position at = reduced_model_position(model, node);

    for (size_t i = 0; i < count; i++)
        film[i] = z[model->num_unknowns - 1] + grid_gap(&model->grid, node + i) +
                  dot(basis + i * width, coupled ? z : z + num_pressure, width);
    for (size_t r = 0; coupled && r < self->num_runs; r++) {
        const cut_run *run = &self->runs[r];
        reduced_model_deflect(film, model, at, count, run->line, run->column, run->count,
                              self->band_pressure + run->first, run->sign);
    }
}

double nodes_band_film(const node_state *self, const double *z, size_t node) {
    double film;

    nodes_band_films(&film, self, z, node, 1);
    return film;
}

void nodes_add_band_films(double *target, const double *factors, const node_state *self,
                          size_t node, size_t count) {
    const reduced_model *model = self->model;
    const size_t num_pressure = model->num_pressure;
    const bool coupled = model->deformation == DEFORMATION_COUPLED;
    size_t width;
    const double *basis = band_film_modes(&width, self, node);

    for (size_t i = 0; i < count; i++)
        nodes_add_row(coupled ? target : target + num_pressure, factors[i], basis + i * width,
                      width);
    for (size_t r = 0; coupled && r < self->num_runs; r++) {
        const cut_run *run = &self->runs[r];
        for (size_t k = 0; k < run->count; k++) {
            double influence = 0;
            for (size_t i = 0; i < count; i++) {
                double film = 0;
                const double unit = 1;
                reduced_model_deflect(&film, model, reduced_model_position(model, node + i), 1,
                                      run->line, run->column + k, 1, &unit, run->sign);
                influence += factors[i] * film;
            }
            nodes_add_row(target, influence, model->band.pressure + (run->first + k) * num_pressure,
                          num_pressure);
        }
    }
}

/* The film of a state in the band, as context of the functions for band_minimum. */
typedef struct film_of_state {
    const node_state *nodes;
    const double *z;
} film_of_state;

static double film_at(const void *context, size_t node) {
    const film_of_state *self = context;

    return nodes_band_film(self->nodes, self->z, node);
}

/* Returns the film at a node; NaN outside of the band. */
static double film_in_band(const void *context, size_t node) {
    const film_of_state *self = context;
    const reduced_model *model = self->nodes->model;
    const grid_position at = reduced_model_position(model, node);
    const band_line *line = &model->band.lines[at.line];
    const bool banded =
        reduced_model_has_band(model, at.line) && at.column >= line->begin && at.column < line->end;

    return banded ? film_at(context, node) : NAN;
}

/* Returns the minimum of the film between the nodes around a node of the band. The first nodes of
 * the band have too few neighbours in the band. There the function returns the film at the node. */
static double film_around_band(const void *context, size_t node) {
    const film_of_state *self = context;

    return minimum_around(&self->nodes->model->grid, node, film_in_band, self);
}

/* Returns the minimum film around a needed node of a line contact. If the films at both needed
 * neighbours are larger, the result is the minimum of the parabola through the three nodes.
 * Otherwise the result is the film at the node. */
static double film_around(const node_state *self, size_t q) {
    const size_t *node = self->model->rows.needed_node;
    const double *film = self->now.film;
    const double left = (double)(node[q] - node[q - 1]), right = (double)(node[q + 1] - node[q]);
    const double fall = (film[q - 1] - film[q]) / left, rise = (film[q + 1] - film[q]) / right;
    const double curvature = (fall + rise) / (left + right);
    const double slope = (rise * left - fall * right) / (left + right);

    return fall > 0 && rise > 0 ? film[q] - slope * slope / (4 * curvature) : film[q];
}

/* Returns the minimum around a needed node, as in the full model. Uses the films of the nodes
 * between this node and its needed neighbours. */
static double film_between(size_t *node, const node_state *self, size_t q, film_function *film,
                           const void *context) {
    const size_t *needed = self->model->rows.needed_node;
    double smallest = self->now.film[q];

    *node = needed[q];
    for (size_t k = needed[q - 1] + 1; k < needed[q + 1]; k++) {
        const double here = film(context, k);
        if (!(here < smallest)) continue;
        smallest = here;
        *node = k;
    }
    return minimum_around(&self->model->grid, *node, film, context);
}

/* Returns the needed node of a line contact with the smallest film, among the nodes that have
 * pressure and lie before the band. Excludes the last needed node. Returns 0 if there is no such
 * node. */
static size_t lowest_before_band(const node_state *self) {
    const reduced_model *model = self->model;
    size_t best = 0;

    if (model->band.num_lines > 1 || model->grid.discretization == DISCRETIZATION_PUBLISHED)
        return 0;
    for (size_t q = 0; q + 1 < model->rows.num_needed; q++)
        if (self->pressurised[q] && model->rows.needed_node[q] < model->band.lines[0].begin &&
            self->now.film[q] < self->now.film[best])
            best = q;
    return best;
}

enum { MINIMUM_REACH = 2 }; // number of nodes on each side that minimum_around uses

bool nodes_have_dip(const node_state *self) {
    const exit_band *band = &self->model->band;
    const double *film = self->now.film;

    if (lowest_before_band(self) == 0) return false;
    for (size_t q = 1; q + 1 < self->model->rows.num_needed; q++) {
        if (self->model->rows.needed_node[q] >= band->lines[0].begin + MINIMUM_REACH) return false;
        if (film[q - 1] > film[q] && film[q + 1] >= film[q]) return true;
    }
    return false;
}

/* Checks whether a needed node has pressure, and its film is at most as thick as at both needed
 * neighbours. */
static bool is_dip(const node_state *self, size_t q) {
    const double *film = self->now.film;

    return q > 0 && self->pressurised[q] && film[q] <= film[q - 1] && film[q] <= film[q + 1];
}

/* Returns the smallest film of the needed nodes with pressure, and its node. In a transient contact
 * a film minimum may pass through the part of the contact before the band. For a line contact with
 * the accurate discretisation, the film is interpolated between nodes in each dip before the band,
 * as in the full model. */
static double smallest_needed(size_t *node, const node_state *self, film_function *film,
                              const void *context) {
    const row_set *rows = &self->model->rows;
    const size_t best = lowest_before_band(self), end = self->model->band.lines[0].begin;
    size_t lowest = rows->num_needed, beside = 0;

    for (size_t q = 0; q < rows->num_needed; q++)
        if (self->pressurised[q] &&
            (lowest == rows->num_needed || self->now.film[q] < self->now.film[lowest]))
            lowest = q;
    if (lowest == rows->num_needed) return INFINITY;
    double smallest = self->now.film[lowest];
    *node = rows->needed_node[lowest];
    for (size_t q = 1; q + 1 < rows->num_needed && best > 0; q++) {
        if (rows->needed_node[q] >= end + (film ? MINIMUM_REACH : 0)) break;
        if (q != best && !is_dip(self, q)) continue;
        beside = rows->needed_node[q];
        const double dip =
            film ? film_between(&beside, self, q, film, context) : film_around(self, q);
        if (!(dip < smallest)) continue;
        smallest = dip;
        *node = beside;
    }
    return smallest;
}

double nodes_minimum_film(size_t *node, node_state *self, const double *z) {
    const film_of_state film = {self, z};
    const bool line = self->model->band.num_lines == 1;
    const band_values in_band = {film_at, line ? film_around_band : NULL, &film};
    const exit_band *band = &self->model->band;

    self->lowest_in_band = 0;
    self->least_in_band = INFINITY;
    nodes_expand_runs(self, z);
    for (size_t l = band->first_minimum; l <= band->last_minimum; l++) {
        const size_t first = l * grid_width(&self->model->grid);
        size_t lowest;
        const double here = band_minimum(&lowest, &in_band, first + band->lines[l].begin,
                                         first + self->exit[l] + 1);
        if (!(here < self->least_in_band)) continue;
        self->least_in_band = here;
        self->lowest_in_band = lowest;
    }
    if (isfinite(self->least_in_band) && !line)
        self->least_in_band = film_around_band(&film, self->lowest_in_band);
    return nodes_minimum_between(node, self, NULL, NULL);
}

double nodes_minimum_between(size_t *node, const node_state *self, film_function *film,
                             const void *context) {
    const double beside = smallest_needed(node, self, film, context);

    if (beside < self->least_in_band) return beside;
    *node = self->lowest_in_band;
    return self->least_in_band;
}

contact_scalars nodes_scalars(node_state *self, const double *z, double exit_position,
                              const ehd_contact *contact) {
    const reduced_model *model = self->model;
    const double approach = z[model->num_unknowns - 1];
    size_t lowest = 0;
    const double minimum = nodes_minimum_film(&lowest, self, z);

    return (contact_scalars){.central_film_thickness = nodes_at_centre(model, self->now.film),
                             .central_pressure = nodes_at_centre(model, self->now.pressure),
                             .minimum_film_thickness = minimum,
                             .minimum_position = grid_x(&model->grid, lowest),
                             .rigid_approach = approach,
                             .exit_position = exit_position,
                             .load = (nodes_load(self) + far_field_load(contact, approach).value) /
                                     model->kind->load};
}

reduced_pressures nodes_pressure_range(node_state *self, const double *z) {
    const reduced_model *model = self->model;
    const exit_band *band = &model->band;
    reduced_pressures range = {0, 0};

    for (size_t q = 0; q < model->rows.num_needed; q++)
        if (self->pressurised[q]) reduced_pressures_include(&range, self->now.pressure[q]);
    for (size_t l = 0; l < band->num_lines; l++) {
        const band_line *line = &band->lines[l];
        const size_t end = self->exit[l] < line->end ? self->exit[l] : line->end;
        if (end <= line->begin) continue;
        nodes_expand_range(self, z, line->offset, end - line->begin);
        for (size_t k = line->offset; k < line->offset + end - line->begin; k++)
            reduced_pressures_include(&range, self->band_pressure[k]);
    }
    return range;
}

// ---- derivatives of the film

void nodes_add_row(double *target, double factor, const double *source, size_t count) {
    for (size_t j = 0; j < count; j++)
        target[j] += factor * source[j];
}

void nodes_add_cut_row(double *target, double factor, const node_state *self, size_t row) {
    const reduced_model *model = self->model;
    const size_t num_pressure = model->num_pressure;

    nodes_add_row(target, factor, nodes_checkpoint_table(self) + row * num_pressure, num_pressure);
    for (size_t r = 0; r < self->num_runs; r++) {
        const cut_run *run = &self->runs[r];
        for (size_t k = run->first; k < run->first + run->count; k++)
            nodes_add_row(target,
                          factor * run->sign * model->cut.left[k * model->cut.num_rows + row],
                          model->band.pressure + k * num_pressure, num_pressure);
    }
}

void nodes_add_film_row(double *target, double factor, const node_state *self, size_t needed) {
    const reduced_model *model = self->model;
    const size_t num_deformation = model->num_deformation;

    if (model->deformation == DEFORMATION_INDEPENDENT)
        nodes_add_row(target + model->num_pressure, factor,
                      model->rows.film + needed * num_deformation, num_deformation);
    else
        nodes_add_cut_row(target, factor, self, needed);
}

double nodes_central_change(node_state *self, const double *step) {
    const reduced_model *model = self->model;
    const double *checkpoint = nodes_checkpoint_table(self);
    size_t num_pressure = model->num_pressure, num_deformation = model->num_deformation;
    double change = step[model->num_unknowns - 1];

    nodes_expand_runs(self, step);
    for (size_t i = 0; i < 4; i++) {
        size_t q = model->centre.index[i];
        double film = 0;
        if (model->centre.weight[i] == 0) continue;
        if (model->deformation == DEFORMATION_INDEPENDENT) {
            film =
                dot(model->rows.film + q * num_deformation, step + num_pressure, num_deformation);
        } else {
            film = dot(checkpoint + q * num_pressure, step, num_pressure);
            for (size_t r = 0; r < self->num_runs; r++) {
                const cut_run *run = &self->runs[r];
                for (size_t k = run->first; k < run->first + run->count; k++)
                    film += run->sign * model->cut.left[k * model->cut.num_rows + q] *
                            self->band_pressure[k];
            }
        }
        change += model->centre.weight[i] * film;
    }
    return change;
}
