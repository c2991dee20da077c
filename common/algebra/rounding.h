/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Defines the tolerance for round-off in comparisons of numbers, and the distance of difference
 * quotients. The comment at the constant gives the reason for its value.
 * Used by common, romrun and snapgen to compare grids, points in time, settings and states, and as
 * the tolerance of sums of weights and of optimal least squares. */
#ifndef EHD_ROUNDING_H
#define EHD_ROUNDING_H

#include <float.h>
#include <math.h>

/* Largest relative difference at which two numbers are treated as equal. Examples are a given grid
 * and the default grid, or two points in time that were summed from different time steps. Round-off
 * changes a few units of the 16th digit. Numbers that are meant to differ already differ within the
 * six digits that messages print. With a tolerance of 0, a time step of exactly the largest
 * permitted length counts as too long (test_apart.c,
 * steps_in_which_bodies_part_or_touch_are_short). */
static const double ROUNDING = 1e-9;

/* Returns the distance of central difference quotients, relative to the size of the argument. The
 * truncation error is about the square of the distance, the round-off about DBL_EPSILON divided by
 * the distance. The sum of both is smallest at the cube root of DBL_EPSILON, 6e-6. */
static inline double difference_distance(void) {
    return cbrt(DBL_EPSILON);
}

#endif
