/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/online/solver_parts.h"

#include <cblas.h>
#include <string.h>

// ---- the exit's cut

void nodes_move_exit(reduced_solver *self, const size_t *exit) {
    const reduced_model *model = self->model;
    size_t num_lines = model->band.num_lines, bytes = num_lines * sizeof *exit;

    if (memcmp(self->exit, exit, bytes) == 0) return;
    memcpy(self->exit, exit, bytes);
    for (size_t q = 0; q < model->rows.num_needed; q++) {
        size_t node = model->rows.needed_node[q];
        self->alive[q] = reduced_model_column(model, node) < exit[reduced_model_line(model, node)];
    }
    self->checkpoint = reduced_model_checkpoint(model, exit);
    self->num_runs = reduced_model_runs(
        self->runs, model, model->checkpoints.exit + self->checkpoint * num_lines, exit);
}

const double *nodes_checkpoint_table(const reduced_solver *self) {
    const reduced_model *model = self->model;

    return model->checkpoints.cut + self->checkpoint * model->cut.num_rows * model->num_pressure;
}

void nodes_make_cut_table(reduced_solver *self) {
    const reduced_model *model = self->model;
    size_t size = model->cut.num_rows * model->num_pressure,
           bytes = model->band.num_lines * sizeof(size_t);

    if (memcmp(self->table_exit, self->exit, bytes) == 0) return;
    memcpy(self->cut, nodes_checkpoint_table(self), size * sizeof(double));
    if (self->num_runs > 0)
        reduced_model_change_cut(self->cut, model, self->runs, self->num_runs, self->block);
    memcpy(self->table_exit, self->exit, bytes);
}

// ---- the state at nodes

static void product(double *y, const double *matrix, const double *x, size_t rows, size_t columns) {
    if (rows > 0)
        cblas_dgemv(CblasRowMajor, CblasNoTrans, (int)rows, (int)columns, 1, matrix, (int)columns,
                    x, 1, 0, y, 1);
}

void nodes_expand_places(reduced_solver *self, const double *z, size_t first, size_t count) {
    const reduced_model *model = self->model;

    reduced_band_pressure(self->band_pressure + first, model, z, first, count);
}

void nodes_expand_band(reduced_solver *self, const double *z, size_t from, size_t to) {
    if (to > from) nodes_expand_places(self, z, from - self->model->band.lines[0].begin, to - from);
}

void nodes_expand_runs(reduced_solver *self, const double *z) {
    for (size_t r = 0; r < self->num_runs; r++)
        nodes_expand_places(self, z, self->runs[r].first, self->runs[r].count);
}

void nodes_values_at(reduced_values *values, const reduced_model *model, const double *z,
                     size_t checkpoint) {
    size_t size = model->cut.num_rows * model->num_pressure;

    values->checkpoint = checkpoint;
    product(values->pressure, model->rows.pressure, z, model->rows.num_needed, model->num_pressure);
    product(values->cut, model->checkpoints.cut + values->checkpoint * size, z, model->cut.num_rows,
            model->num_pressure);
}

void reduced_values_of(reduced_values *values, const reduced_model *model, const double *z,
                       const size_t *exit) {
    nodes_values_at(values, model, z, reduced_model_checkpoint(model, exit));
}

void nodes_add_values(reduced_values *values, double factor, const reduced_values *of,
                      const reduced_model *model) {
    cblas_daxpy((int)model->rows.num_needed, factor, of->pressure, 1, values->pressure, 1);
    cblas_daxpy((int)model->cut.num_rows, factor, of->cut, 1, values->cut, 1);
}

void nodes_expand(double *pressure, double *film, double *cut_value, reduced_solver *self,
                  const reduced_values *values, const double *z) {
    const reduced_model *model = self->model;

    for (size_t q = 0; q < model->rows.num_needed; q++)
        pressure[q] = self->alive[q] ? values->pressure[q] : 0;
    memcpy(cut_value, values->cut, model->cut.num_rows * sizeof(double));
    nodes_expand_runs(self, z);
    for (size_t r = 0; r < self->num_runs; r++) {
        const cut_run *run = &self->runs[r];
        cblas_dgemv(CblasRowMajor, CblasTrans, (int)run->count, (int)model->cut.num_rows, run->sign,
                    model->cut.left + run->first * model->cut.num_rows, (int)model->cut.num_rows,
                    self->band_pressure + run->first, 1, 1, cut_value, 1);
    }
    if (model->deformation == DEFORMATION_COUPLED)
        memcpy(film, cut_value, model->rows.num_needed * sizeof(double));
    else
        product(film, model->rows.film, z + model->num_pressure, model->rows.num_needed,
                model->num_deformation);
    for (size_t q = 0; q < model->rows.num_needed; q++)
        film[q] += z[model->num_unknowns - 1];
}

void nodes_expand_state(reduced_solver *self, const reduced_values *known, const double *z) {
    if (!known || known->checkpoint != self->checkpoint) {
        nodes_values_at(&self->values, self->model, z, self->checkpoint);
        known = &self->values;
    }
    nodes_expand(self->pressure, self->film, self->cut_value, self, known, z);
}

double nodes_load(const reduced_solver *self) {
    return self->cut_value[self->model->cut.num_rows - 1];
}

void nodes_band_films(double *film, const reduced_solver *self, const double *z, size_t node,
                      size_t count) {
    const reduced_model *model = self->model;
    size_t place = reduced_model_band_place(model, node), num_pressure = model->num_pressure;
    bool coupled = model->deformation == DEFORMATION_COUPLED;
    size_t width = coupled ? num_pressure : model->num_deformation;
    const double *checkpoint =
        model->checkpoints.band + self->checkpoint * model->band.num_nodes * num_pressure;
    const double *basis = (coupled ? checkpoint : model->band.film) + place * width;
    const grid_place at = reduced_model_place(model, node);

    for (size_t i = 0; i < count; i++)
        film[i] = z[model->num_unknowns - 1] + grid_gap(&model->grid, node + i) +
                  cblas_ddot((int)width, basis + i * width, 1, coupled ? z : z + num_pressure, 1);
    for (size_t r = 0; coupled && r < self->num_runs; r++) {
        const cut_run *run = &self->runs[r];
        reduced_model_deflect(film, model, at, count, run->line, run->column, run->count,
                              self->band_pressure + run->first, run->sign);
    }
}

double nodes_band_film(const reduced_solver *self, const double *z, size_t node) {
    double film;

    nodes_band_films(&film, self, z, node, 1);
    return film;
}

void nodes_add_row(double *target, double factor, const double *source, size_t count) {
    for (size_t j = 0; j < count; j++)
        target[j] += factor * source[j];
}

void reduced_band_pressure(double *pressure, const reduced_model *model, const double *coordinates,
                           size_t first, size_t count) {
    product(pressure, model->band.pressure + first * model->num_pressure, coordinates, count,
            model->num_pressure);
}
