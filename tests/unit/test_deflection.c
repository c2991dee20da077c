/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compares the deflection of line and point contacts with integrals, with a direct sum, and with
 * the solution of Hertz. */
#include "common/physics/deflection.h"
#include "tests/unit/allocation.h"
#include "tests/unit/check.h"
#include "tests/unit/random.h"
#include "tests/unit/sample.h"

#include <gsl/gsl_integration.h>
#include <math.h>
#include <stdlib.h>

static ehd_contact line_contact(double step) {
    return sample_published(sample_contact("barus", "incompressible", 10, 5, step));
}

static ehd_contact point_contact(size_t cells, bool half) {
    return sample_published(sample_point("barus", "incompressible", 20, 5, cells, half));
}

// ---- kernels

/* Returns the influence of a line load at a distance x. */
static double line_influence(double x, void *parameters) {
    (void)parameters;
    return -log(x * x) / (2 * M_PI);
}

/* Returns the integral of 1/r along x over a cell, at the distance y. integral_over_cell then
 * integrates over y. */
static double strip(double y, void *parameters) {
    const double *ends = parameters;
    return 2 / (M_PI * M_PI) * (asinh(ends[1] / fabs(y)) - asinh(ends[0] / fabs(y)));
}

/* Integrates an influence, which may be singular at zero, over the cell around `centre`. */
static double integral_over_cell(const gsl_function *influence, double centre, double step) {
    gsl_integration_workspace *workspace = gsl_integration_workspace_alloc(500);
    const double begin = centre - step / 2, end = centre + step / 2;
    const double places[] = {begin, fmin(fmax(0, begin), end), end};
    double sum = 0, part, estimate;

    assert_non_null(workspace);
    for (int i = 0; i < 2; i++) {
        if (places[i + 1] <= places[i]) continue;
        gsl_integration_qags(influence, places[i], places[i + 1], 1e-15, 1e-12, 500, workspace,
                             &part, &estimate);
        sum += part;
    }
    gsl_integration_workspace_free(workspace);
    return sum;
}

static void line_kernel_is_the_integral_over_a_cell(void **state) {
    (void)state;
    const double step = 0.05;
    const ehd_contact contact = line_contact(step);
    const gsl_function influence = {line_influence, NULL};
    ehd_deflection *deflection = deflection_create(contact.kind, &contact.grid);

    assert_non_null(deflection);
    for (size_t d = 0; d < contact.grid.num_nodes; d++)
        check_close(deflection_kernel(deflection)[d],
                    integral_over_cell(&influence, (double)d * step, step), 1e-10, 1e-15);
    deflection_free(deflection);
}

static void point_kernel_is_the_integral_over_a_cell(void **state) {
    (void)state;
    const double step = 0.05;
    static const double places[][2] = {{0, 0}, {1, 0},  {0, 1},  {1, 1},    {3, 2},
                                       {2, 3}, {39, 8}, {40, 7}, {30, -28}, {-3, 90}};

    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        double x = places[i][0] * step, y = places[i][1] * step;
        double ends[2] = {x - step / 2, x + step / 2};
        const gsl_function influence = {strip, ends};
        check_close(contact_point.kernel(&shape_round, x, y, step),
                    integral_over_cell(&influence, y, step), 2e-12, 0);
    }
    // a square cell at its own centre: 8 triangles of (step/2) asinh(1)
    check_close(contact_point.kernel(&shape_round, 0, 0, step), 8 / (M_PI * M_PI) * step * asinh(1),
                1e-14, 0);
    // a cell far away acts like a point load
    check_close(contact_point.kernel(&shape_round, 4, 3, step), 2 / (M_PI * M_PI) * step * step / 5,
                1e-5, 0);
}

// ---- the convolution

/* Compares the deflection with the direct sum. The random pressures are equal in every run. */
static void check_against_direct_sum(const ehd_contact *contact, double tolerance) {
    const ehd_grid *grid = &contact->grid;
    size_t n = grid->num_nodes;
    ehd_deflection *deflection = deflection_create(contact->kind, grid);
    double *pressure = calloc(3 * n, sizeof *pressure), largest = 0;
    uint64_t seed = 5;

    assert_true(deflection && pressure);
    double *delta = pressure + n, *direct = delta + n;
    for (size_t k = 0; k < n; k++) {
        pressure[k] = random_next(&seed);
    }
    for (size_t k = 0; k < n; k++) {
        for (size_t j = 0; j < n; j++) {
            double x = grid_x(grid, k) - grid_x(grid, j), y = grid_y(grid, j);
            direct[k] +=
                pressure[j] * deflection_influence(contact->kind, grid, x, grid_y(grid, k) - y);
            if (grid->half && y > 0) // adds the mirror image of this cell
                direct[k] +=
                    pressure[j] * deflection_influence(contact->kind, grid, x, grid_y(grid, k) + y);
        }
        largest = fmax(largest, fabs(direct[k]));
    }
    deflection_apply(delta, deflection, pressure);
    check_close_array(delta, direct, n, 0, tolerance * largest);
    deflection_apply(pressure, deflection, pressure); // result and pressure in the same array
    check_close_array(pressure, delta, n, 0, 0);
    free(pressure);
    deflection_free(deflection);
}

static void fft_equals_direct_sum(void **state) {
    (void)state;
    ehd_contact lines[] = {line_contact(0.1), line_contact(0.04), line_contact(0.01)};
    ehd_contact points[] = {point_contact(16, false), point_contact(16, true),
                            point_contact(26, false), point_contact(38, true)};

    lines[1].grid.discretization = DISCRETIZATION_ACCURATE;
    points[1].grid.discretization = DISCRETIZATION_ACCURATE;
    points[2].grid.discretization = DISCRETIZATION_ACCURATE;
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++)
        check_against_direct_sum(&lines[i], 1e-13);
    for (size_t i = 0; i < sizeof points / sizeof *points; i++)
        check_against_direct_sum(&points[i], 1e-12);
}

// ---- the pressure of Hertz

/* Returns the deflection [num_nodes] under the pressure sqrt(1 - r^2); r^2 is twice the gap. */
static double *hertz_deflection(const ehd_contact *contact) {
    const ehd_grid *grid = &contact->grid;
    ehd_deflection *deflection = deflection_create(contact->kind, grid);
    double *values = calloc(grid->num_nodes, sizeof *values);

    assert_true(deflection && values);
    for (size_t k = 0; k < grid->num_nodes; k++)
        values[k] = sqrt(fmax(0, 1 - 2 * grid_gap(grid, k)));
    deflection_apply(values, deflection, values);
    deflection_free(deflection);
    return values;
}

/* Returns the film's largest deviation from the film of the dry contact: zero inside,
 * (|X| sqrt(X^2-1) - ln(|X| + sqrt(X^2-1)))/2 outside, with Delta(0) = 1/4 + ln(2)/2. */
static double line_deviation(double step) {
    const ehd_contact contact = line_contact(step);
    double *values = hertz_deflection(&contact), worst = 0;

    for (size_t k = 0; k < contact.grid.num_nodes; k++) {
        double x = fabs(grid_x(&contact.grid, k)), root = x > 1 ? sqrt(x * x - 1) : 0;
        double exact = x > 1 ? (x * root - log(x + root)) / 2 : 0;
        double film = values[k] + contact_gap(&shape_round, x, 0) - (0.25 + M_LN2 / 2);
        worst = fmax(worst, fabs(film - exact));
    }
    free(values);
    return worst;
}

static void hertz_pressure_deflects_a_line_as_hertz(void **state) {
    (void)state;
    double coarse = line_deviation(0.02), fine = line_deviation(0.01),
           finest = line_deviation(0.005);
    assert_true(finest < 2.5e-4);
    // the square root of the pressure at the ends causes an error of h^1.5 ln h
    assert_true(coarse / fine > 2.2 && coarse / fine < 3);
    assert_true(fine / finest > 2.2 && fine / finest < 3);
}

/* Returns the largest deviation of the deflection from Delta = 1 - r^2/2 inside and ((2 - r^2)
 * asin(1/r) + sqrt(r^2 - 1))/pi outside. */
static double point_deviation(size_t cells, bool half) {
    const ehd_contact contact = point_contact(cells, half);
    double *values = hertz_deflection(&contact), worst = 0;

    for (size_t k = 0; k < contact.grid.num_nodes; k++) {
        double r2 = 2 * grid_gap(&contact.grid, k), exact = 1 - r2 / 2;
        if (r2 > 1) exact = ((2 - r2) * asin(1 / sqrt(r2)) + sqrt(r2 - 1)) / M_PI;
        worst = fmax(worst, fabs(values[k] - exact));
    }
    free(values);
    return worst;
}

static void hertz_pressure_deflects_a_point_as_hertz(void **state) {
    (void)state;
    double coarse = point_deviation(64, false), fine = point_deviation(256, false);
    // the steep edge cuts through cells, so the order is about one
    assert_true(coarse < 2.5e-3 && fine < coarse / 3.5);
    check_close(point_deviation(64, true), coarse, 1e-9, 0);
}

// ---- order of convergence, threads and faults

/* Returns the error of the central deflection under the pressure (1 - R^2)^3, whose integral is
 * known. */
static double error_of_smooth(ehd_contact contact, ehd_discretization discretization,
                              double expected) {
    contact.grid.discretization = discretization;
    const ehd_grid *grid = &contact.grid;
    ehd_deflection *deflection = deflection_create(contact.kind, grid);
    double *pressure = calloc(grid->num_nodes, sizeof *pressure), error = NAN;

    assert_true(deflection && pressure);
    for (size_t k = 0; k < grid->num_nodes; k++) {
        double rest = 1 - 2 * grid_gap(grid, k);
        pressure[k] = rest > 0 ? rest * rest * rest : 0;
    }
    deflection_apply(pressure, deflection, pressure);
    for (size_t k = 0; k < grid->num_nodes; k++)
        if (grid_gap(grid, k) < 1e-12) error = fabs(pressure[k] - expected);
    free(pressure);
    deflection_free(deflection);
    return error;
}

static void order_of_the_deflection(void **state) {
    (void)state;
    // -1/pi int (1 - x^2)^3 ln|x| dx, and 2/pi^2 iint (1 - r^2)^3/r dx dy
    const double on_line = 2 / M_PI * (1 - 1. / 3 + 3. / 25 - 1. / 49);
    const double on_point = 4 / M_PI * 16 / 35;
    const struct {
        ehd_contact coarse, fine;
        double expected;
    } cases[] = {{line_contact(0.1), line_contact(0.05), on_line},
                 {point_contact(48, true), point_contact(96, true), on_point}};

    for (size_t i = 0; i < 2; i++) {
        double published =
            error_of_smooth(cases[i].coarse, DISCRETIZATION_PUBLISHED, cases[i].expected) /
            error_of_smooth(cases[i].fine, DISCRETIZATION_PUBLISHED, cases[i].expected);
        double accurate =
            error_of_smooth(cases[i].coarse, DISCRETIZATION_ACCURATE, cases[i].expected) /
            error_of_smooth(cases[i].fine, DISCRETIZATION_ACCURATE, cases[i].expected);
        assert_true(published > 3.5 && published < 4.5); // second order
        assert_true(accurate > 7);                       // third order
    }
}

/* On coarse and fine grids, any number of threads gives the same bits. */
static void threads_deflect_to_the_same_bits(void **state) {
    (void)state;
    for (size_t cells = 8; cells <= 128; cells *= 4)
        for (int half = 0; half < 2; half++) {
            const ehd_contact contact = point_contact(cells, half != 0);
            const size_t bytes = contact.grid.num_nodes * sizeof(double);
            ehd_deflection *alone = deflection_create(contact.kind, &contact.grid);
            double *pressure = malloc(bytes), *expected = malloc(bytes);

            assert_true(alone && pressure && expected);
            for (size_t k = 0; k < contact.grid.num_nodes; k++)
                pressure[k] = sin(0.1 * (double)(k % 997));
            deflection_apply(expected, alone, pressure);
            for (size_t members = 2; members <= 5; members += 3) {
                team *threads = team_create(members);
                ehd_deflection *shared =
                    deflection_create_shared(contact.kind, &contact.grid, threads);
                double *found = malloc(bytes);

                assert_true(threads && shared && found);
                assert_memory_equal(deflection_kernel(shared), deflection_kernel(alone), bytes);
                deflection_apply(found, shared, pressure);
                assert_memory_equal(found, expected, bytes);
                deflection_free(shared);
                team_free(threads);
                free(found);
            }
            deflection_free(alone);
            free(pressure);
            free(expected);
        }
}

static void deflection_without_memory(void **state) {
    (void)state;
    const struct {
        const contact_kind *kind;
        ehd_grid grid;
    } cases[] = {{&contact_line, grid_of(-1, 0.1, 21, 1, false, DISCRETIZATION_PUBLISHED)},
                 {&contact_point, grid_of(-1, 0.1, 21, 11, true, DISCRETIZATION_PUBLISHED)}};

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        ehd_deflection *deflection;
        size_t call = 0;
        bool failed;
        do {
            allocation_fail_at(call);
            deflection = deflection_create(cases[i].kind, &cases[i].grid);
            failed = allocation_failed();
            if (failed) assert_null(deflection);
        } while (failed && call++ < 100);
        assert_true(call >= 3 && call < 100);
        assert_non_null(deflection);
        deflection_free(deflection);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(line_kernel_is_the_integral_over_a_cell),
        cmocka_unit_test(point_kernel_is_the_integral_over_a_cell),
        cmocka_unit_test(fft_equals_direct_sum),
        cmocka_unit_test(hertz_pressure_deflects_a_line_as_hertz),
        cmocka_unit_test(hertz_pressure_deflects_a_point_as_hertz),
        cmocka_unit_test(order_of_the_deflection),
        cmocka_unit_test(threads_deflect_to_the_same_bits),
        cmocka_unit_test(deflection_without_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
