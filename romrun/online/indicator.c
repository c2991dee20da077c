/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/online/indicator.h"

#include "common/physics/far_field.h"
#include "romrun/model/reduced_cut.h"

#include <cblas.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

struct indicator {
    const reduced_model *model;
    double *pressure, *film; // [num_needed] of the control rows
    double *fluid_memory;    // [NUM_FLUID_ARRAYS, num_needed]
    far_field outer;         // boundary nodes among the needed ones
    double *band_pressure;   // [nodes of the band] where the exit differs from its checkpoint's
    cut_run *runs;           // [num_lines]
    reynolds_row *rows;      // [num_rows] of the control rows
    double residual;         // of the last bound
    arena memory;            // of all arrays
};

indicator *indicator_free(indicator *self) {
    if (self) arena_free(&self->memory);
    free(self);
    return NULL;
}

indicator *indicator_create(const reduced_model *model) {
    const row_set *control = &model->control;
    size_t num_needed = control->num_needed + 1; // no allocation of size zero
    indicator *self = calloc(1, sizeof *self);

    if (!self) return NULL;
    arena *memory = &self->memory;
    self->model = model;
    self->pressure = arena_array(memory, num_needed, sizeof(double));
    self->film = arena_array(memory, num_needed, sizeof(double));
    self->fluid_memory = arena_array(memory, NUM_FLUID_ARRAYS * num_needed, sizeof(double));
    far_field_init(&self->outer, &model->grid, control->needed_node, control->num_needed, memory);
    self->band_pressure = arena_array(memory, model->band.num_nodes, sizeof(double));
    self->runs = arena_array(memory, model->band.num_lines, sizeof *self->runs);
    self->rows = arena_array(memory, (control->num_rows + 1), sizeof *self->rows);
    return memory->failed ? indicator_free(self) : self;
}

/* H at a needed node without the deflection by the exit's runs. */
static double film_at_checkpoint(const reduced_model *model, size_t q, const double *z,
                                 size_t checkpoint) {
    const row_set *control = &model->control;
    bool coupled = model->deformation == DEFORMATION_COUPLED;
    size_t width = coupled ? model->num_pressure : model->num_deformation;
    const double *film =
        coupled ? model->checkpoints.control + (checkpoint * control->num_needed + q) * width
                : control->film + q * width;

    return z[model->num_unknowns - 1] + control->gap[q] +
           cblas_ddot((int)width, film, 1, coupled ? z : z + model->num_pressure, 1);
}

static bool is_before(const reduced_model *model, size_t node, const size_t *exit) {
    return reduced_model_column(model, node) < exit[reduced_model_line(model, node)];
}

/* P and H at the needed nodes. */
static void expand(indicator *self, const reduced_state *state) {
    const reduced_model *model = self->model;
    const row_set *control = &model->control;
    const double *z = state->coordinates;
    const size_t *exit = reduced_state_exits(state);
    size_t num_pressure = model->num_pressure, num_runs = 0;
    size_t checkpoint = reduced_model_checkpoint(model, exit);

    if (model->deformation == DEFORMATION_COUPLED)
        num_runs = reduced_model_runs(
            self->runs, model, model->checkpoints.exit + checkpoint * model->band.num_lines, exit);
    for (size_t r = 0; r < num_runs; r++)
        reduced_band_pressure(self->band_pressure + self->runs[r].first, model, z,
                              self->runs[r].first, self->runs[r].count);
    for (size_t q = 0; q < control->num_needed; q++) {
        size_t node = control->needed_node[q];
        const grid_position at = reduced_model_position(model, node);
        const double *modes = control->pressure + q * num_pressure;
        self->pressure[q] =
            at.column < exit[at.line] ? cblas_ddot((int)num_pressure, modes, 1, z, 1) : 0;
        self->film[q] = film_at_checkpoint(model, q, z, checkpoint);
        for (size_t r = 0; r < num_runs; r++)
            reduced_model_deflect(self->film + q, model, at, 1, self->runs[r].line,
                                  self->runs[r].column, self->runs[r].count,
                                  self->band_pressure + self->runs[r].first, self->runs[r].sign);
    }
}

double indicator_control_residual(indicator *self, const reduced_state *state,
                                  const ehd_contact *contact) {
    const reduced_model *model = self->model;
    const row_set *control = &model->control;
    size_t num_needed = control->num_needed;
    // a node that the exit divides has another row
    const size_t cell_node = reduced_exit_divides(state, model) ? state->exit - 1 : NO_NODE;
    double sum = 0;
    reynolds_fluid fluid = reynolds_fluid_in(self->fluid_memory, num_needed, contact);

    if (control->num_rows == 0) return 0;
    expand(self, state);
    far_field_add(self->pressure, &self->outer, contact,
                  state->coordinates[model->num_unknowns - 1]);
    reynolds_fluid_evaluate(&fluid, contact, self->pressure, num_needed);
    far_field_set_density(&fluid, &self->outer);
    reynolds_rows(self->rows, &model->grid, contact->entrainment, NULL, control->stencils,
                  control->num_rows, &fluid, self->pressure, self->film);
    for (size_t r = 0; r < control->num_rows; r++) {
        double residual = control->weight[r] * self->rows[r].residual;
        if (is_before(model, control->node[r], reduced_state_exits(state)) &&
            control->node[r] != cell_node)
            sum += residual * residual;
    }
    return sqrt(sum);
}

/* Change of the central film, in units of a^2/R, up to which the bound is about linear. Measured on
 * 1250 random scenes of both loaded regions with five viscosity and two density laws, in the most
 * accurate sizes: up to half of it the deviation is at most a seventh of the linear bound, and soon
 * above it grows with its cube. */
static const double LINEAR = 3e-4;

/* Of a film with this sensitivity. */
static double bound_of(double residual, double sensitivity, double film) {
    const double film_change = sensitivity * residual, part = film_change / LINEAR;
    const double bound = film_change * (1 + part * part) / film;

    // at a control row the pressure may lie beyond the end of the viscosity law
    return isnan(bound) ? INFINITY : bound;
}

double indicator_bound(indicator *self, reduced_solver *solver, const reduced_state *state,
                       const ehd_contact *contact, const contact_scalars *scalars) {
    self->residual =
        hypot(reduced_remaining_residual(solver), indicator_control_residual(self, state, contact));
    return bound_of(self->residual, reduced_central_sensitivity(solver),
                    scalars->central_film_thickness);
}

double indicator_bound_minimum(const indicator *self, reduced_solver *solver,
                               const contact_scalars *scalars) {
    return bound_of(self->residual, reduced_minimum_sensitivity(solver),
                    scalars->minimum_film_thickness);
}
