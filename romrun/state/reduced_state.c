/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/state/reduced_state.h"

#include "common/algebra/product.h"
#include "common/physics/exit.h"
#include "romrun/model/reduced_cut.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

ehd_status reduced_state_init(reduced_state *state, const reduced_model *model, ehd_error *error) {
    bool lines = model->band.num_lines > 1;

    *state = (reduced_state){.coordinates = calloc(model->num_unknowns, sizeof(double)),
                             .exit_offset = NAN};
    if (lines) state->exits = calloc(model->band.num_lines, sizeof *state->exits);
    if (state->coordinates && (state->exits || !lines)) return EHD_OK;
    reduced_state_free(state);
    return ehd_no_memory(error, "reduced state");
}

void reduced_state_free(reduced_state *state) {
    free(state->coordinates);
    free(state->exits);
    memset(state, 0, sizeof *state);
}

const size_t *reduced_state_exits(const reduced_state *state) {
    return state->exits ? state->exits : &state->exit;
}

static size_t exit_in_band(const band_line *line, size_t exit) {
    if (exit < line->min_exit) return line->min_exit;
    return exit > line->max_exit ? line->max_exit : exit;
}

void reduced_state_set_exits(reduced_state *state, const reduced_model *model,
                             const size_t *exits) {
    const size_t central = grid_central_line(&model->grid) / grid_width(&model->grid);

    state->exit_offset = NAN;
    state->exit = exit_in_band(&model->band.lines[central], exits[central]);
    for (size_t l = 0; l < model->band.num_lines && state->exits; l++)
        state->exits[l] = exit_in_band(&model->band.lines[l], exits[l]);
}

void reduced_state_copy(reduced_state *target, const reduced_state *source,
                        const reduced_model *model) {
    memcpy(target->coordinates, source->coordinates, model->num_unknowns * sizeof(double));
    reduced_state_set_exits(target, model, reduced_state_exits(source));
    target->exit_offset = source->exit_offset;
}

ehd_status reduced_values_init(reduced_values *values, const reduced_model *model,
                               ehd_error *error) {
    values->pressure = malloc(model->rows.num_needed * sizeof(double));
    values->cut = malloc(model->cut.num_rows * sizeof(double));
    values->checkpoint = model->checkpoints.num; // means: no checkpoint
    if (values->pressure && values->cut) return EHD_OK;
    reduced_values_free(values);
    return ehd_no_memory(error, "online solver");
}

void reduced_values_free(reduced_values *values) {
    free(values->pressure);
    free(values->cut);
    memset(values, 0, sizeof *values);
}

bool reduced_exit_divides(const reduced_state *state, const reduced_model *model) {
    return exit_is_within_node(&model->grid) && !isnan(state->exit_offset);
}

double reduced_exit_position(const reduced_state *state, const reduced_model *model) {
    const ehd_grid *grid = &model->grid;

    if (!reduced_exit_divides(state, model)) return grid_x(grid, state->exit);
    return grid_x(grid, state->exit - 1) + state->exit_offset * grid->step;
}

void reduced_pressures_include(reduced_pressures *range, double pressure) {
    if (isless(pressure, range->least) || isnan(pressure)) range->least = pressure;
    if (isgreater(pressure, range->largest) || isnan(pressure)) range->largest = pressure;
}

// ---- values at nodes

static void product(double *y, const double *matrix, const double *x, size_t rows, size_t columns) {
    memset(y, 0, rows * sizeof *y);
    add_product(y, matrix, columns, rows, columns, x);
}

void reduced_values_at(reduced_values *values, const reduced_model *model, const double *z,
                       size_t checkpoint) {
    size_t size = model->cut.num_rows * model->num_pressure;

    values->checkpoint = checkpoint;
    product(values->pressure, model->rows.pressure, z, model->rows.num_needed, model->num_pressure);
    product(values->cut, model->checkpoints.cut + checkpoint * size, z, model->cut.num_rows,
            model->num_pressure);
}

void reduced_values_of(reduced_values *values, const reduced_model *model, const double *z,
                       const size_t *exit) {
    reduced_values_at(values, model, z, reduced_model_checkpoint(model, exit));
}

void reduced_band_pressure(double *pressure, const reduced_model *model, const double *coordinates,
                           size_t first, size_t count) {
    product(pressure, model->band.pressure + first * model->num_pressure, coordinates, count,
            model->num_pressure);
}
