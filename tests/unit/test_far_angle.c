/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The angular part of the far field: its equation, its exit, the flow through a distant circle, and
 * the closed form of round contacts. */
#include "common/physics/ellipse.h"
#include "tests/unit/check.h"

#include <math.h>

static const double ellipticities[] = {0.05, 0.2, 0.5, 0.8, 1, 1.25, 2, 3, 5};
enum { NUM_ELLIPTICITIES = sizeof ellipticities / sizeof *ellipticities };

static double largest_shape(const far_angle *of) {
    double largest = 0;

    for (int i = 0; i <= 400; i++)
        largest = fmax(largest, far_angle_shape(of, of->exit * i / 400));
    return largest;
}

/* Returns (q^3 S')' - 9 q^3 S + 8 cos(phi), by finite differences. */
static double residual_at(const far_angle *of, double phi, double d) {
    const double here = far_angle_shape(of, phi);
    const double before = pow(far_angle_rise(of, phi - d / 2), 3);
    const double behind = pow(far_angle_rise(of, phi + d / 2), 3);
    const double flow = behind * (far_angle_shape(of, phi + d) - here) -
                        before * (here - far_angle_shape(of, phi - d));

    return flow / (d * d) - 9 * pow(far_angle_rise(of, phi), 3) * here + 8 * cos(phi);
}

static void solves_its_equation(void **state) {
    (void)state;
    for (int k = 0; k < NUM_ELLIPTICITIES; k++) {
        const contact_shape shape = shape_of(ellipticities[k]);
        for (int i = 0; i < 40; i++) {
            const double phi = shape.far.exit * (i + 0.4) / 41;
            const double rise = far_angle_rise(&shape.far, phi), d = 5e-4 * fmin(1, sqrt(rise));
            const double scale = 8 + 9 * rise * rise * rise * far_angle_shape(&shape.far, phi);
            check_close(residual_at(&shape.far, phi, d) / scale, 0, 0, 2e-4);
        }
    }
}

/* Nothing flows through Y = 0 or behind the exit, so the integral of the equation is the flow
 * through a circle in front of the contact. This test is more accurate than finite differences. */
static void keeps_the_flow(void **state) {
    (void)state;
    const int num = 4000;
    for (int k = 0; k < NUM_ELLIPTICITIES; k++) {
        const contact_shape shape = shape_of(ellipticities[k]);
        const far_angle *of = &shape.far;
        double sum = 0;
        for (int i = 0; i < num; i++) {
            const double phi = of->exit * (i + 0.5) / num;
            sum += 9 * pow(far_angle_rise(of, phi), 3) * far_angle_shape(of, phi);
        }
        // the closed form takes a tanh as 1 (far_angle.h), so its slope S' at the exit is 2e-5 of
        // its rise instead of 0
        check_close(sum * of->exit / num, 8 * sin(of->exit), of->ratio == 1 ? 1e-5 : 1e-6, 0);
    }
}

static void ends_with_its_slope(void **state) {
    (void)state;
    for (int k = 0; k < NUM_ELLIPTICITIES; k++) {
        const contact_shape shape = shape_of(ellipticities[k]);
        const far_angle *of = &shape.far;
        const double d = 1e-3 * sqrt(far_angle_rise(of, M_PI_2));
        check_close(far_angle_shape(of, of->exit - 2 * d) / far_angle_shape(of, of->exit - d), 4,
                    0.05, 0);
        check_close(far_angle_shape(of, of->exit + d), 0, 0, 0);
        check_close(far_angle_shape(of, of->exit - 1e-9), 0, 0, 1e-7 * largest_shape(of));
        check_close(tan(of->exit - M_PI_2) > 0 && tan(of->exit - M_PI_2) < 0.5, 1, 0, 0);
    }
}

static void of_a_circle_it_is_the_closed_form(void **state) {
    (void)state;
    const far_angle *round = &shape_round.far;
    check_close(tan(round->exit), -3 * tanh(3 * round->exit), 1e-4, 0);
    for (int side = -1; side <= 1; side += 2) {
        const far_angle near = far_angle_of(1 + side * 1e-10);
        for (int i = 0; i < 50; i++)
            check_close(far_angle_shape(&near, 1.89 * i / 49),
                        far_angle_shape(round, 1.89 * i / 49), 0, 1e-8);
    }
}

static void angles_come_back(void **state) {
    (void)state;
    for (int k = 0; k < NUM_ELLIPTICITIES; k++) {
        const contact_shape shape = shape_of(ellipticities[k]);
        const far_angle *of = &shape.far;
        for (double phi = 0.05; phi < 2; phi += 0.15) {
            const double chi = far_angle_stretched(of, phi), d = 1e-5;
            double slope, unused;
            check_close(far_angle_direction(of, chi, &slope), phi, 1e-13, 0);
            check_close((far_angle_direction(of, chi + d, &unused) -
                         far_angle_direction(of, chi - d, &unused)) /
                            (2 * d),
                        slope, 1e-6, 0);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(solves_its_equation), cmocka_unit_test(keeps_the_flow),
        cmocka_unit_test(ends_with_its_slope), cmocka_unit_test(of_a_circle_it_is_the_closed_form),
        cmocka_unit_test(angles_come_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
