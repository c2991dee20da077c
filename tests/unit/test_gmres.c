/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Linear systems of Newton's method. GMRES with a near-field preconditioner is compared with a
 * dense factorisation. */
#include "fullrun/full_solver.h"
#include "fullrun/gmres.h"
#include "tests/unit/check.h"
#include "tests/unit/dense.h"
#include "tests/unit/problem.h"
#include "tests/unit/sample.h"

#include <stdlib.h>

static void iterative_equals_dense(void **state) {
    (void)state;
    full_settings iterative = full_default_settings(), dense = iterative;
    dense.solve_linear = dense_solve;
    for (int i = 0; i < NUM_SAMPLE_CASES; i++) {
        ehd_contact contact = sample_case(i);
        problem ours, reference;
        problem_solve_cold(&ours, &contact, &iterative);
        problem_solve_cold(&reference, &contact, &dense);
        check_same_state(&ours, &reference);
        assert_true(ours.info.gmres_iterations > 0);
        assert_int_equal(reference.info.gmres_iterations, 0);
        problem_free(&ours);
        problem_free(&reference);
    }
}

static void every_step_equals_dense(void **state) {
    (void)state;
    full_settings settings = full_default_settings();
    settings.solve_linear = compare_linear_solvers;
    for (int i = 0; i < NUM_SAMPLE_CASES; i++) {
        ehd_contact contact = sample_case(i);
        problem both;
        problem_solve_cold(&both, &contact, &settings);
        problem_free(&both);
    }
}

/* If the near field contains the whole kernel, the preconditioner is the Jacobian, except for a
 * constant that the approach compensates. Any contact then takes two iterations. */
static void whole_kernel_needs_two_iterations(void **state) {
    (void)state;
    full_settings settings = full_default_settings();
    for (int i = 0; i < NUM_SAMPLE_CASES; i++) {
        ehd_contact contact = sample_case(i);
        problem solved;
        settings.near_field = contact.grid.num_inner;
        problem_solve_cold(&solved, &contact, &settings);
        assert_true(solved.info.gmres_iterations <= 2 * solved.info.newton_iterations);
        problem_free(&solved);
    }
}

/* With the default near field and tolerance, a system takes one or two dozen iterations, also if
 * the viscosity spans many decades. On 1201 nodes the mean is 18 (full_default_settings). A
 * narrower near field or a stricter tolerance needs more iterations. A wider near field or a looser
 * tolerance costs more than it saves. */
static void near_field_preconditions(void **state) {
    (void)state;
    static const char *const lubricants[] = {"barus", "roelands", "no1"};
    const full_settings settings = full_default_settings();
    size_t newton = 0, gmres = 0;
    for (int i = 0; i < NUM_SAMPLE_CASES; i++) {
        ehd_contact contact = sample_case(i);
        problem solved;
        problem_solve_cold(&solved, &contact, &settings);
        assert_true(solved.info.gmres_iterations <= 30 * solved.info.newton_iterations);
        problem_free(&solved);
    }
    for (int i = 0; i < 6; i++) {
        ehd_contact contact = sample_contact(lubricants[i / 2], "dowson-higginson",
                                             i % 2 ? 200 : 20, i % 2 ? 5 : 10, 0.005);
        problem solved;
        problem_solve_cold(&solved, &contact, &settings);
        newton += solved.info.newton_iterations;
        gmres += solved.info.gmres_iterations;
        problem_free(&solved);
    }
    assert_true(newton <= 32);
    assert_in_range(gmres, 15 * newton, 20 * newton);
}

static size_t most_iterations;

static ehd_status watch_iterations(full_system *system, double tolerance, size_t *iterations,
                                   ehd_error *error) {
    const ehd_status status = full_solve_gmres(system, tolerance, iterations, error);
    if (*iterations > most_iterations) most_iterations = *iterations;
    return status;
}

/* On 19201 nodes a system takes up to 46 iterations, each of which stores a vector. The limit of
 * iterations must be higher, and the memory of the vectors must be allocated only when it is
 * needed. */
static void vectors_suffice_for_a_fine_grid(void **state) {
    (void)state;
    const ehd_contact contact = sample_contact("barus", "dowson-higginson", 200, 5, 0.0003125);
    full_settings settings = full_default_settings();
    settings.solve_linear = watch_iterations;
    problem solved;
    most_iterations = 0;
    problem_solve_cold(&solved, &contact, &settings);
    assert_in_range(most_iterations, 43, 50);
    assert_true(gmres_workspace_bytes(&contact.grid) < 1000);
    problem_free(&solved);
}

static size_t num_systems, num_kept, kept_iterations;

static ehd_status compare_kept(full_system *system, double tolerance, size_t *iterations,
                               ehd_error *error) {
    (void)tolerance;
    num_systems++;
    const ehd_status status = compare_linear_solvers(system, 1e-11, iterations, error);
    if (system->keeps_factors) num_kept++, kept_iterations += *iterations;
    return status;
}

/* Takes a time step from a stationary solution to a load that is higher by the fraction `rise`. */
static void step_from_stationary(const ehd_contact *contact, double rise) {
    const double rate = 50;
    const ehd_grid *grid = &contact->grid;
    double *previous = malloc(grid->num_inner * sizeof *previous);
    full_settings settings = full_default_settings();
    ehd_contact loaded = *contact;
    problem start, next;

    assert_non_null(previous);
    settings.exit_at_node = true;
    problem_solve_cold(&start, contact, &settings);
    for (size_t r = 0; r < grid->num_inner; r++)
        previous[r] = -rate * start.state.film[grid_node_of_row(grid, r)];
    loaded.closure.value *= 1 + rise;
    settings.solve_linear = compare_kept;
    problem_init(&next, &loaded, &settings);
    full_state_copy(&next.state, &start.state, grid);
    const reynolds_squeeze squeeze = {rate, previous};
    assert_int_equal(full_solve(&next.info, &next.state, next.solver, &loaded, &squeeze, NULL),
                     EHD_OK);
    assert_int_equal(next.info.status, EHD_OK);
    problem_free(&start);
    problem_free(&next);
    free(previous);
}

/* The factors of the first system of a time step precondition the other systems of this step,
 * although their scales and pressure zones differ. The solutions stay exact, with few
 * iterations. */
static void factors_serve_the_whole_step(void **state) {
    (void)state;
    const ehd_contact contacts[] = {
        sample_contact("barus", "incompressible", 20, 10, 0.02),
        sample_point("barus", "incompressible", 20, 10, 32, false),
    };
    for (size_t i = 0; i < 2; i++) {
        num_systems = num_kept = kept_iterations = 0;
        step_from_stationary(&contacts[i], 0.05);
        assert_true(num_systems >= 3);
        assert_int_equal(num_kept, num_systems - 1);
        // measured: 122 iterations in 4 systems of the line, 90 in 5 systems of the point
        assert_true(kept_iterations <= (i ? 100 : 135));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(iterative_equals_dense),
        cmocka_unit_test(every_step_equals_dense),
        cmocka_unit_test(whole_kernel_needs_two_iterations),
        cmocka_unit_test(near_field_preconditions),
        cmocka_unit_test(factors_serve_the_whole_step),
        cmocka_unit_test(vectors_suffice_for_a_fine_grid),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
