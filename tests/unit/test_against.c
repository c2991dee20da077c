/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Differences of two results: fields on different grids, and films over time. */
#include "romrun/calibrate/against.h"
#include "tests/unit/check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Returns a polynomial that has degree 3 and is even in Y. Interpolation with four nodes per axis
 * reproduces this polynomial exactly. */
static double cubic(double x, double y) {
    return 1 + x - 0.5 * x * x + 0.25 * x * x * x + (2 - x * x * x) * y * y;
}

/* Returns the values of `cubic` at all nodes, or at the inner nodes [num_inner]. */
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

/* Checks the difference between the fields of `cubic` on two grids. The first field has an error at
 * one node; the difference must equal this error. */
static void check_pair(const ehd_grid *grid, const ehd_grid *other, size_t row, double error) {
    double *nodes = field_of(grid, false), *inner = field_of(other, true);

    nodes[grid_node_of_row(grid, row)] += error;
    check_close(against_difference(nodes, grid, inner, other), error, 0, 1e-12);
    free(nodes);
    free(inner);
}

/* Compares with fields on a second grid that equals the first grid, or is finer, coarser, longer,
 * shorter or shifted. */
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
    // only nodes of the first grid that lie within the second grid or at its ends are compared
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

/* Compares a result on a whole or half grid with stored fields, whose grid is always whole. */
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

/* Stores the text that is printed for a comparison over time. */
static void print_to(char text[1024], const time_trace *trace, const time_series *full) {
    FILE *file = tmpfile();
    const int out = dup(STDOUT_FILENO);
    const ehd_grid grid = full->grid;
    ehd_error error = {""};

    assert_true(file && out >= 0);
    fflush(stdout);
    assert_true(dup2(fileno(file), STDOUT_FILENO) >= 0);
    const ehd_status status = against_print_in_time(trace, full, "full.h5", &grid, &error);
    fflush(stdout);
    assert_true(dup2(out, STDOUT_FILENO) >= 0);
    close(out);
    rewind(file);
    text[fread(text, 1, 1023, file)] = '\0';
    fclose(file);
    assert_int_equal(status, EHD_OK);
}

/* The bodies are in contact, then apart, then in contact again, with a film that is 10 % off.
 * Checks that the printed deviations cover both periods of contact. */
static void compares_all_contacts(void **state) {
    (void)state;
    enum { COUNT = 31 };
    static double time[COUNT], film[COUNT], pressure[COUNT], load[COUNT], other[COUNT];
    char text[1024];

    for (int i = 0; i < COUNT; i++) {
        const bool apart = i > 10 && i < 20;
        time[i] = 0.1 * i;
        load[i] = pressure[i] = apart ? 0 : 1;
        other[i] = apart ? NAN : 0.2;
        film[i] = i < 20 ? other[i] : 0.22;
    }
    const time_trace trace = {
        .count = COUNT, .time = time, .central_film_thickness = film, .central_pressure = pressure};
    const time_series full = {.grid = line(-4, 0.1, 61),
                              .num_times = COUNT,
                              .time = time,
                              .central_film_thickness = other,
                              .central_pressure = pressure,
                              .load = load};
    print_to(text, &trace, &full);
    if (!strstr(text, "while the bodies are in contact in both\n") ||
        !strstr(text, "thickness   at most 10 % off, at T = 2; 5 % in the mean\n") ||
        !strstr(text, "pressure         at most 0 % off"))
        fail_msg("%s", text);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(interpolates_lines),
        cmocka_unit_test(interpolates_points),
        cmocka_unit_test(compares_all_contacts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
