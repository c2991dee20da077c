/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Defines the tolerance for round-off in comparisons of numbers. The comment at the constant gives
 * the reason for its value.
 * Used by common, romrun and snapgen to compare grids, points in time, settings and states. */
#ifndef EHD_ROUNDING_H
#define EHD_ROUNDING_H

/* Largest relative difference at which two numbers are treated as equal. Examples are a given grid
 * and the default grid, or two points in time that were summed from different time steps. Round-off
 * changes a few units of the 16th digit. Numbers that are meant to differ already differ within the
 * six digits that messages print. With a tolerance of 0, a time step of exactly the largest
 * permitted length counts as too long (test_apart.c,
 * steps_in_which_bodies_part_or_touch_are_short). */
static const double ROUNDING = 1e-9;

#endif
