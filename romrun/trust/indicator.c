/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/trust/indicator.h"

#include "common/algebra/vectors.h"
#include "common/physics/far_field.h"
#include "romrun/model/reduced_cut.h"
#include "romrun/trust/functionals.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

struct indicator {
    const reduced_model *model;
    functionals *functionals;
    double *pressure, *film; // [num_needed] at the needed nodes of the control rows
    double *fluid_memory;    // [NUM_FLUID_ARRAYS, num_needed]
    far_field outer;         // far field at the boundary nodes among the needed nodes
    double *band_pressure;   // [nodes of the band] P at the nodes of `runs`
    cut_run *runs;           // [num_lines] runs between the checkpoint's exit line and the exit
    reynolds_row *rows;      // [num_rows] the control rows
    double *residual;        // [num_rows] residuals of the control rows, weighted
    double *influence;       // [rows of the model] influence of rows on a film
    size_t *nearest;         // [num_rows] nearest row of the model whose influence is not 0
    size_t *nearest_of_all;  // [num_rows] nearest row of the model, whatever its influence
    double *added; // [rows of the model] for each row, the sum of the squared residuals of the
                   // control rows whose `nearest` is this row
    arena memory;
};

indicator *indicator_free(indicator *self) {
    if (!self) return NULL;
    functionals_free(self->functionals);
    arena_free(&self->memory);
    free(self);
    return NULL;
}

indicator *indicator_create(const reduced_model *model) {
    const row_set *control = &model->control;
    size_t num_needed = control->num_needed + 1; // avoids allocations of size zero
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
    self->residual = arena_array(memory, control->num_rows + 1, sizeof(double));
    self->influence = arena_array(memory, model->rows.num_rows, sizeof(double));
    self->nearest = arena_array(memory, control->num_rows + 1, sizeof *self->nearest);
    self->nearest_of_all = arena_array(memory, control->num_rows + 1, sizeof *self->nearest_of_all);
    self->added = arena_array(memory, model->rows.num_rows, sizeof(double));
    self->functionals = functionals_create(model);
    if (memory->failed || !self->functionals) return indicator_free(self);
    for (size_t r = 0; r < control->num_rows; r++)
        self->nearest_of_all[r] = reduced_model_nearest_row(model, control->node[r], NULL);
    return self;
}

/* Returns H at a needed node of the control rows for the exit line of the checkpoint. The result
 * does not contain the deflection by the runs, the nodes between this exit line and the present
 * exit line. */
static double film_at_checkpoint(const reduced_model *model, size_t q, const double *z,
                                 size_t checkpoint) {
    const row_set *control = &model->control;
    bool coupled = model->deformation == DEFORMATION_COUPLED;
    size_t width = coupled ? model->num_pressure : model->num_deformation;
    const double *film =
        coupled ? model->checkpoints.control + (checkpoint * control->num_needed + q) * width
                : control->film + q * width;

    return z[model->num_unknowns - 1] + control->gap[q] +
           dot(film, coupled ? z : z + model->num_pressure, width);
}

static bool is_before(const reduced_model *model, size_t node, const size_t *exit) {
    return reduced_model_column(model, node) < exit[reduced_model_line(model, node)];
}

/* Computes P and H at the needed nodes of the control rows. */
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
        self->pressure[q] = at.column < exit[at.line] ? dot(modes, z, num_pressure) : 0;
        self->film[q] = film_at_checkpoint(model, q, z, checkpoint);
        for (size_t r = 0; r < num_runs; r++)
            reduced_model_deflect(self->film + q, model, at, 1, self->runs[r].line,
                                  self->runs[r].column, self->runs[r].count,
                                  self->band_pressure + self->runs[r].first, self->runs[r].sign);
    }
}

const double *indicator_control_residuals(indicator *self, const reduced_state *state,
                                          const ehd_contact *contact) {
    const reduced_model *model = self->model;
    const row_set *control = &model->control;
    size_t num_needed = control->num_needed;
    // the Reynolds row does not hold at the node before an exit that lies between nodes
    const size_t cell_node = reduced_exit_divides(state, model) ? state->exit - 1 : NO_NODE;
    reynolds_fluid fluid = reynolds_fluid_in(self->fluid_memory, num_needed, contact);

    if (control->num_rows == 0) return self->residual;
    expand(self, state);
    far_field_add(self->pressure, &self->outer, contact,
                  state->coordinates[model->num_unknowns - 1]);
    reynolds_fluid_evaluate(&fluid, contact, self->pressure, num_needed);
    far_field_set_density(&fluid, &self->outer);
    reynolds_rows(self->rows, &model->grid, contact->entrainment, NULL, control->stencils,
                  control->num_rows, &fluid, self->pressure, self->film);
    for (size_t r = 0; r < control->num_rows; r++) {
        const bool counts = is_before(model, control->node[r], reduced_state_exits(state)) &&
                            control->node[r] != cell_node;
        self->residual[r] = counts ? control->weight[r] * self->rows[r].residual : 0;
    }
    return self->residual;
}

/* Returns the bound of the relative error of a film. self->influence must hold the influence of the
 * rows on this film. `own_rows`: change of the film that the residuals of the least squares
 * cause. */
static double bound(const indicator *self, double own_rows, double thickness) {
    double sum = own_rows * own_rows;

    for (size_t r = 0; r < self->model->control.num_rows; r++) {
        const double moved = self->residual[r] * self->influence[self->nearest[r]];
        sum += moved * moved;
    }
    const double relative = sqrt(sum) / thickness;
    // the sum is NaN if the pressure at a control row exceeds the limit of the viscosity law
    return isnan(relative) ? INFINITY : relative;
}

double indicator_bound(indicator *self, reduced_solver *solver, const reduced_state *state,
                       const ehd_contact *contact, const contact_scalars *scalars) {
    const row_set *control = &self->model->control;

    indicator_control_residuals(self, state, contact);
    const double own_rows =
        functionals_film_error(self->influence, self->functionals, solver, REDUCED_CENTRAL_FILM);
    for (size_t r = 0; r < control->num_rows; r++)
        self->nearest[r] =
            self->influence[self->nearest_of_all[r]] != 0
                ? self->nearest_of_all[r]
                : reduced_model_nearest_row(self->model, control->node[r], self->influence);
    return bound(self, own_rows, scalars->central_film_thickness);
}

double indicator_bound_minimum(indicator *self, reduced_solver *solver,
                               const contact_scalars *scalars) {
    const double own_rows =
        functionals_film_error(self->influence, self->functionals, solver, REDUCED_MINIMUM_FILM);

    return bound(self, own_rows, scalars->minimum_film_thickness);
}

static void add_control_rows(indicator *self) {
    const reduced_model *model = self->model;

    memset(self->added, 0, model->rows.num_rows * sizeof *self->added);
    for (size_t r = 0; r < model->control.num_rows; r++)
        self->added[self->nearest[r]] += self->residual[r] * self->residual[r];
}

void indicator_bound_others(double bounds[NUM_INDICATED], indicator *self, reduced_solver *solver,
                            const reduced_state *state, const ehd_contact *contact,
                            const contact_scalars *scalars) {
    const reduced_model *model = self->model;

    add_control_rows(self);
    const reduced_errors errors =
        functionals_other_errors(self->functionals, solver, state, contact, self->added);
    bounds[INDICATED_CENTRAL_PRESSURE] = errors.central_pressure / scalars->central_pressure;
    bounds[INDICATED_EXIT_POSITION] = errors.exit_position;
    bounds[INDICATED_LOAD] = errors.load;
    bounds[INDICATED_PRESSURE] = errors.pressure;
    bounds[INDICATED_FILM] = errors.film / scalars->central_film_thickness;
    bounds[INDICATED_FRICTION] = NAN;            // see indicator_bound_friction
    for (int q = 0; q < INDICATED_FRICTION; q++) // NaN becomes infinite, as in `bound`
        if (isnan(bounds[q]) &&
            (q != INDICATED_EXIT_POSITION || reduced_exit_divides(state, model)))
            bounds[q] = INFINITY;
}

double indicator_bound_peak(indicator *self, reduced_solver *solver) {
    add_control_rows(self);
    const double error = functionals_peak_error(self->functionals, solver, self->added);
    return isnan(error) ? INFINITY : error; // NaN becomes infinite, as in `bound`
}

double indicator_bound_friction(indicator *self, reduced_solver *solver, const reduced_state *state,
                                const ehd_contact *contact, double friction) {
    add_control_rows(self);
    const double relative =
        functionals_friction_error(self->functionals, solver, state, contact, self->added) /
        fabs(friction);
    // NaN becomes infinite, as in `bound`
    return isnan(relative) ? INFINITY : relative + node_cubature_tolerance;
}
