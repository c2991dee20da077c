/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The reduced model in time: BDF2 steps in the moving frame, for march_run or for a multibody
 * code's own integrator. The cost of a step does not depend on the size of the grid. */
#ifndef EHD_REDUCED_MARCH_H
#define EHD_REDUCED_MARCH_H

#include "common/time/march.h"
#include "romrun/online/film_splines.h"
#include "romrun/online/reduced_solver.h"

typedef struct reduced_march reduced_march;

/* All inputs must outlive it; threads may share model and splines. EHD_MEMORY. */
ehd_status reduced_march_create(
    // output:
    reduced_march **self, // free with reduced_march_free
    // input:
    const reduced_model *model, const film_splines *splines, const ehd_contact *reference,
    const reduced_settings *settings, ehd_error *error);
reduced_march *reduced_march_free(reduced_march *self); // accepts and returns NULL

/* Has each step indicate how far its films are off, times these factors; NaN, the default: it does
 * not, and how fast the contact changes is held against its training. Before the start. */
void reduced_march_indicate(reduced_march *self, double factor, double factor_minimum);

/* The solver of the march, for an observer. */
reduced_solver *reduced_march_inner(reduced_march *self);

/* As a solver for march_run. The start is the stationary solution, or where the speed is zero a fit
 * through the trained states around. */
march_solver reduced_march_solver(reduced_march *self);

/* The last accepted state, and its frame. */
reduced_state reduced_march_state(const reduced_march *self, contact_frame *frame);

/* Effort so far. */
typedef struct reduced_march_effort {
    double seconds, seconds_rows, seconds_linear, seconds_exit;
    double seconds_previous; // carrying previous states over
    size_t iterations;
} reduced_march_effort;
reduced_march_effort reduced_march_effort_of(const reduced_march *self);

#endif
