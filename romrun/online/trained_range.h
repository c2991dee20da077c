/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which contacts a model was trained for. */
#ifndef EHD_TRAINED_RANGE_H
#define EHD_TRAINED_RANGE_H

#include "common/physics/contact_place.h"
#include "common/time/frame.h"
#include "romrun/model/reduced_model.h"

/* Coordinates of a contact in the trained range: ln M, ln(alpha p_H), and of a flow that is thinned
 * the logarithm of by how much (contact_place.h). Regions of load, speed, sliding and Eyring's stress,
 * or of M and L, are polytopes in them, and what varies in one of these alone is a straight line. */
enum { RANGE_AXES = 4 };
void trained_place(double place[RANGE_AXES], contact_place of);

/* The trained range: convex hull of the training points in these coordinates, and fastest change. */
typedef struct trained_range trained_range;
trained_range *trained_range_create(const reduced_model *model); // NULL: no memory
trained_range *trained_range_free(trained_range *range);         // accepts and returns NULL

/* Memory of one thread for checks of a range, and for the texts of their reasons; NULL: there is none. */
typedef struct range_memory range_memory;
range_memory *range_memory_create(const trained_range *range);
range_memory *range_memory_free(range_memory *memory); // accepts and returns NULL

/* Why a contact lies outside, or NULL; valid until the next check with this memory. `memory` NULL: the check
 * takes memory of its own, and does not name a lubricant. `rates`: at which the contact changes; NULL: it is
 * stationary. Without a lubricant in `place` any is inside. */
const char *trained_range_check(const trained_range *range, range_memory *memory,
                                contact_place place, const frame_rates *rates);

/* How far outside a contact lies, to choose among the ranges of models of parts: of one that lies inside not
 * above 0, the less the deeper, in parts of the range's extent; else above 0, a distance in the coordinates
 * themselves, which are those of all ranges. */
double trained_range_outside(const trained_range *range, range_memory *memory, contact_place place);

#endif
