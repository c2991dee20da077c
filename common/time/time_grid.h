/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Default grid of a contact that varies with time, and whether a grid suffices at one time. */
#ifndef EHD_TIME_GRID_H
#define EHD_TIME_GRID_H

#include "common/physics/grid_choice.h"
#include "common/time/history.h"

/* Returns the extent that a contact needs from T = 0 to `end_time`. The step is that of the
 * reference. The ends suit the smallest M of all times too, whose thick film has a long inlet.
 * Loads below frame_negligible_load count as this load. If the grid would have more than 10,000
 * nodes, loads below twice this, 4 times, ... do, or the ends are those of the reference. If the
 * entrainment reverses, there is an inlet on either side. */
grid_extent time_grid_extent(const ehd_histories *histories, const ehd_contact *reference,
                             double end_time);

/* Returns grid_inlet_effect for a frame's contact. `backwards`: the fluid enters at the grid's
 * other end. */
double time_grid_inlet_effect(const ehd_contact *contact, bool backwards);

#endif
