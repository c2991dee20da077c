/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/solve/kept_factors.h"

#include <math.h>
#include <string.h>

void kept_factors_init(kept_factors *self, const reduced_model *model, arena *memory) {
    size_t max_rows = system_max_rows(model);

    self->matrix = arena_array(memory, max_rows * model->num_unknowns, sizeof(double));
    self->row = arena_array(memory, model->rows.num_rows, sizeof *self->row);
    self->exit = arena_array(memory, model->band.num_lines, sizeof *self->exit);
    self->factors = least_squares_create(max_rows, model->num_unknowns);
    memory->failed |= reduced_state_init(&self->start, model, NULL) != EHD_OK || !self->factors;
}

void kept_factors_free(kept_factors *self) {
    reduced_state_free(&self->start);
    self->factors = least_squares_free(self->factors);
}

void kept_factors_set(kept_factors *self, const row_system *system, const node_state *nodes,
                      double closure_weight) {
    const reduced_model *model = system->model;
    size_t num_rows = system->num_active + model->num_deformation + 1;

    self->weight = closure_weight;
    self->num_rows = system->num_active;
    memcpy(self->row, system->active, system->num_active * sizeof *self->row);
    memcpy(self->exit, nodes->exit, model->band.num_lines * sizeof *self->exit);
    memcpy(self->matrix, system->matrix, num_rows * model->num_unknowns * sizeof(double));
    self->valid = least_squares_factorise(self->factors, self->matrix, num_rows) == EHD_OK;
}

/* Largest distance between the present exit and the exit of the kept Jacobian, half widths. Up to
 * this distance the kept factors are tried (romrun/online/README.md, In time; test_kept_factors.c,
 * factors_serve_while_exits_are_near). */
static const double MAX_EXIT_DISTANCE = 0.025;

/* For point contacts, whose grid steps are longer than MAX_EXIT_DISTANCE, the result is at least
 * one node. If it were zero, exits that move by a node would make the factors useless in six of
 * seven time steps. The one node saves 21 to 25 % of the instructions (65 nodes a side, load
 * periods 1/2 and 3/4). */
size_t kept_factors_reach(const reduced_model *model) {
    const double nodes = MAX_EXIT_DISTANCE / model->grid.step;

    return (size_t)(model->band.num_lines > 1 ? fmax(nodes, 1) : nodes);
}

bool kept_factors_are_near(const kept_factors *self, const reduced_model *model,
                           const reduced_state *state) {
    const size_t max_distance = kept_factors_reach(model);
    const size_t *exit = reduced_state_exits(state);

    for (size_t l = 0; l < model->band.num_lines; l++)
        if (index_distance(exit[l], self->exit[l]) > max_distance) return false;
    return true;
}
