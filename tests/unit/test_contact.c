/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/contact.h"
#include "common/physics/reynolds.h"
#include "tests/unit/check.h"
#include "tests/unit/sample.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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

/* The Moes numbers of physical scenes have the same bounds as given Moes numbers. */
static void moes_bounds_of_physical_scenes(void **state) {
    (void)state;
    scene given = sample_scene("barus", "incompressible", NAN, NAN);
    ehd_contact contact;
    ehd_error error;
    given.physical.radius = 0.01;
    given.physical.speed = 1;
    given.physical.modulus = 2.2e11;
    given.physical.viscosity = 0.01;
    given.physical.load = 2e5 * 0.101 / 30.15113445777636;
    assert_int_equal(scene_contact(&contact, &given, &error), EHD_OK);
    given.physical.load = 2e5 * 0.05 / 30.15113445777636;
    assert_int_equal(scene_contact(&contact, &given, &error), EHD_DATA);
    assert_string_equal(error.text,
                        "M: found 0.05, expected at least 0.1 (half width 0.0062 mm, p_H 0.0341 "
                        "GPa, M = 0.05, L = 7.64): is physical.load = 331.662 in N/mm?");
}

/* A half width above the radius is refused. A modulus in MPa instead of Pa causes such a half
 * width. */
static void a_contact_is_narrower_than_its_bodies(void **state) {
    (void)state;
    scene given = sample_scene("barus", "incompressible", NAN, NAN);
    ehd_contact contact;
    ehd_error error;
    given.physical.radius = 0.01;
    given.physical.speed = 1;
    given.physical.viscosity = 0.01;
    given.physical.load = 2e5;
    given.physical.modulus = 5.2e7; // a = R if the modulus is 8 load/(pi R) = 5.1e7 Pa
    assert_int_equal(scene_contact(&contact, &given, &error), EHD_OK);
    given.physical.modulus = 2.2e5;
    assert_int_equal(scene_contact(&contact, &given, &error), EHD_DATA);
    assert_string_equal(error.text,
                        "half width over radius: found 15.2, expected at most 1 (half width 152 "
                        "mm, p_H 0.000837 GPa, M = 3.02e+04, L = 0.000242): is physical.modulus = "
                        "220000 in MPa?");
}

static law_value *viscosity_value(scene *of, const char *key) {
    return &of->lubricant.viscosity.values[laws_slot(viscosity_laws, key)];
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
    given.physical.viscosity = 0.0398; // the law gives 0.04
    assert_int_equal(scene_contact(&contact, &given, NULL), EHD_OK);
    given.physical.viscosity = 0.039;
    assert_int_equal(scene_contact(&contact, &given, &error), EHD_DATA);
    assert_non_null(strstr(error.text, "physical.viscosity: found 0.039, expected 0.04"));
}

/* A viscosity that contradicts the scene's temperature is refused, for example the viscosity at the
 * reference temperature. If no viscosity is given, the viscosity of the law is used. */
static void viscosity_is_that_of_the_temperature(void **state) {
    static const char *const laws[] = {"barus", "roelands"};
    (void)state;
    for (int i = 0; i < 2; i++) {
        scene given = sample_scene(laws[i], "incompressible", NAN, NAN);
        ehd_contact hot, known;
        ehd_error error;
        given.physical.load = 2e5;
        given.physical.radius = 0.01;
        given.physical.speed = 1;
        given.physical.modulus = 2.2e11;
        given.physical.viscosity = 0.04;
        viscosity_value(&given, "eta0")->number = 0.04;
        viscosity_value(&given, "temperature")->number = 80;
        viscosity_value(&given, "reference_temperature")->number = 40;
        viscosity_value(&given, "temperature_coefficient")->number = 0.03;
        assert_int_equal(scene_contact(&hot, &given, &error), EHD_DATA);
        assert_non_null(strstr(error.text, "physical.viscosity: found 0.04, expected 0.01"));
        assert_non_null(strstr(error.text, "the temperature of 80 degC, within 1 %, or nothing"));
        given.physical.viscosity = NAN;
        assert_int_equal(scene_contact(&hot, &given, NULL), EHD_OK);
        given.physical.viscosity = hot.lubricant.eta0;
        assert_int_equal(scene_contact(&known, &given, NULL), EHD_OK);
        check_close(hot.moes_M, known.moes_M, 0, 0);
        check_close(hot.moes_L, known.moes_L, 0, 0);
        check_close(hot.moes_L,
                    hot.lubricant.alpha * 2.2e11 *
                        pow(hot.lubricant.eta0 * 2 / (2.2e11 * 0.01), 0.25),
                    1e-13, 0);
    }
}

static void viscosity_that_no_law_has_is_needed(void **state) {
    (void)state;
    scene given = sample_scene("barus", "incompressible", NAN, NAN);
    ehd_contact contact;
    ehd_error error;
    given.physical.load = 2e5;
    given.physical.radius = 0.01;
    given.physical.speed = 1;
    given.physical.modulus = 2.2e11;
    assert_int_equal(scene_contact(&contact, &given, &error), EHD_DATA);
    assert_string_equal(error.text, "physical.viscosity: found nothing, expected a value with the "
                                    "law barus");
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
    assert_non_null(strstr(error.text, "Hertz pressure: found 4.8 GPa, expected at most 4.7"));
    given.hertz_pressure = NAN;
    given.moes.L = 50;
    assert_int_equal(scene_contact(&contact, &given, NULL), EHD_DATA);
}

static void isoviscous_contact(void **state) {
    (void)state;
    for (int l = 0; l < NUM_SAMPLE_LUBRICANTS; l++) {
        ehd_contact contact = sample_contact(sample_lubricants[l], "dowson-higginson", 10, 0, 0.1);
        double memory[NUM_FLUID_ARRAYS * 3];
        reynolds_fluid fluid = reynolds_fluid_in(memory, 3, &contact);
        check_close(contact.hertz_pressure, 0, 0, 0);
        check_close(contact.alpha_p_H, 0, 0, 0);
        reynolds_fluid_evaluate(&fluid, &contact, (double[]){0, 0.5, 1}, 3);
        for (int i = 0; i < 3; i++) {
            check_close(fluid.mobility[i], 1 / contact.lambda, 1e-13, 0);
            check_close(fluid.mobility_slope[i], 0, 0, 0);
            check_close(fluid.density[i], 1, 0, 0);
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

/* Checks the exits of a pressure on a half grid with three lines, of which the first lies at Y = 0,
 * and a boundary line. The pressure of the first line ends inside the grid. The pressure of the
 * second line has a gap, and a negative value behind its end. The pressure of the third line is
 * zero. The whole grid also has the mirrored lines. */
static void exits_of_a_pressure(void **state) {
    (void)state;
    const ehd_grid grid = grid_of(-1, 0.5, 4, 3, true, DISCRETIZATION_PUBLISHED);
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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(physical_scene),
        cmocka_unit_test(moes_bounds_of_physical_scenes),
        cmocka_unit_test(a_contact_is_narrower_than_its_bodies),
        cmocka_unit_test(contradictory_viscosity_is_refused),
        cmocka_unit_test(viscosity_is_that_of_the_temperature),
        cmocka_unit_test(viscosity_that_no_law_has_is_needed),
        cmocka_unit_test(moes_numbers),
        cmocka_unit_test(given_hertz_pressure_wins),
        cmocka_unit_test(pressure_beyond_the_law_is_refused),
        cmocka_unit_test(isoviscous_contact),
        cmocka_unit_test(grid_nodes),
        cmocka_unit_test(exits_of_a_pressure),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
