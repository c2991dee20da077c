/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The full model in time: BDF2 steps in the moving frame, for march_run. */
#ifndef EHD_FULL_MARCH_H
#define EHD_FULL_MARCH_H

#include "common/time/march.h"
#include "fullrun/full_solver.h"

typedef struct full_march full_march;

/* Returns the approximate memory of a march in bytes. */
double full_march_bytes(const ehd_contact *reference);

/* Creates a march with the full model. `reference` is the contact at all factors 1, and must
 * outlive the march.
 * Errors: EHD_MEMORY; EHD_DATA: a discretisation that cannot be used in time. */
ehd_status full_march_create(
    // output:
    full_march **self, // free with full_march_free
    // input:
    const ehd_contact *reference, const full_settings *settings,
    double start_film, // central film of a dry start, dimensionless; NaN: the film of the
                       // film formula at a hundredth of the speed
    ehd_error *error);
full_march *full_march_free(full_march *self); // accepts and returns NULL

/* Returns the march as a solver for march_run. At zero speed it starts from the dry contact with
 * the central film `start_film` of full_march_create. */
march_solver full_march_solver(full_march *self);

/* Returns the last accepted state, and its frame unless `frame` is NULL. */
const full_state *full_march_state(const full_march *self, const contact_frame **frame);

// ---- hand-over: a solver continues where another one of the same reference and grid stopped

/* Returns the number of accepted states that a step uses. */
size_t full_march_num_states(const full_march *self);

/* Returns the accepted state `steps` before the next one: 1 is the last accepted
 * state, 0 the last attempt. */
const full_state *full_march_state_before(const full_march *self, size_t steps,
                                          const contact_frame **frame);

/* Sets the accepted state at `steps`, from 1 to BDF_PREVIOUS in ascending order. Only
 * states that are set count. Along the path the base (common/time/README.md, Along the
 * path) must be set before. */
void full_march_take(full_march *self, size_t steps, const full_state *state,
                     const contact_frame *frame);

/* Return and set the base of a march along the path: the start, of which other states carry only
 * their difference. Errors: EHD_MEMORY. */
const full_state *full_march_base(const full_march *self, const contact_frame **frame);
ehd_status full_march_take_base(full_march *self, const full_state *state,
                                const contact_frame *frame, ehd_error *error);

/* Return and set the errors of rho H that the film of the last accepted state has accumulated
 * over its steps, [num_nodes]. */
void full_march_errors(double *errors, const full_march *self);
void full_march_take_errors(full_march *self, const double *errors);

/* Effort of the march so far, times in seconds. */
typedef struct full_march_effort {
    double seconds_rows, seconds_linear;
    size_t newton_iterations, gmres_iterations;
} full_march_effort;
full_march_effort full_march_effort_of(const full_march *self);

#endif
