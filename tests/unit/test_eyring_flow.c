/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Flow factors of a Ree-Eyring fluid, compared with a numerical integration of its velocity
 * profile. */
#include "common/physics/eyring_flow.h"
#include "tests/unit/check.h"

#include <math.h>

/* Shear stress in the middle of the film, and flow along and across the sliding. Viscosity, film
 * and Eyring stress are one. The flows are divided by the gradients and multiplied by 12. */
typedef struct profile {
    double middle, along, across;
} profile;

/* Integrates sliding and flow over the film by the midpoint rule. The stress at z is
 * (middle[0] + x z, middle[1] + y z). The fluid shears at the rate sinh(stress) in the direction of
 * the stress. */
enum { SLID, SLID_ACROSS, FLOW, FLOW_ACROSS, NUM_SUMS };

static void integrate(double sums[NUM_SUMS], const double middle[2], double x, double y) {
    enum { PARTS = 400 };

    for (int i = 0; i < NUM_SUMS; i++)
        sums[i] = 0;
    for (int k = 0; k < PARTS; k++) {
        const double z = (k + 0.5) / PARTS - 0.5;
        const double along = middle[0] + x * z, across = middle[1] + y * z;
        const double stress = hypot(along, across);
        const double fluidity = stress > 0 ? sinh(stress) / stress : 1;
        sums[SLID] += fluidity * along / PARTS;
        sums[SLID_ACROSS] += fluidity * across / PARTS;
        // int (u - mean u) dz = -int z du/dz dz; the flow is counted against the gradient
        sums[FLOW] += z * fluidity * along / PARTS;
        sums[FLOW_ACROSS] += z * fluidity * across / PARTS;
    }
}

/* Returns the profile for a rate of sliding and two gradients. An outer bisection finds the stress
 * along the sliding, in the middle of the film. For each such stress, an inner bisection finds the
 * stress across the sliding at which nothing slides to the side. */
static profile profile_of(double rate, double sigma_x, double sigma_y) {
    const double x = 2 * sigma_x, y = 2 * sigma_y;
    const double most = asinh(rate) + sigma_x + sigma_y;
    double low = 0, high = most, sums[NUM_SUMS], middle[2] = {0, 0};

    for (int i = 0; i < 32; i++) {
        middle[0] = (low + high) / 2;
        double left = -most, right = most;
        for (int k = 0; k < 32 && sigma_y > 0 && sigma_x > 0; k++) {
            middle[1] = (left + right) / 2;
            integrate(sums, middle, x, y);
            *(sums[SLID_ACROSS] < 0 ? &left : &right) = middle[1];
        }
        integrate(sums, middle, x, y);
        *(sums[SLID] < rate ? &low : &high) = middle[0];
    }
    return (profile){middle[0], 12 * sums[FLOW] / x, 12 * sums[FLOW_ACROSS] / y};
}

/* With a gradient along the sliding, the flow factor and the stress in the middle are exact. */
static void along_the_sliding_the_factor_is_exact(void **state) {
    (void)state;
    for (double sigma = 0.01; sigma < 30; sigma *= 2)
        for (double rate = 0.01; rate < 1e7; rate *= 10) {
            const eyring_gradient of = eyring_gradient_of(sigma);
            const profile found = profile_of(rate, sigma, 0);
            // the error of the midpoint rule is at least (Sigma/400)^2/6
            const double off = 1e-5 + 1e-5 * sigma * sigma;
            check_close(eyring_along(&of, rate).value, found.along, off, 0);
            check_close(eyring_stress(&of, rate), found.middle, off, 1e-7);
        }
}

static void across_the_sliding_the_factor_is_near(void **state) {
    (void)state;
    const double sigmas[] = {0.1, 0.5, 1, 2}, off[] = {1.3e-4, 3.2e-3, 0.013, 0.068};

    for (int i = 0; i < 4; i++) {
        const eyring_gradient of = eyring_gradient_of(sigmas[i]);
        double worst = 0;
        check_close(eyring_across(&of, 0).value, profile_of(0, 0, sigmas[i]).across, 5e-5, 0);
        for (double rate = 0.01; rate < 1e5; rate *= 10) {
            const double exact = profile_of(rate, 0, sigmas[i]).across;
            worst = fmax(worst, fabs(eyring_across(&of, rate).value / exact - 1));
        }
        print_message("across at %g: %g off\n", sigmas[i], worst);
        assert_true(worst < off[i] && worst > off[i] / 3);
    }
}

/* For the flow in one direction, the rows of point contacts neglect the pressure gradient in the
 * other direction. The constants EYRING_DOUBT_... bound this error. */
static void doubt_is_a_bound(void **state) {
    (void)state;
    for (double x = 0.1; x < 3.1; x *= 3)
        for (double y = 0.1; y < 3.1; y *= 3)
            for (double rate = 0.01; rate < 1e5; rate *= 10) {
                const eyring_gradient along = eyring_gradient_of(x), across = eyring_gradient_of(y);
                const profile exact = profile_of(rate, x, y);
                const double off_along = eyring_along(&along, rate).value / exact.along - 1;
                const double off_across = eyring_across(&across, rate).value / exact.across - 1;
                assert_true(fabs(off_along) < EYRING_DOUBT_ALONG * y * y + 1e-5);
                assert_true(fabs(off_across) <
                            EYRING_DOUBT_ACROSS * x * x + EYRING_DOUBT_ACROSS_OWN * y * y + 1e-5);
            }
}

/* Factors lose no digits by cancellation and do not overflow. They are compared with the definition
 * of the factors in extended precision. */
static void factors_hold_all_digits(void **state) {
    (void)state;
    for (double sigma = 1e-3; sigma < 500; sigma *= 1.07) {
        const long double s = sigma, cosine = coshl(s), sine = sinhl(s);
        const eyring_gradient of = eyring_gradient_of(sigma);
        // long double has 19 digits; cancellation multiplies its relative error by 3/Sigma^2
        const double digits = 3e-15 + 1e-18 / (sigma * sigma);
        check_close(of.at_rest, (double)(3 * (s * cosine - sine) / (s * s * s)), digits, 0);
        check_close(of.sliding, (double)(3 * (s * cosine / sine - 1) / (s * s)), digits, 0);
    }
    const eyring_gradient none = eyring_gradient_of(0), tiny = eyring_gradient_of(1e-200);
    check_close(none.at_rest, 1, 0, 0);
    check_close(none.sliding, 1, 0, 0);
    check_close(tiny.at_rest, 1, 0, 0);
    for (double sigma = 1; sigma < 1e300; sigma *= 1e3)
        for (double rate = 0; rate < 1e40; rate = 1e3 * (rate + 1)) {
            const eyring_gradient large = eyring_gradient_of(sigma);
            const eyring_factor along = eyring_along(&large, rate),
                                across = eyring_across(&large, rate);
            assert_true(isfinite(along.value) && isfinite(across.value));
            assert_true(isfinite(along.by_log_gradient) && isfinite(across.by_log_gradient));
            assert_true(isfinite(eyring_stress(&large, rate)));
        }
}

static void derivatives_are_those_of_the_factors(void **state) {
    (void)state;
    const double h = 1e-5;
    for (double sigma = 1e-3; sigma < 500; sigma *= 3)
        for (double rate = 1e-3; rate < 1e12; rate *= 20)
            for (int way = 0; way < 2; way++) {
                eyring_factor (*factor)(const eyring_gradient *, double) =
                    way == 0 ? eyring_along : eyring_across;
                const eyring_gradient of = eyring_gradient_of(sigma);
                const eyring_gradient up = eyring_gradient_of(sigma * (1 + h));
                const eyring_gradient down = eyring_gradient_of(sigma * (1 - h));
                const eyring_factor found = factor(&of, rate);
                check_close(
                    found.by_log_rate,
                    log(factor(&of, rate * (1 + h)).value / factor(&of, rate * (1 - h)).value) /
                        (2 * h),
                    1e-6, 1e-9);
                check_close(found.by_log_gradient,
                            log(factor(&up, rate).value / factor(&down, rate).value) / (2 * h),
                            1e-6, 1e-9);
            }
    // beyond the largest gradient the factor is constant
    const eyring_gradient beyond = eyring_gradient_of(2 * EYRING_LARGEST_GRADIENT);
    check_close(eyring_along(&beyond, 1).by_log_gradient, 0, 0, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(along_the_sliding_the_factor_is_exact),
        cmocka_unit_test(across_the_sliding_the_factor_is_near),
        cmocka_unit_test(doubt_is_a_bound),
        cmocka_unit_test(factors_hold_all_digits),
        cmocka_unit_test(derivatives_are_those_of_the_factors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
