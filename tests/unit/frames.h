/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Frames (common/time/frame.h) of a contact whose load, speed, radius and modulus are multiples of
 * their reference values, and points in time of previous states. */
#ifndef EHD_FRAMES_H
#define EHD_FRAMES_H

#include "common/time/bdf.h"
#include "common/time/frame.h"

/* Factors on the reference load, speed, radius and modulus, used by frame_of_case. */
enum { NUM_FACTORS = 9 };
extern const double factors[NUM_FACTORS][4];

/* Returns the frame at time 0.5 for factors on load, speed, radius and modulus. If the approach is
 * NaN, the load is given. */
contact_frame frame_of(const contact_kind *kind, double load, double speed, double radius,
                       double modulus, double approach);
contact_frame frame_of_case(const contact_kind *kind, size_t i);

/* Fills [BDF_PREVIOUS + 1] points in time: `now` and the times of the previous states. lengths[i]
 * is the length of the time step that ends at time[i]. */
void fill_times(double *time, double now, const double *lengths);

#endif
