/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/calibrate/time_factors.h"

#include "romrun/calibrate/trade.h"

#include <math.h>

const double time_margin = 3;

/* Returns the error estimate of a film in a step, not limited to 1. */
static double estimate(const film_factors *factors, const film_bounds *bounds, reduced_film film) {
    return film == REDUCED_CENTRAL_FILM
               ? factors->central * bounds->central + factors->central_floor
               : factors->central * bounds->arriving + factors->minimum * bounds->arising +
                     factors->minimum_floor;
}

/* Changes the floor of a film and returns the new factors. The factor of this film becomes the
 * smallest value, at least `least`, with which the estimate of each step is at least time_margin
 * times its error. */
static film_factors with_floor(film_factors factors, const step_samples *steps, reduced_film film,
                               double least, double floor) {
    const bool central = film == REDUCED_CENTRAL_FILM;
    double *factor = central ? &factors.central : &factors.minimum;

    *(central ? &factors.central_floor : &factors.minimum_floor) = floor;
    *factor = least;
    for (size_t i = 0; i < steps->count; i++) {
        const step_sample *here = &steps->samples[i];
        const double known = central ? 0 : factors.central * here->bounds.arriving;
        const double bound = central ? here->bounds.central : here->bounds.arising;
        const double wanted = time_margin * here->deviation[film] - known - floor;
        if (bound > 0) *factor = fmax(*factor, wanted / bound);
    }
    return factors;
}

/* Returns the sum, over all trajectories that are not `lost`, of the largest estimate of a film. A
 * lost trajectory has a step that did not converge or is not trusted. */
static double sum_of_largest(film_factors factors, const step_samples *steps, reduced_film film,
                             const bool *lost) {
    double sum = 0, largest = 0;

    for (size_t i = 0; i < steps->count; i++) {
        const step_sample *here = &steps->samples[i];
        if (i > 0 && here->trajectory != here[-1].trajectory) {
            sum += largest;
            largest = 0;
        }
        if (!lost[here->trajectory])
            largest = fmax(largest, estimate(&factors, &here->bounds, film));
    }
    return sum + largest;
}

/* Returns the factors with the floor of a film for which sum_of_largest is smallest. The sum is a
 * convex function of the floor, so a ternary search finds its minimum. */
static film_factors with_best_floor(film_factors factors, const step_samples *steps,
                                    reduced_film film, const bool *lost, double *errors) {
    // `usual`: quantile of the errors at which the search begins (time_factors_fit). `precision`:
    // width of the last search interval, divided by the width of the first one. If either constant
    // is 0.5, a single step decides a factor (test_time_factors.c,
    // test_a_step_with_a_tiny_bound_decides_no_factor).
    const double usual = 0.95, precision = 1e-3;

    for (size_t i = 0; i < steps->count; i++)
        errors[i] = time_margin * steps->samples[i].deviation[film];
    double low = trade_quantile_of(errors, steps->count, usual);
    double high = trade_quantile_of(errors, steps->count, 1);
    const double width = precision * (high - low);
    while (high - low > width) {
        const double third = (high - low) / 3;
        const film_factors lower = with_floor(factors, steps, film, time_margin, low + third),
                           upper = with_floor(factors, steps, film, time_margin, high - third);
        if (sum_of_largest(lower, steps, film, lost) <= sum_of_largest(upper, steps, film, lost))
            high -= third;
        else
            low += third;
    }
    return with_floor(factors, steps, film, time_margin, low);
}

film_factors time_factors_fit(const step_samples *steps, const bool *lost, double *errors) {
    film_factors factors = with_floor((film_factors){0}, steps, REDUCED_CENTRAL_FILM, 0, 0);

    if (steps->count == 0) return factors;
    if (factors.central > time_margin)
        factors = with_best_floor(factors, steps, REDUCED_CENTRAL_FILM, lost, errors);
    return with_best_floor(factors, steps, REDUCED_MINIMUM_FILM, lost, errors);
}

void time_factors_apply(double *indicated, const film_factors *factors, const step_samples *steps) {
    for (size_t i = 0; i < steps->count; i++) {
        const step_sample *here = &steps->samples[i];
        double *worst = &indicated[here->trajectory];
        for (int film = 0; film < NUM_REDUCED_FILMS; film++)
            *worst = fmin(fmax(*worst, estimate(factors, &here->bounds, (reduced_film)film)), 1);
    }
}
