/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chooses the candidates that are trained on next: corners of the hull, then largest error
 * estimates (README.md, Training where it matters).
 * Called by adaptive.c in each round. */
#ifndef EHD_POINT_CHOICE_H
#define EHD_POINT_CHOICE_H

#include "common/training/tree.h"
#include "romrun/trust/trained_range.h"
#include <stdbool.h>

/* Finds the corners of the convex hull of places, except corners at most `tolerance` outside the
 * hull of the other corners. Returns their number, 0 if there is no memory. Of equal places the
 * first is taken, so that the result depends on the places alone.
 * - In a plane, where only the first two coordinates differ, quickhull (Barber, Dobkin and
 *   Huhdanpaa 1996) stops at this tolerance.
 * - Otherwise the places furthest outside are added, one after the other. */
size_t point_choice_corners(
    // output:
    size_t *corners, // [return value], room for num_points
    // input:
    const double (*places)[RANGE_AXES], size_t num_points, double tolerance);

typedef struct candidates {
    const tree_point *points; // [num_points]
    size_t num_points;
    const bool *trained;     // [num_points] whether it was trained on before
    const double *indicated; // [num_points] error estimate; infinite: not known
    double accuracy;         // only candidates with a larger estimate are chosen
} candidates;

/* Chooses the candidates with the largest error estimates, the largest first. Of equal estimates it
 * takes the candidate furthest from all trained points.
 * - Every second choice is the largest finite estimate, if there is one. Otherwise a few candidates
 *   with infinite estimates would take all places.
 * - A candidate lies no nearer to the others chosen now than to the points taken before, because
 *   training on a candidate also improves the model near this candidate. If too few candidates are
 *   that far away, half of this distance is enough, and so on.
 *
 * Fewer than `max_chosen` are chosen only if there are no more candidates. EHD_MEMORY. */
ehd_status point_choice_worst(
    // output:
    size_t *chosen, // [*num_chosen], room for `max_chosen`
    size_t *num_chosen,
    // input:
    const candidates *from, size_t max_chosen, ehd_error *error);

#endif
