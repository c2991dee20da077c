/* SPDX-License-Identifier: GPL-3.0-or-later */
/* romrun --fallback full in time. The reduced model takes a step if it is trusted. Otherwise the
 * full model takes the step from the same states, until the reduced model is trusted again
 * (README.md, Fallback).
 * Called by romrun/main.c. */
#ifndef EHD_FALLBACK_MARCH_H
#define EHD_FALLBACK_MARCH_H

#include "common/output/time_run.h"
#include "fullrun/full_march.h"
#include "romrun/online/parts_march.h"

typedef struct fallback_march fallback_march;

/* Creates a march with fallback. `reduced` must outlive the march, and nothing else may use it.
 * `accuracy`: accuracy of the films. A tenth of the accuracy limits the error estimate of a reduced
 * step. This tenth also limits the difference of both models' films before reduced steps are taken
 * again. `distrust`: reason why the full model takes all steps; NULL: it takes single steps.
 * Errors: EHD_MEMORY. */
ehd_status fallback_march_create(
    // output:
    fallback_march **self, // free with fallback_march_free
    // input:
    parts_march *reduced, double start_film, double accuracy, const char *distrust,
    ehd_error *error);
fallback_march *fallback_march_free(fallback_march *self); // accepts and returns NULL

/* Returns the march as a solver for march_run. */
march_solver fallback_march_solver(fallback_march *self);

/* Return the fraction of the steps that the full model took, and the effort of both models in
 * seconds, for time_run. */
time_run_share fallback_march_share(const void *solver);
void fallback_march_effort(double *rows, double *linear, double *exit, const void *solver);

#endif
