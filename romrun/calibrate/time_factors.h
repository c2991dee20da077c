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
    size_t trajectory; // of the steps that are added next
    size_t count;
    step_sample *samples; // [count]; the steps of a trajectory follow each other
} step_samples;

/* Smallest ratio of error estimate to error over the steps of a calibration. With 2 in place of 3
 * one of 800 runs of scenes/studies/silent-in-time (seeds 41 and 51) had an error of 1.0005e-3
 * without a warning, at an accuracy of 1e-3. The estimate was 0.75e-3. */
extern const double time_margin;

/* Fits factors and floors: the estimate of each step is at least time_margin times its error. With
 * a floor of 0 a step whose bound is lost in noise decides the factor alone. So the fit takes the
 * floor for which the mean over the trajectories of their largest estimate is smallest, and with it
 * the smallest factor, from time_margin on. If the central film needs no larger factor than
 * time_margin with a floor of 0, the floor stays 0. Without steps all are 0.
 *
 * A floor is at least time_margin times the error that 95 % of the steps do not exceed. With
 * smaller floors and a margin of 2 the estimates of 3 of 106 steps of
 * tests/pipeline/calibrate.bats, "step by step", were below the errors; with a margin of 3 none
 * was. */
film_factors time_factors_fit(
    // input:
    const step_samples *steps,
    const bool *lost, // [number of trajectories]; the mean leaves these out
    // work:
    double *errors); // [count]

/* Raises the estimate of each trajectory to its largest estimate of either film, but not above 1.
 */
void time_factors_apply(
    // in and output:
    double *indicated, // [number of trajectories]
    // input:
    const film_factors *factors, const step_samples *steps);

#endif
