/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The filter that smooths films with transport along the path. */
#include "common/time/path_filter.h"
#include "tests/unit/allocation.h"
#include "tests/unit/check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static ehd_grid line_grid(double step) {
    return grid_of(-2, step, (size_t)round(4 / step) + 1, 1, false, DISCRETIZATION_ACCURATE);
}

/* Returns the filtered values of a function at the nodes of one line. The caller frees them. */
static double *filtered(const ehd_grid *grid, double length, double (*of)(double x, double k),
                        double k, size_t line) {
    const size_t width = grid_width(grid);
    double *values = malloc(width * sizeof *values);
    path_filter filter;
    assert_non_null(values);
    assert_int_equal(path_filter_init(&filter, grid, length, NULL), EHD_OK);
    for (size_t i = 0; i < width; i++)
        values[i] = of(grid_x(grid, i), k);
    path_filter_apply(&filter, values, line, 1, 1);
    path_filter_free(&filter);
    return values;
}

static double polynomial(double x, double k) {
    (void)k;
    return 1 + x * (2 + x * (3 + x * (4 - 5 * x)));
}

/* The filter does not change polynomials of degree four, even on a fine grid, where the filter's
 * matrix is ill-conditioned. */
static void polynomials_of_degree_four_pass(void **state) {
    (void)state;
    for (double step = 0.01; step > 0.001; step /= 2) {
        const ehd_grid grid = line_grid(step);
        double *values = filtered(&grid, 0.0125, polynomial, 0, 0);
        for (size_t i = 0; i < grid_width(&grid); i++)
            check_close(values[i], polynomial(grid_x(&grid, i), 0), 0, 1e-10);
        free(values);
    }
}

static double wave(double x, double k) {
    return cos(k * x) * exp(-pow(x / 0.4, 8));
}

/* Compares a filtered wave at the centre with theory. There the filter's length hardly varies. */
static void waves_shorter_than_the_length_are_damped(void **state) {
    const double length = 0.05, step = 0.005;
    const ehd_grid grid = line_grid(step);
    const size_t centre = (size_t)round(2 / step) + 1;
    (void)state;
    for (double k = 10; k < 100; k *= 1.5) {
        const double difference = 2 * sin(k * step / 2) / step; // finite difference instead of k
        const double expected = 1 / (1 + pow(difference * length / 2, 2 * PATH_FILTER_ORDER));
        double *values = filtered(&grid, length, wave, k, 0);
        check_close(values[centre], expected, 0, 0.02);
        free(values);
    }
}

static double spike(double x, double k) {
    return fabs(x - k) < 1e-9 ? 1 : 0;
}

/* The filter spreads the value of a node over the neighbouring nodes and keeps the sum. Towards the
 * rim of the dry contact a value spreads less, and beyond the rim not at all. */
static void the_sum_is_kept_and_the_rim_left_alone(void **state) {
    const ehd_grid grid = line_grid(0.01);
    (void)state;
    double last = 0;
    for (double place = 0; place < 1.3; place += 0.25) {
        double *values = filtered(&grid, 0.02, spike, place, 0), sum = 0;
        for (size_t i = 0; i < grid_width(&grid); i++)
            sum += values[i];
        const double left = values[(size_t)round((place + 2) / 0.01) + 1];
        check_close(sum, 1, 0, 1e-12);
        assert_true(left > last || left == 1);
        last = left;
        free(values);
    }
    check_close(last, 1, 0, 0);
}

/* On each line of a point contact the filter has a length of its own. Lines beyond the rim of the
 * dry contact are not filtered. */
static void lines_across_go_by_their_distance(void **state) {
    const ehd_grid grid = grid_of(-2, 0.02, 201, 76, true, DISCRETIZATION_ACCURATE);
    (void)state;
    double last = 0;
    for (size_t line = 0; line < 60; line += 10) {
        double *values = filtered(&grid, 0.04, spike, 0, line);
        assert_true(values[101] > last || values[101] == 1);
        last = values[101];
        free(values);
    }
    check_close(last, 1, 0, 0);
}

static void survives_failing_allocations(void **state) {
    const ehd_grid grid = line_grid(0.1);
    (void)state;
    for (size_t i = 0; i < 3; i++) {
        path_filter filter;
        allocation_fail_at(i);
        assert_int_equal(path_filter_init(&filter, &grid, 0.1, NULL), EHD_MEMORY);
        assert_true(allocation_failed());
    }
}

static void a_length_of_too_many_steps_is_refused(void **state) {
    (void)state;
    ehd_error error = {""};
    const ehd_grid grid = grid_of(-4, 0.005, 1201, 1, false, DISCRETIZATION_ACCURATE);
    path_filter filter;

    assert_int_equal(path_filter_init(&filter, &grid, 0.25, &error), EHD_OK);
    path_filter_free(&filter);
    assert_int_equal(path_filter_init(&filter, &grid, 0.5, &error), EHD_DATA);
    assert_non_null(
        strstr(error.text, "transient.smoothing: found 0.5, expected at most about 0.25"));
}

static void the_length_goes_with_the_tolerance(void **state) {
    (void)state;
    ehd_contact contact = {.grid = line_grid(0.0025), .smoothing = NAN, .time_tolerance = NAN};

    check_close(path_filter_length(&contact), 0.014, 1e-15, 0);
    contact.time_tolerance = 1e-2;
    check_close(path_filter_length(&contact), 0.014, 1e-15, 0);
    contact.time_tolerance = 1.5e-3 / 8;
    check_close(path_filter_length(&contact), 0.007, 1e-12, 0);
    contact.time_tolerance = 1e-9; // the length is at least 0.85 grid steps
    check_close(path_filter_length(&contact), 0.85 * 0.0025, 1e-12, 0);
    contact.smoothing = 0;
    check_close(path_filter_length(&contact), 0, 0, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_length_goes_with_the_tolerance),
        cmocka_unit_test(a_length_of_too_many_steps_is_refused),
        cmocka_unit_test(polynomials_of_degree_four_pass),
        cmocka_unit_test(waves_shorter_than_the_length_are_damped),
        cmocka_unit_test(the_sum_is_kept_and_the_rim_left_alone),
        cmocka_unit_test(lines_across_go_by_their_distance),
        cmocka_unit_test(survives_failing_allocations),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
