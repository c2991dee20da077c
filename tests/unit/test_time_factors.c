/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The fit of the factors of transient error estimates, on made-up steps. */
#include "romrun/calibrate/time_factors.h"
#include "tests/unit/check.h"
#include "tests/unit/random.h"

#include <math.h>

enum { NUM_TRAJECTORIES = 20, NUM_EACH = 50, NUM_STEPS = NUM_TRAJECTORIES * NUM_EACH };

static step_sample samples[NUM_STEPS];
static step_samples steps;
static bool lost[NUM_TRAJECTORIES];
static double errors[NUM_STEPS];

/* Makes steps with random errors up to 1e-4. A bound of a step is half to four times the error. */
static void make_steps(uint64_t seed) {
    steps = (step_samples){.count = NUM_STEPS, .samples = samples};
    for (size_t i = 0; i < NUM_STEPS; i++) {
        const double central = 1e-4 * random_next(&seed), minimum = 1e-4 * random_next(&seed);
        const double arriving = minimum * random_next(&seed);
        samples[i] = (step_sample){
            .trajectory = i / NUM_EACH,
            .deviation = {[REDUCED_CENTRAL_FILM] = central, [REDUCED_MINIMUM_FILM] = minimum},
            .bounds = {.central = central * exp2(3 * random_next(&seed) - 1),
                       .arriving = arriving,
                       .arising = minimum * exp2(3 * random_next(&seed) - 1)}};
    }
    for (size_t t = 0; t < NUM_TRAJECTORIES; t++)
        lost[t] = false;
}

static double central_of(const film_factors *factors, const step_sample *step) {
    return factors->central * step->bounds.central + factors->central_floor;
}

static double minimum_of(const film_factors *factors, const step_sample *step) {
    return factors->central * step->bounds.arriving + factors->minimum * step->bounds.arising +
           factors->minimum_floor;
}

static film_factors fit_that_covers(void) {
    const film_factors factors = time_factors_fit(&steps, lost, errors);

    for (size_t i = 0; i < NUM_STEPS; i++) {
        const double *off = samples[i].deviation;
        const double rounding = 1 + 1e-12;
        assert_true(rounding * central_of(&factors, &samples[i]) >=
                    time_margin * off[REDUCED_CENTRAL_FILM]);
        assert_true(rounding * minimum_of(&factors, &samples[i]) >=
                    time_margin * off[REDUCED_MINIMUM_FILM]);
    }
    return factors;
}

/* Returns the mean, over all trajectories that are not lost (time_factors.h), of the largest
 * estimate of a film in the trajectory. */
static double mean_of(const film_factors *factors,
                      double (*of)(const film_factors *, const step_sample *)) {
    double largest[NUM_TRAJECTORIES] = {0}, sum = 0;
    size_t count = 0;

    for (size_t i = 0; i < NUM_STEPS; i++)
        largest[samples[i].trajectory] =
            fmax(largest[samples[i].trajectory], of(factors, &samples[i]));
    for (size_t t = 0; t < NUM_TRAJECTORIES; t++)
        if (!lost[t]) sum += largest[t], count++;
    return sum / (double)count;
}

static void test_steps_are_covered_with_small_factors(void **state) {
    (void)state;
    for (uint64_t seed = 1; seed <= 20; seed++) {
        make_steps(seed);
        const film_factors factors = fit_that_covers();
        assert_true(factors.central <= 6 && factors.minimum <= 6);
    }
}

static void test_a_step_with_a_tiny_bound_decides_no_factor(void **state) {
    (void)state;
    make_steps(1);
    const film_factors before = fit_that_covers();
    const double central = mean_of(&before, central_of), minimum = mean_of(&before, minimum_of);
    samples[77].deviation[REDUCED_CENTRAL_FILM] = samples[77].deviation[REDUCED_MINIMUM_FILM] =
        1.1e-4;
    samples[77].bounds = (film_bounds){1e-8, 0, 1e-8}; // without a floor the factor would be 33000
    const film_factors after = fit_that_covers();
    assert_true(after.central <= 6 && after.minimum <= 6);
    assert_true(mean_of(&after, central_of) < 1.5 * central);
    assert_true(mean_of(&after, minimum_of) < 1.5 * minimum);
}

static void test_a_step_that_is_far_off_decides_no_floor(void **state) {
    (void)state;
    make_steps(2);
    samples[77].deviation[REDUCED_CENTRAL_FILM] = samples[77].deviation[REDUCED_MINIMUM_FILM] =
        1e-2;
    samples[77].bounds = (film_bounds){4e-3, 0, 4e-3};
    const film_factors factors = fit_that_covers();
    assert_true(factors.central_floor < 4e-4 && factors.minimum_floor < 4e-4);
}

/* The fit minimises the mean of the largest estimates (mean_of). Compares this mean with the means
 * for other floors. The search of the fit has a precision of 0.1 %. */
static void test_the_mean_is_the_smallest(void **state) {
    (void)state;
    make_steps(3);
    for (size_t i = 0; i < NUM_STEPS; i += 97) {
        samples[i].bounds.central *= 1e-2;
        samples[i].bounds.arising *= 1e-2;
    }
    const film_factors found = fit_that_covers();
    for (double floor = 2.85e-4; floor < 3.1e-4; floor += 1e-6) {
        film_factors other = found;
        other.central = other.minimum = time_margin;
        other.central_floor = floor;
        for (size_t i = 0; i < NUM_STEPS; i++)
            other.central = fmax(
                other.central, (time_margin * samples[i].deviation[REDUCED_CENTRAL_FILM] - floor) /
                                   samples[i].bounds.central);
        assert_true(mean_of(&found, central_of) < 1.01 * mean_of(&other, central_of));
        other.central = found.central;
        other.minimum_floor = floor;
        for (size_t i = 0; i < NUM_STEPS; i++)
            other.minimum =
                fmax(other.minimum, (time_margin * samples[i].deviation[REDUCED_MINIMUM_FILM] -
                                     found.central * samples[i].bounds.arriving - floor) /
                                        samples[i].bounds.arising);
        assert_true(mean_of(&found, minimum_of) < 1.01 * mean_of(&other, minimum_of));
    }
}

/* The bounds of most trajectories are small, so a larger factor raises their estimates less than a
 * larger floor does. One trajectory has large bounds. Because of this trajectory the fit chooses
 * the larger floor, unless this trajectory is lost. */
static void test_lost_trajectories_are_covered_and_not_in_the_mean(void **state) {
    (void)state;
    make_steps(4);
    for (size_t i = 0; i < NUM_STEPS; i++) {
        samples[i].deviation[REDUCED_MINIMUM_FILM] = i == 77 ? 2e-4 : 1e-4;
        samples[i].bounds.arriving = 0;
        samples[i].bounds.arising = i == 77 ? 4e-5 : 1e-7;
    }
    for (size_t i = 3 * NUM_EACH; i < 4 * NUM_EACH; i++)
        samples[i].bounds.arising = 10;
    check_close(fit_that_covers().minimum_floor, 6e-4 - time_margin * 4e-5, 2e-3, 0);
    lost[3] = true;
    const film_factors factors = fit_that_covers();
    check_close(factors.minimum_floor, 3e-4, 1e-3, 0);
    check_close(factors.minimum, 7.5, 1e-2, 0);
}

static void test_estimates_of_trajectories(void **state) {
    (void)state;
    double indicated[NUM_TRAJECTORIES] = {[5] = 1};
    make_steps(5);
    samples[0].bounds.arising = 7;
    const film_factors factors = {1, 2, 0.1, 0.2};
    time_factors_apply(indicated, &factors, &steps);
    assert_true(indicated[0] == 1 && indicated[5] == 1);
    double largest = 0;
    for (size_t i = NUM_EACH; i < 2 * NUM_EACH; i++)
        largest = fmax(largest, minimum_of(&factors, &samples[i]));
    assert_true(indicated[1] == largest);
}

static void test_without_steps_there_are_no_factors(void **state) {
    (void)state;
    const step_samples none = {0};
    const film_factors factors = time_factors_fit(&none, lost, errors);
    assert_true(factors.central == 0 && factors.central_floor == 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_steps_are_covered_with_small_factors),
        cmocka_unit_test(test_a_step_with_a_tiny_bound_decides_no_factor),
        cmocka_unit_test(test_a_step_that_is_far_off_decides_no_floor),
        cmocka_unit_test(test_the_mean_is_the_smallest),
        cmocka_unit_test(test_lost_trajectories_are_covered_and_not_in_the_mean),
        cmocka_unit_test(test_estimates_of_trajectories),
        cmocka_unit_test(test_without_steps_there_are_no_factors)};

    return cmocka_run_group_tests(tests, NULL, NULL);
}
