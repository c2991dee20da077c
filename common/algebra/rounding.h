/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sets the tolerance for round-off in comparisons of numbers. The tolerance follows from no
 * equation.
 * Used by common, romrun and snapgen to compare grids, times, settings and states. */
#ifndef EHD_ROUNDING_H
#define EHD_ROUNDING_H

/* Largest relative difference at which two numbers are treated as equal. Examples are a given and
 * a default grid, or two times that are different sums of steps. Round-off changes some units of
 * the 16th digit. Numbers that are meant to differ do so within the six digits of messages. With 0
 * a step at its limit is taken as too long (test_apart.c,
 * steps_in_which_bodies_part_or_touch_are_short). */
static const double ROUNDING = 1e-9;

#endif
