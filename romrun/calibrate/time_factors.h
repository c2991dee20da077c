/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fits the factors of the error estimates in time to steps with known errors
 * (romrun/trust/README.md, Factors).
 * Called by calibration.c for each size. */
#ifndef EHDROM_ROMRUN_TIME_FACTORS_H
#define EHDROM_ROMRUN_TIME_FACTORS_H

#include "romrun/online/reduced_march.h"
#include "romrun/trust/functionals.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct step_sample {
    size_t trajectory;
    double deviation[NUM_REDUCED_FILMS]; // relative errors of the films
    film_bounds bounds;
} step_sample;

typedef struct step_samples {
    size_t trajectory; // trajectory of the steps that are added next
    size_t count;
    step_sample *samples; // [count]; the steps of a trajectory are contiguous
} step_samples;

/* Smallest ratio of error estimate to error over the steps of a calibration. With a ratio of 2 in
 * place of 3, one of 800 runs of scenes/studies/silent-in-time (seeds 41 and 51) exceeded an
 * accuracy of 1e-3 without a warning. The error of this run was 1.0005e-3, and its estimate
 * 0.75e-3. */
extern const double time_margin;

/* Fits the factors and floors of the estimates, which film_factors defines. The estimate of each
 * step becomes at least time_margin times its error. With a floor of 0, a single step with a bound
 * near zero would decide the factor. The fit therefore takes the floor that minimises the mean,
 * over the trajectories, of the largest estimate of each trajectory. With this floor it takes the
 * smallest factor, at least time_margin. If a floor of 0 and the factor time_margin suffice for the
 * central film, the floor stays 0. Without steps all factors and floors are 0.
 *
 * A floor is at least time_margin times the error that 95 % of the steps do not exceed. With
 * smaller floors and a margin of 2, 3 of 106 steps of tests/pipeline/calibrate.bats, "step by
 * step", had estimates below the errors. With a margin of 3 no step had such an estimate. */
film_factors time_factors_fit(
    // input:
    const step_samples *steps,
    const bool *lost, // [number of trajectories] true: a step of the trajectory did not converge
                      // or is not trusted, and the mean leaves out the trajectory
    // work:
    double *errors); // [count]

/* Raises the estimate of each trajectory to the largest estimate of its steps, over both films, but
 * not above 1. */
void time_factors_apply(
    // in and output:
    double *indicated, // [number of trajectories]
    // input:
    const film_factors *factors, const step_samples *steps);

#endif
