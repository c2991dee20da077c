/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Differences of the fields of two results on different grids. */
#include "romrun/calibrate/against.h"
#include "tests/unit/check.h"

#include <math.h>
#include <stdlib.h>

/* Returns a polynomial of degree 3 in X and Y, which interpolation by four nodes an axis
 * reproduces; even in Y. */
static double cubic(double x, double y) {
    return 1 + x - 0.5 * x * x + 0.25 * x * x * x + (2 - x * x * x) * y * y;
}

/* Returns the polynomial at all nodes, or [num_inner] at the inner ones. */
static double *field_of(const ehd_grid *grid, bool inner) {
    double *values = malloc(grid->num_nodes * sizeof *values);

    assert_non_null(values);
    for (size_t i = 0; i < (inner ? grid->num_inner : grid->num_nodes); i++) {
        const size_t node = inner ? grid_node_of_row(grid, i) : i;
        values[i] = cubic(grid_x(grid, node), grid_y(grid, node));
    }
    return values;
}

static ehd_grid line(double x_min, double step, size_t nodes) {
    return grid_of(x_min, step, nodes, 1, false, DISCRETIZATION_ACCURATE);
}

static ehd_grid point(double x_min, double step, size_t nodes, size_t lines, bool half) {
    return grid_of(x_min, step, nodes, lines, half, DISCRETIZATION_ACCURATE);
}

/* Compares equal fields, except for `error` at one node of the first grid. */
static void check_pair(const ehd_grid *grid, const ehd_grid *other, size_t row, double error) {
    double *nodes = field_of(grid, false), *inner = field_of(other, true);

    nodes[grid_node_of_row(grid, row)] += error;
    check_close(against_difference(nodes, grid, inner, other), error, 0, 1e-12);
    free(nodes);
    free(inner);
}

/* The other grid is equal, finer, coarser, longer, shorter or shifted. */
static void interpolates_lines(void **state) {
    (void)state;
    const ehd_grid own = line(-4, 0.05, 121);
    const ehd_grid others[] = {own,
                               line(-4, 0.02, 301),
                               line(-6, 0.125, 65),
                               line(-2, 0.05, 61),
                               line(-4.03, 0.0625, 97),
                               line(-4, 0.05 * 120 / 119, 120)};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        check_pair(&own, &others[i], 60, 0);
        check_pair(&own, &others[i], 60, 0.5);
    }
    // nodes outside of the other grid are not compared, all within and at its ends are
    const ehd_grid shorter = line(-2, 0.05, 61);
    double *nodes = field_of(&own, false), *inner = field_of(&shorter, true);
    nodes[grid_node_of_row(&own, 39)] += 1;
    nodes[grid_node_of_row(&own, 101)] += 1;
    check_close(against_difference(nodes, &own, inner, &shorter), 0, 0, 1e-12);
    nodes[grid_node_of_row(&own, 40)] += 0.25;
    check_close(against_difference(nodes, &own, inner, &shorter), 0.25, 0, 1e-12);
    nodes[grid_node_of_row(&own, 100)] += 0.75;
    check_close(against_difference(nodes, &own, inner, &shorter), 0.75, 0, 1e-12);
    free(nodes);
    free(inner);
}

/* The stored grids are whole, the grid of the result is whole or half. */
static void interpolates_points(void **state) {
    (void)state;
    for (int half = 0; half < 2; half++) {
        const ehd_grid own = point(-3, 0.125, 37, half ? 13 : 25, half);
        const ehd_grid others[] = {grid_whole(&own), point(-3, 0.0625, 73, 49, false),
                                   point(-2.5, 0.1, 41, 41, false), point(-4, 0.25, 25, 9, false)};
        const size_t centre = (half ? 0 : 12) * 37 + 20;
        for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
            check_pair(&own, &others[i], centre, 0);
            check_pair(&own, &others[i], centre, 0.5);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(interpolates_lines),
        cmocka_unit_test(interpolates_points),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
