/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The grid of a contact where nobody gives one: wide enough for its inlet, fine enough for its
 * film (README.md, default grid). */
#ifndef EHD_GRID_CHOICE_H
#define EHD_GRID_CHOICE_H

#include "common/physics/contact.h"

/* The extent that a contact needs with the accurate rows, by its M and L. */
grid_extent grid_extent_needed(const ehd_contact *contact);

/* Extends one to what serves both. */
void grid_extent_join(grid_extent *self, const grid_extent *other);

/* The grid of what is given, NaN where it is not, and else of what is needed: ends that are not
 * given move outwards, and a step that is not given is reduced, until whole steps fit.
 * Discretisation, boundary and, of a point contact, half are those of `like`. */
ehd_grid grid_choose(const grid_extent *given, const grid_extent *needed, const ehd_grid *like);

#endif
