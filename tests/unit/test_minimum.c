/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The minimum of a film, interpolated between nodes. It is exact if the film is a polynomial of
 * degree four along a line and across the lines. */
#include "common/physics/minimum.h"
#include "tests/unit/check.h"

#include <math.h>

/* A film whose minimum, 0.3, lies `along` and `across` grid steps away from node (30, 7). */
typedef struct valley {
    ehd_grid grid;
    double along, across, third, fourth;
    double slant;   // shift of the valley from one line to the next, in grid steps
    size_t missing; // node without a value
} valley;

static const size_t COLUMN = 30, LINE = 7;

static valley valley_at(double along, double across, bool point) {
    valley self = {grid_of(-4, 0.1, 61, point ? 21 : 1, false, DISCRETIZATION_PUBLISHED),
                   along,
                   across,
                   0.05,
                   0.01,
                   0,
                   0};

    self.grid.discretization = DISCRETIZATION_ACCURATE;
    return self;
}

static double value_at(const void *context, size_t node) {
    const valley *self = context;
    const size_t width = grid_width(&self->grid);
    double y =
        self->grid.inner_lines > 1 ? (double)(node / width) - (double)LINE - self->across : 0;
    double x = (double)(node % width) - (double)COLUMN - self->along - self->slant * y;

    if (node == self->missing) return NAN;
    return 0.3 + x * x * (1 + x * (self->third + x * self->fourth)) +
           2 * y * y * (1 + y * (self->third + y * self->fourth));
}

static double minimum_of(const valley *self) {
    size_t line = self->grid.inner_lines > 1 ? LINE : 0;
    return minimum_around(&self->grid, line * grid_width(&self->grid) + COLUMN, value_at, self);
}

static void exact_for_quartics(void **state) {
    (void)state;
    for (double along = -0.5; along <= 0.5; along += 0.125) {
        const valley line = valley_at(along, 0, false);
        check_close(minimum_of(&line), 0.3, 1e-13, 0);
        for (double across = -0.5; across <= 0.5; across += 0.25) {
            const valley point = valley_at(along, across, true);
            check_close(minimum_of(&point), 0.3, 1e-13, 0);
        }
    }
}

/* The minimum is exact even if the valley moves by several nodes from line to line, as in the
 * horseshoe of a point contact. */
static void along_a_slanting_valley(void **state) {
    (void)state;
    for (double slant = -4; slant <= 4; slant += 0.5) {
        valley point = valley_at(0.3, -0.4, true);
        point.slant = slant;
        const size_t column = COLUMN + (size_t)lround(0.3 + slant * 0.4 + 10) - 10;
        const size_t node = LINE * grid_width(&point.grid) + column; // lowest node of its line
        check_close(minimum_around(&point.grid, node, value_at, &point), 0.3, 1e-13, 0);
    }
}

static void of_the_line_where_those_beside_it_are_missing(void **state) {
    (void)state;
    valley point = valley_at(0.3, -0.4, true);
    const double of_the_line = value_at(&point, LINE * grid_width(&point.grid) + COLUMN) -
                               0.3 * 0.3 * (1 - 0.3 * (point.third - 0.3 * point.fourth));

    point.missing = (LINE + 2) * grid_width(&point.grid) + COLUMN;
    check_close(minimum_of(&point), of_the_line, 1e-13, 0);
}

static void on_the_mirror_line(void **state) {
    (void)state;
    valley half = valley_at(0.3, -7, true); // the minimum lies on line 0, the line of symmetry
    half.grid = grid_like(&half.grid, -4, 0.1, 61, 11);
    half.grid.half = true;
    check_close(minimum_around(&half.grid, COLUMN, value_at, &half), 0.3, 1e-13, 0);
}

static void nodal_where_it_cannot_be_interpolated(void **state) {
    (void)state;
    valley line = valley_at(0.3, 0, false), edge = line, flat = line;
    const double nodal = value_at(&line, COLUMN);

    line.missing = COLUMN + 2;
    check_close(minimum_of(&line), nodal, 0, 0);
    edge.grid.inner_x = COLUMN; // the next node is a boundary node
    check_close(minimum_of(&edge), nodal, 0, 0);
    flat.grid.discretization = DISCRETIZATION_PUBLISHED;
    check_close(minimum_of(&flat), nodal, 0, 0);
    flat = valley_at(8, 0, false); // the minimum is eight nodes away
    check_close(minimum_of(&flat), value_at(&flat, COLUMN), 0, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exact_for_quartics),
        cmocka_unit_test(along_a_slanting_valley),
        cmocka_unit_test(of_the_line_where_those_beside_it_are_missing),
        cmocka_unit_test(on_the_mirror_line),
        cmocka_unit_test(nodal_where_it_cannot_be_interpolated),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
