/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Marches the full model through time by BDF2 steps in the moving frame. march_run (march.h) calls
 * this solver (README.md, In time).
 * Called by main.c, by snapgen/trajectory.c, and by recording.c and fallback_march.c of
 * romrun/calibrate. */
#ifndef EHD_FULL_MARCH_H
#define EHD_FULL_MARCH_H

#include "common/time/bdf_march.h"
#include "fullrun/full_solver.h"

typedef struct full_march full_march;

/* Returns the approximate memory of a march in bytes. */
double full_march_bytes(const ehd_contact *reference);

/* Creates a march with the full model. `reference` is the contact with all history factors equal to
 * 1, and must outlive the march.
 * Errors: EHD_MEMORY; EHD_DATA: the discretisation cannot be used for transient contacts. */
ehd_status full_march_create(
    // output:
    full_march **self, // free with full_march_free
    // input:
    const ehd_contact *reference, const full_settings *settings,
    double start_film, // dimensionless central film of a dry start; NaN: the film formula's value
                       // at a hundredth of the reference speed
    ehd_error *error);
full_march *full_march_free(full_march *self); // accepts and returns NULL

/* Returns the march as a solver for march_run. At zero speed it starts from the dry contact with
 * the central film `start_film` of full_march_create. */
march_solver full_march_solver(full_march *self);

/* Returns the last accepted state, and its frame unless `frame` is NULL. */
const full_state *full_march_state(const full_march *self, const contact_frame **frame);

/* Returns the bdf_march inside this march. bdf_march_take_over uses it to take states from the
 * march of another model, or to give states to that march. */
bdf_march *full_march_steps(full_march *self);

#endif
