/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The accepted states of a march as numbers, for restarts and for an integrator that goes back. */
#ifndef EHD_SAVED_RING_H
#define EHD_SAVED_RING_H

#include "common/program/status.h"
#include "common/time/bdf.h"
#include "common/time/frame.h"

/* How a solver's own states become numbers and come back. */
typedef struct saved_states {
    size_t num_states; // BDF_PREVIOUS, or one more if a state may be passing
    size_t size;       // numbers of a state, without its frame
    /* The state at a place of the ring, and its frame. */
    void (*save)(double *target, contact_frame *frame, const void *self, size_t place);
    /* Back, ready for the next step. EHD_DATA: no numbers of a state. */
    ehd_status (*restore)(void *self, size_t place, const contact_frame *frame,
                          const double *source, ehd_error *error);
} saved_states;

/* Numbers of a frame, all of whose members are doubles. */
enum { NUM_FRAME = sizeof(contact_frame) / sizeof(double) };
_Static_assert(sizeof(contact_frame) == NUM_FRAME * sizeof(double), "a frame is doubles alone");

/* The frame at the front of a saved state, behind which there are `size` numbers. EHD_DATA: it is no
 * frame, or a number is not finite. */
ehd_status saved_frame(contact_frame *frame, const double *saved, size_t size, ehd_error *error);

/* Numbers of all states: how many count, and each with its frame. */
size_t ring_saved_size(const saved_states *states);

/* The states that the ring holds. */
void ring_save(
    // output:
    double *saved, // [ring_saved_size]
    // input:
    const bdf_ring *ring, const saved_states *states, const void *self);

/* EHD_DATA: no such numbers; the ring then has no states. */
ehd_status ring_restore(
    // in and out:
    bdf_ring *ring, void *self,
    // input:
    const double *saved, const saved_states *states, ehd_error *error);

#endif
