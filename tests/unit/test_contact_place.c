/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/contact_place.h"
#include "common/physics/traction.h"
#include "tests/unit/check.h"
#include "tests/unit/sample.h"

#include <math.h>

static ehd_contact sliding_contact(double slide_roll, double stress) {
    ehd_contact contact = sample_contact("barus", "incompressible", 12, 5, 0.1);

    contact.half_width = 1e-4;
    contact.radius = 0.01;
    contact.slide_roll = slide_roll;
    contact.lubricant.thinning_stress = stress * contact.hertz_pressure;
    return contact;
}

static double thinning_of(double slide_roll, double stress) {
    const ehd_contact contact = sliding_contact(slide_roll, stress);

    return contact_place_of(&contact).thinning.sliding;
}

/* The thinning is tau_N/tau0 = (lambda U/12) (a/R) S eta/H (p_H/tau0) at eta = H = 1. The sign of
 * the sliding S does not matter. */
static void thinning_is_a_ratio_of_stresses(void **state) {
    const ehd_contact contact = sliding_contact(0.3, 0.01);
    const double found = thinning_of(0.3, 0.01);
    (void)state;

    check_close(found, contact.lambda / 12 * 0.01 * 0.3 / 0.01, 1e-14, 0);
    check_close(thinning_of(0.6, 0.02), found, 1e-14, 0);
    check_close(thinning_of(-0.3, 0.01), found, 1e-14, 0);
    check_close(thinning_of(0.3, 0.005), 2 * found, 1e-14, 0);
    check_close(thinning_of(0, 0.01), 0, 0, 0);
    check_close(thinning_of(0.3, 0), 0, 0, 0);    // a law that does not thin the flow
    check_close(thinning_of(NAN, 0.01), 0, 0, 0); // no traction
}

static void thinning_that_no_film_shows_is_none(void **state) {
    (void)state;
    check_close(thinning_coordinate(0), log(1e-6), 1e-15, 0);
    check_close(thinning_coordinate(1e-7), log(1e-6), 1e-15, 0);
    check_close(thinning_coordinate(1e-3) - thinning_coordinate(1e-4), log(10), 1e-14, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(thinning_is_a_ratio_of_stresses),
        cmocka_unit_test(thinning_that_no_film_shows_is_none),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
