/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Viscosity and density of the laws. Names of laws and their settings are tested in test_laws.c. */
#include "common/physics/lubricant.h"
#include "tests/unit/allocation.h"
#include "tests/unit/check.h"
#include "tests/unit/sample.h"

#include <gsl/gsl_integration.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static ehd_lubricant sample_lubricant(const char *name) {
    return sample_contact(name, "dowson-higginson", 10, 5, 0.1).lubricant;
}

static double log_viscosity(const ehd_lubricant *lubricant, double pressure) {
    double slope;
    return lubricant->viscosity->evaluate(lubricant, pressure, &slope);
}

static void viscosity_derivative(void **state) {
    (void)state;
    for (int l = 0; l < NUM_SAMPLE_LUBRICANTS; l++) {
        ehd_lubricant lubricant = sample_lubricant(sample_lubricants[l]);
        for (double p = 1e7; p < fmin(4.6e9, lubricant.pressure_limit); p *= 1.3) {
            double h = 1e-3 * p, slope;
            // difference of fourth order
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
    // ln of eta(1 GPa)/eta(0), computed independently from the formulas
    static const double at_giga[] = {20, 12.909806659521264, 13.328407194322661, 9.51454678656911,
                                     10.96611946095047};
    for (int l = 0; l < NUM_SAMPLE_LUBRICANTS; l++) {
        ehd_lubricant lubricant = sample_lubricant(sample_lubricants[l]);
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
        ehd_lubricant lubricant = sample_lubricant(sample_lubricants[2 + l]);
        check_close(lubricant.alpha, alpha[l], 0, 0.0051e-9);
        check_close(lubricant.pressure_limit, limit[l], 0, 0.05e9);
        check_close(lubricant.eta0, eta0[l], 1e-12, 0);
    }
}

/* The viscosity of a law rises with a finite slope up to the pressure limit of the law. Above the
 * limit, the value at the limit is used. */
static void viscosity_rises_to_its_limit(void **state) {
    (void)state;
    for (int l = 2; l < NUM_SAMPLE_LUBRICANTS; l++) {
        ehd_lubricant lubricant = sample_lubricant(sample_lubricants[l]);
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
    for (int l = 0; l < NUM_SAMPLE_LUBRICANTS; l++) {
        ehd_lubricant lubricant = sample_lubricant(sample_lubricants[l]);
        double pressure[] = {-0.01, 0}, log_eta[2], by_p[2], rho[2], rho_by_p[2];
        lubricant_evaluate(log_eta, by_p, rho, rho_by_p, &lubricant, 1e9, pressure, 2);
        check_close(log_eta[0], log_eta[1], 0, 0);
        check_close(by_p[0], by_p[1], 0, 0);
        check_close(rho[0], 1, 0, 0);
        check_close(rho_by_p[0], rho_by_p[1], 0, 0);
    }
}

static double fluidity(double pressure, void *lubricant) {
    return exp(-log_viscosity(lubricant, pressure));
}

/* Compares the coefficient alpha with GSL's adaptive integration: for oil no1 of Table 1 at several
 * temperatures, for oils whose viscosity hardly depends on pressure, and for oils that solidify at
 * low pressure. The integration in lubricant_init allocates no memory. */
static void alpha_is_the_integral_of_fluidity(void **state) {
    (void)state;
    static const struct {
        double temperature, c2, b1;
    } cases[] = {{25, 18.18, 0.23}, {-40, 18.18, 0.23}, {120, 18.18, 0.23}, {25, 900, 0.23},
                 {-50, 0.2, 0.23},  {25, 18.18, 0.5},   {25, 18.18, 0.01}};
    gsl_integration_workspace *workspace = gsl_integration_workspace_alloc(1000);
    assert_non_null(workspace);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        static const char *const keys[] = {"A1", "A2",  "B1",   "B2",         "C1",
                                           "C2", "Tg0", "mu_g", "temperature"};
        const double values[] = {19.17,  4.07, cases[i].b1,         0.0249, 16.04, cases[i].c2,
                                 -73.86, 1e12, cases[i].temperature};
        lubricant_settings settings = sample_scene("no1", "incompressible", 10, 5).lubricant;
        double integral, estimate;
        ehd_lubricant lubricant;
        settings.viscosity.values[laws_slot(viscosity_laws, "preset")].word[0] = '\0';
        for (size_t k = 0; k < sizeof keys / sizeof *keys; k++)
            settings.viscosity.values[laws_slot(viscosity_laws, keys[k])].number = values[k];
        allocation_fail_at(0);
        assert_int_equal(lubricant_init(&lubricant, &settings, NULL), EHD_OK);
        assert_false(allocation_failed());
        const gsl_function function = {fluidity, &lubricant};
        gsl_integration_qag(&function, 0, fmin(3e9, lubricant.pressure_limit), 0, 1e-10, 1000,
                            GSL_INTEG_GAUSS61, workspace, &integral, &estimate);
        check_close(lubricant.alpha, 1 / integral, 1e-9, 0);
    }
    gsl_integration_workspace_free(workspace);
}

// ---- temperature

static void set_number(lubricant_settings *settings, const char *key, double value) {
    settings->viscosity.values[laws_slot(viscosity_laws, key)].number = value;
}

/* Returns an oil at a temperature. At 40 degC it has a viscosity of 0.04 Pa s, the pressure
 * coefficient 2e-8/Pa and the temperature coefficient 0.03/K. */
static ehd_lubricant oil_at(const char *law, double temperature) {
    lubricant_settings settings = sample_scene(law, "incompressible", 10, 5).lubricant;
    ehd_lubricant lubricant;
    ehd_error error;
    set_number(&settings, "eta0", 0.04);
    set_number(&settings, "temperature", temperature);
    set_number(&settings, "reference_temperature", 40);
    set_number(&settings, "temperature_coefficient", 0.03);
    if (lubricant_init(&lubricant, &settings, &error)) fail_msg("%s", error.text);
    return lubricant;
}

static void barus_at_a_temperature(void **state) {
    (void)state;
    const ehd_lubricant hot = oil_at("barus", 90);
    check_close(hot.eta0, 0.04 * exp(-1.5), 1e-14, 0);
    check_close(hot.alpha, 2e-8, 0, 0);
    check_close(log_viscosity(&hot, 1e9), 20, 1e-14, 0);
    check_close(hot.temperature_coefficient, 0.03, 0, 0);
    check_close(oil_at("barus", 40).eta0, 0.04, 0, 0);
}

/* Returns ln eta(p, T) by the single formula of Roelands (1966). */
static double roelands_formula(double pressure, double celsius) {
    const double a = log(0.04) + 9.67, z = 2e-8 * 1.96e8 / a, reference = 40 + 273.15 - 138;
    const double s0 = 0.03 * reference / a;
    return log(0.04) +
           a * (pow(1 + pressure / 1.96e8, z) * pow((celsius + 273.15 - 138) / reference, -s0) - 1);
}

static void roelands_at_a_temperature(void **state) {
    static const double celsius[] = {-20, 40, 70, 150}, pressures[] = {0, 1e8, 1e9, 3e9};
    (void)state;
    for (int t = 0; t < 4; t++) {
        const ehd_lubricant oil = oil_at("roelands", celsius[t]);
        const double step = 1e-3; // K
        double slope;
        for (int p = 0; p < 4; p++)
            check_close(log(oil.eta0) + log_viscosity(&oil, pressures[p]),
                        roelands_formula(pressures[p], celsius[t]), 1e-12, 1e-12);
        oil.viscosity->evaluate(&oil, 0, &slope);
        check_close(oil.alpha, slope, 1e-12, 0);
        check_close(
            oil.temperature_coefficient,
            (roelands_formula(0, celsius[t] - step) - roelands_formula(0, celsius[t] + step)) /
                (2 * step),
            1e-8, 0);
    }
    check_close(oil_at("roelands", 40).alpha, 2e-8, 1e-15, 0);
    check_close(oil_at("roelands", 40).temperature_coefficient, 0.03, 1e-14, 0);
}

/* Compares the temperature coefficient with finite differences of ln eta0 (Maier et al. 2015, eq.
 * 40). */
static void wlf_has_a_temperature_coefficient(void **state) {
    const double step = 1e-3; // K
    double log_eta0[3];
    ehd_lubricant oil;
    (void)state;
    for (int i = 0; i < 3; i++) {
        lubricant_settings settings = sample_scene("no1", "incompressible", 10, 5).lubricant;
        set_number(&settings, "temperature", 60 + (i - 1) * step);
        assert_int_equal(lubricant_init(&oil, &settings, NULL), EHD_OK);
        log_eta0[i] = log(oil.eta0);
        if (i == 1) log_eta0[1] = oil.temperature_coefficient;
    }
    check_close(log_eta0[1], (log_eta0[0] - log_eta0[2]) / (2 * step), 1e-7, 0);
}

static void half_a_temperature_is_refused(void **state) {
    static const char *const keys[] = {"eta0", "temperature", "reference_temperature",
                                       "temperature_coefficient"};
    char text[96];
    (void)state;
    for (int i = 0; i < 4; i++) {
        lubricant_settings settings = sample_scene("barus", "incompressible", 10, 5).lubricant;
        ehd_lubricant lubricant;
        ehd_error error;
        for (int k = 0; k < 4; k++)
            set_number(&settings, keys[k], k == 3 ? 0.03 : k == 0 ? 0.04 : 40);
        assert_int_equal(lubricant_init(&lubricant, &settings, &error), EHD_OK);
        set_number(&settings, keys[i], NAN);
        assert_int_equal(lubricant_init(&lubricant, &settings, &error), EHD_DATA);
        snprintf(text, sizeof text, "lubricant.viscosity.%s: found nothing, expected a value with",
                 keys[i]);
        assert_non_null(strstr(error.text, text));
    }
    lubricant_settings settings = sample_scene("barus", "incompressible", 10, 5).lubricant;
    ehd_lubricant lubricant;
    ehd_error error;
    set_number(&settings, "eta0", 1e6);
    set_number(&settings, "temperature", -50);
    set_number(&settings, "reference_temperature", 40);
    set_number(&settings, "temperature_coefficient", 0.03);
    assert_int_equal(lubricant_init(&lubricant, &settings, &error), EHD_DATA);
    assert_non_null(
        strstr(error.text, "temperature: found -50 degC, where the viscosity is 1.49e+07"));
}

static void bad_lubricants_are_refused(void **state) {
    (void)state;
    static const struct {
        const char *lubricant;
        const char *key; // key of the constant that is replaced
        double value;
        const char *text; // part of the error text
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
        cmocka_unit_test(alpha_is_the_integral_of_fluidity),
        cmocka_unit_test(barus_at_a_temperature),
        cmocka_unit_test(roelands_at_a_temperature),
        cmocka_unit_test(wlf_has_a_temperature_coefficient),
        cmocka_unit_test(half_a_temperature_is_refused),
        cmocka_unit_test(bad_lubricants_are_refused),
        cmocka_unit_test(unknown_laws_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
