/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chooses the default grid of a contact: long enough for its inlet and fine enough for its film
 * (README.md, Default grid).
 * Called by common/settings/scene_contact.c, common/time/time_grid.c and
 * common/training/training_set.c. */
#ifndef EHD_GRID_CHOICE_H
#define EHD_GRID_CHOICE_H

#include "common/physics/contact.h"

/* Number of intervals of the midpoint rule over start/X, for integrals over the inlet upstream of
 * X = start. Numbers from 4 to 400 give the same inlets for seven line contacts (M 0.5 to 1000, L 0
 * to 15; README.md, Default grid). From 20 intervals on, the first two digits of the inlet
 * estimates do not change, for M = 1, 5 and 20 (fullrun/README.md, Estimates of inlet and step). */
enum { INLET_INTERVALS = 200 };

/* Returns the extent that a contact needs in the accurate discretisation, from its M and L. */
grid_extent grid_extent_needed(const ehd_contact *contact);

/* Returns an extent with the shortest inlet for which grid_inlet_effect is at most `effect`. The
 * inlet is not longer than the inlet of grid_extent_needed. */
grid_extent grid_extent_within(const ehd_contact *contact, double effect);

/* Estimates the relative error of the central film if the inlet is `length` long and the contact
 * is stationary (README.md, default grid). INFINITY: the grid begins within the dry contact. The
 * estimate is larger than the error: 1.1 to 5 times for lines, 1.4 to 20 times for points with an
 * open boundary. */
double grid_inlet_effect(const ehd_contact *contact, double length);

/* Extends `self` so that it is long, wide and fine enough for both extents. */
void grid_extent_join(grid_extent *self, const grid_extent *other);

/* Makes a grid from the values in `given`. Values that are NaN come from `needed`. Ends that are
 * not given move outwards, and a step that is not given is reduced, until whole steps fit. The grid
 * has the discretisation, boundary and shape of `like`. The grid of a point contact is a half grid
 * if `like` is a half grid. */
ehd_grid grid_choose(const grid_extent *given, const grid_extent *needed, const ehd_grid *like);

#endif
