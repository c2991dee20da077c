/* SPDX-License-Identifier: GPL-3.0-or-later */
/* romrun --fallback full in time. The reduced model takes a time step if this step is trusted.
 * Otherwise the full model takes the step from the last accepted states. It also takes the next
 * steps until the reduced model is trusted again (README.md, Fallback).
 * Called by romrun/main.c. */
#ifndef EHD_FALLBACK_MARCH_H
#define EHD_FALLBACK_MARCH_H

#include "common/output/time_run.h"
#include "fullrun/full_march.h"
#include "romrun/online/parts_march.h"

typedef struct fallback_march fallback_march;

/* Creates a march with fallback. `reduced` must outlive the march, and nothing else may use it.
 * `accuracy`: accuracy of the films. A reduced step is accepted only if its error estimate is at
 * most a tenth of the accuracy. After a step of the full model, the reduced model takes the next
 * step only if the films of both models differ by at most the same tenth. `distrust`: reason why
 * the full model takes all steps; NULL: the full model takes only the steps that the reduced model
 * cannot take. Errors: EHD_MEMORY. */
ehd_status fallback_march_create(
    // output:
    fallback_march **self, // free with fallback_march_free
    // input:
    parts_march *reduced, double start_film, double accuracy, const char *distrust,
    ehd_error *error);
fallback_march *fallback_march_free(fallback_march *self); // accepts and returns NULL

/* Returns the march as a solver for march_run. */
march_solver fallback_march_solver(fallback_march *self);

/* Returns the contribution of the full model to the march, for `share` of time_run_task. */
time_run_share fallback_march_share(const void *solver);

#endif
