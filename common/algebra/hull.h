/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Convex hulls of points in any dimension, without their facets. */
#ifndef EHD_HULL_H
#define EHD_HULL_H

#include <stddef.h>

enum { HULL_AXES = 4 }; // at most

/* About how far a place lies outside of the convex hull of points: |p - sum x_i p_i| and
 * |1 - sum x_i| together, with x >= 0 that makes this least. Infinite where there is no memory, and
 * of numbers that are not finite. Coordinates of the order of 1; inside it is below 1e-10. */
double hull_distance(const double *points, // [num_axes, num_points]
                     size_t num_points, size_t num_axes,
                     const double *place); // [num_axes]

/* The same in memory that is kept, of at most so many points, infinite for more; NULL: there is none. */
typedef struct hull_space hull_space;
hull_space *hull_space_create(size_t max_points);
hull_space *hull_space_free(hull_space *space); // accepts and returns NULL
double hull_distance_in(hull_space *space, const double *points, size_t num_points, size_t num_axes,
                        const double *place);

#endif
