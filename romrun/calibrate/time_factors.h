/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Factors of the error estimates in time, from steps whose errors are known. */
#ifndef EHDROM_ROMRUN_TIME_FACTORS_H
#define EHDROM_ROMRUN_TIME_FACTORS_H

#include "romrun/online/reduced_march.h"
#include "romrun/online/reduced_solver.h"

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

/* How many times its error the estimate of each step of a calibration is at least. With 2 one of 800 runs of
 * scenes/studies/silent-in-time (seeds 41 and 51) was silent: 1.0005e-3 off and estimated 0.75e-3. */
extern const double time_margin;

/* Factors and floors with which the estimate of each step is at least time_margin times its error, 0
 * without steps. With a floor of 0, a step whose bound is as small as its noise would alone decide the
 * factor. So each film has the floor for which the largest estimates of the trajectories have the
 * smallest mean, with the smallest factor that goes with it, of at least time_margin. The central film
 * has a floor of 0 where its factor is then smaller than that.
 *
 * A floor is at least the error that 95 % of the steps do not exceed: with a smaller one 3 of 106 steps of
 * tests/pipeline/calibrate.bats, "step by step", are off by more than is estimated. */
film_factors time_factors_fit(
    // input:
    const step_samples *steps, const bool *lost, // of each trajectory; left out of the mean
    // work:
    double *errors); // [count]

/* Raises `indicated` of each trajectory to the largest estimate of either film, at most to 1. */
void time_factors_apply(
    // in and output:
    double *indicated, // [number of trajectories]
    // input:
    const film_factors *factors, const step_samples *steps);

#endif
