/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/model/reduced_build.h"

#include "common/algebra/product.h"
#include "common/algebra/vectors.h"
#include "common/program/program.h"

#include <string.h>

/* Checks whether a node lies before the band and hence before any exit. */
static bool is_before_band(const reduced_model *model, size_t node) {
    return reduced_model_column(model, node) <
           model->band.lines[reduced_model_line(model, node)].begin;
}

/* Computes the deflections, [num_nodes, num_pressure], that the pressure modes cause if they are
 * set to zero from the beginning of the band on. */
static void deflect_modes(double *coupled, const reduced_model *model, const reduced_basis *basis,
                          ehd_deflection *deflection, double *work) {
    size_t num_nodes = basis->grid.num_nodes, num_pressure = basis->num_pressure;

    for (size_t j = 0; j < num_pressure; j++) {
        for (size_t k = 0; k < num_nodes; k++)
            work[k] = is_before_band(model, k) ? basis->pressure[k * num_pressure + j] : 0;
        deflection_apply(work, deflection, work);
        for (size_t k = 0; k < num_nodes; k++)
            coupled[k * num_pressure + j] = work[k];
    }
}

/* Copies rows of a node-major matrix: target[i, :] = source[nodes[i], :]. */
static double *gather_rows(arena *memory, const double *source, const size_t *nodes, size_t count,
                           size_t width) {
    double *target = arena_array(memory, count * width, sizeof(double));

    for (size_t i = 0; target && i < count; i++)
        memcpy(target + i * width, source + nodes[i] * width, width * sizeof(double));
    return target;
}

/* Copies the rows of a node-major matrix at the band's nodes, one grid line after another. */
static double *gather_band(reduced_model *model, const double *source, size_t width) {
    double *target = arena_array(&model->memory, model->band.num_nodes * width, sizeof(double));

    for (size_t l = 0; target && l < model->band.num_lines; l++) {
        const band_line *line = &model->band.lines[l];
        size_t first = l * grid_width(&model->grid) + line->begin;
        memcpy(target + line->offset * width, source + first * width,
               (line->end - line->begin) * width * sizeof(double));
    }
    return target;
}

/* Fills the cut table for an exit at the beginning of the band: deflections at the needed nodes for
 * a coupled basis, V_delta^T K V_p for an independent basis. The last row of the table is the load
 * balance. */
static void fill_cut_base(reduced_model *model, const reduced_basis *basis, const double *coupled) {
    size_t num_pressure = model->num_pressure, last = model->cut.num_rows - 1;
    double *load = model->cut.base + last * num_pressure;

    if (model->deformation == DEFORMATION_COUPLED) {
        memcpy(model->cut.base, model->rows.film, last * num_pressure * sizeof(double));
    } else {
        memset(model->cut.base, 0, last * num_pressure * sizeof(double));
        add_matrix_product(model->cut.base, num_pressure, 1,
                           (strided){basis->deformation_modes, 1, last}, coupled, num_pressure,
                           last, num_pressure, basis->grid.num_nodes);
    }
    for (size_t j = 0; j < num_pressure; j++) {
        load[j] = 0;
        for (size_t k = 1; k < basis->grid.num_nodes; k++)
            if (is_before_band(model, k))
                load[j] +=
                    grid_load_weight(&model->grid, k) * basis->pressure[k * num_pressure + j];
    }
}

/* Fills the left sides (`left` of exit_cut) of an independent basis, except the column of the load.
 * Row i is V_delta^T K e_i = K^T V_delta at node i. K^T = W K W^-1 with the quadrature weights W,
 * which differ from 1 on a half grid. */
static void fill_left_independent(reduced_model *model, const reduced_basis *basis,
                                  ehd_deflection *deflection, double *work) {
    const ehd_grid *grid = &basis->grid;
    size_t num_deformation = model->num_deformation;

    for (size_t j = 0; j < num_deformation; j++) {
        for (size_t k = 0; k < grid->num_nodes; k++)
            work[k] = basis->deformation_modes[k * num_deformation + j] / grid_weight(grid, k);
        deflection_apply(work, deflection, work);
        for (size_t l = 0; l < model->band.num_lines; l++) {
            const band_line *line = &model->band.lines[l];
            for (size_t c = line->begin; c < line->end; c++) {
                size_t node = l * grid_width(grid) + c, index = line->offset + c - line->begin;
                model->cut.left[index * model->cut.num_rows + j] =
                    grid_weight(grid, node) * work[node];
            }
        }
    }
}

/* Lists rows, with the weight D of the basis. The caller has checked the rows. */
static ehd_status list_rows(reduced_model *model, row_set *set, const reduced_basis *basis,
                            const size_t *rows, size_t num_rows, ehd_error *error) {
    set->num_rows = num_rows;
    set->node = arena_array(&model->memory, num_rows, sizeof *set->node);
    set->weight = arena_array(&model->memory, num_rows, sizeof *set->weight);
    if (!set->node || !set->weight) return ehd_no_memory(error, "reduced model");
    for (size_t r = 0; r < num_rows; r++) {
        set->node[r] = rows ? rows[r] : grid_node_of_row(&basis->grid, r);
        set->weight[r] = basis->weight[set->node[r]];
    }
    return reduced_model_list_needed(model, set, error);
}

static ehd_status check_rows(const reduced_model *model, const size_t *rows, size_t num_rows,
                             ehd_error *error) {
    const ehd_grid *grid = &model->grid;

    ehd_status status = reduced_check_num_rows(num_rows, model->num_pressure,
                                               model->num_deformation, "rows", error);

    if (status) return status;
    for (size_t r = 0; rows && r < num_rows; r++) {
        const grid_position at = reduced_model_position(model, rows[r]);
        if (at.column < 1 || at.column > grid->inner_x || rows[r] >= grid->num_nodes ||
            !grid_is_inner_line(grid, at.line))
            return ehd_fail(error, EHD_DATA,
                            "rows: found node %zu, expected an inner node of the grid", rows[r]);
    }
    return EHD_OK;
}

/* Copies the bases at the rows' needed nodes. `film`: deflections of a coupled basis, or
 * deformation modes. */
static ehd_status gather_needed(reduced_model *model, row_set *set, const reduced_basis *basis,
                                const double *film, size_t film_width, ehd_error *error) {
    set->pressure = gather_rows(&model->memory, basis->pressure, set->needed_node, set->num_needed,
                                basis->num_pressure);
    set->film = gather_rows(&model->memory, film, set->needed_node, set->num_needed, film_width);
    return set->pressure && set->film ? EHD_OK : ehd_no_memory(error, "reduced model");
}

/* Checks that there is memory for cut.left, a number for each node of the band and each needed
 * node. For a point contact with all rows this is the largest table. */
static ehd_status check_cut_memory(const reduced_model *model, ehd_error *error) {
    const double rows = (double)model->cut.num_rows, nodes = (double)model->band.num_nodes;
    const double modes = (double)(2 * model->num_pressure + model->num_deformation);

    return program_check_memory("reduced model", "table of the exit", model->band.num_nodes,
                                "nodes of the band", "", 8 * (nodes * (rows + modes)), error);
}

/* Sets the rows of both bases at the nodes of the band, in which the exit may lie, and the tables
 * that subtract the film of pressures behind the exit (reduced_cut.h). */
static ehd_status fill_cut(reduced_model *model, const reduced_basis *basis,
                           ehd_deflection *deflection, const double *coupled, double *work,
                           ehd_error *error) {
    bool coupled_basis = model->deformation == DEFORMATION_COUPLED;
    exit_band *band = &model->band;
    exit_cut *cut = &model->cut;

    cut->num_rows = (coupled_basis ? model->rows.num_needed : model->num_deformation) + 1;
    const ehd_status status = check_cut_memory(model, error);
    if (status) return status;
    band->pressure = gather_band(model, basis->pressure, basis->num_pressure);
    band->film = coupled_basis
                     ? gather_band(model, coupled, basis->num_pressure)
                     : gather_band(model, basis->deformation_modes, basis->num_deformation);
    cut->base = arena_array(&model->memory, cut->num_rows * basis->num_pressure, sizeof(double));
    cut->left = arena_array(&model->memory, band->num_nodes * cut->num_rows, sizeof(double));
    if (model->memory.failed) return ehd_no_memory(error, "reduced model");
    fill_cut_base(model, basis, coupled);
    if (!coupled_basis) fill_left_independent(model, basis, deflection, work);
    return EHD_OK;
}

/* Fills the tables of a set of rows, and for the selected rows the tables of the exit. */
static ehd_status fill_tables(reduced_model *model, row_set *set, const reduced_basis *basis,
                              ehd_deflection *deflection, ehd_error *error) {
    size_t num_nodes = basis->grid.num_nodes, num_pressure = basis->num_pressure;
    bool coupled_basis = model->deformation == DEFORMATION_COUPLED;
    arena memory = {0};
    double *coupled = arena_array(&memory, num_nodes * num_pressure, sizeof(double));
    double *work = arena_array(&memory, num_nodes, sizeof(double));
    const double *film = coupled_basis ? coupled : basis->deformation_modes;
    size_t film_width = coupled_basis ? num_pressure : basis->num_deformation;
    ehd_status status = memory.failed ? ehd_no_memory(error, "reduced model") : EHD_OK;

    if (!status && (coupled_basis || set == &model->rows))
        deflect_modes(coupled, model, basis, deflection, work);
    if (!status) status = gather_needed(model, set, basis, film, film_width, error);
    if (!status && set == &model->rows)
        status = fill_cut(model, basis, deflection, coupled, work, error);
    arena_free(&memory);
    return status;
}

ehd_status reduced_model_build(reduced_model *model, const reduced_basis *basis, const size_t *rows,
                               size_t num_rows, ehd_error *error) {
    ehd_deflection *deflection = deflection_create(basis->kind, &basis->grid);
    size_t count = rows ? num_rows : basis->grid.num_inner;

    *model = (reduced_model){.kind = basis->kind,
                             .grid = basis->grid,
                             .carriage = basis->carriage,
                             .band.num_lines = grid_lines(&basis->grid),
                             .deformation = basis->deformation,
                             .num_pressure = basis->num_pressure,
                             .num_deformation = basis->num_deformation,
                             .num_unknowns =
                                 reduced_num_unknowns(basis->num_pressure, basis->num_deformation)};
    ehd_status status = deflection ? EHD_OK : ehd_no_memory(error, "reduced model");
    if (!status) status = check_rows(model, rows, count, error);
    if (!status) status = list_rows(model, &model->rows, basis, rows, count, error);
    if (!status) status = reduced_model_find_band(model, basis, deflection, error);
    if (!status) status = fill_tables(model, &model->rows, basis, deflection, error);
    if (!status) status = reduced_states_copy(&model->states, &basis->states, error);
    if (!status) status = reduced_model_complete(model, error);
    deflection_free(deflection);
    if (status) reduced_model_free(model);
    return status;
}

ehd_status reduced_model_add_control(reduced_model *model, const reduced_basis *basis,
                                     const size_t *rows, size_t num_rows, ehd_error *error) {
    ehd_deflection *deflection = deflection_create(basis->kind, &basis->grid);
    ehd_status status = deflection ? EHD_OK : ehd_no_memory(error, "reduced model");

    if (!status) status = list_rows(model, &model->control, basis, rows, num_rows, error);
    if (!status) status = fill_tables(model, &model->control, basis, deflection, error);
    if (!status) status = reduced_model_complete_control(model, error);
    deflection_free(deflection);
    return status;
}

/* Adds the integrals int P X of the modes to `moment`. The modes are cut at the beginning of the
 * band. */
static void fill_moment(double *moment, const reduced_model *model, const reduced_basis *basis) {
    const ehd_grid *grid = &basis->grid;
    const size_t num = basis->num_pressure;

    for (size_t r = 0; r < grid->num_inner; r++) {
        const size_t k = grid_node_of_row(grid, r);
        if (is_before_band(model, k))
            axpy(moment, grid_load_weight(grid, k) * grid_x(grid, k), basis->pressure + k * num,
                 num);
    }
}

ehd_status reduced_model_add_cubature(reduced_model *model, const reduced_basis *basis,
                                      const size_t *nodes, const double *friction,
                                      const double *dry, size_t num_nodes, ehd_error *error) {
    ehd_deflection *deflection = deflection_create(basis->kind, &basis->grid);
    node_cubature *cubature = &model->cubature;
    row_set *set = &cubature->nodes;

    set->num_needed = num_nodes;
    set->needed_node = arena_array(&model->memory, num_nodes, sizeof *set->needed_node);
    cubature->friction = arena_array(&model->memory, num_nodes, sizeof(double));
    cubature->dry = arena_array(&model->memory, num_nodes, sizeof(double));
    cubature->moment = arena_array(&model->memory, basis->num_pressure, sizeof(double));
    ehd_status status =
        deflection && !model->memory.failed ? EHD_OK : ehd_no_memory(error, "reduced model");
    if (!status) {
        memcpy(set->needed_node, nodes, num_nodes * sizeof *nodes);
        memcpy(cubature->friction, friction, num_nodes * sizeof *friction);
        memcpy(cubature->dry, dry, num_nodes * sizeof *dry);
        fill_moment(cubature->moment, model, basis);
        status = fill_tables(model, set, basis, deflection, error);
    }
    if (!status) status = reduced_model_place_rows(model, set, error);
    deflection_free(deflection);
    return status;
}
