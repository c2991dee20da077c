/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Large point contacts, solved by several threads. */
#include "fullrun/full_solver.h"
#include "tests/unit/check.h"
#include "tests/unit/problem.h"
#include "tests/unit/sample.h"

#include <math.h>
#include <stdlib.h>

/* Threads change neither the bits of a solution on a large grid nor the number of iterations. */
static void threads_change_no_bit(void **state) {
    (void)state;
    for (int half = 0; half < 2; half++) {
        const ehd_contact contact =
            sample_point("roelands", "dowson-higginson", 20, 10, half ? 144 : 104, half != 0);
        const size_t bytes = contact.grid.num_nodes * sizeof(double);
        full_settings settings = full_default_settings();
        problem alone;

        assert_true(full_is_large(&contact.grid));
        problem_solve_cold(&alone, &contact, &settings);
        for (size_t members = 2; members <= 5; members += 3) {
            problem shared;
            settings.threads = team_create(members);
            assert_non_null(settings.threads);
            problem_solve_cold(&shared, &contact, &settings);
            assert_int_equal(shared.info.newton_iterations, alone.info.newton_iterations);
            assert_int_equal(shared.info.gmres_iterations, alone.info.gmres_iterations);
            assert_memory_equal(&shared.info.residual, &alone.info.residual, sizeof(double));
            assert_memory_equal(&shared.info.complementarity, &alone.info.complementarity,
                                sizeof(double));
            assert_memory_equal(shared.state.pressure, alone.state.pressure, bytes);
            assert_memory_equal(shared.state.film, alone.state.film, bytes);
            problem_free(&shared);
            settings.threads = team_free(settings.threads);
        }
        problem_free(&alone);
    }
}

/* If a small grid is solved on the way to the solution on a large grid, a multigrid cycle is used
 * instead of factors. The solution equals the usual solution on the small grid up to round-off.
 * Threads change no bit of this solution. */
static void a_small_grid_is_solved_as_a_large_one(void **state) {
    (void)state;
    const ehd_contact contact = sample_point("barus", "dowson-higginson", 20, 10, 96, true);
    const size_t bytes = contact.grid.num_nodes * sizeof(double);
    full_settings settings = full_default_settings();
    problem alone, on_the_way, shared;

    assert_false(full_is_large(&contact.grid));
    problem_solve_cold(&alone, &contact, &settings);
    settings.as_large = true;
    problem_solve_cold(&on_the_way, &contact, &settings);
    settings.threads = team_create(3);
    problem_solve_cold(&shared, &contact, &settings);
    check_same_state(&on_the_way, &alone);
    assert_memory_not_equal(on_the_way.state.pressure, alone.state.pressure, bytes);
    assert_memory_equal(shared.state.pressure, on_the_way.state.pressure, bytes);
    problem_free(&alone);
    problem_free(&on_the_way);
    problem_free(&shared);
    team_free(settings.threads);
}

/* The solution of a time step on a large grid satisfies the Reynolds equation, including the
 * squeeze term, at each node with pressure. */
static void large_grids_satisfy_the_problem_in_time(void **state) {
    (void)state;
    const ehd_contact contact = sample_point("barus", "dowson-higginson", 20, 10, 144, true);
    const ehd_grid *grid = &contact.grid;
    full_settings settings = full_default_settings();
    double *previous = calloc(grid->num_inner, sizeof *previous);
    reynolds_row *rows = calloc(grid->num_inner, sizeof *rows);
    problem solved;

    assert_true(previous && rows);
    settings.threads = team_create(2);
    problem_solve_cold(&solved, &contact, &settings);
    for (size_t r = 0; r < grid->num_inner; r++) {
        const size_t node = grid_node_of_row(grid, r);
        previous[r] = -10 * (1 + 0.1 * sin(5 * grid_x(grid, node))) * solved.state.film[node];
    }
    const reynolds_squeeze squeeze = {10, previous};
    assert_int_equal(
        full_solve(&solved.info, &solved.state, solved.solver, &contact, &squeeze, NULL), EHD_OK);
    assert_int_equal(solved.info.status, EHD_OK);
    problem_rows_in_time(rows, &solved, &squeeze);
    for (size_t r = 0; r < grid->num_inner; r++)
        if (full_has_pressure(&solved.state, grid_node_of_row(grid, r)))
            check_close(rows[r].residual, 0, 0, 1e-9 * row_size(&rows[r]));
    problem_free(&solved);
    team_free(settings.threads);
    free(previous);
    free(rows);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(threads_change_no_bit),
        cmocka_unit_test(a_small_grid_is_solved_as_a_large_one),
        cmocka_unit_test(large_grids_satisfy_the_problem_in_time),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
