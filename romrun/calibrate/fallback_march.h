/* SPDX-License-Identifier: GPL-3.0-or-later */
/* romrun --fallback full in time: reduced steps while they are to be trusted, else steps of the full
 * model from the same states, until the reduced one can be trusted again (README.md, Fallback). */
#ifndef EHD_FALLBACK_MARCH_H
#define EHD_FALLBACK_MARCH_H

#include "common/output/time_run.h"
#include "fullrun/full_march.h"
#include "romrun/online/parts_march.h"

typedef struct fallback_march fallback_march;

/* `reduced` must outlive it; nothing else may use it.
 * `accuracy`: of the films; to a tenth of it a reduced step has to indicate its films, and to agree with
 * the full one before steps are reduced again. `distrust`: why no reduced step is to be trusted, and all
 * are the full model's; NULL: single ones. EHD_MEMORY. */
ehd_status fallback_march_create(
    // output:
    fallback_march **self, // free with fallback_march_free
    // input:
    parts_march *reduced, double start_film, double accuracy, const char *distrust,
    ehd_error *error);
fallback_march *fallback_march_free(fallback_march *self); // accepts and returns NULL

/* As a solver for march_run. */
march_solver fallback_march_solver(fallback_march *self);

/* For time_run: the full model's share of the steps, and the effort of both. */
time_run_share fallback_march_share(const void *solver);
void fallback_march_effort(double *rows, double *linear, double *exit, const void *solver);

#endif
