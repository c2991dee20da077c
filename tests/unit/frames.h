/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Frames of a contact whose load, speed, radius and modulus have changed, and times of steps. */
#ifndef EHD_FRAMES_H
#define EHD_FRAMES_H

#include "common/time/bdf.h"
#include "common/time/frame.h"

/* Factors on load, speed, radius and modulus. */
enum { NUM_FACTORS = 9 };
extern const double factors[NUM_FACTORS][4];

/* At time 0.5; approach NaN: by the load. */
contact_frame frame_of(const contact_kind *kind, double load, double speed, double radius,
                       double modulus, double approach);
contact_frame frame_of_case(const contact_kind *kind, size_t i);

/* Times of the state being solved and of those before it, [BDF_PREVIOUS + 1]; lengths[0] is that of
 * the step under way. */
void fill_times(double *time, double now, const double *lengths);

#endif
