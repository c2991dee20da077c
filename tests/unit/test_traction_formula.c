/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The formula for a traction curve from mean conditions. It is compared with the published formula,
 * with its limits, and with the friction under Hertz pressure that it approximates. */
#include "common/physics/laws.h"
#include "common/physics/traction.h"
#include "common/physics/traction_formula.h"
#include "tests/unit/check.h"
#include "tests/unit/sample.h"

#include <math.h>
#include <string.h>

static const double VISCOSITY = 0.04, ALPHA = 2e-8, SPEED = 2, MODULUS = 2.2e11, RADIUS = 0.01,
                    FILM = 3e-7; // m

/* Returns a contact with a Hertz pressure of 0.6 to 1 GPa and Eyring's law. */
static ehd_contact sliding(const char *kind, double load, double tau0) {
    scene given = sample_scene("barus", "incompressible", NAN, NAN);
    ehd_contact contact;
    ehd_error error;

    strcpy(given.contact, kind);
    given.physical.load = load;
    given.physical.radius = RADIUS;
    given.physical.speed = SPEED;
    given.physical.modulus = MODULUS;
    given.physical.viscosity = VISCOSITY;
    given.slide_roll = 0.05;
    strcpy(given.lubricant.shear.law, "eyring");
    given.lubricant.shear.values[laws_slot(shear_laws, "tau0")].number = tau0;
    if (scene_contact(&contact, &given, &error)) fail_msg("%s", error.text);
    return contact;
}

static void is_as_it_is_printed(void **unused) {
    static const char *const kinds[] = {"line", "point"};
    static const double loads[] = {1e5, 20}, means[] = {M_PI / 4, 2. / 3};
    (void)unused;

    for (int i = 0; i < 2; i++) {
        const double tau0 = 5e6;
        const ehd_contact contact = sliding(kinds[i], loads[i], tau0);
        const double p = means[i] * contact.hertz_pressure;
        const double film = FILM / contact_film_scale(&contact);
        for (double slide_roll = -0.2; slide_roll < 0.3; slide_roll += 0.1) {
            const double viscous = VISCOSITY * exp(ALPHA * p) * slide_roll * SPEED / FILM;
            const traction_estimate found = traction_at_mean_pressure(&contact, film, slide_roll);
            check_close(found.coefficient, tau0 * asinh(viscous / tau0) / p, 1e-12, 1e-15);
            check_close(found.excess, fabs(viscous) / tau0, 1e-12, 1e-12);
        }
    }
}

static void is_newtons_where_the_eyring_stress_is_large(void **unused) {
    const ehd_contact contact = sliding("point", 20, 1e12);
    const double p = 2. / 3 * contact.hertz_pressure;
    const double film = FILM / contact_film_scale(&contact);
    (void)unused;

    check_close(traction_at_mean_pressure(&contact, film, 0.03).coefficient,
                VISCOSITY * exp(ALPHA * p) * 0.03 * SPEED / FILM / p, 1e-6, 0);
    assert_true(traction_at_mean_pressure(&contact, film, 0.03).excess < 1e-2);
}

/* Returns the coefficient of friction for Hertz pressure and a constant film. Integrates the stress
 * by the midpoint rule, over rings of a point contact or strips of a line contact. */
static double under_hertz(const ehd_contact *contact, double film, double slide_roll) {
    enum { PARTS = 4000 };
    const bool point = contact->kind->dimensions > 1;
    ehd_contact of = *contact;
    double sum = 0, weights = 0;

    of.slide_roll = slide_roll;
    for (int i = 0; i < PARTS; i++) {
        const double r = (i + 0.5) / PARTS, weight = point ? r : 1;
        sum += weight * contact_shear_stress(&of, sqrt(1 - r * r), film, 0);
        weights += weight;
    }
    return sum / weights / hertz_mean_pressure(contact->kind);
}

static void stands_for_the_stress_under_hertz(void **unused) {
    static const char *const kinds[] = {"line", "point"};
    static const double loads[] = {2.8e5, 42}; // alpha p_H of about 20
    (void)unused;

    for (int i = 0; i < 2; i++) {
        const ehd_contact contact = sliding(kinds[i], loads[i], 1e5);
        const double film = FILM / contact_film_scale(&contact);
        assert_true(contact.alpha_p_H > 18 && contact.alpha_p_H < 20.5);
        for (double slide_roll = 1e-6; slide_roll < 2; slide_roll *= 3) {
            const traction_estimate found = traction_at_mean_pressure(&contact, film, slide_roll);
            const double exact = under_hertz(&contact, film, slide_roll);
            assert_true(found.coefficient < exact);
            if (found.excess > TRACTION_MIN_EXCESS) assert_true(found.coefficient > 0.9 * exact);
            if (found.excess > 1e4) assert_true(found.coefficient > 0.98 * exact);
            if (found.excess < 0.1) assert_true(found.coefficient < 0.2 * exact);
        }
    }
}

static void is_not_known_otherwise(void **unused) {
    ehd_contact contact = sliding("line", 1e5, 5e6);
    (void)unused;

    assert_true(isnan(traction_at_mean_pressure(&contact, 0.1, NAN).coefficient));
    contact.lubricant.shear = &shear_limiting;
    assert_true(isnan(traction_at_mean_pressure(&contact, 0.1, 0.1).coefficient));
    contact = sliding("line", 1e5, 5e6);
    contact.half_width = NAN;
    assert_true(isnan(traction_at_mean_pressure(&contact, 0.1, 0.1).coefficient));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(is_as_it_is_printed),
        cmocka_unit_test(is_newtons_where_the_eyring_stress_is_large),
        cmocka_unit_test(stands_for_the_stress_under_hertz),
        cmocka_unit_test(is_not_known_otherwise),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
