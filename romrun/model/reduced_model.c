/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/model/reduced_cut.h"
#include "romrun/model/start_shift.h"

#include "common/physics/deflection.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

void reduced_model_free(reduced_model *model) {
    arena_free(&model->memory);
    reduced_states_free(&model->states);
    memset(model, 0, sizeof *model);
}

const double node_cubature_tolerance = 1e-5;

// ---- lines and columns

size_t reduced_model_line(const reduced_model *model, size_t node) {
    return model->band.num_lines > 1 ? node / grid_width(&model->grid) : 0;
}

size_t reduced_model_column(const reduced_model *model, size_t node) {
    return model->band.num_lines > 1 ? node % grid_width(&model->grid) : node;
}

grid_position reduced_model_position(const reduced_model *model, size_t node) {
    return (grid_position){reduced_model_line(model, node), reduced_model_column(model, node)};
}

size_t reduced_model_row(const reduced_model *model, size_t node) {
    for (size_t r = 0; r < model->rows.num_rows; r++)
        if (model->rows.node[r] == node) return r;
    return NO_NODE;
}

size_t reduced_model_nearest_row(const reduced_model *model, size_t node, const double *influence) {
    const row_set *rows = &model->rows;
    const grid_position here = reduced_model_position(model, node);
    size_t nearest = SIZE_MAX, row = 0;

    for (size_t r = 0; r < rows->num_rows; r++) {
        if (influence && influence[r] == 0) continue;
        const grid_position at = reduced_model_position(model, rows->node[r]);
        const size_t along = index_distance(at.column, here.column);
        const size_t across = index_distance(at.line, here.line);
        const size_t square = along * along + across * across;
        if (square >= nearest) continue;
        nearest = square;
        row = r;
    }
    return row;
}

bool reduced_model_has_band(const reduced_model *model, size_t line) {
    return model->band.lines[line].end > model->band.lines[line].begin;
}

size_t reduced_model_band_index(const reduced_model *model, size_t node) {
    const band_line *line = &model->band.lines[reduced_model_line(model, node)];

    return line->offset + reduced_model_column(model, node) - line->begin;
}

void reduced_model_deflect(double *film, const reduced_model *model, grid_position at,
                           size_t num_at, size_t line, size_t first, size_t count,
                           const double *pressure, double sign) {
    size_t width = grid_width(&model->grid);
    const double *kernel = model->kernel + index_distance(at.line, line) * width;
    bool has_mirrored = model->grid.half && line > 0;
    const double *mirrored = has_mirrored ? model->kernel + (at.line + line) * width : NULL;

    for (size_t i = 0; i < count; i++) {
        double source = sign * pressure[i];
        for (size_t a = 0; a < num_at; a++) {
            size_t apart = index_distance(at.column + a, first + i);
            film[a] += kernel[apart] * source;
            if (has_mirrored) film[a] += mirrored[apart] * source;
        }
    }
}

// ---- needed nodes of rows

/* Finds the nodes around X = 0 (Y = 0) and the weights of cubic interpolation. A node at X = 0 has
 * the weight 1. */
static void find_centre(size_t nodes[4], double weights[4], const ehd_grid *grid) {
    double column = -grid->x_min / grid->step + 1;
    size_t k = (size_t)floor(column + 1e-6);
    double t = column - (double)k;
    size_t before = grid_central_line(grid);

    for (size_t i = 0; i < 4; i++)
        nodes[i] = before + k - 1 + i;
    weights[0] = -t * (t - 1) * (t - 2) / 6;
    weights[1] = (t + 1) * (t - 1) * (t - 2) / 2;
    weights[2] = -(t + 1) * t * (t - 2) / 2;
    weights[3] = (t + 1) * t * (t - 1) / 6;
    if (fabs(t) < 1e-6)
        for (size_t i = 0; i < 4; i++)
            weights[i] = i == 1 ? 1 : 0;
}

static void mark_stencils(bool *needed, const ehd_grid *grid, const size_t *rows, size_t num_rows) {
    for (size_t r = 0; r < num_rows; r++) {
        reynolds_stencil stencil = reynolds_stencil_at(grid, rows[r]);
        for (int a = 0; a < NUM_STENCIL; a++)
            if (stencil.node[a] != NO_NODE) needed[stencil.node[a]] = true;
    }
}

ehd_status reduced_model_list_needed(reduced_model *model, row_set *set, ehd_error *error) {
    size_t num_nodes = model->grid.num_nodes, centre[4], count = 0;
    bool *needed = calloc(num_nodes, sizeof *needed);

    if (!needed) return ehd_no_memory(error, "reduced model");
    mark_stencils(needed, &model->grid, set->node, set->num_rows);
    find_centre(centre, model->centre.weight, &model->grid);
    for (size_t i = 0; i < 4 && set == &model->rows; i++)
        if (model->centre.weight[i] != 0) needed[centre[i]] = true;
    for (size_t k = 0; k < num_nodes; k++)
        count += needed[k];
    set->needed_node = arena_array(&model->memory, count, sizeof *set->needed_node);
    for (size_t k = 0; set->needed_node && k < num_nodes; k++)
        if (needed[k]) set->needed_node[set->num_needed++] = k;
    free(needed);
    return set->needed_node ? EHD_OK : ehd_no_memory(error, "reduced model");
}

/* Returns the index of a node in an ascending list that contains the node. If the node is NO_NODE,
 * returns NO_NODE. */
static size_t index_in(const size_t *nodes, size_t count, size_t node) {
    size_t low = 0, high = count;

    if (node == NO_NODE) return NO_NODE;
    while (high - low > 1) {
        size_t middle = (low + high) / 2;
        if (nodes[middle] <= node)
            low = middle;
        else
            high = middle;
    }
    return low;
}

ehd_status reduced_model_place_rows(reduced_model *model, row_set *set, ehd_error *error) {
    size_t centre[4];

    set->stencils = arena_array(&model->memory, set->num_rows, sizeof *set->stencils);
    set->gap = arena_array(&model->memory, set->num_needed, sizeof *set->gap);
    if (!set->stencils || !set->gap) return ehd_no_memory(error, "reduced model");
    for (size_t r = 0; r < set->num_rows; r++) {
        reynolds_stencil *stencil = &set->stencils[r];
        *stencil = reynolds_stencil_at(&model->grid, set->node[r]);
        for (int a = 0; a < NUM_STENCIL; a++)
            stencil->node[a] = index_in(set->needed_node, set->num_needed, stencil->node[a]);
    }
    for (size_t q = 0; q < set->num_needed; q++)
        set->gap[q] = grid_gap(&model->grid, set->needed_node[q]);
    if (set != &model->rows) return EHD_OK;
    find_centre(centre, model->centre.weight, &model->grid);
    for (size_t i = 0; i < 4; i++)
        model->centre.index[i] = index_in(set->needed_node, set->num_needed, centre[i]);
    return EHD_OK;
}

// ---- tables that follow from the stored ones

/* Fills the left sides (`left` of exit_cut) of a coupled basis, except the column of the load. Row
 * i holds the deflections at the needed nodes by a pressure of 1 at band node i, which are entries
 * of K. */
static void fill_left_coupled(reduced_model *model) {
    const double unit = 1;

    for (size_t l = 0; l < model->band.num_lines; l++) {
        const band_line *line = &model->band.lines[l];
        for (size_t c = line->begin; c < line->end; c++) {
            double *left = model->cut.left + (line->offset + c - line->begin) * model->cut.num_rows;
            memset(left, 0, model->rows.num_needed * sizeof(double));
            for (size_t q = 0; q < model->rows.num_needed; q++)
                reduced_model_deflect(left + q, model,
                                      reduced_model_position(model, model->rows.needed_node[q]), 1,
                                      l, c, 1, &unit, 1);
        }
    }
}

/* Fills the last column of the left sides, for both kinds of bases: the load of a pressure of 1 at
 * a band node. */
static void fill_left_load(reduced_model *model) {
    for (size_t l = 0; l < model->band.num_lines; l++) {
        const band_line *line = &model->band.lines[l];
        double weight = grid_load_weight(&model->grid, l * grid_width(&model->grid) + line->begin);
        for (size_t i = line->offset; i < line->offset + line->end - line->begin; i++)
            model->cut.left[(i + 1) * model->cut.num_rows - 1] = weight;
    }
}

static ehd_status fill_kernel(reduced_model *model, ehd_error *error) {
    const ehd_grid *grid = &model->grid;
    size_t width = grid_width(grid), lines = (grid->half ? 2 : 1) * model->band.num_lines;

    model->kernel = arena_array(&model->memory, lines * width, sizeof(double));
    if (!model->kernel) return ehd_no_memory(error, "reduced model");
    for (size_t l = 0; l < lines; l++)
        for (size_t d = 0; d < width; d++)
            model->kernel[l * width + d] = deflection_influence(
                model->kind, grid, (double)d * grid->step, (double)l * grid_step_across(grid));
    return EHD_OK;
}

ehd_status reduced_model_complete(reduced_model *model, ehd_error *error) {
    ehd_status status = reduced_model_place_rows(model, &model->rows, error);

    if (!status) status = fill_kernel(model, error);
    if (status) return status;
    if (model->deformation == DEFORMATION_COUPLED) fill_left_coupled(model);
    fill_left_load(model);
    status = start_shift_build(model, error);
    return status ? status : reduced_model_make_checkpoints(model, error);
}

ehd_status reduced_model_complete_control(reduced_model *model, ehd_error *error) {
    ehd_status status = reduced_model_place_rows(model, &model->control, error);

    return status ? status : reduced_model_make_control_checkpoints(model, error);
}
