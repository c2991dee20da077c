/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes scenes between the scenes of a training, for the validation of a model that was made from
 * the training. Which scenes are neighbours follows from Gabriel's graph (deimselect/README.md, The
 * check).
 * Called by romrun/calibrate/check_scenes.c. */
#ifndef EHD_BETWEEN_H
#define EHD_BETWEEN_H

#include "common/training/training_set.h"

/* Makes the scenes half-way between neighbours of a training. Stationary points and trajectories
 * are never neighbours. Each number in which two scenes differ takes the value in the middle. If
 * both numbers are positive, this is the geometric mean, so that ln M and ln(alpha p_H) of physical
 * scenes also lie in the middle.
 *
 * Two points of one lubricant and group are neighbours if no third point sees them at an obtuse
 * angle (Gabriel's graph). In a grid of points, a point has neighbours along lines and diagonals of
 * the grid. The two diagonals of a cell have the same middle, which is taken once. Two trajectories
 * that differ only in numbers are neighbours if no third trajectory sees them at an obtuse angle. A
 * trajectory that differs from all others in more than numbers has no neighbours. The result
 * contains one scene for it, with half its swing: half the amplitudes, and half of each ramp and
 * step.
 *
 * The scenes are in the order of the plan. The result may have no points at all. The run time is
 * O(num_points^3) at worst. Errors: EHD_MEMORY. */
ehd_status between_neighbours(
    // output:
    plan *between, // free with plan_free; groups and bounds are those of `of`
    // input:
    const plan *of,
    const training_set *trained, // training set of the plan `of`
    const char *name,            // name of the plan, for errors
    ehd_error *error);

/* Chooses points that are far apart. Begins with the first point. Then always adds the point
 * farthest from the chosen points, or the first of equally far points. Points of different
 * lubricants or groups are infinitely far apart. So each lubricant of each group gets a first point
 * before any gets a second, even if this takes more than `count` points. Errors: EHD_MEMORY. */
ehd_status between_spread(
    // output:
    bool *chosen, // [num_points]
    // input:
    const training_set *set, size_t count, ehd_error *error);

/* Chooses `count` more points, evenly along the list that tree_walk makes of the set's tree. Each
 * part of the parameter space gets chosen points in proportion to its number of points, so the
 * chosen points are a fair sample. The points of between_spread are no fair sample: they are mostly
 * at the edge of this space. Errors: EHD_MEMORY. */
ehd_status between_sweep(
    // in and out:
    bool *chosen, // [num_points]
    // input:
    const training_set *set, size_t count, ehd_error *error);

/* Chooses trajectories like between_spread, but never more than `count`. */
ehd_status between_spread_trajectories(
    // output:
    bool *chosen, // [num_trajectories]
    // input:
    const training_set *set, size_t count, ehd_error *error);

/* Removes the points of a plan for which `keep`, [num_points], is false, and renews the text of the
 * plan. Errors: EHD_MEMORY. */
ehd_status between_keep(plan *of, const bool *keep, const char *name, ehd_error *error);

#endif
