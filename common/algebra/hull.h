/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes distances from the convex hull of points in up to four dimensions. The method is
 * non-negative least squares (nnls.h), which does not need the facets of the hull.
 * Called by romrun/trust to check whether a contact and its lubricant lie within the training data,
 * and by snapgen/point_choice.c. */
#ifndef EHD_HULL_H
#define EHD_HULL_H

#include <stddef.h>

enum { HULL_AXES = 4 }; // largest num_axes

/* Returns approximately the distance of a place p from the convex hull of the points p_i. The
 * result is the smallest length of the vector (p - sum x_i p_i, 1 - sum x_i) for x >= 0. The
 * coordinates must be of the order of 1. Inside the hull the result is below 1e-10. The result is
 * infinite when out of memory, and if a number is not finite. */
double hull_distance(const double *points, // [num_axes, num_points]
                     size_t num_points, size_t num_axes,
                     const double *place); // [num_axes]

/* Memory for hull_distance_in with at most max_points points. */
typedef struct hull_space hull_space;
hull_space *hull_space_create(size_t max_points); // NULL when out of memory
hull_space *hull_space_free(hull_space *space);   // accepts and returns NULL
/* Like hull_distance, but uses memory that the caller keeps between calls. The result is infinite
 * if num_points exceeds the max_points of the memory. */
double hull_distance_in(hull_space *space, const double *points, size_t num_points, size_t num_axes,
                        const double *place);

#endif
