/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/deflection.h"
#include "common/program/program.h"
#include "fullrun/full_solver.h"
#include "tests/unit/allocation.h"
#include "tests/unit/check.h"
#include "tests/unit/dense.h"
#include "tests/unit/problem.h"
#include "tests/unit/sample.h"

#include <lapacke.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

// ---- properties of a solution

/* Compares the film with direct summation of the pressure. */
static void check_film(const problem *solved) {
    const ehd_grid *grid = &solved->contact.grid;
    for (size_t k = 0; k < grid->num_nodes; k++) {
        double film = solved->state.rigid_approach + grid_gap(grid, k);
        for (size_t j = 1; j < solved->state.exit; j++)
            film += solved->state.pressure[j] *
                    deflection_influence(solved->contact.kind, grid,
                                         fabs((double)k - (double)j) * grid->step, 0);
        check_close(solved->state.film[k], film, 0, 1e-12);
    }
}

/* Tests the published discretisation, whose exit is at a node. */
static void solution_satisfies_the_problem(void **state) {
    (void)state;
    full_settings settings = full_default_settings();
    for (int i = 0; i < NUM_SAMPLE_CASES; i++) {
        ehd_contact contact = sample_published(sample_case(i));
        const ehd_grid *grid = &contact.grid;
        reynolds_row *rows = malloc(grid->num_inner * sizeof *rows);
        problem solved;
        double sum = 0;

        assert_non_null(rows);
        problem_solve_cold(&solved, &contact, &settings);
        size_t exit = solved.state.exit;
        const double *pressure = solved.state.pressure;
        problem_rows(rows, &solved);
        check_film(&solved);
        // under pressure: f = 0 and P >= 0; cavitated: P = 0 and Lambda = -f >= 0
        for (size_t k = 1; k < exit; k++) {
            assert_true(pressure[k] >= 0);
            check_close(rows[k - 1].residual, 0, 0, 1e-9 * row_size(&rows[k - 1]));
            sum += pressure[k];
        }
        for (size_t k = exit; k <= grid->num_inner; k++) {
            check_close(pressure[k], 0, 0, 0);
            assert_true(rows[k - 1].residual <= 1e-10 * row_size(&rows[k - 1]));
        }
        check_close(pressure[0], 0, 0, 0);
        check_close(pressure[grid->num_nodes - 1], 0, 0, 0);
        check_close(sum * grid->step, M_PI_2, 1e-10, 0);
        assert_true(exit > 1 && exit < grid->num_nodes - 1);
        assert_true(solved.info.residual < settings.tolerance);
        assert_true(solved.info.complementarity <= 1e-10);
        contact_scalars scalars = full_evaluate_scalars(&solved.state, &contact);
        check_close(scalars.load, 1, 1e-10, 0);
        check_close(scalars.exit_position, grid_x(grid, exit), 1e-15, 0);
        assert_true(scalars.exit_position > 1 && scalars.exit_position < 2);
        assert_true(scalars.minimum_film_thickness > 0 &&
                    scalars.minimum_film_thickness < scalars.central_film_thickness);
        problem_free(&solved);
        free(rows);
    }
}

/* At x_min = -4.01 no node is at X = 0. The interpolation to X = 0 is exact for a cubic. */
static void scalars_between_nodes(void **state) {
    (void)state;
    ehd_contact contact = sample_contact("barus", "incompressible", 10, 5, 0.04);
    contact.grid.x_min = -4.01;
    problem solved;
    full_settings settings = full_default_settings();
    problem_init(&solved, &contact, &settings);
    for (size_t k = 0; k < contact.grid.num_nodes; k++) {
        double x = grid_x(&contact.grid, k);
        solved.state.film[k] = 3 + x * (2 + x * (-1 + x / 2));
        solved.state.pressure[k] = 0.5 - x;
    }
    contact_scalars scalars = full_evaluate_scalars(&solved.state, &contact);
    check_close(scalars.central_film_thickness, 3, 1e-13, 0);
    check_close(scalars.central_pressure, 0.5, 1e-13, 0);
    problem_free(&solved);
}

static void solution_is_a_fixed_point(void **state) {
    (void)state;
    full_settings settings = full_default_settings();
    ehd_contact contact = sample_case(1);
    problem solved;
    problem_solve_cold(&solved, &contact, &settings);
    size_t exit = solved.state.exit;
    double approach = solved.state.rigid_approach;
    assert_int_equal(full_solve(&solved.info, &solved.state, solved.solver, &contact, NULL, NULL),
                     EHD_OK);
    assert_int_equal(solved.info.status, EHD_OK);
    assert_true(solved.info.newton_iterations <= 1);
    assert_int_equal(solved.state.exit, exit);
    check_close(solved.state.rigid_approach, approach, 1e-10, 0);
    problem_free(&solved);
}

// ---- grids

/* Returns the order of the central film's error. The boundary nodes are at the same places on all
 * grids. */
static double order_in_the_step(ehd_discretization discretization) {
    static const size_t intervals[] = {300, 600, 1200};
    const full_settings settings = full_default_settings();
    double film[3];
    for (int s = 0; s < 3; s++) {
        const double step = 6 / (double)intervals[s];
        ehd_contact contact = sample_contact("barus", "incompressible", 40, 5, 0.02);
        contact.grid = grid_of(-4 + step, step, intervals[s] - 1, 1, false, discretization);
        problem solved;
        problem_solve_cold(&solved, &contact, &settings);
        film[s] = full_evaluate_scalars(&solved.state, &contact).central_film_thickness;
        problem_free(&solved);
    }
    return log2((film[0] - film[1]) / (film[1] - film[2]));
}

static void order_of_convergence(void **state) {
    (void)state;
    check_close(order_in_the_step(DISCRETIZATION_PUBLISHED), 2, 0, 0.1);
    assert_true(order_in_the_step(DISCRETIZATION_ACCURATE) > 3); // measured: 3.37
}

static void newton_count_does_not_grow(void **state) {
    (void)state;
    static const double steps[] = {0.02, 0.01, 0.005, 0.0025};
    full_settings settings = full_default_settings();
    for (int s = 0; s < 4; s++) {
        ehd_contact contact = sample_contact("no1", "dowson-higginson", 12, 12, steps[s]);
        problem solved;
        problem_solve_cold(&solved, &contact, &settings);
        assert_true(solved.info.newton_iterations <= (s == 0 ? 15 : 6));
        problem_free(&solved);
    }
}

/* The pressure zone starts a tenth of a half width too short or too long. The zone grows at once as
 * far as the multipliers require. Newton's method therefore takes no more iterations than the
 * pressure alone needs, on coarse and fine grids. Measured: 4 to 7 iterations. */
static void zone_grows_at_once(void **state) {
    (void)state;
    static const double steps[] = {0.02, 0.01, 0.005};
    static const char *const lubricants[] = {"barus", "roelands", "no1"};
    const full_settings settings = full_default_settings();
    for (int i = 0; i < 9; i++) {
        ehd_contact contact =
            sample_contact(lubricants[i % 3], "dowson-higginson", 12, 6, steps[i / 3]);
        problem solved;
        problem_solve_cold(&solved, &contact, &settings);
        const size_t exit = solved.state.exit, apart = (size_t)lround(0.1 / contact.grid.step);
        for (size_t far = 0; far <= 2 * apart; far += 2 * apart) {
            full_state_set_zone(&solved.state, &contact.grid, exit - apart + far);
            assert_int_equal(
                full_solve(&solved.info, &solved.state, solved.solver, &contact, NULL, NULL),
                EHD_OK);
            assert_int_equal(solved.info.status, EHD_OK);
            assert_int_equal(solved.state.exit, exit);
            assert_true(solved.info.newton_iterations <= 8);
        }
        problem_free(&solved);
    }
}

/* A pressurised zone that starts with a hole or with all nodes leads to the solution. A start with
 * two to four nodes may fail, but must not read memory before the grid (sanitizers). */
static void any_zone_is_solved_or_given_up(void **state) {
    (void)state;
    const full_settings settings = full_default_settings();
    for (int kind = 0; kind < 2; kind++) {
        ehd_contact contact = sample_contact("barus", "incompressible", 20, 5, 0.02);
        if (kind) contact.grid.discretization = DISCRETIZATION_ACCURATE;
        problem solved;
        problem_solve_cold(&solved, &contact, &settings);
        const size_t exit = solved.state.exit;
        const size_t exits[] = {exit, contact.grid.num_nodes - 1, 4, 3, 2};
        for (size_t i = 0; i < sizeof exits / sizeof *exits; i++) {
            full_state_set_zone(&solved.state, &contact.grid, exits[i]);
            if (i == 0) solved.state.ruptured[exit - 10] = true;
            assert_int_equal(
                full_solve(&solved.info, &solved.state, solved.solver, &contact, NULL, NULL),
                EHD_OK);
            if (i < 2) {
                assert_int_equal(solved.info.status, EHD_OK);
                assert_int_equal(solved.state.exit, exit);
                assert_true(solved.info.complementarity < 1e-9);
                assert_false(solved.state.ruptured[exit - 10]);
            }
        }
        problem_free(&solved);
    }
}

/* At a high alpha p_H a full Newton step may lead far away from the solution. This contact takes 8
 * iterations with a line search, and 354 without, most of them in a continuation. */
static void steps_are_searched(void **state) {
    (void)state;
    const full_settings settings = full_default_settings();
    ehd_contact contact = sample_contact("barus", "incompressible", 500, 15, 0.002);
    contact.grid.discretization = DISCRETIZATION_ACCURATE;
    problem solved;
    problem_solve_cold(&solved, &contact, &settings);
    assert_true(solved.info.newton_iterations <= 12);
    problem_free(&solved);
}

// ---- an exit between two nodes, with the accurate discretisation

static ehd_contact accurate_contact(double moes_M, double moes_L, double step) {
    ehd_contact contact = sample_contact("barus", "incompressible", moes_M, moes_L, step);

    contact.grid.discretization = DISCRETIZATION_ACCURATE;
    return contact;
}

static double exit_of(double step) {
    const ehd_contact contact = accurate_contact(20, 10, step);
    const full_settings settings = full_default_settings();
    problem solved;

    problem_solve_cold(&solved, &contact, &settings);
    double exit = full_evaluate_scalars(&solved.state, &contact).exit_position;
    assert_true(solved.info.complementarity <= 1e-10);
    problem_free(&solved);
    return exit;
}

/* On a coarse grid the exit has the place of the exit on a grid with a quarter of the grid step.
 * Measured: X = 1.055470 and 1.055492. Exits at nodes would be 1.06 and 1.055. */
static void exit_is_that_of_a_finer_grid(void **state) {
    (void)state;
    check_close(exit_of(0.02), exit_of(0.005), 0, 4e-5);
}

enum { NUM_SWEPT = 21, NUM_COEFFICIENTS = 5 };

/* Returns the largest deviation of equidistant values from a fitted polynomial of degree four. */
static double scatter(const double values[NUM_SWEPT]) {
    double matrix[NUM_SWEPT * NUM_COEFFICIENTS], right[NUM_SWEPT], largest = 0;

    for (int i = 0; i < NUM_SWEPT; i++) {
        right[i] = values[i];
        for (int j = 0; j < NUM_COEFFICIENTS; j++) // Chebyshev polynomials
            matrix[i * NUM_COEFFICIENTS + j] = cos(j * acos(2. * i / (NUM_SWEPT - 1) - 1));
    }
    double kept[NUM_SWEPT * NUM_COEFFICIENTS];
    memcpy(kept, matrix, sizeof kept);
    assert_int_equal(LAPACKE_dgels(LAPACK_ROW_MAJOR, 'N', NUM_SWEPT, NUM_COEFFICIENTS, 1, matrix,
                                   NUM_COEFFICIENTS, right, 1),
                     0);
    for (int i = 0; i < NUM_SWEPT; i++) {
        double fit = 0;
        for (int j = 0; j < NUM_COEFFICIENTS; j++)
            fit += kept[i * NUM_COEFFICIENTS + j] * right[j];
        largest = fmax(largest, fabs(values[i] - fit));
    }
    return largest;
}

/* While M grows from 20 to 30 the exit passes a node at 1.05, and its position must stay a smooth
 * function of M. Measured: a deviation of 1.2e-5 from a polynomial (with exits at nodes: 4e-3), and
 * 4 to 6 Newton iterations from one contact to the next. */
static void exit_is_smooth_in_the_load(void **state) {
    (void)state;
    const full_settings settings = full_default_settings();
    double exits[NUM_SWEPT];
    problem solved;

    for (int i = 0; i < NUM_SWEPT; i++) {
        const ehd_contact contact = accurate_contact(20 * pow(1.5, i / (NUM_SWEPT - 1.)), 10, 0.01);
        if (i == 0) {
            problem_solve_cold(&solved, &contact, &settings);
        } else {
            assert_int_equal(
                full_solve(&solved.info, &solved.state, solved.solver, &contact, NULL, NULL),
                EHD_OK);
            assert_int_equal(solved.info.status, EHD_OK);
            assert_true(solved.info.newton_iterations <= 6);
        }
        exits[i] = full_evaluate_scalars(&solved.state, &contact).exit_position;
    }
    assert_true(exits[0] > 1.05 && exits[NUM_SWEPT - 1] < 1.05);
    assert_true(scatter(exits) < 2e-5);
    problem_free(&solved);
}

/* A result stores pressure and approach, but not the place of the exit in its cell. Checks that the
 * solver finds this place again from both. */
static void pressure_holds_the_exit(void **state) {
    (void)state;
    const full_settings settings = full_default_settings();
    static const double loads[] = {5, 20, 23, 200};

    for (int i = 0; i < 4; i++) {
        const ehd_contact contact = accurate_contact(loads[i], 5, 0.01);
        problem solved;
        problem_solve_cold(&solved, &contact, &settings);
        const size_t exit = solved.state.exit;
        const double offset = solved.state.exit_offset;
        assert_true(offset >= 0 && offset <= 1 && solved.state.pressure[exit - 1] > 0);
        full_state_set_zone(&solved.state, &contact.grid, exit);
        assert_true(isnan(solved.state.exit_offset));
        assert_int_equal(
            full_solve(&solved.info, &solved.state, solved.solver, &contact, NULL, NULL), EHD_OK);
        assert_int_equal(solved.info.status, EHD_OK);
        assert_true(solved.info.newton_iterations <= 3);
        assert_int_equal(solved.state.exit, exit);
        check_close(solved.state.exit_offset, offset, 0, 1e-6);
        problem_free(&solved);
    }
}

/* Residuals are zero upstream of the last node with pressure, and nonzero at this node and at the
 * cavitated nodes. */
static void rows_before_the_exit_hold(void **state) {
    (void)state;
    const ehd_contact contact = accurate_contact(20, 10, 0.01);
    const full_settings settings = full_default_settings();
    reynolds_row *rows = malloc(contact.grid.num_inner * sizeof *rows);
    problem solved;

    assert_non_null(rows);
    problem_solve_cold(&solved, &contact, &settings);
    problem_rows(rows, &solved);
    const size_t exit = solved.state.exit;
    for (size_t k = 1; k < exit - 1; k++)
        check_close(rows[k - 1].residual, 0, 0, 1e-9 * row_size(&rows[k - 1]));
    for (size_t k = exit - 1; k <= contact.grid.num_inner; k++)
        assert_true(rows[k - 1].residual < -1e-3);
    problem_free(&solved);
    free(rows);
}

/* The Jacobian is exact, including the row of the exit cell. It equals the dense Jacobian, and
 * Newton's method converges quadratically. */
static void the_cell_is_part_of_the_linear_system(void **state) {
    (void)state;
    const ehd_contact contact = accurate_contact(12, 6, 0.04),
                      other = accurate_contact(13, 6, 0.04);
    full_settings settings = full_default_settings();
    problem solved;

    settings.solve_linear = compare_linear_solvers;
    problem_solve_cold(&solved, &contact, &settings);
    assert_int_equal(full_solve(&solved.info, &solved.state, solved.solver, &other, NULL, NULL),
                     EHD_OK);
    assert_int_equal(solved.info.status, EHD_OK);
    assert_true(solved.info.newton_iterations <= 4);
    problem_free(&solved);
}

/* On so fine a grid, round-off leaves residuals of 5e-12. If the tolerance is smaller, as in
 * training, the iteration ends when the residuals no longer fall. On its default grid this contact
 * takes 6 iterations. Waiting for a residual below 1e-12 by chance would take 47 iterations. */
static void rounding_ends_the_iteration(void **state) {
    (void)state;
    full_settings settings = full_default_settings();
    ehd_contact contact = sample_contact("roelands", "dowson-higginson", 2000, 10, 0.000625);
    problem solved;
    settings.tolerance = 1e-12;
    problem_solve_cold(&solved, &contact, &settings);
    assert_true(solved.info.newton_iterations <= 12);
    problem_free(&solved);
}

// ---- outcomes and errors

static void not_converged_is_an_outcome(void **state) {
    (void)state;
    full_settings settings = full_default_settings();
    settings.max_iterations = 1;
    ehd_contact contact = sample_case(1);
    problem stopped;
    problem_init(&stopped, &contact, &settings);
    assert_int_equal(full_solve_cold(&stopped.info, &stopped.state, stopped.solver, &contact, NULL),
                     EHD_OK);
    assert_int_equal(stopped.info.status, EHD_NOT_CONVERGED);
    assert_string_equal(stopped.info.reason, "iteration limit reached");
    assert_true(stopped.info.newton_iterations >= 1);
    problem_free(&stopped);
}

/* The solver reports cells far wider than the inlet, instead of taking thousands of steps. */
static void too_coarse_a_grid_is_an_outcome(void **state) {
    (void)state;
    full_settings settings = full_default_settings();
    const ehd_contact accurate = sample_contact("barus", "incompressible", 1000, 0, 0.04);
    const ehd_contact contacts[] = {sample_published(accurate), accurate};
    for (int i = 0; i < 2; i++) {
        problem stopped;
        problem_init(&stopped, &contacts[i], &settings);
        assert_int_equal(
            full_solve_cold(&stopped.info, &stopped.state, stopped.solver, &contacts[i], NULL),
            EHD_OK);
        assert_int_equal(stopped.info.status, EHD_NOT_CONVERGED);
        assert_string_equal(stopped.info.reason, "film driven to zero, as by too coarse a grid");
        assert_true(stopped.info.newton_iterations < 500);
        problem_free(&stopped);
    }
}

static ehd_status singular_solver(full_system *system, double tolerance, size_t *iterations,
                                  ehd_error *error) {
    (void)system;
    (void)tolerance;
    *iterations = 0;
    return ehd_fail(error, EHD_NOT_CONVERGED, "singular");
}

static ehd_status memoryless_solver(full_system *system, double tolerance, size_t *iterations,
                                    ehd_error *error) {
    (void)system;
    (void)tolerance;
    *iterations = 0;
    return ehd_fail(error, EHD_MEMORY, "no memory left");
}

static void linear_solver_failures(void **state) {
    (void)state;
    full_settings settings = full_default_settings();
    ehd_contact contact = sample_case(1);
    ehd_error error;
    problem failing;

    settings.solve_linear = singular_solver;
    problem_init(&failing, &contact, &settings);
    assert_int_equal(full_solve_cold(&failing.info, &failing.state, failing.solver, &contact, NULL),
                     EHD_OK);
    assert_int_equal(failing.info.status, EHD_NOT_CONVERGED);
    assert_string_equal(failing.info.reason, "linear system singular");
    problem_free(&failing);

    settings.solve_linear = memoryless_solver;
    problem_init(&failing, &contact, &settings);
    assert_int_equal(
        full_solve_cold(&failing.info, &failing.state, failing.solver, &contact, &error),
        EHD_MEMORY);
    assert_string_equal(error.text, "no memory left");
    problem_free(&failing);
}

static void solver_without_memory(void **state) {
    (void)state;
    ehd_contact contact = sample_case(0);
    full_settings settings = full_default_settings();
    full_solver *solver;
    size_t call = 0;
    bool failed;
    do {
        allocation_fail_at(call);
        ehd_status status =
            full_solver_create(&solver, contact.kind, &contact.grid, &settings, NULL);
        failed = allocation_failed();
        assert_int_equal(status, failed ? EHD_MEMORY : EHD_OK);
        assert_true((solver == NULL) == failed);
    } while (failed && call++ < 100);
    assert_true(call >= 15 && call < 100);
    full_solver_free(solver);
}

static void state_without_memory(void **state) {
    (void)state;
    ehd_contact contact = sample_case(0);
    full_state fields;
    for (size_t call = 0; call < 4; call++) {
        allocation_fail_at(call);
        ehd_status status = full_state_init(&fields, &contact.grid, NULL);
        assert_int_equal(status, allocation_failed() ? EHD_MEMORY : EHD_OK);
        assert_int_equal(status == EHD_OK, call == 3);
        full_state_free(&fields);
    }
}

/* Each solution allocates memory for coarser grids and the continuation. Each of these allocations
 * may fail. */
static void solve_without_memory(void **state) {
    (void)state;
    ehd_contact contact = sample_contact("barus", "incompressible", 10, 2, 0.01);
    full_settings settings = full_default_settings();
    size_t call = 0;
    bool failed;
    problem starved;
    problem_init(&starved, &contact, &settings);
    do {
        allocation_fail_at(call);
        ehd_status status =
            full_solve_cold(&starved.info, &starved.state, starved.solver, &contact, NULL);
        failed = allocation_failed();
        assert_int_equal(status, failed ? EHD_MEMORY : EHD_OK);
    } while (failed && call++ < 200);
    assert_true(call >= 15 && call < 200);
    problem_free(&starved);
}

// ---- interruption

/* Sends a signal before the third linear system. This system must not be solved, and the stored
 * step must not change. */
static ehd_status interrupted_gmres(full_system *system, double tolerance, size_t *iterations,
                                    ehd_error *error) {
    static size_t calls;
    size_t n = system->grid->num_nodes;
    double *before = malloc(n * sizeof *before);

    assert_non_null(before);
    memcpy(before, system->step, n * sizeof *before);
    if (++calls == 3) raise(SIGINT);
    ehd_status status = full_solve_gmres(system, tolerance, iterations, error);
    if (calls < 3) {
        assert_int_equal(status, EHD_OK);
    } else {
        assert_int_equal(calls, 3);
        assert_int_equal(status, EHD_INTERRUPTED);
        assert_int_equal(*iterations, 0);
        assert_memory_equal(system->step, before, n * sizeof *before);
    }
    free(before);
    return status;
}

static void an_interrupted_linear_system_is_no_step(void **state) {
    (void)state;
    ehd_contact contact = sample_case(0);
    full_settings settings = full_default_settings();
    char *arguments[] = {"fullrun", NULL};
    const program_options options = {.max_arguments = 0};
    ehd_error error = {""};
    program self;
    problem stopped;

    program_start(&self, 1, arguments, &options); // catches the signal
    settings.solve_linear = interrupted_gmres;
    problem_init(&stopped, &contact, &settings);
    assert_int_equal(
        full_solve_cold(&stopped.info, &stopped.state, stopped.solver, &contact, &error),
        EHD_INTERRUPTED);
    assert_string_equal(error.text, "full model: interrupted");
    assert_int_not_equal(stopped.info.status, EHD_OK);
    problem_free(&stopped);
    program_finish(&self, EHD_OK, &error);
}

/* Checks that the minimum film is found in the deeper of two valleys. The bottom of this valley
 * lies between two nodes. At both nodes the film is thicker than at the node in the bottom of the
 * other valley. */
static void the_smallest_film_need_not_be_at_the_smallest_node(void **state) {
    (void)state;
    const ehd_contact contact = sample_contact("barus", "incompressible", 20, 6, 0.05);
    full_state two;

    assert_int_equal(full_state_init(&two, &contact.grid, NULL), EHD_OK);
    for (size_t k = 0; k < contact.grid.num_nodes; k++) {
        const double x = grid_x(&contact.grid, k);
        two.film[k] = fmin(0.3002 + (x + 0.5) * (x + 0.5), 0.3 + (x - 0.525) * (x - 0.525));
    }
    check_close(full_evaluate_scalars(&two, &contact).minimum_film_thickness, 0.3, 1e-12, 0);
    full_state_free(&two);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_smallest_film_need_not_be_at_the_smallest_node),
        cmocka_unit_test(solution_satisfies_the_problem),
        cmocka_unit_test(scalars_between_nodes),
        cmocka_unit_test(solution_is_a_fixed_point),
        cmocka_unit_test(order_of_convergence),
        cmocka_unit_test(newton_count_does_not_grow),
        cmocka_unit_test(zone_grows_at_once),
        cmocka_unit_test(any_zone_is_solved_or_given_up),
        cmocka_unit_test(steps_are_searched),
        cmocka_unit_test(exit_is_that_of_a_finer_grid),
        cmocka_unit_test(exit_is_smooth_in_the_load),
        cmocka_unit_test(pressure_holds_the_exit),
        cmocka_unit_test(rows_before_the_exit_hold),
        cmocka_unit_test(the_cell_is_part_of_the_linear_system),
        cmocka_unit_test(rounding_ends_the_iteration),
        cmocka_unit_test(not_converged_is_an_outcome),
        cmocka_unit_test(too_coarse_a_grid_is_an_outcome),
        cmocka_unit_test(linear_solver_failures),
        cmocka_unit_test(solver_without_memory),
        cmocka_unit_test(state_without_memory),
        cmocka_unit_test(solve_without_memory),
        // the process stays interrupted, so this test is the last
        cmocka_unit_test(an_interrupted_linear_system_is_no_step),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
