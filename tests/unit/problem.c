/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/unit/problem.h"

#include "tests/unit/check.h"
#include "tests/unit/dense.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void problem_init(problem *self, const ehd_contact *contact, const full_settings *settings) {
    self->contact = *contact;
    assert_int_equal(
        full_solver_create(&self->solver, contact->kind, &contact->grid, settings, NULL), EHD_OK);
    assert_int_equal(full_state_init(&self->state, &contact->grid, NULL), EHD_OK);
}

void problem_free(problem *self) {
    full_state_free(&self->state);
    self->solver = full_solver_free(self->solver);
}

void problem_solve_cold(problem *self, const ehd_contact *contact, const full_settings *settings) {
    problem_init(self, contact, settings);
    assert_int_equal(full_solve_cold(&self->info, &self->state, self->solver, contact, NULL),
                     EHD_OK);
    assert_int_equal(self->info.status, EHD_OK);
}

void check_same_state(const problem *actual, const problem *expected) {
    size_t n = expected->contact.grid.num_nodes;
    assert_int_equal(actual->state.exit, expected->state.exit);
    check_close(actual->state.rigid_approach, expected->state.rigid_approach, 1e-9, 0);
    check_close_array(actual->state.pressure, expected->state.pressure, n, 0, 1e-9);
    check_close_array(actual->state.film, expected->state.film, n, 1e-9, 1e-10);
}

void problem_rows(reynolds_row *rows, const problem *solved) {
    problem_rows_in_time(rows, solved, NULL);
}

void problem_rows_in_time(reynolds_row *rows, const problem *solved,
                          const reynolds_squeeze *squeeze) {
    const ehd_grid *grid = &solved->contact.grid;
    size_t n = grid->num_nodes;
    double *memory = malloc((NUM_FLUID_ARRAYS + 1) * n * sizeof *memory);
    reynolds_stencil *stencils = malloc(grid->num_inner * sizeof *stencils);
    arena of_outer = {0};
    far_field outer;

    assert_true(memory && stencils);
    double *pressure = memory + NUM_FLUID_ARRAYS * n;
    memcpy(pressure, solved->state.pressure, n * sizeof *pressure);
    far_field_init(&outer, grid, NULL, n, &of_outer);
    far_field_add(pressure, &outer, &solved->contact, solved->state.rigid_approach);
    reynolds_fluid fluid = reynolds_fluid_in(memory, n, &solved->contact);
    for (size_t r = 0; r < grid->num_inner; r++)
        stencils[r] = reynolds_stencil_at(grid, grid_node_of_row(grid, r));
    reynolds_fluid_evaluate(&fluid, &solved->contact, pressure, n);
    far_field_set_density(&fluid, &outer);
    reynolds_rows(rows, grid, 1, squeeze, stencils, grid->num_inner, &fluid, pressure,
                  solved->state.film);
    arena_free(&of_outer);
    free(stencils);
    free(memory);
}

double row_size(const reynolds_row *row) {
    double largest = 0;
    for (int a = 0; a < NUM_STENCIL; a++)
        largest = fmax(largest, fmax(fabs(row->by_pressure[a]), fabs(row->by_film[a])));
    return largest;
}

/* Compares both linear solvers in each call: they must agree in each Newton step, not only in the
 * final solution. */
ehd_status compare_linear_solvers(full_system *system, double tolerance, size_t *iterations,
                                  ehd_error *error) {
    size_t n = system->grid->num_nodes;
    double *dense = malloc(n * sizeof *dense), largest = 0;

    assert_non_null(dense);
    assert_int_equal(dense_solve(system, tolerance, iterations, error), EHD_OK);
    memcpy(dense, system->step, n * sizeof *dense);
    double approach = system->step_approach;
    for (size_t k = 0; k < n; k++)
        largest = fmax(largest, fabs(dense[k]));
    assert_int_equal(full_solve_gmres(system, 1e-11, iterations, error), EHD_OK);
    check_close_array(system->step, dense, n, 0, 1e-6 * largest);
    check_close(system->step_approach, approach, 1e-6, 1e-6 * largest);
    free(dense);
    return EHD_OK;
}
