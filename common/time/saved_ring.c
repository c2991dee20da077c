/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/time/saved_ring.h"

#include <math.h>
#include <string.h>

ehd_status saved_frame(contact_frame *frame, const double *saved, size_t size, ehd_error *error) {
    memcpy(frame, saved, sizeof *frame);
    if (!frame_is_valid(frame))
        return ehd_fail(error, EHD_DATA,
                        "saved state: found a frame of half width %g, expected a contact's",
                        frame->half_width);
    for (size_t i = NUM_FRAME; i < NUM_FRAME + size; i++)
        if (!isfinite(saved[i]))
            return ehd_fail(error, EHD_DATA, "saved state: found %g, expected finite values",
                            saved[i]);
    return EHD_OK;
}

enum { NUM_PREVIOUS, IS_PASSING, NUM_HEAD };

/* Returns the number of states: the previous ones and a passing one, which exists only if the ring
 * has all previous ones. */
static size_t num_saved(const bdf_ring *ring) {
    return ring->num_previous + (ring->passing ? 1 : 0);
}

size_t ring_saved_size(const saved_states *states) {
    return NUM_HEAD + states->num_states * (NUM_FRAME + states->size);
}

void ring_save(double *saved, const bdf_ring *ring, const saved_states *states, const void *self) {
    memset(saved, 0, ring_saved_size(states) * sizeof *saved);
    saved[NUM_PREVIOUS] = (double)ring->num_previous;
    saved[IS_PASSING] = ring->passing ? 1 : 0;
    saved += NUM_HEAD;
    for (size_t i = 0; i < num_saved(ring); i++, saved += NUM_FRAME + states->size) {
        contact_frame frame;
        states->save(saved + NUM_FRAME, &frame, self, ring->place[i + 1]);
        memcpy(saved, &frame, sizeof frame);
    }
}

/* Checks that each accepted state is later than the one before it. EHD_DATA: the ring then has no
 * states. */
static ehd_status check_times(bdf_ring *ring, ehd_error *error) {
    const size_t count = num_saved(ring);

    for (size_t i = 1; i < count; i++) {
        const double later = ring->time[bdf_ring_accepted(ring, i)];
        const double time = ring->time[bdf_ring_accepted(ring, i + 1)];
        if (later > time) continue;
        bdf_ring_keep(ring, 0);
        return ehd_fail(error, EHD_DATA,
                        "saved state: found time %g after %g, expected a later one", later, time);
    }
    return EHD_OK;
}

ehd_status ring_restore(bdf_ring *ring, void *self, const double *saved, const saved_states *states,
                        ehd_error *error) {
    const double count = saved[NUM_PREVIOUS], passing = saved[IS_PASSING];

    bdf_ring_keep(ring, 0);
    if (!(isgreaterequal(count, 1) && count <= BDF_PREVIOUS && count == floor(count)))
        return ehd_fail(error, EHD_DATA, "saved state: found %g previous states, expected 1 to %d",
                        count, BDF_PREVIOUS);
    const bool may_pass = count == BDF_PREVIOUS && states->num_states > BDF_PREVIOUS;
    if (passing != 0 && !(passing == 1 && may_pass))
        return ehd_fail(error, EHD_DATA, "saved state: found %g passing states, expected %s",
                        passing, may_pass ? "0 or 1" : "0");
    saved += NUM_HEAD;
    for (size_t i = 0; i < (size_t)(count + passing); i++, saved += NUM_FRAME + states->size) {
        const size_t place = ring->place[i + 1];
        contact_frame frame;
        ehd_status status = saved_frame(&frame, saved, states->size, error);
        if (!status) status = states->restore(self, place, &frame, saved + NUM_FRAME, error);
        if (status) return status;
        ring->time[place] = frame.time;
    }
    bdf_ring_keep(ring, (size_t)count);
    ring->passing = passing == 1;
    return check_times(ring, error);
}
