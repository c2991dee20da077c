/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Linear systems of a Newton step: GMRES with a near field against a dense factorisation. */
#include "fullrun/full_solver.h"
#include "tests/unit/check.h"
#include "tests/unit/dense.h"
#include "tests/unit/problem.h"
#include "tests/unit/sample.h"

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

/* With the whole kernel kept, the preconditioner is the Jacobian but for a constant that the approach
 * absorbs: two iterations, whatever the contact. */
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

/* The default near field: a dozen or two, also where the viscosity spans many decades. */
static void near_field_preconditions(void **state) {
    (void)state;
    full_settings settings = full_default_settings();
    for (int i = 0; i < NUM_SAMPLE_CASES; i++) {
        ehd_contact contact = sample_case(i);
        problem solved;
        problem_solve_cold(&solved, &contact, &settings);
        assert_true(solved.info.gmres_iterations <= 30 * solved.info.newton_iterations);
        problem_free(&solved);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(iterative_equals_dense),
        cmocka_unit_test(every_step_equals_dense),
        cmocka_unit_test(whole_kernel_needs_two_iterations),
        cmocka_unit_test(near_field_preconditions),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
