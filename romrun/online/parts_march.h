/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Marches a model that consists of several models, one for each part of a region of contacts. The
 * part in whose trained range the contact lies solves the step. If the contact leaves this range,
 * the states are handed to another part (README.md, Models for parts of a region). A model with one
 * part is marched by this part alone.
 * Called by online_transient.c, and by romrun/calibrate/fallback_march.c. */
#ifndef EHD_PARTS_MARCH_H
#define EHD_PARTS_MARCH_H

#include "common/time/march.h"
#include "romrun/online/reduced_march.h"

typedef struct parts_march parts_march;

/* Creates a march from up to MAX_PARTS marches, one for each part, with the same reference and
 * grid. The new march owns these marches. They are freed with the new march, or at once if the call
 * fails. Errors: EHD_MEMORY. */
ehd_status parts_march_create(
    // output:
    parts_march **self, // free with parts_march_free
    // input:
    reduced_march *const *parts, size_t num_parts, ehd_error *error);
parts_march *parts_march_free(parts_march *self); // accepts and returns NULL

/* Returns the march as a solver for march_run. */
march_solver parts_march_solver(parts_march *self);

/* Return the index of the part that solved the last attempt (or the start), the index of the part
 * that solved the last accepted state, and the march of a part. */
size_t parts_march_attempted(const parts_march *self);
size_t parts_march_accepted(const parts_march *self);
reduced_march *parts_march_part(const parts_march *self, size_t part);

/* Chooses the part for the contact in a frame and returns the march of this part. The caller then
 * hands the states of another solver to this march (bdf_march_take_over). After the call only this
 * part has accepted states. */
reduced_march *parts_march_choose(parts_march *self, const contact_frame *frame);

/* Returns how often a contact was handed from one part to another so far, including attempts that
 * were not accepted. */
size_t parts_march_num_handed(const parts_march *self);

#endif
