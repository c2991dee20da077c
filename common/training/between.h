/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scenes between those of a training, for a check of what is made of it. */
#ifndef EHD_BETWEEN_H
#define EHD_BETWEEN_H

#include "common/training/training_set.h"

/* The scenes half-way between neighbours of a training, its trajectories apart from its stationary
 * points: each number in which two scenes differ is in the middle, the geometric mean where both
 * are positive, so that ln M and ln(alpha p_H) of physical scenes are in the middle too. Neighbours
 * are two points, of one lubricant and group, that no third one sees at an obtuse angle (Gabriel's
 * graph), of a grid those along its lines and its diagonals, whose common middle counts once; of
 * trajectories two that differ in numbers only; one that has no such other has half its own swing:
 * half the amplitudes, ramps and steps half-way. Pairs in the order of the plan. May have no points
 * at all. O(num_points^3) at worst. EHD_MEMORY. */
ehd_status between_neighbours(
    // output:
    plan *between, // free with plan_free; groups and bounds are those of `of`
    // input:
    const plan *of,
    const training_set *trained, // of that plan
    const char *name,            // of the plan, for errors
    ehd_error *error);

/* Chooses points far from one another: the first, then always the one that is farthest from those
 * chosen, the first of equals; one of each lubricant and group before a second one of any, and of all
 * of these at least one. EHD_MEMORY. */
ehd_status between_spread(
    // output:
    bool *chosen, // [num_points]
    // input:
    const training_set *set, size_t count, ehd_error *error);

/* Chooses so many more points evenly along the walk through the set's tree, as many of a part of the
 * region as it has: a sample, where those far from one another are mostly at the edge. EHD_MEMORY. */
ehd_status between_sweep(
    // in and out:
    bool *chosen, // [num_points]
    // input:
    const training_set *set, size_t count, ehd_error *error);

/* As between_spread, of trajectories, never more than `count`. */
ehd_status between_spread_trajectories(
    // output:
    bool *chosen, // [num_trajectories]
    // input:
    const training_set *set, size_t count, ehd_error *error);

/* Leaves only points of a plan that `keep`, [num_points], says, and renews its text. EHD_MEMORY. */
ehd_status between_keep(plan *of, const bool *keep, const char *name, ehd_error *error);

#endif
