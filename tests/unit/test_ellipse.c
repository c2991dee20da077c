/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compares the shape of the elliptical contact with integrals and published formulas, its
 * parameters with the dimensional contact, and its gap under Hertz pressure with a constant. */
#include "common/physics/deflection.h"
#include "common/physics/grid_choice.h"
#include "common/physics/reynolds.h"
#include "tests/unit/check.h"
#include "tests/unit/sample.h"

#include <gsl/gsl_integration.h>
#include <gsl/gsl_mode.h>
#include <gsl/gsl_sf_ellint.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double ratios[] = {0.1, 0.5, 0.8, 1, 1.25, 2, 3, 8};
enum { NUM_RATIOS = sizeof ratios / sizeof *ratios };

// ---- the shape

/* along returns the integrand of A, and across the integrand of B, with t = s^2/(1 - s)^2
 * (common/physics/README.md). */
static double along(double s, void *parameters) {
    const double k2 = pow(*(double *)parameters, 2), root = s / (1 - s), t = root * root;
    return 2 / (pow(1 + t, 1.5) * sqrt(k2 + t)) / ((1 - s) * (1 - s));
}

static double across(double s, void *parameters) {
    const double k2 = pow(*(double *)parameters, 2), root = s / (1 - s), t = root * root;
    return 2 / (sqrt(1 + t) * pow(k2 + t, 1.5)) / ((1 - s) * (1 - s));
}

static double integral(double of(double, void *), double begin, double end, double parameter) {
    gsl_integration_workspace *workspace = gsl_integration_workspace_alloc(1000);
    const gsl_function function = {of, &parameter};
    double value, estimate;

    assert_non_null(workspace);
    gsl_integration_qags(&function, begin, end, 0, 1e-12, 1000, workspace, &value, &estimate);
    gsl_integration_workspace_free(workspace);
    return value;
}

static void shapes_are_those_of_the_integrals(void **state) {
    (void)state;
    for (int i = 0; i < NUM_RATIOS; i++) {
        const double k = ratios[i], A = integral(along, 0, 1, k), B = integral(across, 0, 1, k);
        const contact_shape shape = shape_of(k);
        check_close(shape.compliance, 2 * A / M_PI, 1e-11, 0);
        check_close(shape.gap_across, k * k * B / A, 1e-11, 0);
        check_close(shape.flow_across, 1 / (k * k), 1e-15, 0);
        check_close(shape.cell * shape.cell * shape.cell, 1 / k, 1e-14, 0);
        check_close(ellipse_radius_ratio(k), A / B, 1e-11, 0);
        check_close(ellipse_ellipticity(ellipse_radius_ratio(k)), k, 1e-13, 0);
    }
    // the shape of a circle is exact to the last bit, also if its ellipticity is computed from the
    // ratio of the radii
    const contact_shape circle = shape_of(ellipse_ellipticity(1));
    assert_memory_equal(&circle, &shape_round, sizeof circle);
}

/* Compares the semi-axes with Legendre's integrals, as in handbooks (A. P. Boresi, R. J. Schmidt,
 * Advanced Mechanics of Materials, contact stresses). k is the ratio of the minor to the major
 * semi-axis, e^2 = 1 - k^2, and the curvatures are 2 A < 2 B. Then A/B = (K - E)/(E/k^2 - K), and
 * the minor semi-axis is (2 k E/pi)^(1/3) (3 w/(2 E' (A + B)))^(1/3). */
static void semi_axes_are_those_of_handbooks(void **state) {
    (void)state;
    for (double k = 0.1; k < 0.99; k += 0.11) {
        const double e = sqrt(1 - k * k);
        const double K = gsl_sf_ellint_Kcomp(e, GSL_PREC_DOUBLE);
        const double E = gsl_sf_ellint_Ecomp(e, GSL_PREC_DOUBLE);
        const double ratio = (E / (k * k) - K) / (K - E); // ratio B/A of larger to smaller radius
        const double radius = 0.01, modulus = 2e11, load = 50;
        const double both = (1 + 1 / ratio) / (2 * radius);
        const double minor = cbrt(2 * k * E / M_PI) * cbrt(3 * load / (2 * modulus * both));
        check_close(ellipse_radius_ratio(1 / k), ratio, 1e-9, 0);
        const contact_shape wide = shape_of(ellipse_ellipticity(ratio));
        const contact_shape slim = shape_of(ellipse_ellipticity(1 / ratio));
        check_close(contact_ellipse.half_width(&wide, load, radius, modulus), minor, 1e-9, 0);
        check_close(contact_ellipse.half_width(&slim, load, radius * ratio, modulus), minor / k,
                    1e-9, 0);
    }
}

/* For moderate ellipses b/a is the ratio of the radii to the power 2/3 (J. A. Greenwood, J.
 * Tribology 107, 1985). */
static void ellipticity_of_moderate_ellipses(void **state) {
    (void)state;
    for (double k = 1; k <= 3; k += 0.25)
        check_close(pow(ellipse_radius_ratio(k), 2. / 3), k, 0.02, 0);
}

/* For b/a from 1 to 10 the formula of Hamrock and Brewe (J. Lubrication Technology 105, 1983)
 * deviates by less than 3.5 %. */
static void ellipticity_is_near_the_power_of_the_radii(void **state) {
    (void)state;
    for (double k = 1; k <= 10; k += 0.5)
        check_close(1.0339 * pow(ellipse_radius_ratio(k), 0.636), k, 0.035, 0);
}

// ---- the contact

static ehd_contact physical_contact(double radius, double radius_across) {
    scene given = sample_scene("barus", "incompressible", NAN, NAN);
    ehd_contact contact;

    snprintf(given.contact, sizeof given.contact, "ellipse");
    snprintf(given.boundary, sizeof given.boundary, "zero");
    given.physical = (physical_settings){.load = 100,
                                         .radius = radius,
                                         .radius_across = radius_across,
                                         .speed = 1,
                                         .modulus = 2.2e11,
                                         .viscosity = 0.04};
    assert_int_equal(scene_contact(&contact, &given, NULL), EHD_OK);
    return contact;
}

static void numbers_are_those_of_the_dimensional_contact(void **state) {
    (void)state;
    const double radii[][2] = {{0.01, 0.03}, {0.01, 0.01}, {0.02, 0.008}};

    for (size_t i = 0; i < 3; i++) {
        const double radius = radii[i][0], radius_across = radii[i][1];
        const ehd_contact contact = physical_contact(radius, radius_across);
        const contact_shape *shape = &contact.grid.shape;
        const double a = contact.half_width, b = contact_half_width_across(&contact);
        const double p_H = 1.5 * 100 / (M_PI * a * b);
        check_close(contact.hertz_pressure, p_H, 1e-12, 0);
        check_close(contact.lambda, 12 * 1 * 0.04 * radius * radius / (p_H * a * a * a), 1e-12, 0);
        check_close(contact.alpha_p_H, 2e-8 * p_H, 1e-12, 0);
        check_close(shape->gap_across, radius * b * b / (radius_across * a * a), 1e-12, 0);
        check_close(contact.kind->moes_M(shape, contact.lambda), contact.moes_M, 1e-12, 0);
        // the influence of a distant cell gives the deflection's factor 2 p_H b R_x/(pi E' a^2)
        check_close(contact.kind->kernel(shape, 80, 0, 0.1) / (0.01 * shape->cell / 80),
                    2 * p_H * b * radius / (M_PI * 2.2e11 * a * a), 1e-6, 0);
        // the same contact turned by 90 degrees: the semi-axes are exchanged
        const ehd_contact side = physical_contact(radius_across, radius);
        check_close(side.half_width, b, 1e-12, 0);
        check_close(contact_half_width_across(&side), a, 1e-12, 0);
        check_close(side.hertz_pressure, p_H, 1e-12, 0);
    }
}

static void moes_numbers_give_the_same_contact(void **state) {
    (void)state;
    const ehd_contact physical = physical_contact(0.01, 0.03);
    const double k = physical.grid.shape.ellipticity;
    scene given = sample_scene("barus", "incompressible", physical.moes_M, physical.moes_L);
    ehd_contact contact;

    snprintf(given.contact, sizeof given.contact, "ellipse");
    snprintf(given.boundary, sizeof given.boundary, "zero");
    given.ellipticity = k;
    assert_int_equal(scene_contact(&contact, &given, NULL), EHD_OK);
    check_close(contact.hertz_pressure, physical.hertz_pressure, 1e-12, 0);
    check_close(contact.lambda, physical.lambda, 1e-12, 0);
    assert_true(grid_same(&contact.grid, &physical.grid));
    contact.grid.shape = shape_of(k * (1 + 1e-5));
    assert_false(grid_same(&contact.grid, &physical.grid));
}

/* For ellipticity 1 the default grid is the grid of a point contact. For wide ellipses the sides of
 * the grid must lie nearer to the centre, in units of b. */
static void default_grid_knows_the_sides(void **state) {
    (void)state;
    static const double of[] = {0.5, 1, 2, 4, 9};
    ehd_contact contact = sample_point("barus", "incompressible", 20, 5, 8, true);

    contact.grid.boundary = BOUNDARY_ZERO;
    const double around = grid_extent_needed(&contact).y_max;
    contact.kind = &contact_ellipse;
    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        contact.grid.shape = shape_of(of[i]);
        contact_set_moes(&contact, 20 * pow(of[i], 3) * pow(contact.grid.shape.compliance, 2), 5);
        const grid_extent extent = grid_extent_needed(&contact);
        const double expected =
            of[i] > 1 ? fmax(1.5, 1 + (-0.75 * extent.x_min - 1) / of[i]) : -0.75 * extent.x_min;
        check_close(extent.y_max, expected, 1e-12, 0);
        if (of[i] == 1) check_close(extent.y_max, around, 0, 0);
    }
}

// ---- the kernel

/* Returns the integral of 1/r along x over a cell, at Y = y. integral_over_cell then integrates
 * over Y. */
static double strip(double y, void *parameters) {
    const double *cell = parameters; // ends of the cell, k
    return asinh(cell[1] / fabs(cell[2] * y)) - asinh(cell[0] / fabs(cell[2] * y));
}

static double integral_over_cell(double k, double x, double y, double step, double across) {
    gsl_integration_workspace *workspace = gsl_integration_workspace_alloc(1000);
    double cell[] = {x - step / 2, x + step / 2, k}, sum = 0, part, estimate;
    const gsl_function function = {strip, cell};
    const double low = y - across / 2, high = y + across / 2;
    const double ends[] = {low, fmin(fmax(0, low), high), high};

    assert_non_null(workspace);
    for (int i = 0; i < 2; i++) {
        if (ends[i + 1] <= ends[i]) continue;
        gsl_integration_qags(&function, ends[i], ends[i + 1], 1e-15, 1e-12, 1000, workspace, &part,
                             &estimate);
        sum += part;
    }
    gsl_integration_workspace_free(workspace);
    return sum;
}

static void kernel_is_the_integral_over_a_cell(void **state) {
    (void)state;
    static const double places[][2] = {{0, 0},  {1, 0},   {0, 1},   {3, 2},
                                       {39, 8}, {70, 90}, {3, 400}, {-400, 7}};
    const double step = 0.05;

    for (int r = 0; r < NUM_RATIOS; r++)
        for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
            const contact_shape shape = shape_of(ratios[r]);
            const double x = places[i][0] * step, y = places[i][1] * step;
            check_close(contact_ellipse.kernel(&shape, x, y, step),
                        integral_over_cell(ratios[r], x, y, step, shape.cell * step) * 2 /
                            (M_PI * M_PI) / shape.compliance,
                        4e-12, 0);
        }
}

// ---- the pressure of Hertz

static ehd_contact ellipse_on(double k, size_t cells) {
    ehd_contact contact =
        sample_published(sample_point("barus", "incompressible", 20, 5, cells, true));

    contact.kind = &contact_ellipse;
    contact.grid.shape = shape_of(k);
    return contact;
}

/* Computes the largest deviations of gap plus deflection. `inside`: from the value at the centre,
 * inside the ellipse. `outside`: from the dry gap, outside the ellipse on Y = 0. */
static void deviations_under_hertz(double *inside, double *outside, double k, size_t cells) {
    const ehd_contact contact = ellipse_on(k, cells);
    const ehd_grid *grid = &contact.grid;
    ehd_deflection *deflection = deflection_create(contact.kind, grid);
    double *film = calloc(grid->num_nodes, sizeof *film);

    assert_true(deflection && film);
    for (size_t i = 0; i < grid->num_nodes; i++)
        film[i] = sqrt(fmax(0, 1 - grid_square_distance(grid, i)));
    deflection_apply(film, deflection, film);
    *inside = *outside = 0;
    double approach = NAN;
    for (size_t i = 0; i < grid->num_nodes; i++) {
        film[i] += grid_gap(grid, i);
        if (grid_square_distance(grid, i) < 1e-12) approach = film[i];
    }
    for (size_t i = 0; i < grid->num_nodes; i++) {
        const double r2 = grid_square_distance(grid, i), x = grid_x(grid, i);
        const bool on_axis = grid_y(grid, i) < 1e-12;
        if (r2 <= 1) *inside = fmax(*inside, fabs(film[i] - approach));
        if (r2 > 1 && on_axis)
            *outside = fmax(
                *outside, fabs(film[i] - approach - contact.kind->dry_gap(&grid->shape, fabs(x))));
    }
    free(film);
    deflection_free(deflection);
}

static void hertz_pressure_leaves_the_gap_constant(void **state) {
    (void)state;
    static const double of[] = {0.5, 1, 2, 3};

    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        double coarse[2], fine[2];
        deviations_under_hertz(&coarse[0], &coarse[1], of[i], 64);
        deviations_under_hertz(&fine[0], &fine[1], of[i], 256);
        // the steep edge cuts through cells, so the order is about one
        for (int part = 0; part < 2; part++)
            assert_true(coarse[part] < 6e-3 && fine[part] < coarse[part] / 3.5);
    }
}

static void dry_gap_opens_from_the_edge(void **state) {
    (void)state;
    for (int r = 0; r < NUM_RATIOS; r++) {
        const contact_shape shape = shape_of(ratios[r]);
        check_close(contact_ellipse.dry_gap(&shape, -1), 0, 0, 1e-14);
        check_close(contact_ellipse.dry_gap(&shape, 1000), 5e5, 1e-4, 0);
    }
    // for a circle the general integral equals the closed form of a point contact
    for (double x = 1.01; x < 20; x *= 1.5)
        check_close(ellipse_dry_gap(&shape_round, x), contact_point.dry_gap(&shape_round, x), 1e-9,
                    1e-14);
}

// ---- the rows

/* With ellipticity b/a, the flow across has the factor (a/b)^2 and uses the grid step across. */
static void flow_across_has_its_factor(void **state) {
    (void)state;
    const double k = 2.5;

    for (int accurate = 0; accurate < 2; accurate++) {
        ehd_contact contact = ellipse_on(1, 8);
        ehd_grid *grid = &contact.grid;
        grid->discretization = accurate ? DISCRETIZATION_ACCURATE : DISCRETIZATION_PUBLISHED;
        const size_t n = grid->num_nodes;
        double *memory = calloc((NUM_FLUID_ARRAYS + 2) * n, sizeof *memory);
        assert_non_null(memory);
        double *pressure = memory + NUM_FLUID_ARRAYS * n, *film = pressure + n;
        reynolds_fluid fluid = reynolds_fluid_in(memory, n, &contact);
        // residuals without flow across, with the flow across of the circle, and of the ellipse
        double cell = NAN, residual[3];
        const size_t node = grid_node_of_row(grid, grid->inner_x * 2 + 3);
        reynolds_stencil stencil = reynolds_stencil_at(grid, node);
        reynolds_row row;
        for (size_t i = 0; i < n; i++) {
            pressure[i] = 0.3 + 0.1 * sin(1.3 * (double)i);
            film[i] = 0.4 + 0.1 * cos(0.7 * (double)i);
        }
        reynolds_fluid_evaluate(&fluid, &contact, pressure, n);
        for (int i = 0; i < 3; i++) {
            grid->shape = i < 2 ? shape_round : shape_of(k);
            grid->shape.flow_across *= i > 0;
            cell = grid->shape.cell;
            reynolds_rows(&row, grid, 1, NULL, &stencil, 1, &fluid, pressure, film);
            residual[i] = row.residual;
        }
        check_close(residual[2] - residual[0], (residual[1] - residual[0]) / pow(k * cell, 2),
                    1e-11, 0);
        assert_true(fabs(residual[1] - residual[0]) > 1e-3 * fabs(residual[0]));
        free(memory);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shapes_are_those_of_the_integrals),
        cmocka_unit_test(semi_axes_are_those_of_handbooks),
        cmocka_unit_test(ellipticity_of_moderate_ellipses),
        cmocka_unit_test(ellipticity_is_near_the_power_of_the_radii),
        cmocka_unit_test(numbers_are_those_of_the_dimensional_contact),
        cmocka_unit_test(moes_numbers_give_the_same_contact),
        cmocka_unit_test(default_grid_knows_the_sides),
        cmocka_unit_test(kernel_is_the_integral_over_a_cell),
        cmocka_unit_test(hertz_pressure_leaves_the_gap_constant),
        cmocka_unit_test(dry_gap_opens_from_the_edge),
        cmocka_unit_test(flow_across_has_its_factor),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
