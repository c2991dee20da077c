/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which candidates are trained on next. */
#ifndef EHD_POINT_CHOICE_H
#define EHD_POINT_CHOICE_H

#include "common/training/tree.h"
#include "romrun/online/trained_range.h"
#include <stdbool.h>

/* Corners of the convex hull of places, but for those that lie no further than `tolerance` outside
 * of what the others span: in a plane, where the last coordinate is everywhere the same, by quickhull
 * (Barber, Dobkin and Huhdanpaa 1996) that stops early, else the furthest outside one after the
 * other. Of equal ones the first counts. The result depends on the places alone. 0: no memory. */
size_t point_choice_corners(
    // output:
    size_t *corners, // [return value], room for num_points
    // input:
    const double (*places)[RANGE_AXES], size_t num_points, double tolerance);

typedef struct candidates {
    const tree_point *points; // [num_points]
    size_t num_points;
    const bool *trained;     // [num_points] trained on before
    const double *indicated; // [num_points] deviation; infinite where nothing is known
    double accuracy;         // candidates indicated to deviate no more are left out
} candidates;

/* The worst first, of equal ones the one furthest from all that is trained on. Every second one is
 * the worst of those with a finite deviation, where there are any: a few of which nothing is known
 * would else take all places. Two that are chosen together lie no nearer to each other than to what
 * was taken before, because training on one of them mends the other; where that leaves too few,
 * half as near, and so on. Fewer than `max_chosen` only where there are no more candidates.
 * EHD_MEMORY. */
ehd_status point_choice_worst(
    // output:
    size_t *chosen, // [*num_chosen], room for `max_chosen`
    size_t *num_chosen,
    // input:
    const candidates *from, size_t max_chosen, ehd_error *error);

#endif
