/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Starts of Newton's method: warm starts from a neighbour or from far away, and cold starts. */
#include "fullrun/full_solver.h"
#include "tests/unit/check.h"
#include "tests/unit/problem.h"
#include "tests/unit/sample.h"

static void warm_start_equals_cold_start(void **state) {
    (void)state;
    full_settings settings = full_default_settings();
    for (int i = 0; i < NUM_SAMPLE_CASES; i++) {
        ehd_contact contact = sample_case(i), neighbour = contact;
        problem warm, cold;
        contact_set_moes(&neighbour, 1.3 * contact.moes_M, 0.8 * contact.moes_L);
        problem_solve_cold(&cold, &contact, &settings);
        problem_solve_cold(&warm, &neighbour, &settings);
        warm.contact = contact;
        assert_int_equal(full_solve_from(&warm.info, &warm.state, warm.solver, &contact, NULL),
                         EHD_OK);
        assert_int_equal(warm.info.status, EHD_OK);
        check_same_state(&warm, &cold);
        problem_free(&warm);
        problem_free(&cold);
    }
}

/* If a start from far away fails, the solver falls back to a cold start. */
static void far_start_converges(void **state) {
    (void)state;
    full_settings settings = full_default_settings();
    ehd_contact start = sample_contact("no1", "dowson-higginson", 5, 1, 0.02);
    ehd_contact goal = sample_contact("no1", "dowson-higginson", 150, 12, 0.02);
    problem far, cold;
    problem_solve_cold(&far, &start, &settings);
    problem_solve_cold(&cold, &goal, &settings);
    far.contact = goal;
    assert_int_equal(full_solve_from(&far.info, &far.state, far.solver, &goal, NULL), EHD_OK);
    assert_int_equal(far.info.status, EHD_OK);
    check_same_state(&far, &cold);
    problem_free(&far);
    problem_free(&cold);
}

/* If neighbours are too far apart, smaller continuation steps would take hundreds or thousands of
 * iterations. A cold start takes few iterations, so the solver must change to it early. */
static void far_start_is_given_up_early(void **state) {
    (void)state;
    full_settings settings = full_default_settings();
    ehd_contact start = sample_contact("barus", "incompressible", 2, 25, 0.005);
    ehd_contact goal = sample_contact("barus", "incompressible", 1, 25, 0.005);
    problem far;
    problem_solve_cold(&far, &start, &settings);
    far.contact = goal;
    assert_int_equal(full_solve_from(&far.info, &far.state, far.solver, &goal, NULL), EHD_OK);
    assert_int_equal(far.info.status, EHD_OK);
    assert_true(far.info.newton_iterations < 80); // measured: 66
    problem_free(&far);
}

/* A cold start must reduce its continuation steps to an eighth if this leads to the solution. If
 * there is no solution, it must not try many smaller steps. */
static void continuation_takes_strides_that_help(void **state) {
    (void)state;
    const full_settings settings = full_default_settings();
    const ehd_contact comes = sample_contact("roelands", "incompressible", 2, 50, 0.0125);
    // this contact has a solution in the accurate discretisation, but not in the published one
    const ehd_contact too_coarse =
        sample_published(sample_contact("barus", "dowson-higginson", 200, 0, 0.04));
    problem easy, hopeless;
    problem_solve_cold(&easy, &comes, &settings);
    problem_free(&easy);
    problem_init(&hopeless, &too_coarse, &settings);
    assert_int_equal(
        full_solve_cold(&hopeless.info, &hopeless.state, hopeless.solver, &too_coarse, NULL),
        EHD_OK);
    assert_int_equal(hopeless.info.status, EHD_NOT_CONVERGED);
    assert_true(hopeless.info.newton_iterations < 240); // measured: 213
    problem_free(&hopeless);
}

/* Contacts with extreme parameters must all converge from the dry contact, in a limited number of
 * iterations (START_FILM in continuation.c). */
static void extremes_converge(void **state) {
    (void)state;
    static const double corners[][2] = {{1, 0},  {2, 0.5}, {10, 0},   {20, 0},  {50, 0}, {200, 0},
                                        {1, 25}, {20, 25}, {200, 25}, {10, 10}, {40, 9}, {100, 5}};
    size_t num_iterations[2] = {0, 0};
    full_settings settings = full_default_settings();
    for (size_t i = 0; i < sizeof corners / sizeof *corners; i++)
        for (int d = 0; d < 4; d++) {
            ehd_contact contact =
                sample_contact("barus", d % 2 ? "dowson-higginson" : "incompressible",
                               corners[i][0], corners[i][1], 0.02);
            problem solved;
            if (d > 1) contact = sample_published(contact);
            problem_solve_cold(&solved, &contact, &settings);
            assert_true(solved.state.exit < contact.grid.num_nodes - 1);
            num_iterations[d / 2] += solved.info.newton_iterations;
            problem_free(&solved);
        }
    assert_true(num_iterations[0] < 630); // measured: 581
    assert_true(num_iterations[1] < 480); // measured: 441
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(warm_start_equals_cold_start),
        cmocka_unit_test(far_start_converges),
        cmocka_unit_test(far_start_is_given_up_early),
        cmocka_unit_test(continuation_takes_strides_that_help),
        cmocka_unit_test(extremes_converge),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
