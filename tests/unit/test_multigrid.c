/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Multigrid cycles on a matrix like the matrix of a contact. In the upstream part of the grid the
 * matrix contains pressure flow in both directions. In the downstream part it contains entrainment
 * along the lines, and some nodes have no pressure. */
#include "fullrun/multigrid.h"

#include "common/physics/ellipse.h"
#include "tests/unit/check.h"
#include "tests/unit/sample.h"

#include <math.h>
#include <stdlib.h>

static ehd_grid grid_with(size_t cells, bool half) {
    return sample_point("barus", "incompressible", 20, 10, cells, half).grid;
}

static void add(double *row, int line, int column, double value, bool at_mirror) {
    if (at_mirror && line < 0) line = -line;
    if (column < -CYCLE_BACK) column = -CYCLE_BACK;
    row[(line + 1) * CYCLE_COLUMNS + column + CYCLE_BACK] += value;
}

/* Adds pressure flow along the lines, and across the lines with a coefficient `across` times as
 * large. */
static void add_flow(double *row, double across, bool at_mirror) {
    add(row, 0, 0, -2 - 2 * across, at_mirror);
    for (int side = -1; side <= 1; side += 2) {
        add(row, 0, side, 1, at_mirror);
        add(row, side, 0, across, at_mirror);
    }
}

/* Adds the upwind difference of the deflection that the pressures at the node and its neighbours
 * cause. */
static void add_entrainment(double *row, bool at_mirror) {
    const double kernel[2][2] = {{3, 0.54}, {0.54, 0.21}}, upwind[3] = {1.5, -2, 0.5};

    for (int line = -1; line <= 1; line++)
        for (int column = -1; column <= 1; column++)
            for (int back = 0; back < 3; back++)
                add(row, line, column - back, -upwind[back] * kernel[abs(line)][abs(column)],
                    at_mirror);
}

static void fill(multigrid *cycle, const ehd_grid *grid) {
    const double across = grid->shape.flow_across / (grid->shape.cell * grid->shape.cell);

    for (size_t r = 0; r < grid->num_inner; r++) {
        const size_t line = r / grid->inner_x, column = r % grid->inner_x;
        double *row = multigrid_rows(cycle) + r * CYCLE_ENTRIES;
        const double x = (double)column / (double)grid->inner_x;
        const double y = (double)line / (double)grid->inner_lines;

        for (size_t a = 0; a < CYCLE_ENTRIES; a++)
            row[a] = 0;
        if (x < 0.6 || x > 0.75) add_flow(row, across, grid->half && line == 0);
        if (x > 0.5) add_entrainment(row, grid->half && line == 0);
        multigrid_unknowns(cycle)[r] = !grid->half || x < 0.8 + 0.1 * y;
    }
}

/* Computes y = b - A x with the rows of the unknowns. */
static void residual(double *y, multigrid *cycle, const double *b, const double *x,
                     const ehd_grid *grid) {
    for (size_t r = 0; r < grid->num_inner; r++) {
        const double *row = multigrid_rows(cycle) + r * CYCLE_ENTRIES;
        y[r] = b[r];
        for (size_t a = 0; a < CYCLE_ENTRIES; a++)
            if (row[a] != 0)
                y[r] -= row[a] * x[(r / grid->inner_x + a / CYCLE_COLUMNS - 1) * grid->inner_x +
                                   r % grid->inner_x + a % CYCLE_COLUMNS - CYCLE_BACK];
    }
}

/* Returns the largest error after a number of cycles. Each cycle solves for the residual that the
 * earlier cycles have left. The exact solution is between -1 and 1. */
static double error_on(ehd_grid grid, size_t cycles) {
    multigrid *cycle = multigrid_create(&grid, NULL);
    const size_t bytes = grid.num_inner * sizeof(double);
    double *wanted = malloc(bytes), *found = calloc(grid.num_inner, sizeof(double));
    double *given = calloc(grid.num_inner, sizeof(double)), error = 0;

    assert_true(cycle && wanted && found && given);
    fill(cycle, &grid);
    assert_true(multigrid_prepare(cycle));
    for (size_t r = 0; r < grid.num_inner; r++)
        wanted[r] = multigrid_unknowns(cycle)[r] ? sin(0.1 * (double)(r % 997)) : 0;
    residual(given, cycle, found, wanted, &grid);
    for (size_t r = 0; r < grid.num_inner; r++)
        given[r] = -given[r];
    for (size_t i = 0; i < cycles; i++) {
        residual(multigrid_right(cycle), cycle, given, found, &grid);
        multigrid_cycle(cycle);
        for (size_t r = 0; r < grid.num_inner; r++)
            found[r] += multigrid_solution(cycle)[r];
    }
    for (size_t r = 0; r < grid.num_inner; r++)
        error = fmax(error, fabs(found[r] - wanted[r]));
    assert_true(isfinite(error));
    multigrid_free(cycle);
    free(wanted);
    free(found);
    free(given);
    return error;
}

static double error_after(size_t cycles, size_t cells, bool half) {
    return error_on(grid_with(cells, half), cycles);
}

/* A grid that is as small as a coarsest grid is solved directly, by factors of its matrix. */
static void small_grids_take_one_cycle(void **state) {
    (void)state;
    for (int half = 0; half < 2; half++)
        check_close(error_after(1, 32, half), 0, 0, 1e-12);
}

/* Long narrow grids are also solved directly, because the band of their matrix is narrow. */
static void narrow_grids_take_one_cycle_and_little_memory(void **state) {
    (void)state;
    const ehd_grid square = grid_with(128, false);

    for (int along = 0; along < 2; along++) {
        const ehd_grid grid = grid_like(&square, -1, 0.05, along ? 600 : 24, along ? 24 : 600);
        check_close(error_on(grid, 1), 0, 0, 1e-11);
        assert_true(multigrid_bytes(&grid) < 2500);
    }
    assert_true(multigrid_bytes(&square) < 500);
}

/* A cycle with two grids reduces the error by the factor 0.22, a cycle with three grids by 0.35. If
 * the relaxation solved the even lines first, convergence would be slower. */
static void cycles_converge_on_any_grid(void **state) {
    (void)state;
    for (size_t cells = 128; cells <= 256; cells *= 2)
        assert_true(error_after(8, cells, true) < 1e-4);
    assert_true(error_after(8, 64, false) < 1e-4);
    assert_true(error_after(8, 128, false) < 1e-4);
}

/* Cycles also converge if the flow across the lines is much larger, as in narrow ellipses. If the
 * coarser grids had only every second node of each line, the errors of these three ellipses would
 * be 2e-2, 4e-2 and 1e-3. */
static void cycles_converge_on_narrow_ellipses(void **state) {
    (void)state;
    for (double ellipticity = 0.05; ellipticity < 0.3; ellipticity *= 2) {
        ehd_grid grid = grid_with(256, true);
        grid.shape = shape_of(ellipticity);
        assert_true(error_on(grid, 8) < 1e-5);
    }
}

/* If the matrix of a line is singular, multigrid_prepare returns false. */
static void singular_lines_are_found(void **state) {
    (void)state;
    const ehd_grid grid = grid_with(128, true);
    multigrid *cycle = multigrid_create(&grid, NULL);

    assert_non_null(cycle);
    fill(cycle, &grid);
    for (size_t a = 0; a < CYCLE_ENTRIES; a++)
        multigrid_rows(cycle)[a] = 0;
    assert_false(multigrid_prepare(cycle));
    multigrid_free(cycle);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(small_grids_take_one_cycle),
        cmocka_unit_test(narrow_grids_take_one_cycle_and_little_memory),
        cmocka_unit_test(cycles_converge_on_any_grid),
        cmocka_unit_test(cycles_converge_on_narrow_ellipses),
        cmocka_unit_test(singular_lines_are_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
