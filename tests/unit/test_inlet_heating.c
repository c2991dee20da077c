/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The factor for shear heating in the inlet: limits, factors of other authors, range, and the
 * values that it takes from a contact. */
#include "common/physics/inlet_heating.h"
#include "tests/unit/check.h"
#include "tests/unit/sample.h"

#include <math.h>
#include <string.h>

static void falls_from_one(void **unused) {
    (void)unused;

    check_close(inlet_heating_factor(1e-12, 0.004, 0), 1, 1e-5, 0);
    for (double loading = 1e-3; loading < 20; loading *= 3) {
        const double factor = inlet_heating_factor(loading, 0.004, 0.1);
        assert_true(factor < inlet_heating_factor(loading / 3, 0.004, 0.1));
        assert_true(factor < inlet_heating_factor(loading, 0.002, 0.1));
        assert_true(factor < inlet_heating_factor(loading, 0.004, 0));
        check_close(factor, inlet_heating_factor(loading, 0.004, -0.1), 0, 0);
    }
    // by hand: (1 - 13.2 0.005) / (1 + 0.213 (1 + 2.23))
    check_close(inlet_heating_factor(1, 0.005, 1), 0.934 / 1.68799, 1e-14, 0);
}

/* Returns the factor of Murch and Wilson (1975), as quoted by Wilson and Sheu (1983), for pure
 * rolling and any load. A comparison with this factor gives the range of use of our factor. */
static double murch_wilson(double loading) {
    return 1 / (1 + 0.254 * pow(loading, 0.62));
}

static void others_found_about_the_same(void **unused) {
    (void)unused;

    for (double ratio = 0.001; ratio < 0.0101; ratio += 0.001)
        for (double loading = 1e-3; loading < 2000; loading *= 1.25) {
            const double factor = inlet_heating_factor(loading, ratio, 0);
            if (isnan(factor)) continue;
            assert_true(factor > 0.77 * murch_wilson(loading));
            assert_true(factor < 1.07 * murch_wilson(loading));
        }
    // "at high values ... simple sliding ... only about 20 percent of that for pure rolling"
    check_close(inlet_heating_factor(500, 1e-6, 2) / inlet_heating_factor(500, 1e-6, 0), 0.2, 0.1,
                0);
}

static void says_where_it_does_not_hold(void **unused) {
    const double ratio = 0.005, last = pow(0.25 / 13.2 / ratio, 1 / 0.42);
    (void)unused;

    assert_true(isfinite(inlet_heating_factor(0.999 * last, ratio, 2)));
    assert_true(isnan(inlet_heating_factor(1.001 * last, ratio, 2)));
    assert_true(isnan(inlet_heating_factor(0.5 * last, ratio, 2.001)));
    assert_true(isnan(inlet_heating_factor(NAN, ratio, 0)));
    assert_true(isnan(inlet_heating_factor(1, NAN, 0)));
    assert_true(isnan(inlet_heating_factor(1, ratio, NAN)));
}

// ---- factors of contacts

static scene oil(void) {
    scene given = sample_scene("roelands", "incompressible", NAN, NAN);

    given.physical.load = 2e5;
    given.physical.radius = 0.01;
    given.physical.speed = 3;
    given.physical.modulus = 2.2e11;
    given.lubricant.thermal_conductivity = 0.14;
    given.lubricant.viscosity.values[laws_slot(viscosity_laws, "temperature_coefficient")].number =
        0.03;
    return given;
}

static void of_a_contact(void **unused) {
    const scene given = oil();
    ehd_contact contact;
    (void)unused;

    assert_int_equal(scene_contact(&contact, &given, NULL), EHD_OK);
    const inlet_heating heating = inlet_heating_of(&contact);
    check_close(heating.loading, 0.04 * 0.03 * 3 * 3 / 0.14, 1e-13, 0);
    check_close(heating.factor,
                inlet_heating_factor(heating.loading, contact.hertz_pressure / 2.2e11, 0), 1e-13,
                0);
    assert_true(heating.factor < 0.99);
}

static void nothing_is_known_without_conductivity(void **unused) {
    scene given = oil();
    ehd_contact contact;
    (void)unused;

    given.lubricant.thermal_conductivity = NAN;
    assert_int_equal(scene_contact(&contact, &given, NULL), EHD_OK);
    assert_true(isnan(inlet_heating_of(&contact).loading));
    assert_true(isnan(inlet_heating_of(&contact).factor));
}

static void what_it_lacks_is_said(void **unused) {
    const size_t slot = laws_slot(viscosity_laws, "temperature_coefficient");
    scene given = oil();
    ehd_contact contact;
    ehd_error error;
    (void)unused;

    given.lubricant.viscosity.values[slot].number = NAN;
    assert_int_equal(scene_contact(&contact, &given, &error), EHD_DATA);
    assert_string_equal(error.text,
                        "lubricant.viscosity.temperature_coefficient: found nothing, expected a "
                        "value with lubricant.thermal_conductivity");
    given = sample_scene("no1", "incompressible", 20, 8);
    given.lubricant.thermal_conductivity = 0.14;
    assert_int_equal(scene_contact(&contact, &given, &error), EHD_DATA);
    assert_non_null(strstr(error.text, "lubricant.thermal_conductivity: found a value with moes"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(falls_from_one),
        cmocka_unit_test(others_found_about_the_same),
        cmocka_unit_test(says_where_it_does_not_hold),
        cmocka_unit_test(of_a_contact),
        cmocka_unit_test(nothing_is_known_without_conductivity),
        cmocka_unit_test(what_it_lacks_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
