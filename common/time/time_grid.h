/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the default grid of a contact that varies with time, and checks whether a grid is long
 * enough at a given time (common/physics/README.md, Default grid).
 * Called by fullrun/main.c and common/training/training_set.c, and by fullrun/full_march.c for
 * each step. */
#ifndef EHD_TIME_GRID_H
#define EHD_TIME_GRID_H

#include "common/physics/grid_choice.h"
#include "common/time/history.h"

/* Returns the extent of the grid that a contact needs from T = 0 to `end_time`. The grid step is
 * the step of the reference's grid. The inlet suits the time of the smallest M, when the film is
 * thickest: the estimated error of the central film is then at most 3 %. Three rules determine the
 * length:
 * - Loads below default_accuracy times the reference load are replaced by this value.
 * - The grid has at most 10,000 nodes, or at most twice the nodes of the reference if these are
 *   more. M is doubled until the grid is small enough.
 * - If the entrainment reverses, both ends have an inlet. */
grid_extent time_grid_extent(const ehd_histories *histories, const ehd_contact *reference,
                             double end_time);

/* Checks whether the inlet of a frame's contact is too short: the estimated error exceeds 5 %, and
 * the default grid of a stationary contact is longer. `backwards`: the fluid enters at the grid's
 * other end. */
bool time_grid_is_short(
    // output:
    double *effect, // grid_inlet_effect
    // input:
    const ehd_contact *contact, bool backwards);

#endif
