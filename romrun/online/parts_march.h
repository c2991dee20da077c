/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The march of a model of parts: each step is solved by one reduced model, that in whose trained
 * range the contact lies. A contact that leaves the range of one is handed to another (README.md,
 * Models of parts). Of one part alone it is that part's march. */
#ifndef EHD_PARTS_MARCH_H
#define EHD_PARTS_MARCH_H

#include "common/time/march.h"
#include "romrun/online/reduced_march.h"

typedef struct parts_march parts_march;

/* Takes the marches, one a part, of one reference and one grid, which it frees also where it fails.
 * EHD_MEMORY. */
ehd_status parts_march_create(
    // output:
    parts_march **self, // free with parts_march_free
    // input:
    reduced_march *const *parts, size_t num_parts, ehd_error *error);
parts_march *parts_march_free(parts_march *self); // accepts and returns NULL

/* As a solver for march_run. */
march_solver parts_march_solver(parts_march *self);

/* The part of the last attempt, or of the start, and that of the last accepted state, by index. */
size_t parts_march_attempted(const parts_march *self);
size_t parts_march_accepted(const parts_march *self);
reduced_march *parts_march_part(const parts_march *self, size_t part);

/* The part that a contact in a frame is for, to which states of another solver are then handed
 * (reduced_march_take): it alone has accepted states from now on. */
reduced_march *parts_march_choose(parts_march *self, const contact_frame *frame);

/* How often a contact was handed from one part to another so far, attempts that were not accepted
 * included. */
size_t parts_march_num_handed(const parts_march *self);

/* Effort of all parts so far. */
reduced_march_effort parts_march_effort_of(const parts_march *self);

#endif
