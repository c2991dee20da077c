/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Round-off of numbers that are compared. */
#ifndef EHD_ROUNDING_H
#define EHD_ROUNDING_H

/* Relative difference up to which two numbers count as equal, such as a given and a default grid, or
 * times after different sums. Round-off leaves some units of the 16th digit; numbers that differ on
 * purpose differ in the six digits of messages. With 0 a step at its limit counts as too long
 * (test_apart.c, steps_in_which_bodies_part_or_touch_are_short). */
static const double ROUNDING = 1e-9;

#endif
