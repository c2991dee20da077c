/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "podbuild/test_weight.h"
#include "romrun/solve/reduced_solver.h"
#include "tests/unit/trained.h"

#include <cblas.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static trained training;
static reduced_basis basis;

static int train(void **state) {
    (void)state;
    trained_init(&training, 0.05);
    trained_basis(&basis, &training, DEFORMATION_COUPLED, 8, 0);
    return 0;
}

static int end(void **state) {
    (void)state;
    reduced_basis_free(&basis);
    trained_free(&training);
    return 0;
}

static void all_are_positive_and_finite(void **state) {
    (void)state;
    double *weight = malloc(basis.grid.num_nodes * sizeof *weight);
    for (const test_weight *entry = test_weights; entry->name; entry++) {
        assert_ptr_equal(entry_find(test_weights, sizeof *entry, entry->name), entry);
        memset(weight, 0, basis.grid.num_nodes * sizeof *weight);
        assert_int_equal(entry->weigh(weight, &basis, training.contacts, TRAINED_STATES, NULL),
                         EHD_OK);
        for (size_t k = 0; k < basis.grid.num_nodes; k++)
            assert_true(isfinite(weight[k]) && weight[k] > 0);
    }
    assert_null(entry_find(test_weights, sizeof *test_weights, "none"));
    free(weight);
}

static void mode_is_that_of_the_basis(void **state) {
    (void)state;
    double *weight = malloc(basis.grid.num_nodes * sizeof *weight), largest = 0;
    assert_int_equal(test_weight_mode(weight, &basis, NULL, 0, NULL), EHD_OK);
    check_close_array(weight, basis.weight, basis.grid.num_nodes, 0.0, 0.0);
    for (size_t k = 0; k < basis.grid.num_nodes; k++)
        largest = fmax(largest, fabs(basis.pressure[k * basis.num_pressure]));
    for (size_t k = 0; k < basis.grid.num_nodes; k++)
        check_close(weight[k], fmax(fabs(basis.pressure[k * basis.num_pressure]), 1e-4 * largest),
                    0.0, 0.0);
    free(weight);
}

/* Number of rows of a least-squares problem, and their smallest and largest norm. */
typedef struct norms {
    size_t num_rows;
    double least, most;
} norms;

/* Replaces the least-squares solver. Records number and norms of the Reynolds rows, which are all
 * rows except the closure. */
static ehd_status look(double *step, void *context, const double *matrix, const double *right,
                       size_t num_rows, size_t num_unknowns) {
    norms *self = context;
    (void)step, (void)right;
    self->num_rows = num_rows - 1;
    for (size_t i = 0; i < self->num_rows; i++) {
        const double norm = cblas_dnrm2((int)num_unknowns, matrix + i * num_unknowns, 1);
        self->least = fmin(self->least, norm);
        self->most = fmax(self->most, norm);
    }
    return EHD_NOT_CONVERGED;
}

/* Returns the norms of all rows with the weights of the basis, at training solution s. */
static norms norms_at(size_t s) {
    const size_t num_unknowns = basis.states.num_unknowns;
    norms seen = {0, INFINITY, 0};
    const reduced_settings once = {
        .max_iterations = 1, .exit_at_node = true, .solve_linear = look, .linear_context = &seen};
    reduced_model model;
    reduced_solver *solver;
    reduced_state at = {.exit = basis.states.exit[s]};
    reduced_info info;
    assert_int_equal(reduced_model_build(&model, &basis, NULL, 0, NULL), EHD_OK);
    assert_int_equal(reduced_solver_create(&solver, &model, &once, NULL), EHD_OK);
    at.coordinates = malloc(num_unknowns * sizeof(double));
    memcpy(at.coordinates, basis.states.coordinates + s * num_unknowns,
           num_unknowns * sizeof(double));
    assert_int_equal(reduced_solve(&info, &at, solver, &training.contacts[s], NULL, NULL), EHD_OK);
    free(at.coordinates);
    reduced_solver_free(solver);
    reduced_model_free(&model);
    return seen;
}

static void row_norm_gives_unit_rows(void **state) {
    (void)state;
    const size_t s = 4;
    double *before = basis.weight, *weight = malloc(basis.grid.num_nodes * sizeof *weight);
    // the weights are computed from this training solution alone
    assert_int_equal(test_weight_row_norm(weight, &basis, &training.contacts[s], 1, NULL), EHD_OK);
    basis.weight = weight;
    const norms seen = norms_at(s), other = norms_at(s + 3);
    basis.weight = before;
    free(weight);
    assert_int_equal(seen.num_rows, basis.states.exit[s] - 1);
    check_close(seen.least, 1.0, 1e-10, 0.0);
    check_close(seen.most, 1.0, 1e-10, 0.0);
    assert_true(other.most > 1.01);
}

/* The squared length of each row, averaged over all training solutions, is one. In a single
 * solution a row may be longer than one, but not longer than the square root of the number of
 * solutions. */
static void row_norm_is_the_mean_of_all_solutions(void **state) {
    (void)state;
    double *before = basis.weight, *weight = malloc(basis.grid.num_nodes * sizeof *weight);
    double most = 0;
    size_t first = basis.grid.num_nodes;
    assert_int_equal(test_weight_row_norm(weight, &basis, training.contacts, TRAINED_STATES, NULL),
                     EHD_OK);
    basis.weight = weight;
    for (size_t s = 0; s < TRAINED_STATES; s++) {
        most = fmax(most, norms_at(s).most);
        first = basis.states.exit[s] < first ? basis.states.exit[s] : first;
    }
    basis.weight = before;
    // a row behind some of the exits has no larger weight than the last row before all exits
    for (size_t k = first; k < basis.grid.num_nodes; k++)
        assert_true(weight[k] <= weight[first - 1]);
    free(weight);
    assert_true(most > 1 && most <= sqrt(TRAINED_STATES) * (1 + 1e-10));
}

static void row_norm_wants_a_contact(void **state) {
    (void)state;
    double *weight = malloc(basis.grid.num_nodes * sizeof *weight);
    ehd_contact other = training.contacts[0];
    ehd_error error;
    other.moes_M *= 1.01;
    assert_int_equal(test_weight_row_norm(weight, &basis, &other, 1, &error), EHD_DATA);
    assert_non_null(strstr(error.text, "--plan: found none of the stationary training points"));
    assert_int_equal(test_weight_row_norm(weight, &basis, NULL, 0, &error), EHD_DATA);
    free(weight);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_are_positive_and_finite),
        cmocka_unit_test(mode_is_that_of_the_basis),
        cmocka_unit_test(row_norm_gives_unit_rows),
        cmocka_unit_test(row_norm_is_the_mean_of_all_solutions),
        cmocka_unit_test(row_norm_wants_a_contact),
    };
    return cmocka_run_group_tests(tests, train, end);
}
