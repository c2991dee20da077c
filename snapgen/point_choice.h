/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chooses the candidates that are trained on next: first the corners of the convex hull of all
 * candidates, then candidates with the largest error estimates (README.md, Training where it
 * matters).
 * Called by adaptive.c in each round. */
#ifndef EHD_POINT_CHOICE_H
#define EHD_POINT_CHOICE_H

#include "common/training/tree.h"
#include "romrun/trust/trained_range.h"
#include <stdbool.h>

/* Finds the corners of the convex hull of points with the coordinates `places`. Leaves out corners
 * that lie at most `tolerance` outside the hull of the other corners. Returns the number of
 * corners, 0 if there is no memory. Of points with equal coordinates only the first can be a
 * corner, so that the corners depend only on the coordinates.
 * - If all points lie in a plane (only the first two coordinates differ), finds the corners by
 *   quickhull (Barber, Dobkin and Huhdanpaa 1996), which stops at this tolerance.
 * - Otherwise repeatedly adds the point that lies furthest outside the hull so far. */
size_t point_choice_corners(
    // output:
    size_t *corners, // [return value], room for num_points
    // input:
    const double (*places)[RANGE_AXES], size_t num_points, double tolerance);

typedef struct candidates {
    const tree_point *points; // [num_points]
    size_t num_points;
    const bool *trained;     // [num_points] whether the candidate was trained on before
    const double *indicated; // [num_points] error estimate; infinite: the error is not known
    double accuracy;         // only candidates with a larger estimate are chosen
} candidates;

/* Chooses the candidates with the largest error estimates, the largest first. If estimates are
 * equal, chooses the candidate that is furthest from all trained and chosen points.
 * - Every second choice is the candidate with the largest finite estimate, if there is one.
 *   Without this rule a few candidates with infinite estimates would fill the whole round.
 * - Training on a candidate also improves the model near this candidate. A candidate is therefore
 *   chosen only if it is at least as far from the candidates chosen now as from the points trained
 *   before. If too few candidates are so far away, half of this distance is enough, and so on.
 *
 * Fewer than `max_chosen` are chosen only if there are no more candidates. EHD_MEMORY. */
ehd_status point_choice_worst(
    // output:
    size_t *chosen, // [*num_chosen], room for `max_chosen`
    size_t *num_chosen,
    // input:
    const candidates *from, size_t max_chosen, ehd_error *error);

#endif
