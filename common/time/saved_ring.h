/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The accepted states of a march as numbers, for restarts and for an integrator that goes back. */
#ifndef EHD_SAVED_RING_H
#define EHD_SAVED_RING_H

#include "common/program/status.h"
#include "common/time/bdf.h"
#include "common/time/frame.h"

/* Functions that turn a solver's states into numbers and back. */
typedef struct saved_states {
    size_t num_states; // BDF_PREVIOUS, or one more if a state may be passing
    size_t size;       // numbers of a state, without its frame
    /* Saves the state at a place of the ring, and its frame. */
    void (*save)(double *target, contact_frame *frame, const void *self, size_t place);
    /* Restores a state, ready for the next step. EHD_DATA: the numbers are no state. */
    ehd_status (*restore)(void *self, size_t place, const contact_frame *frame,
                          const double *source, ehd_error *error);
} saved_states;

/* Doubles in a frame, whose members are all doubles. */
enum { NUM_FRAME = sizeof(contact_frame) / sizeof(double) };
_Static_assert(sizeof(contact_frame) == NUM_FRAME * sizeof(double), "a frame is doubles alone");

/* Reads the frame at the front of a saved state. `size` further numbers follow it. EHD_DATA: it is
 * no frame, or a number is not finite. */
ehd_status saved_frame(contact_frame *frame, const double *saved, size_t size, ehd_error *error);

/* Returns the length of all saved states: how many there are, and each state with its frame. */
size_t ring_saved_size(const saved_states *states);

/* Saves the states that the ring holds. */
void ring_save(
    // output:
    double *saved, // [ring_saved_size]
    // input:
    const bdf_ring *ring, const saved_states *states, const void *self);

/* Restores the states of ring_save. EHD_DATA: the numbers are no such states; the ring then has
 * none. */
ehd_status ring_restore(
    // in and out:
    bdf_ring *ring, void *self,
    // input:
    const double *saved, const saved_states *states, ehd_error *error);

#endif
