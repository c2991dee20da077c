/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks whether a contact lies in the range that a model was trained for, the convex hull of the
 * training points (README.md, Results that are rejected).
 * Called by romrun/online for each result, by romrun/calibrate, by deimselect and by
 * snapgen/adaptive.c. */
#ifndef EHD_TRAINED_RANGE_H
#define EHD_TRAINED_RANGE_H

#include "common/physics/contact_place.h"
#include "common/time/frame.h"
#include "romrun/model/reduced_model.h"

/* Computes the coordinates of a contact in the trained range: ln M, ln(alpha p_H), and the
 * logarithms of the thinning of the flow by sliding and by the gradient (contact_place.h). A region
 * of load, speed, sliding and Eyring's stress, or of M and L, is a polytope in these coordinates.
 * Contacts that differ only in one of these quantities lie on a straight line. */
enum { RANGE_AXES = 4 };
void trained_place(double place[RANGE_AXES], contact_place of);

/* The trained range: the convex hull of the training points in the coordinates of trained_place,
 * and the rates of the fastest changes in training. */
typedef struct trained_range trained_range;
trained_range *trained_range_create(const reduced_model *model); // NULL: no memory
trained_range *trained_range_free(trained_range *range);         // accepts and returns NULL

/* Work memory of one thread for checks of a range, including the texts of reasons.
 * range_memory_create returns NULL without memory. */
typedef struct range_memory range_memory;
range_memory *range_memory_create(const trained_range *range);
range_memory *range_memory_free(range_memory *memory); // accepts and returns NULL

/* Returns the reason why a contact lies outside of the range, or NULL if it lies inside. The text
 * is valid until the next check with this memory. `memory` NULL: the check allocates its own
 * memory, and the text does not name a lubricant. `rates`: rates of change of the contact; NULL:
 * the contact is stationary. If `place` has no lubricant, lubricants are not checked. */
const char *trained_range_check(const trained_range *range, range_memory *memory,
                                contact_place place, const frame_rates *rates);

/* Returns how far outside of the range a contact lies, for comparing the ranges of several models.
 * Outside, the result is the distance from the range in the coordinates of trained_place. Inside,
 * the result is minus the distance from the border, relative to the extent of the range. */
double trained_range_outside(const trained_range *range, range_memory *memory, contact_place place);

#endif
