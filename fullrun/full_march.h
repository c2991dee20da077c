/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The full model in time: BDF2 steps in the moving frame, for march_run. */
#ifndef EHD_FULL_MARCH_H
#define EHD_FULL_MARCH_H

#include "common/time/march.h"
#include "fullrun/full_solver.h"

typedef struct full_march full_march;

/* Bytes of memory, about. */
double full_march_bytes(const ehd_contact *reference);

/* `reference`: the contact at all factors 1; must outlive it. EHD_MEMORY. */
ehd_status full_march_create(
    // output:
    full_march **self, // free with full_march_free
    // input:
    const ehd_contact *reference, const full_settings *settings,
    double start_film, // central film of a dry start, dimensionless; NaN: that at a hundredth of
                       // the speed
    ehd_error *error);
full_march *full_march_free(full_march *self); // accepts and returns NULL

/* As a solver for march_run. Where the speed is zero the start is the dry contact with the central
 * film `start_film` of full_march_create. */
march_solver full_march_solver(full_march *self);

/* The last accepted state, and its frame. */
const full_state *full_march_state(const full_march *self, const contact_frame **frame);

// ---- from and to another solver of the same reference and grid, which goes on where this one stopped

/* How many accepted states a step looks at. */
size_t full_march_num_states(const full_march *self);

/* The accepted state so many steps before the next one, 1 being the last; 0: the last attempt. */
const full_state *full_march_state_before(const full_march *self, size_t steps,
                                          const contact_frame **frame);

/* Takes an accepted state, at `steps` from 1 to BDF_PREVIOUS in ascending order; those taken so far
 * count. Along the path the base (common/time/README.md) has to be taken before. */
void full_march_take(full_march *self, size_t steps, const full_state *state,
                     const contact_frame *frame);

/* Along the path: the state that others are told from. EHD_MEMORY. */
const full_state *full_march_base(const full_march *self, const contact_frame **frame);
ehd_status full_march_take_base(full_march *self, const full_state *state,
                                const contact_frame *frame, ehd_error *error);

/* Errors of rho H that the film of the last accepted state has taken up, [num_nodes]. */
void full_march_errors(double *errors, const full_march *self);
void full_march_take_errors(full_march *self, const double *errors);

/* Effort so far, in seconds. */
typedef struct full_march_effort {
    double seconds_rows, seconds_linear;
    size_t newton_iterations, gmres_iterations;
} full_march_effort;
full_march_effort full_march_effort_of(const full_march *self);

#endif
