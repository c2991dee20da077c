/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Frames (common/time/frame.h) of a contact with other load, speed, radius and modulus, and times
 * of steps. */
#ifndef EHD_FRAMES_H
#define EHD_FRAMES_H

#include "common/time/bdf.h"
#include "common/time/frame.h"

/* Factors on load, speed, radius and modulus. */
enum { NUM_FACTORS = 9 };
extern const double factors[NUM_FACTORS][4];

/* Returns the frame at time 0.5. If the approach is NaN, the load is given. */
contact_frame frame_of(const contact_kind *kind, double load, double speed, double radius,
                       double modulus, double approach);
contact_frame frame_of_case(const contact_kind *kind, size_t i);

/* Fills [BDF_PREVIOUS + 1] times: `now` and the times of the previous states. lengths[0] is the
 * length of the current step. */
void fill_times(double *time, double now, const double *lengths);

#endif
