/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/online/solver_parts.h"

#include <cblas.h>
#include <math.h>
#include <string.h>

// ---- one iteration

static bool is_row_alive(const reduced_solver *self, size_t r) {
    return self->alive[self->model->rows.stencils[r].node[NODE_HERE]];
}

void system_list_rows(reduced_solver *self) {
    self->num_system = 0;
    for (size_t r = 0; r < self->model->rows.num_rows; r++)
        if (is_row_alive(self, r)) self->system_row[self->num_system++] = r;
}

void system_evaluate_rows(reduced_solver *self, const ehd_contact *contact,
                          const reduced_squeeze *squeeze, const reduced_values *known,
                          const double *z) {
    const reduced_model *model = self->model;
    size_t num_needed = model->rows.num_needed;
    double *memory = self->fluid_memory;
    bool compressible = contact->lubricant.density != NULL;
    reynolds_fluid fluid = {memory, memory + num_needed,
                            compressible ? memory + 2 * num_needed : NULL,
                            compressible ? memory + 3 * num_needed : NULL};

    nodes_expand_state(self, known, z);
    for (size_t q = 0; q < num_needed; q++)
        self->film[q] += model->rows.gap[q];
    reynolds_fluid_evaluate(&fluid, contact, self->pressure, num_needed);
    const reynolds_squeeze rows_squeeze = {squeeze ? squeeze->rate : 0,
                                           squeeze ? squeeze->earlier : NULL};
    reynolds_rows(self->rows, model->grid.step, contact->entrainment,
                  squeeze ? &rows_squeeze : NULL, model->rows.stencils, model->rows.num_rows,
                  &fluid, self->pressure, self->film);
}

/* target += sum of factors[a] * sources[a], in one pass. */
static void add_rows(double *restrict target, const double factors[NUM_LINE_STENCIL],
                     const double *const sources[NUM_LINE_STENCIL], size_t count) {
    for (size_t j = 0; j < count; j++) {
        double sum = target[j];
        for (int a = 0; a < NUM_LINE_STENCIL; a++)
            sum += factors[a] * sources[a][j];
        target[j] = sum;
    }
}

/* Row of the weighted reduced Jacobian: stencil coefficients times rows of the bases, those of the coupled film at the
 * exit's checkpoint. */
static void fill_reynolds_row(double *target, const reduced_solver *self, size_t r) {
    const reduced_model *model = self->model;
    const reynolds_stencil *stencil = &model->rows.stencils[r];
    const reynolds_row *row = &self->rows[r];
    double weight = model->rows.weight[r], approach = 0;
    bool coupled = model->deformation == DEFORMATION_COUPLED;
    size_t width = coupled ? model->num_pressure : model->num_deformation;
    size_t offset = coupled ? 0 : model->num_pressure;
    const double *film = coupled ? nodes_checkpoint_table(self) : model->rows.film;

    double by_pressure[NUM_LINE_STENCIL] = {0}, by_film[NUM_LINE_STENCIL] = {0};
    const double *pressures[NUM_LINE_STENCIL], *films[NUM_LINE_STENCIL];

    for (int a = 0; a < NUM_LINE_STENCIL; a++) {
        bool there = stencil->node[a] != NO_NODE;
        size_t q = there ? stencil->node[a] : 0;
        pressures[a] = model->rows.pressure + q * model->num_pressure;
        films[a] = film + q * width;
        if (!there) continue;
        if (self->alive[q]) by_pressure[a] = weight * row->by_pressure[a];
        by_film[a] = weight * row->by_film[a];
        approach += row->by_film[a];
    }
    memset(target, 0, model->num_unknowns * sizeof(double));
    add_rows(target, by_pressure, pressures, model->num_pressure);
    add_rows(target + offset, by_film, films, width);
    for (int a = NODE_LEFT; a <= NODE_RIGHT && stencil->node[a] != NO_NODE; a++) {
        size_t q = stencil->node[a];
        if (self->alive[q])
            nodes_add_row(target, weight * row->by_pressure[a],
                          model->rows.pressure + q * model->num_pressure, model->num_pressure);
        nodes_add_row(target + offset, weight * row->by_film[a], film + q * width, width);
        approach += row->by_film[a];
    }
    target[model->num_unknowns - 1] = weight * approach;
}

size_t system_fill_right(reduced_solver *self, const double *z, const size_t *list, size_t num_list,
                         const contact_closure *closure, double closure_weight) {
    const reduced_model *model = self->model;
    size_t count = 0;

    for (; count < num_list; count++) {
        size_t r = list[count];
        self->right[count] =
            is_row_alive(self, r) ? model->rows.weight[r] * self->rows[r].residual : 0;
    }
    for (size_t j = 0; j < model->num_deformation; j++, count++)
        self->right[count] = z[model->num_pressure + j] - self->cut_value[j];
    self->right[count] =
        closure_weight * (closure->by_load * nodes_load(self) +
                          closure->by_approach * z[model->num_unknowns - 1] - closure->value);
    return count + 1;
}

/* What a band node's pressure makes of the system's rows: the load balance last, [num_system + 1]. The products are
 * rounded as fill_reynolds_row does, so that a node that is taken away leaves nothing of itself. */
static void weigh_left(double *left, size_t stride, const reduced_solver *self, size_t place,
                       double sign, double load_weight) {
    const reduced_model *model = self->model;
    const double *by_node = model->cut.left + place * model->cut.num_rows;

    for (size_t i = 0; i < self->num_system; i++) {
        size_t r = self->system_row[i];
        const reynolds_stencil *stencil = &model->rows.stencils[r];
        double weight = model->rows.weight[r], sum = 0;
        for (int a = 0; a < NUM_STENCIL; a++)
            if (stencil->node[a] != NO_NODE)
                sum += weight * self->rows[r].by_film[a] * by_node[stencil->node[a]];
        left[i * stride] = sign * sum;
    }
    left[self->num_system * stride] = sign * load_weight * by_node[model->cut.num_rows - 1];
}

/* matrix += left right of the first `rank` nodes in the block. */
static void add_block(reduced_solver *self, size_t rank) {
    const reduced_model *model = self->model;

    cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, (int)self->num_system + 1,
                (int)model->num_pressure, (int)rank, 1, self->block, CUT_BLOCK, self->block_right,
                (int)model->num_pressure, 1, self->matrix, (int)model->num_unknowns);
}

/* Brings the rows of a coupled basis from the exit's checkpoint to the exit: eq. (36) with the stencils applied to its
 * left sides first. */
static void add_runs(reduced_solver *self, double load_weight) {
    const reduced_model *model = self->model;
    size_t rank = 0;

    for (size_t r = 0; r < self->num_runs; r++) {
        const cut_run *run = &self->runs[r];
        for (size_t k = run->first; k < run->first + run->count; k++) {
            weigh_left(self->block + rank, CUT_BLOCK, self, k, run->sign, load_weight);
            memcpy(self->block_right + rank * model->num_pressure,
                   model->band.pressure + k * model->num_pressure,
                   model->num_pressure * sizeof(double));
            if (++rank < CUT_BLOCK) continue;
            add_block(self, rank);
            rank = 0;
        }
    }
    if (rank > 0) add_block(self, rank);
}

/* The projected elasticity of an independent basis, from row `count` on; returns the row behind. */
static size_t fill_elasticity(reduced_solver *self, size_t count) {
    const reduced_model *model = self->model;
    size_t n = model->num_unknowns, num_pressure = model->num_pressure;

    for (size_t j = 0; j < model->num_deformation; j++, count++) {
        double *row = self->matrix + count * n;
        memset(row, 0, n * sizeof(double));
        nodes_add_row(row, -1, self->cut + j * num_pressure, num_pressure);
        row[num_pressure + j] = 1;
    }
    return count;
}

void system_fill_matrix(reduced_solver *self, const contact_closure *closure,
                        double closure_weight) {
    const reduced_model *model = self->model;
    size_t n = model->num_unknowns, num_pressure = model->num_pressure, count = 0;
    bool coupled = model->deformation == DEFORMATION_COUPLED;

    if (!coupled) nodes_make_cut_table(self);
    const double *load = (coupled ? nodes_checkpoint_table(self) : self->cut) +
                         (model->cut.num_rows - 1) * num_pressure;
    for (; count < self->num_system; count++)
        fill_reynolds_row(self->matrix + count * n, self, self->system_row[count]);
    count = fill_elasticity(self, count);
    double *row = self->matrix + count * n;
    memset(row, 0, n * sizeof(double));
    nodes_add_row(row, closure_weight * closure->by_load, load, num_pressure);
    row[n - 1] = closure_weight * closure->by_approach;
    if (coupled) add_runs(self, closure_weight * closure->by_load);
}

double system_closure_weight(double rate) {
    return 1 + rate;
}
