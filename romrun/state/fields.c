/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/state/fields.h"

#include "common/algebra/product.h"
#include "common/physics/deflection.h"

#include <stdlib.h>
#include <string.h>

// ---- the modes

static int compare_sizes(const void *a, const void *b) {
    const size_t p = *(const size_t *)a, q = *(const size_t *)b;

    return p < q ? -1 : p > q;
}

/* Finds the median of the trained exits on each grid line. With the median, the mean number of
 * nodes between cut_exits and the exit of a state is smallest. */
static ehd_status find_cut_exits(size_t *cut_exits, const reduced_model *model, ehd_error *error) {
    const reduced_states *states = &model->states;
    const size_t num = states->num_states, num_lines = model->band.num_lines;
    size_t *exit = malloc(num * sizeof *exit);

    if (!exit) return ehd_no_memory(error, "fields");
    for (size_t l = 0; l < num_lines; l++) {
        for (size_t s = 0; s < num; s++)
            exit[s] = states->exit[s * num_lines + l];
        qsort(exit, num, sizeof *exit, compare_sizes);
        cut_exits[l] = exit[num / 2];
    }
    free(exit);
    return EHD_OK;
}

ehd_status field_modes_init(field_modes *self, const reduced_model *model,
                            const double *pressure_basis, ehd_error *error) {
    *self = (field_modes){.pressure = pressure_basis,
                          .cut_exits = malloc(model->band.num_lines * sizeof *self->cut_exits)};
    if (!self->cut_exits) return ehd_no_memory(error, "fields");
    ehd_status status = find_cut_exits(self->cut_exits, model, error);
    if (status) field_modes_free(self);
    return status;
}

void field_modes_free(field_modes *self) {
    free(self->cut_exits);
    free(self->own);
    *self = (field_modes){0};
}

ehd_status field_modes_fill(double *table, size_t column, const ehd_grid *grid, size_t margin,
                            size_t side, const field_modes *self, const reduced_model *model,
                            ehd_error *error) {
    const size_t num_nodes = grid->num_nodes, num = model->num_pressure;
    const size_t own = grid_width(&model->grid), wide = grid_width(grid);
    ehd_deflection *deflection = deflection_create(model->kind, grid);
    double *work = malloc(num_nodes * sizeof *work);
    ehd_status status = deflection && work ? EHD_OK : ehd_no_memory(error, "fields");

    for (size_t j = 0; j < num && !status; j++) {
        memset(work, 0, num_nodes * sizeof *work);
        for (size_t l = 0; l < model->band.num_lines; l++)
            for (size_t c = 0; c < self->cut_exits[l]; c++)
                work[(l + side) * wide + margin + c] = self->pressure[(l * own + c) * num + j];
        deflection_apply(work, deflection, work);
        for (size_t k = 0; k < num_nodes; k++)
            table[k * column + j] = work[k];
    }
    deflection_free(deflection);
    free(work);
    return status;
}

ehd_status field_modes_deflect(field_modes *self, const reduced_model *model, ehd_error *error) {
    const ehd_grid *grid = &model->grid;

    self->own = array_new(grid->num_nodes, model->num_pressure, sizeof *self->own);
    if (!self->own) return ehd_no_memory(error, "fields");
    self->deflection = self->own;
    self->column = model->num_pressure;
    self->line = grid_width(grid) * self->column;
    return field_modes_fill(self->own, self->column, grid, 0, 0, self, model, error);
}

void field_modes_flat(flat *file, field_modes *self, const reduced_model *model,
                      const double *pressure_basis, bool own) {
    const ehd_grid *grid = &model->grid;

    if (!flat_good(file)) return;
    const ehd_status status =
        file->reading ? field_modes_init(self, model, pressure_basis, file->error) : EHD_OK;
    flat_fail(file, status);
    if (status || !own) return;
    self->deflection =
        flat_table(file, "field_deflection", self->own, grid->num_nodes, model->num_pressure);
    self->column = model->num_pressure;
    self->line = grid_width(grid) * self->column;
}

// ---- fields

/* Computes the sum of the modes, multiplied by `coordinates`, at all nodes. */
static void sum_modes(double *field, const double *modes, size_t column, size_t line,
                      const reduced_model *model, const double *coordinates) {
    const size_t width = grid_width(&model->grid);

    memset(field, 0, model->band.num_lines * width * sizeof *field);
    for (size_t l = 0; l < model->band.num_lines; l++)
        add_product(field + l * width, modes + l * line, column, width, model->num_pressure,
                    coordinates);
}

/* Adds the deflection by the pressures between `cut_exit` and `exit` of a grid line to the film. If
 * `exit` lies before `cut_exit`, subtracts this deflection. */
static void deflect_run(double *film, const reduced_model *model, size_t line, size_t exit,
                        size_t cut_exit, const double *pressure) {
    const size_t width = grid_width(&model->grid), first = exit < cut_exit ? exit : cut_exit;

    for (size_t l = 0; l < model->band.num_lines; l++) {
        const grid_position begin = {l, 0};
        reduced_model_deflect(film + l * width, model, begin, width, line, first,
                              index_distance(exit, cut_exit), pressure + first,
                              exit > cut_exit ? 1 : -1);
    }
}

void reduced_fields(double *pressure, double *film, const reduced_state *state,
                    const reduced_model *model, const field_modes *modes) {
    const ehd_grid *grid = &model->grid;
    const size_t width = grid_width(grid), *exit = reduced_state_exits(state);
    const double *z = state->coordinates;

    sum_modes(pressure, modes->pressure, model->num_pressure, width * model->num_pressure, model,
              z);
    sum_modes(film, modes->deflection, modes->column, modes->line, model, z);
    for (size_t l = 0; l < model->band.num_lines; l++) {
        deflect_run(film, model, l, exit[l], modes->cut_exits[l], pressure + l * width);
        memset(pressure + l * width + exit[l], 0, (width - exit[l]) * sizeof(double));
    }
    for (size_t k = 0; k < grid->num_nodes; k++)
        film[k] += z[model->num_unknowns - 1] + grid_gap(grid, k);
}
