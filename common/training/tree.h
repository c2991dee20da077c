/* SPDX-License-Identifier: GPL-3.0-or-later */
/* In which order points are solved: each one starts from a neighbour that is solved before. */
#ifndef EHD_TREE_H
#define EHD_TREE_H

#include "common/program/status.h"
#include <stddef.h>

#define NO_PARENT ((size_t)-1)

enum { TREE_AXES = 4 };

/* A point as the tree sees it. Points of different families are never neighbours. */
typedef struct tree_point {
    size_t family;
    double
        place[TREE_AXES]; // distances are Euclidean, after each coordinate is scaled to its range
    double effort;        // of a cold start, in any unit
} tree_point;

/* What each coordinate is divided by: its range over all points, 1 where there is none. */
void tree_scale(double scale[TREE_AXES], const tree_point *points, size_t num_points);

/* Infinite between families. */
double tree_distance(const tree_point *left, const tree_point *right,
                     const double scale[TREE_AXES]);

/* Minimum spanning trees, one a family, rooted where a cold start is easiest (Prim's method). Of
 * equal choices the first point wins, so that the same points always give the same tree.
 * O(num_points^2). EHD_MEMORY. */
ehd_status tree_build(
    // output:
    size_t *parent, // [num_points], NO_PARENT at a root
    // input:
    const tree_point *points, size_t num_points, ehd_error *error);

/* Parents first, and those first on which the longest chains wait. EHD_MEMORY. */
ehd_status tree_order(
    // output:
    size_t *order, // [num_points]
    // input:
    const size_t *parent, size_t num_points, ehd_error *error);

/* Depth first, children in the order of their numbers: a piece of this order is a few connected
 * branches. EHD_MEMORY. */
ehd_status tree_walk(
    // output:
    size_t *walk, // [num_points]
    // input:
    const size_t *parent, size_t num_points, ehd_error *error);

#endif
