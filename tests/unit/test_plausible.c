/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plausible, implausible and impossible scenes: wrong units are named, good scenes pass. */
#include "common/settings/plausible.h"
#include "common/settings/scene_contact.h"
#include "tests/unit/check.h"
#include "tests/unit/random.h"

#include <math.h>
#include <string.h>

/* A gear tooth: 500 N/mm on a radius of 12 mm at 4 m/s. */
static contact_settings gear(void) {
    const size_t alpha = laws_slot(viscosity_laws, "alpha"),
                 eta0 = laws_slot(viscosity_laws, "eta0");
    contact_settings given = {.kind = &contact_line,
                              .moes_M = NAN,
                              .moes_L = NAN,
                              .load = 500e3,
                              .radius = 0.012,
                              .radius_across = NAN,
                              .ellipticity = NAN,
                              .speed = 4,
                              .modulus = 226e9,
                              .viscosity = NAN,
                              .hertz_pressure = NAN,
                              .approach_length = NAN};

    for (size_t i = 0; i < MAX_LAW_KEYS; i++)
        given.lubricant.viscosity.values[i].number = NAN;
    strcpy(given.lubricant.viscosity.law, "roelands");
    strcpy(given.lubricant.density.law, "incompressible");
    given.lubricant.viscosity.values[alpha].number = 2e-8;
    given.lubricant.viscosity.values[eta0].number = 0.05;
    given.lubricant.thermal_conductivity = NAN;
    return given;
}

static double *of_law(contact_settings *given, const char *key) {
    return &given->lubricant.viscosity.values[laws_slot(viscosity_laws, key)].number;
}

static plausibility judge(char text[PLAUSIBLE_TEXT], const contact_settings *given) {
    ehd_contact contact;

    assert_int_equal(contact_init(&contact, given, NULL), EHD_OK);
    return plausible_judge(text, &contact, given);
}

static void wrong_units_are_named(void **unused) {
    (void)unused;
    enum { LOAD, RADIUS, SPEED, MODULUS, ETA0, ALPHA };
    const struct {
        double factor;
        const char *says;
        int setting;
        plausibility verdict;
    } typed[] = {
        {1e-3, "M: found 0.0152, expected at least 0.1", LOAD, IMPOSSIBLE},
        {1e-3, ": is physical.load = 500 in N/mm?", LOAD, IMPOSSIBLE},
        {1e3, "Hertz pressure: found 38.7 GPa, expected at most 20 GPa", LOAD, IMPOSSIBLE},
        {1e3, ": is physical.load = 5e+08 too large by a factor of 1000?", LOAD, IMPOSSIBLE},
        {1e3, ": is physical.speed = 4000 in mm/s?", SPEED, IMPLAUSIBLE},
        {1e-6, ": is physical.modulus = 226000 in MPa?", MODULUS, IMPOSSIBLE},
        {1e-6, "half width over radius: found 21.7, expected at most 1", MODULUS, IMPOSSIBLE},
        {1e3, ": is lubricant.viscosity.eta0 = 50 in mPas?", ETA0, IMPLAUSIBLE},
        {1e-3, ": is physical.radius = 1.2e-05 too small by a factor of 1000?", RADIUS, IMPOSSIBLE},
        {4, "pressure coefficient alpha: found 8e-08 1/Pa", ALPHA, IMPLAUSIBLE},
        {0.1, "expected at least 5e-09 1/Pa", ALPHA, IMPLAUSIBLE},
    };
    for (size_t i = 0; i < sizeof typed / sizeof *typed; i++) {
        contact_settings given = gear();
        char text[PLAUSIBLE_TEXT] = "";
        double *const values[] = {&given.load,    &given.radius,          &given.speed,
                                  &given.modulus, of_law(&given, "eta0"), of_law(&given, "alpha")};
        assert_int_equal(judge(text, &given), PLAUSIBLE);
        *values[typed[i].setting] *= typed[i].factor;
        assert_int_equal(judge(text, &given), typed[i].verdict);
        if (!strstr(text, typed[i].says))
            fail_msg("found \"%s\", expected %s", text, typed[i].says);
    }
}

static void the_smaller_radius_counts(void **unused) {
    (void)unused;
    contact_settings given = gear();
    char text[PLAUSIBLE_TEXT];

    given.kind = &contact_ellipse;
    given.modulus = 2e7;
    given.speed = 0.5;
    given.radius = 0.02;
    given.radius_across = 0.02;
    given.load = 10;
    assert_int_equal(judge(text, &given), PLAUSIBLE);
    given.radius_across = 2e-3; // a is 0.17 of the radius along, b 0.37 of the radius across
    assert_int_equal(judge(text, &given), IMPLAUSIBLE);
    assert_non_null(strstr(text, "half width over radius: found 0.37"));
}

static void water_on_rubber_is_plausible(void **unused) {
    (void)unused;
    contact_settings given = gear();
    char text[PLAUSIBLE_TEXT];

    given.modulus = 2e7;
    given.load = 3e3;
    given.radius = 0.02;
    given.speed = 0.5;
    *of_law(&given, "eta0") = 1e-3;
    *of_law(&given, "alpha") = 4.5e-10;
    assert_int_equal(judge(text, &given), PLAUSIBLE);
    // between steel surfaces this coefficient is a mistake
    given = gear();
    *of_law(&given, "alpha") = 4.5e-10;
    assert_int_equal(judge(text, &given), IMPLAUSIBLE);
    assert_null(strstr(text, "?")); // no change of a unit explains it
}

static void temperatures_in_kelvin_are_found(void **unused) {
    (void)unused;
    contact_settings given = gear();
    char text[PLAUSIBLE_TEXT];

    *of_law(&given, "reference_temperature") = 40;
    *of_law(&given, "temperature_coefficient") = 0.01;
    *of_law(&given, "temperature") = 80;
    assert_int_equal(judge(text, &given), PLAUSIBLE);
    *of_law(&given, "temperature") = 353;
    assert_int_equal(judge(text, &given), IMPLAUSIBLE);
    assert_non_null(strstr(text, "temperature: found 353 degC, expected at most 200 degC"));
}

/* Returns a number with an even distribution of its logarithm, from a fixed sequence. */
static double even(double low, double high) {
    static uint64_t seed = 1;

    return low * pow(high / low, random_next(&seed));
}

/* Returns a contact of steel and oil, of any kind, with 0.3 to 3 GPa and M from 5 to 2000. The
 * formulas of Hertz are written out here. */
static contact_settings good_scene(int number) {
    contact_settings given = gear();
    double M = 0, L = 0, width = 1;

    given.kind = number % 3 == 0   ? &contact_line
                 : number % 3 == 1 ? &contact_point
                                   : &contact_ellipse;
    while (!(M >= 5 && M <= 2000 && L <= 30 && width < given.radius / 5)) {
        const double pressure = even(3e8, 3e9);
        given.modulus = even(1.5e11, 2.6e11);
        given.radius = even(3e-3, 0.2);
        given.speed = even(0.05, 20);
        *of_law(&given, "eta0") = even(0.005, 0.3);
        *of_law(&given, "alpha") = even(1e-8, 3e-8);
        const double flow =
            2 * *of_law(&given, "eta0") * given.speed / given.modulus / given.radius;
        if (number % 3 == 0) {
            given.load = 2 * M_PI * given.radius * pressure * pressure / given.modulus;
            width = 4 * given.radius * pressure / given.modulus;
            M = given.load / given.modulus / given.radius / sqrt(flow);
        } else {
            given.load = 2 * pow(M_PI * pressure, 3) * pow(given.radius / given.modulus, 2) / 3;
            width = M_PI * given.radius * pressure / given.modulus;
            M = given.load / given.modulus / pow(given.radius, 2) / pow(flow, 0.75);
        }
        L = *of_law(&given, "alpha") * given.modulus * pow(flow, 0.25);
    }
    if (number % 3 == 2) given.ellipticity = even(0.5, 5);
    return given;
}

static void good_scenes_pass(void **unused) {
    (void)unused;

    for (int number = 0; number < 200; number++) {
        const contact_settings given = good_scene(number);
        char text[PLAUSIBLE_TEXT];
        if (judge(text, &given) != PLAUSIBLE) fail_msg("scene %d: %s", number, text);
    }
}

/* One setting of a good scene is wrong by a power of 1000. Each such mistake that makes the Hertz
 * pressure, the film or M absurd must be found. Nearly always the setting is named. */
static void mistakes_are_found(void **unused) {
    (void)unused;
    static const char *const keys[] = {"load", "radius", "speed", "modulus", "eta0", "alpha"};
    static const double factors[] = {1e3, 1e-3, 1e6, 1e-6};
    int found = 0, named = 0;

    for (int number = 0; number < 240; number++) {
        contact_settings given = good_scene(number);
        const int which = number % 6;
        char text[PLAUSIBLE_TEXT];
        ehd_contact contact;
        double *const values[] = {&given.load,    &given.radius,          &given.speed,
                                  &given.modulus, of_law(&given, "eta0"), of_law(&given, "alpha")};
        *values[which] *= factors[number / 6 % 4];
        if (contact_init(&contact, &given, NULL)) continue; // refused for another reason
        const double film =
            contact.kind->central_film(&contact.grid.shape, contact.moes_M, contact.moes_L) *
            contact.half_width * contact.half_width / contact.radius;
        const bool absurd = contact.hertz_pressure > 5e9 || contact.moes_M < 0.1 ||
                            contact.half_width > contact.radius / 3 || film < 1e-9;
        const plausibility verdict = judge(text, &given);
        if (absurd) assert_int_not_equal(verdict, PLAUSIBLE);
        found += verdict != PLAUSIBLE;
        named += verdict != PLAUSIBLE && strstr(text, keys[which]);
    }
    print_message("mistakes found: %d of 240, setting named: %d\n", found, named);
    assert_true(found >= 200 && named >= 0.85 * found);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wrong_units_are_named),
        cmocka_unit_test(the_smaller_radius_counts),
        cmocka_unit_test(water_on_rubber_is_plausible),
        cmocka_unit_test(temperatures_in_kelvin_are_found),
        cmocka_unit_test(good_scenes_pass),
        cmocka_unit_test(mistakes_are_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
