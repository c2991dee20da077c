/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the order in which points are solved: the solution of each point starts from a neighbour
 * that is solved before it. The trees are minimum spanning trees (Prim's method).
 * Called by training_set.c and between.c, and by adaptive.c and point_choice.c of snapgen. */
#ifndef EHD_TREE_H
#define EHD_TREE_H

#include "common/program/status.h"
#include <stddef.h>

#define NO_PARENT ((size_t)-1)

enum { TREE_AXES = 4 };

/* A point of the tree. A family is a set of points that may start from each other, such as points
 * with the same lubricant. */
typedef struct tree_point {
    size_t family;
    double place[TREE_AXES]; // coordinates; each is scaled to its range for Euclidean distances
    double effort;           // effort of a cold start, in any unit
} tree_point;

/* Computes the divisor of each coordinate: its range over all points, or 1 if the range is 0. */
void tree_scale(double scale[TREE_AXES], const tree_point *points, size_t num_points);

/* Returns the scaled distance between two points; infinite if they belong to different families. */
double tree_distance(const tree_point *left, const tree_point *right,
                     const double scale[TREE_AXES]);

/* Builds minimum spanning trees, one per family, with the root where a cold start is easiest
 * (Prim's method). Of equal choices the first point wins, so the same points always give the same
 * tree. The run time is O(num_points^2). Errors: EHD_MEMORY. */
ehd_status tree_build(
    // output:
    size_t *parent, // [num_points], NO_PARENT at a root
    // input:
    const tree_point *points, size_t num_points, ehd_error *error);

/* Orders the points. Parents come before their children. Points that the longest chains of other
 * points wait for come first. Errors: EHD_MEMORY. */
ehd_status tree_order(
    // output:
    size_t *order, // [num_points]
    // input:
    const size_t *parent, size_t num_points, ehd_error *error);

/* Lists the points depth first, with children in the order of their numbers. A contiguous piece of
 * this list consists of a few connected branches. Errors: EHD_MEMORY. */
ehd_status tree_walk(
    // output:
    size_t *walk, // [num_points]
    // input:
    const size_t *parent, size_t num_points, ehd_error *error);

#endif
