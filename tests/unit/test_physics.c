/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/contact.h"
#include "common/physics/reynolds.h"
#include "tests/unit/check.h"
#include "tests/unit/sample.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const lubricants[] = {"barus", "roelands", "no1", "no2", "no3"};
static const char *const densities[] = {"incompressible", "dowson-higginson"};
enum { NUM_LUBRICANTS = 5, NUM_DENSITIES = 2 };

static ehd_lubricant sample_lubricant(const char *name) {
    return sample_contact(name, "dowson-higginson", 10, 5, 0.1).lubricant;
}

static double log_viscosity(const ehd_lubricant *lubricant, double pressure) {
    double slope;
    return lubricant->viscosity->evaluate(lubricant, pressure, &slope);
}

// ---- lubricants

static void viscosity_derivative(void **state) {
    (void)state;
    for (int l = 0; l < NUM_LUBRICANTS; l++) {
        ehd_lubricant lubricant = sample_lubricant(lubricants[l]);
        for (double p = 1e7; p < fmin(4.6e9, lubricant.pressure_limit); p *= 1.3) {
            double h = 1e-3 * p, slope;
            // fourth order
            double difference =
                (8 * (log_viscosity(&lubricant, p + h) - log_viscosity(&lubricant, p - h)) -
                 (log_viscosity(&lubricant, p + 2 * h) - log_viscosity(&lubricant, p - 2 * h))) /
                (12 * h);
            lubricant.viscosity->evaluate(&lubricant, p, &slope);
            check_close(slope, difference, 1e-8, 0);
        }
    }
}

static void density_derivative(void **state) {
    (void)state;
    const ehd_lubricant lubricant = sample_lubricant("barus");
    for (double p = 1e7; p < 5e9; p *= 1.3) {
        double h = 1e-4 * p, slope;
        double difference =
            (lubricant_density(&lubricant, p + h) - lubricant_density(&lubricant, p - h)) / (2 * h);
        lubricant.density->evaluate(&lubricant, p, &slope);
        check_close(slope, difference, 1e-6, 0);
    }
}

static void density_values(void **state) {
    (void)state;
    const ehd_lubricant lubricant = sample_lubricant("barus");
    check_close(lubricant_density(&lubricant, 0), 1, 0, 0);
    check_close(lubricant_density(&lubricant, -1e9), 1, 0, 0);
    check_close(lubricant_density(&lubricant, 5.9e8), 1.17, 1e-15, 0);
    check_close(lubricant_density(&lubricant, 1e30), 1.34, 1e-15, 0);
}

static void viscosity_values(void **state) {
    (void)state;
    // ln of eta(1 GPa)/eta(0), worked out apart from this code from their formulas
    static const double at_giga[] = {20, 12.909806659521264, 13.328407194322661, 9.51454678656911,
                                     10.96611946095047};
    for (int l = 0; l < NUM_LUBRICANTS; l++) {
        ehd_lubricant lubricant = sample_lubricant(lubricants[l]);
        check_close(log_viscosity(&lubricant, 1e9), at_giga[l], 1e-12, 0);
        check_close(log_viscosity(&lubricant, 0), 0, 0, 1e-14);
    }
}

static void barus_is_exact(void **state) {
    (void)state;
    ehd_lubricant lubricant = sample_lubricant("barus");
    for (double p = 0; p < 3e10; p += 1.7e8)
        check_close(log_viscosity(&lubricant, p), 2e-8 * p, 1e-15, 0);
    check_close(lubricant.alpha, 2e-8, 0, 0);
    assert_true(isnan(lubricant.eta0));
    assert_true(lubricant.pressure_limit > 1e12);
}

static void roelands_slope_at_zero(void **state) {
    (void)state;
    ehd_lubricant lubricant = sample_lubricant("roelands");
    double slope;
    lubricant.viscosity->evaluate(&lubricant, 0, &slope);
    check_close(slope, 2e-8, 1e-14, 0);
    check_close(lubricant.alpha, 2e-8, 0, 0);
    check_close(lubricant.eta0, 0.04, 0, 0);
}

static void wlf_coefficients_and_limits(void **state) {
    (void)state;
    static const double alpha[] = {23.60e-9, 12.51e-9, 18.05e-9};
    static const double limit[] = {11.5e9, 5.0e9, 4.76e9};
    static const double eta0[] = {0.028282476174235197, 0.0016537118365797577, 0.20208749448341043};
    for (int l = 0; l < 3; l++) {
        ehd_lubricant lubricant = sample_lubricant(lubricants[2 + l]);
        check_close(lubricant.alpha, alpha[l], 0, 0.0051e-9);
        check_close(lubricant.pressure_limit, limit[l], 0, 0.05e9);
        check_close(lubricant.eta0, eta0[l], 1e-12, 0);
    }
}

/* Below its limit a law rises with a finite slope; beyond, it is the value at the limit that counts. */
static void viscosity_rises_to_its_limit(void **state) {
    (void)state;
    for (int l = 2; l < NUM_LUBRICANTS; l++) {
        ehd_lubricant lubricant = sample_lubricant(lubricants[l]);
        double limit = lubricant.pressure_limit, last = -1, slope;
        for (int i = 0; i <= 1000; i++) {
            double here = lubricant.viscosity->evaluate(&lubricant, i * limit / 1000, &slope);
            assert_true(here > last && isfinite(here) && slope >= 0);
            last = here;
        }
        double pressure[] = {limit / 1e9, 2 * limit / 1e9}, log_eta[2], by_p[2], rho[2],
               rho_by_p[2];
        lubricant_evaluate(log_eta, by_p, rho, rho_by_p, &lubricant, 1e9, pressure, 2);
        check_close(log_eta[1], log_eta[0], 1e-12, 0);
    }
}

static void negative_pressure_counts_as_zero(void **state) {
    (void)state;
    for (int l = 0; l < NUM_LUBRICANTS; l++) {
        ehd_lubricant lubricant = sample_lubricant(lubricants[l]);
        double pressure[] = {-0.01, 0}, log_eta[2], by_p[2], rho[2], rho_by_p[2];
        lubricant_evaluate(log_eta, by_p, rho, rho_by_p, &lubricant, 1e9, pressure, 2);
        check_close(log_eta[0], log_eta[1], 0, 0);
        check_close(by_p[0], by_p[1], 0, 0);
        check_close(rho[0], 1, 0, 0);
        check_close(rho_by_p[0], rho_by_p[1], 0, 0);
    }
}

static void bad_lubricants_are_refused(void **state) {
    (void)state;
    static const struct {
        const char *lubricant;
        const char *key; // of the constant that is spoilt
        double value;
        const char *text; // of the error, in part
    } cases[] = {
        {"barus", "alpha", NAN, "alpha"},  {"barus", "alpha", -1e-8, "alpha"},
        {"roelands", "alpha", 0, "alpha"}, {"roelands", "eta0", 1e-5, "eta0"},
        {"roelands", "eta0", NAN, "eta0"}, {"no1", "temperature", -95, "glass transition"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        lubricant_settings settings =
            sample_scene(cases[i].lubricant, "incompressible", 10, 5).lubricant;
        ehd_lubricant lubricant;
        ehd_error error = {0};
        settings.viscosity.values[laws_slot(viscosity_laws, cases[i].key)].number = cases[i].value;
        assert_int_equal(lubricant_init(&lubricant, &settings, &error), EHD_DATA);
        assert_non_null(strstr(error.text, cases[i].text));
    }
}

static void unknown_laws_are_refused(void **state) {
    (void)state;
    lubricant_settings good = sample_scene("no1", "incompressible", 10, 5).lubricant, bad;
    ehd_lubricant lubricant;
    bad = good;
    strcpy(bad.viscosity.law, "eyring");
    assert_int_equal(lubricant_init(&lubricant, &bad, NULL), EHD_DATA);
    bad = good;
    strcpy(bad.viscosity.values[laws_slot(viscosity_laws, "preset")].word, "no4");
    assert_int_equal(lubricant_init(&lubricant, &bad, NULL), EHD_DATA);
    bad = good;
    strcpy(bad.density.law, "tait");
    assert_int_equal(lubricant_init(&lubricant, &bad, NULL), EHD_DATA);
    assert_int_equal(lubricant_init(&lubricant, &good, NULL), EHD_OK);
}

// ---- contact

static void physical_scene(void **state) {
    (void)state;
    scene given = sample_scene("barus", "incompressible", NAN, NAN);
    ehd_contact contact;
    given.physical.load = 2e5;
    given.physical.radius = 0.01;
    given.physical.speed = 1;
    given.physical.modulus = 2.2e11;
    given.physical.viscosity = 0.01;
    assert_int_equal(scene_contact(&contact, &given, NULL), EHD_OK);
    // by hand: U = 0.01 2 / (2.2e11 0.01), W = 2e5 / (2.2e11 0.01), a^2 = 8 2e5 0.01 / (pi 2.2e11)
    check_close(contact.moes_M, 30.15113445777636, 1e-13, 0);
    check_close(contact.moes_L, 7.6401960910866045, 1e-13, 0);
    check_close(contact.half_width, 1.5215061585243644e-4, 1e-13, 0);
    check_close(contact.hertz_pressure, 836828387.1884005, 1e-13, 0);
    check_close(contact.alpha_p_H, 16.73656774376801, 1e-13, 0);
    // lambda = 12 u eta0 R^2 / (p_H a^3)
    check_close(contact.lambda, 0.004071211815449362, 1e-13, 0);
    check_close(contact_film_scale(&contact), 2.3149809904275684e-6, 1e-13, 0);
    check_close(contact.load, 2e5, 0, 0);
}

static void contradictory_viscosity_is_refused(void **state) {
    (void)state;
    scene given = sample_scene("roelands", "incompressible", NAN, NAN);
    ehd_contact contact;
    ehd_error error;
    given.physical.load = 2e5;
    given.physical.radius = 0.01;
    given.physical.speed = 1;
    given.physical.modulus = 2.2e11;
    given.physical.viscosity = 0.0398; // the law says 0.04
    assert_int_equal(scene_contact(&contact, &given, NULL), EHD_OK);
    given.physical.viscosity = 0.039;
    assert_int_equal(scene_contact(&contact, &given, &error), EHD_DATA);
    assert_non_null(strstr(error.text, "physical.viscosity: found 0.039, expected 0.04"));
}

static void moes_numbers(void **state) {
    (void)state;
    ehd_contact contact = sample_contact("barus", "incompressible", 8 * M_PI, 7, 0.1);
    check_close(contact.alpha_p_H, 14, 1e-14, 0); // 7 sqrt(8 pi / 2 pi)
    check_close(contact.hertz_pressure, 14 / 2e-8, 1e-14, 0);
    check_close(contact.lambda, 3. / 512, 1e-14, 0); // 3 pi^2 / (8 64 pi^2)
    assert_true(isnan(contact.half_width) && isnan(contact.radius) && isnan(contact.load));
    contact_set_moes(&contact, 2 * M_PI, 3);
    check_close(contact.alpha_p_H, 3, 1e-14, 0);
    check_close(contact.hertz_pressure, 3 / 2e-8, 1e-14, 0);
    check_close(contact.lambda, 3. / 32, 1e-14, 0);
}

static void given_hertz_pressure_wins(void **state) {
    (void)state;
    scene given = sample_scene("barus", "incompressible", 12, 12);
    ehd_contact contact;
    given.hertz_pressure = 0.7e9;
    assert_int_equal(scene_contact(&contact, &given, NULL), EHD_OK);
    check_close(contact.hertz_pressure, 0.7e9, 0, 0);
    check_close(contact.alpha_p_H, 14, 1e-15, 0);
    check_close(contact.moes_L, 12, 0, 0);
    check_close(contact.lambda, 3 * M_PI * M_PI / (8 * 144), 1e-15, 0);
}

static void pressure_beyond_the_law_is_refused(void **state) {
    (void)state;
    scene given = sample_scene("no3", "incompressible", 100, 5);
    ehd_contact contact;
    ehd_error error;
    given.hertz_pressure = 4.7e9;
    assert_int_equal(scene_contact(&contact, &given, NULL), EHD_OK);
    given.hertz_pressure = 4.8e9;
    assert_int_equal(scene_contact(&contact, &given, &error), EHD_DATA);
    assert_non_null(strstr(error.text, "hertz_pressure: found 4.8 GPa"));
    given.hertz_pressure = NAN;
    given.moes.L = 50;
    assert_int_equal(scene_contact(&contact, &given, NULL), EHD_DATA);
}

static void isoviscous_contact(void **state) {
    (void)state;
    for (int l = 0; l < NUM_LUBRICANTS; l++) {
        ehd_contact contact = sample_contact(lubricants[l], "dowson-higginson", 10, 0, 0.1);
        double mobility[3], slope[3], density[3], density_slope[3];
        reynolds_fluid fluid = {mobility, slope, density, density_slope};
        check_close(contact.hertz_pressure, 0, 0, 0);
        check_close(contact.alpha_p_H, 0, 0, 0);
        reynolds_fluid_evaluate(&fluid, &contact, (double[]){0, 0.5, 1}, 3);
        for (int i = 0; i < 3; i++) {
            check_close(mobility[i], 1 / contact.lambda, 1e-13, 0);
            check_close(slope[i], 0, 0, 0);
            check_close(density[i], 1, 0, 0);
        }
    }
}

static void grid_nodes(void **state) {
    (void)state;
    ehd_contact contact = sample_contact("barus", "incompressible", 10, 5, 0.005);
    assert_int_equal(contact.grid.num_inner, 1201);
    assert_int_equal(contact.grid.num_nodes, 1203);
    check_close(grid_x(&contact.grid, 0), -4.005, 1e-15, 0);
    check_close(grid_x(&contact.grid, 1), -4, 0, 0);
    check_close(grid_x(&contact.grid, 1201), 2, 1e-14, 0);
}

/* Three lines of a half, y = 0 first, and the boundary line: one that ends amid, one with none in between and a value
 * that is no pressure behind, one with none; on the whole grid the other half is mirrored. */
static void exits_of_a_pressure(void **state) {
    (void)state;
    const ehd_grid grid = grid_of(-1, 0.5, 4, 3, true);
    const double pressure[4][6] = {{0, 1, 2, 3, 0, 0}, {0, 1, 0, 1, -1e-9, 0}};
    const size_t expected[] = {4, 4, 1, 1};
    const double positions[] = {NAN, 0.5, 0.5, 0.5, NAN};
    size_t columns[4];
    double found[5];

    assert_int_equal(grid.num_nodes, sizeof pressure / sizeof **pressure);
    grid_exit_columns(columns, pressure[0], &grid);
    assert_memory_equal(columns, expected, sizeof expected);
    grid_exits(found, columns, &grid);
    for (size_t l = 0; l < 5; l++) {
        if (isnan(positions[l]))
            assert_true(isnan(found[l]));
        else
            check_close(found[l], positions[l], 1e-15, 0);
    }
}

// ---- Reynolds operator

enum { NUM_NODES = 14 }; // of a small grid, boundary nodes included

/* A small grid with all its stencils and fluid. */
typedef struct small_problem {
    ehd_contact contact;
    double mobility[NUM_NODES], mobility_slope[NUM_NODES];
    double density[NUM_NODES], density_slope[NUM_NODES];
    reynolds_stencil stencils[NUM_NODES - 2];
    double pressure[NUM_NODES], film[NUM_NODES];
} small_problem;

static void small_init(small_problem *small, const ehd_contact *contact) {
    small->contact = *contact;
    small->contact.grid = grid_of(-1, 0.1, NUM_NODES - 2, 1, false);
    for (size_t r = 0; r < NUM_NODES - 2; r++)
        small->stencils[r] = reynolds_stencil_at(&small->contact.grid, r + 1);
}

static void small_rows(reynolds_row *rows, small_problem *small, double entrainment) {
    int compressible = small->contact.lubricant.density != NULL;
    reynolds_fluid fluid = {small->mobility, small->mobility_slope,
                            compressible ? small->density : NULL,
                            compressible ? small->density_slope : NULL};
    reynolds_fluid_evaluate(&fluid, &small->contact, small->pressure, NUM_NODES);
    reynolds_rows(rows, small->contact.grid.step, entrainment, NULL, small->stencils, NUM_NODES - 2,
                  &fluid, small->pressure, small->film);
}

/* Derivative of the residuals with respect to `*value`, a pressure or film of `small`. */
static void difference(double *derivative, small_problem *small, double *value) {
    reynolds_row up[NUM_NODES - 2], down[NUM_NODES - 2];
    double kept = *value, h = 1e-5 * kept;

    *value = kept + h;
    small_rows(up, small, 0.8);
    *value = kept - h;
    small_rows(down, small, 0.8);
    *value = kept;
    for (size_t r = 0; r < NUM_NODES - 2; r++)
        derivative[r] = (up[r].residual - down[r].residual) / (2 * h);
}

/* The analytic derivative with respect to the value at `node`; zero where it is not in the stencil. */
static double by_node(const double *by, const reynolds_stencil *stencil, size_t node) {
    for (int a = 0; a < NUM_STENCIL; a++)
        if (stencil->node[a] == node) return by[a];
    return 0;
}

static double largest_of(const double *by) {
    double largest = 0;
    for (int a = 0; a < NUM_STENCIL; a++)
        largest = fmax(largest, fabs(by[a]));
    return largest;
}

static void check_row_derivatives(const ehd_contact *contact) {
    small_problem small;
    reynolds_row rows[NUM_NODES - 2];
    double derivative[NUM_NODES - 2];

    small_init(&small, contact);
    for (size_t k = 0; k < NUM_NODES; k++) {
        small.pressure[k] = 0.5 + 0.3 * sin(2. * (double)k);
        small.film[k] = 0.4 + 0.1 * cos(3. * (double)k);
    }
    small_rows(rows, &small, 0.8);
    for (size_t k = 0; k < NUM_NODES; k++) {
        difference(derivative, &small, &small.pressure[k]);
        for (size_t r = 0; r < NUM_NODES - 2; r++)
            check_close(by_node(rows[r].by_pressure, &small.stencils[r], k), derivative[r], 1e-6,
                        1e-7 * largest_of(rows[r].by_pressure));
        difference(derivative, &small, &small.film[k]);
        for (size_t r = 0; r < NUM_NODES - 2; r++)
            check_close(by_node(rows[r].by_film, &small.stencils[r], k), derivative[r], 1e-6,
                        1e-7 * largest_of(rows[r].by_film));
    }
}

static void row_derivatives(void **state) {
    (void)state;
    for (int l = 0; l < NUM_LUBRICANTS; l++)
        for (int d = 0; d < NUM_DENSITIES; d++) {
            ehd_contact contact = sample_contact(lubricants[l], densities[d], 5, 6, 0.1);
            check_row_derivatives(&contact);
        }
}

static void first_row_has_no_second_node_back(void **state) {
    (void)state;
    ehd_grid grid = grid_of(-1, 0.1, NUM_NODES - 2, 1, false);
    reynolds_stencil first = reynolds_stencil_at(&grid, 1), second = reynolds_stencil_at(&grid, 2);
    assert_true(first.node[NODE_BACK2] == NO_NODE);
    assert_int_equal(first.node[NODE_BACK], 0);
    assert_int_equal(first.node[NODE_HERE], 1);
    assert_int_equal(first.node[NODE_AHEAD], 2);
    assert_int_equal(second.node[NODE_BACK2], 0);
}

/* Isoviscous, so that both terms can be written down exactly, discretisation included. */
static void manufactured_rows(void **state) {
    (void)state;
    ehd_contact contact = sample_contact("barus", "dowson-higginson", 10, 0, 0.1);
    small_problem small;
    reynolds_row rows[NUM_NODES - 2];
    const double film_slope = 0.2, pressure_slope = 0.3, curvature = 0.7, h = 0.1;

    small_init(&small, &contact);
    double lambda = contact.lambda;
    for (size_t k = 0; k < NUM_NODES; k++) {
        small.film[k] = 0.6;
        small.pressure[k] = 1 + pressure_slope * grid_x(&small.contact.grid, k);
    }
    small_rows(rows, &small, 1);
    for (size_t r = 0; r < NUM_NODES - 2; r++)
        check_close(rows[r].residual, 0, 0, 1e-11 / lambda);

    // film linear: H^3 of the half nodes' means gives 3 H^2 H' + H'^3 h^2
    for (size_t k = 0; k < NUM_NODES; k++)
        small.film[k] = 0.6 + film_slope * grid_x(&small.contact.grid, k);
    small_rows(rows, &small, 0.5);
    for (size_t r = 0; r < NUM_NODES - 2; r++) {
        double film = small.film[r + 1];
        double flow = pressure_slope * (3 * film * film * film_slope + pow(film_slope, 3) * h * h);
        check_close(rows[r].residual, flow / lambda - 0.5 * film_slope, 1e-11, 1e-10);
    }

    // film constant, pressure quadratic
    for (size_t k = 0; k < NUM_NODES; k++) {
        small.film[k] = 0.6;
        small.pressure[k] = 2 + curvature * pow(grid_x(&small.contact.grid, k), 2);
    }
    small_rows(rows, &small, 1);
    for (size_t r = 0; r < NUM_NODES - 2; r++)
        check_close(rows[r].residual, 2 * curvature * pow(0.6, 3) / lambda, 1e-11, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(viscosity_derivative),
        cmocka_unit_test(density_derivative),
        cmocka_unit_test(density_values),
        cmocka_unit_test(viscosity_values),
        cmocka_unit_test(barus_is_exact),
        cmocka_unit_test(roelands_slope_at_zero),
        cmocka_unit_test(wlf_coefficients_and_limits),
        cmocka_unit_test(viscosity_rises_to_its_limit),
        cmocka_unit_test(negative_pressure_counts_as_zero),
        cmocka_unit_test(bad_lubricants_are_refused),
        cmocka_unit_test(unknown_laws_are_refused),
        cmocka_unit_test(physical_scene),
        cmocka_unit_test(contradictory_viscosity_is_refused),
        cmocka_unit_test(moes_numbers),
        cmocka_unit_test(given_hertz_pressure_wins),
        cmocka_unit_test(pressure_beyond_the_law_is_refused),
        cmocka_unit_test(isoviscous_contact),
        cmocka_unit_test(grid_nodes),
        cmocka_unit_test(exits_of_a_pressure),
        cmocka_unit_test(row_derivatives),
        cmocka_unit_test(first_row_has_no_second_node_back),
        cmocka_unit_test(manufactured_rows),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
