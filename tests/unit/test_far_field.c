/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The far field of point contacts and ellipses, and films on grids with a far field. */
#include "common/physics/far_field.h"
#include "tests/unit/check.h"
#include "tests/unit/problem.h"
#include "tests/unit/sample.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static ehd_contact contact_on(double moes_M, double moes_L, double x_min, double x_max,
                              double y_max, double step, const char *boundary) {
    scene given = sample_scene("barus", "incompressible", moes_M, moes_L);
    ehd_contact contact;

    strcpy(given.contact, "point");
    strcpy(given.boundary, boundary);
    given.grid = (grid_settings){x_min, x_max, step, y_max, 1};
    assert_int_equal(scene_contact(&contact, &given, NULL), EHD_OK);
    return contact;
}

/* Returns an elliptical contact with the p_H, R_x, speed and lubricant of the round contact that
 * has the given Moes numbers. */
static ehd_contact ellipse_on(double ellipticity, double moes_M, double moes_L, double x_min,
                              double x_max, double y_max, double step, const char *boundary) {
    const contact_shape shape = shape_of(ellipticity);
    scene given = sample_scene("barus", "incompressible",
                               moes_M * pow(ellipticity, 3) * pow(shape.compliance, 2), moes_L);
    ehd_contact contact;

    strcpy(given.contact, "ellipse");
    strcpy(given.boundary, boundary);
    given.ellipticity = ellipticity;
    given.grid = (grid_settings){x_min, x_max, step, y_max, 1};
    assert_int_equal(scene_contact(&contact, &given, NULL), EHD_OK);
    return contact;
}

static double pressure_at(const ehd_contact *contact, double approach, double x, double y) {
    return far_field_pressure(contact, approach, x, y).value;
}

/* Returns the residual d/dX (H^3 dP/dX) + (1/k^2) d/dY (H^3 dP/dY) - lambda dH/dX, divided by
 * lambda |dH/dX|, by finite differences. */
static double reynolds_at(const ehd_contact *contact, double approach, double x, double y) {
    const double k = contact->grid.shape.ellipticity, d = 0.01 * hypot(x, k * y);
    const double here = pressure_at(contact, approach, x, y);
    double sum = 0;

    for (int i = 0; i < 4; i++) {
        const double along = i < 2 ? (i ? d : -d) : 0, across = i < 2 ? 0 : (i > 2 ? d : -d) / k;
        const double film =
            far_field_film(&contact->grid.shape, approach, x + along / 2, y + across / 2);
        sum += film * film * film * (pressure_at(contact, approach, x + along, y + across) - here);
    }
    const double slope = (far_field_film(&contact->grid.shape, approach, x + d, y) -
                          far_field_film(&contact->grid.shape, approach, x - d, y)) /
                         (2 * d);
    return (sum / (d * d) / contact->lambda - slope) / fabs(slope);
}

/* Away from the exit the relative residual is of order d^2/r^4, where d is the film minus its
 * quadratic part (far_field.h). Checks that it is small, and far smaller at four times the
 * distance. */
static void solves_the_reynolds_equation(void **state) {
    (void)state;
    const double ellipticities[] = {1, 0.5, 1.5, 3}, directions[] = {0, 0.4, 0.8, 1.2};
    for (size_t e = 0; e < 4; e++) {
        const double k = ellipticities[e];
        const ehd_contact contact = ellipse_on(k, 10, 0, -4, 2, 3, 0.25, "open");
        // if b is large, the gap at the sides equals the gap of a circle only farther out
        const double far_off = k > 1 ? k : 1;
        for (int approach = -1; approach <= 1; approach++) {
            for (size_t i = 0; i < 4; i++) {
                const double x = -far_off * cos(directions[i]);
                const double y = far_off * sin(directions[i]) / k;
                const double near = reynolds_at(&contact, approach, 8 * x, 8 * y);
                const double far = reynolds_at(&contact, approach, 32 * x, 32 * y);
                assert_true(fabs(near) < 0.02);
                assert_true(fabs(far) < (k == 1 ? 5e-4 : 2e-3));
            }
        }
    }
}

/* P and its slope vanish at the exit, so P grows with the square of the angle from the exit. */
static void ends_at_the_exit(void **state) {
    (void)state;
    const ehd_contact contact = contact_on(10, 0, -4, 2, 3, 0.25, "open");
    const double exit = M_PI - atan(3), d = 1e-2;
    double before[2];

    for (int i = 0; i < 2; i++) {
        const double phi = exit - d * (i + 1), behind = exit + d * (i + 1);
        before[i] = pressure_at(&contact, -0.5, -5 * cos(phi), 5 * sin(phi));
        check_close(pressure_at(&contact, -0.5, -5 * cos(behind), 5 * sin(behind)), 0, 0, 0);
    }
    assert_true(before[0] > 0);
    check_close(before[1] / before[0], 4, 0.05, 0);
    check_close(pressure_at(&contact, -0.5, -3, 4), pressure_at(&contact, -0.5, -3, -4), 0, 0);
}

/* Checks that the loads outside of two grids differ by the load between the edges of the grids, and
 * compares the derivative of the load with finite differences. */
static void counts_the_load_beyond(void **state) {
    (void)state;
    const double ellipticities[] = {0.5, 3, 1}, approach = -0.4, d = 1e-5;
    ehd_contact one;
    far_value load;
    for (size_t e = 0; e < 3; e++) {
        const double k = ellipticities[e], step = 0.0125;
        const ehd_contact other = ellipse_on(k, 10, 0, -6, 4, 7, 0.25, "open");
        double between = 0;

        one = ellipse_on(k, 10, 0, -4, 2, 3, 0.25, "open");
        // the cells of the inner nodes reach half a cell beyond the outermost inner lines
        const double across = grid_step_across(&one.grid);
        const double inside = grid_extent_of(&one.grid).y_max + across / 2;
        const double outside = grid_extent_of(&other.grid).y_max + across / 2;
        const size_t lines = (size_t)ceil(outside / step);
        const double width = outside / (double)lines;
        for (double x = -6.125 + step / 2; x < 4.125; x += step)
            for (size_t l = 0; l < lines; l++) {
                const double y = ((double)l + 0.5) * width;
                // fraction of a strip that lies outside of the cells of the smaller grid
                const double share = fmin(fmax((y + width / 2 - inside) / width, 0), 1);
                between += 2 * step * width * (x < -4.125 || x > 2.125 ? 1 : share) *
                           pressure_at(&one, approach, x, y);
            }
        load = far_field_load(&one, approach);
        check_close(load.value - far_field_load(&other, approach).value, between, 1e-3, 0);
        check_close(
            load.by_approach,
            (far_field_load(&one, approach + d).value - far_field_load(&one, approach - d).value) /
                (2 * d),
            1e-6, 0);
    }
    const far_value there = far_field_pressure(&one, approach, -3, 2);
    check_close(there.by_approach,
                (pressure_at(&one, approach + d, -3, 2) - pressure_at(&one, approach - d, -3, 2)) /
                    (2 * d),
                1e-6, 0);

    // at this approach the linear closure equals the load balance and has the same slope
    arena memory = {0};
    far_field prepared;
    far_field_init(&prepared, &one.grid, NULL, one.grid.num_nodes, &memory);
    const contact_closure closure = far_field_closure(&prepared, &one, approach);
    const double carried = 2.0;
    check_close(closure.by_load * carried + closure.by_approach * approach - closure.value,
                carried + load.value - one.closure.value, 1e-12, 1e-12);
    check_close(closure.by_approach, load.by_approach, 1e-12, 0);
    arena_free(&memory);
}

/* Only boundary nodes get the far field and its derivative, for either direction of speed. */
static void is_added_at_the_boundary_nodes(void **state) {
    (void)state;
    for (int i = 0; i < 8; i++) {
        const bool open = i / 2 % 2 == 0;
        ehd_contact contact =
            ellipse_on(i < 4 ? 1 : 0.6, 10, 0, -4, 2, 3, 0.25, open ? "open" : "zero");
        const ehd_grid *grid = &contact.grid;
        double *pressure = calloc(grid->num_nodes, sizeof *pressure);
        arena memory = {0};
        far_field field;

        assert_non_null(pressure);
        if (i % 2) contact.far_speed = -0.7;
        far_field_init(&field, grid, NULL, grid->num_nodes, &memory);
        far_field_add(pressure, &field, &contact, 0.2);
        for (size_t k = 0; k < grid->num_nodes; k++) {
            const size_t column = k % grid_width(grid);
            const bool outer = column == 0 || column + 1 == grid_width(grid) ||
                               k / grid_width(grid) + 1 == grid_lines(grid);
            const far_value there =
                far_field_pressure(&contact, 0.2, grid_x(grid, k), grid_y(grid, k));
            check_close(pressure[k], outer && open ? there.value : 0, 1e-13, 0);
            check_close(field.by_approach[k], outer && open ? there.by_approach : 0, 1e-13, 0);
        }
        arena_free(&memory);
        free(pressure);
    }
}

/* Lines, a boundary of zero pressure and contacts at rest have no far field. If the speed is
 * negative, the far field is mirrored. */
static void where_it_is(void **state) {
    (void)state;
    const ehd_contact line = sample_contact("barus", "incompressible", 10, 0, 0.05);
    const ehd_contact zero = contact_on(10, 0, -4, 2, 3, 0.25, "zero");
    ehd_contact open = contact_on(10, 0, -4, 2, 3, 0.25, "open");
    ehd_contact mirrored = contact_on(10, 0, -2, 4, 3, 0.25, "open");

    check_close(far_field_load(&line, 0).value, 0, 0, 0);
    check_close(far_field_load(&zero, 0).value, 0, 0, 0);
    mirrored.far_speed = -1;
    check_close(far_field_load(&mirrored, 0.3).value, far_field_load(&open, 0.3).value, 1e-14, 0);
    check_close(pressure_at(&mirrored, 0.3, 4, 1), pressure_at(&open, 0.3, -4, 1), 1e-14, 0);
    open.far_speed = 0;
    check_close(far_field_load(&open, 0.3).value, 0, 0, 0);
    check_close(pressure_at(&open, 0.3, -4, 1), 0, 0, 0);
}

static contact_scalars films_of(const ehd_contact *contact) {
    const full_settings settings = full_default_settings();
    problem found;

    problem_solve_cold(&found, contact, &settings);
    const contact_scalars scalars = full_evaluate_scalars(&found.state, contact);
    assert_true(found.info.newton_iterations < 12);
    problem_free(&found);
    return scalars;
}

/* With a far field, a domain that begins at X = -4 is as accurate as a domain that begins at
 * X = -16. With zero pressure around the grid, the films of both domains differ. */
static void short_domains_are_as_good_as_long_ones(void **state) {
    (void)state;
    static const double points[][4] = {{5, 0, 1, 3},     {10, 0, 1, 3},     {10, 5, 1, 3},
                                       {20, 5, 1, 3},    {20, 5, 0.5, 3.5}, {20, 0, 1.5, 2.75},
                                       {20, 5, 3, 2.375}};
    double differences = 0;

    for (size_t i = 0; i < sizeof points / sizeof *points; i++) {
        const double M = points[i][0], L = points[i][1];
        const double k = points[i][2], sides = points[i][3];
        const ehd_contact near = ellipse_on(k, M, L, -4, 2, sides, 0.125, "open");
        const ehd_contact far = ellipse_on(k, M, L, -16, 6, 4 * sides, 0.125, "open");
        const ehd_contact without = ellipse_on(k, M, L, -4, 2, sides, 0.125, "zero");
        const contact_scalars expected = films_of(&far), found = films_of(&near);
        check_close(found.central_film_thickness, expected.central_film_thickness, 1e-3, 0);
        check_close(found.minimum_film_thickness, expected.minimum_film_thickness, 1e-3, 0);
        check_close(found.load, 1, 1e-9, 0);
        differences +=
            fabs(films_of(&without).central_film_thickness / expected.central_film_thickness - 1);
    }
    assert_true(differences > 0.15);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(solves_the_reynolds_equation),
        cmocka_unit_test(ends_at_the_exit),
        cmocka_unit_test(counts_the_load_beyond),
        cmocka_unit_test(is_added_at_the_boundary_nodes),
        cmocka_unit_test(where_it_is),
        cmocka_unit_test(short_domains_are_as_good_as_long_ones),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
