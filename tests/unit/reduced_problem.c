/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/unit/reduced_problem.h"

#include "common/physics/deflection.h"

#include "romrun/model/model_file.h"
#include "romrun/state/fields.h"
#include "tests/unit/check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const reduced_settings strict_settings = {.tolerance = 1e-15, .max_iterations = 40};

void reduced_problem_init(reduced_problem *self, const reduced_basis *basis, const size_t *rows,
                          size_t num_rows, const reduced_settings *settings) {
    ehd_error error = {""};

    if (reduced_model_build(&self->model, basis, rows, num_rows, &error))
        fail_msg("%s", error.text);
    if (reduced_solver_create(&self->solver, &self->model, settings, &error))
        fail_msg("%s", error.text);
    assert_int_equal(reduced_state_init(&self->state, &self->model, &error), EHD_OK);
}

void reduced_problem_free(reduced_problem *self) {
    reduced_solver_free(self->solver);
    reduced_state_free(&self->state);
    reduced_model_free(&self->model);
}

void reduced_problem_solve(reduced_problem *self, const ehd_contact *contact) {
    ehd_error error = {""};

    if (reduced_solve(&self->info, &self->state, self->solver, contact, NULL, &error))
        fail_msg("%s", error.text);
    assert_string_equal(self->info.reason, "");
    assert_int_equal(self->info.status, EHD_OK);
}

void fields_of(double *pressure, double *film, const reduced_state *state,
               const reduced_model *model, const double *pressure_basis) {
    field_modes modes;

    assert_int_equal(field_modes_init(&modes, model, pressure_basis, NULL), EHD_OK);
    assert_int_equal(field_modes_deflect(&modes, model, NULL), EHD_OK);
    reduced_fields(pressure, film, state, model, &modes);
    field_modes_free(&modes);
}

/* Returns modes that are 1 at one node and 0 elsewhere. The node of mode j is node_of(grid, j). */
static double *unit_modes(size_t num_nodes, size_t num_modes,
                          size_t node_of(const ehd_grid *, size_t), const ehd_grid *grid) {
    double *modes = calloc(num_nodes * num_modes, sizeof *modes);

    assert_non_null(modes);
    for (size_t j = 0; j < num_modes; j++)
        modes[node_of(grid, j) * num_modes + j] = 1;
    return modes;
}

static size_t node_itself(const ehd_grid *grid, size_t node) {
    (void)grid;
    return node;
}

reduced_basis identity_basis(const snapshot_set *set, deformation_kind kind, const double *weight) {
    const snapshot_source *source = set->sources;
    const reduced_states *states = &source->states;
    const ehd_grid *grid = &set->grid;
    size_t num_nodes = grid->num_nodes, num_inner = grid->num_inner, num_lines = grid_lines(grid);
    bool independent = kind == DEFORMATION_INDEPENDENT;
    reduced_basis basis = {.kind = set->kind,
                           .grid = *grid,
                           .deformation = kind,
                           .num_pressure = num_inner,
                           .num_deformation = independent ? num_nodes : 0};
    size_t num_unknowns = reduced_num_unknowns(basis.num_pressure, basis.num_deformation);
    ehd_deflection *deflection = deflection_create(set->kind, grid);

    assert_non_null(deflection);
    basis.pressure = unit_modes(num_nodes, num_inner, grid_node_of_row, grid);
    if (independent) basis.deformation_modes = unit_modes(num_nodes, num_nodes, node_itself, grid);
    basis.weight = calloc(num_nodes, sizeof(double));
    assert_int_equal(
        reduced_states_init(&basis.states, set->num_states, num_lines, num_unknowns, NULL), EHD_OK);
    memcpy(basis.weight, weight, num_nodes * sizeof(double));
    memcpy(basis.states.exit, states->exit, set->num_states * num_lines * sizeof *states->exit);
    for (size_t s = 0; s < set->num_states; s++) {
        double *coordinates = basis.states.coordinates + s * num_unknowns;
        const double *pressure = source->fields[s];
        for (size_t r = 0; r < num_inner; r++)
            coordinates[r] = pressure[grid_node_of_row(grid, r)];
        if (independent) deflection_apply(coordinates + num_inner, deflection, pressure);
        coordinates[num_unknowns - 1] = states->coordinates[s];
        basis.states.moes_M[s] = states->moes_M[s];
        basis.states.alpha_p_H[s] = states->alpha_p_H[s];
        basis.states.central_film_thickness[s] = states->central_film_thickness[s];
        basis.states.rises[s] = states->rises[s];
    }
    deflection_free(deflection);
    return basis;
}

reduced_basis mirrored_basis(const reduced_basis *half) {
    const ehd_grid grid = grid_whole(&half->grid);
    const reduced_states *states = &half->states;
    size_t width = grid_width(&grid), num = half->num_pressure, lines = grid_lines(&grid);
    reduced_basis whole = *half;

    whole.grid = grid;
    whole.pressure = calloc(grid.num_nodes * num, sizeof(double));
    whole.weight = calloc(grid.num_nodes, sizeof(double));
    assert_true(whole.pressure && whole.weight);
    assert_int_equal(
        reduced_states_init(&whole.states, states->num_states, lines, states->num_unknowns, NULL),
        EHD_OK);
    memcpy(whole.states.coordinates, states->coordinates,
           states->num_states * states->num_unknowns * sizeof(double));
    memcpy(whole.states.moes_M, states->moes_M, states->num_states * sizeof(double));
    memcpy(whole.states.alpha_p_H, states->alpha_p_H, states->num_states * sizeof(double));
    memcpy(whole.states.rises, states->rises, states->num_states * sizeof *states->rises);
    for (size_t l = 0; l < lines; l++) {
        size_t middle = lines / 2, own = l > middle ? l - middle : middle - l;
        memcpy(whole.pressure + l * width * num, half->pressure + own * width * num,
               width * num * sizeof(double));
        for (size_t c = 0; c < width; c++)
            whole.weight[l * width + c] = half->weight[own * width + c] * (own > 0 ? sqrt(0.5) : 1);
        for (size_t s = 0; s < states->num_states; s++)
            whole.states.exit[s * lines + l] = states->exit[s * states->num_lines + own];
    }
    return whole;
}

void rows_model_write(const reduced_basis *basis, const size_t *rows, size_t num_rows,
                      const char *path) {
    static char *words[] = {"deimselect", NULL};
    const program writer = {
        .name = "deimselect", .argc = 1, .argv = words, .force = true, .output = path};
    double *sigmas = calloc(basis->states.num_states, sizeof *sigmas);
    const model_origin origin = {.method = "joint",
                                 .basis_identity = "0123",
                                 .sigma_min_residual = 1,
                                 .sigma_min_jacobian = 1,
                                 .sigma_min_over_exits = 1,
                                 .sigma_min_by_exit = sigmas};
    reduced_model model;
    ehd_error error = {""};

    assert_non_null(sigmas);
    if (reduced_model_build(&model, basis, rows, num_rows, &error) ||
        model_write(&model, basis, &origin, &writer, "rows: all\n", NULL, &error))
        fail_msg("%s", error.text);
    reduced_model_free(&model);
    free(sigmas);
}

void whole_model_write(const reduced_basis *basis, const char *path) {
    rows_model_write(basis, NULL, 0, path);
}
