/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Default grid of a contact that varies with time, and whether a grid suffices at one time. */
#ifndef EHD_TIME_GRID_H
#define EHD_TIME_GRID_H

#include "common/physics/grid_choice.h"
#include "common/time/history.h"

/* Returns the extent that a contact needs from T = 0 to `end_time`. The step is that of the
 * reference. At the smallest M of all times, where the film is thick, the estimated error of the
 * central film by the inlet is at most 3 %. Loads below frame_negligible_load count as this load.
 * If the grid would have more than 10,000 nodes, and more than twice those of the reference alone,
 * the load that counts is doubled until it has not. If the entrainment reverses, there is an inlet
 * on either side. */
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
