/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which contacts a model was trained for. */
#ifndef EHD_TRAINED_RANGE_H
#define EHD_TRAINED_RANGE_H

#include "common/algebra/hull.h"
#include "common/physics/contact_place.h"
#include "common/time/frame.h"
#include "romrun/model/reduced_model.h"

/* Coordinates of a contact in the trained range: ln M, ln(alpha p_H), and of a flow that is thinned
 * the logarithm of by how much (contact_place.h). Regions of load, speed, sliding and Eyring's stress,
 * or of M and L, are polytopes in them, and what varies in one of these alone is a straight line. */
enum { RANGE_AXES = 3 };
void trained_place(double place[RANGE_AXES], contact_place of);

/* The trained range: convex hull of the training points in these coordinates, and fastest change. */
typedef struct trained_range trained_range;
trained_range *trained_range_create(const reduced_model *model); // NULL: no memory
trained_range *trained_range_free(trained_range *range);         // accepts and returns NULL

/* Memory that checks of a range take, kept from one to the next; NULL: there is none. Free with
 * hull_space_free. */
hull_space *trained_range_space(const trained_range *range);

/* Why a contact lies outside, or NULL. `rates`: at which it changes; NULL: it is stationary. `space`: of this thread
 * alone; NULL: a check takes memory of its own where flow is thinned. */
const char *trained_range_check(const trained_range *range, hull_space *space, contact_place place,
                                const frame_rates *rates);

/* How far outside a contact lies, to choose among the ranges of models of parts: of one that lies inside not
 * above 0, the less the deeper, in parts of the range's extent; else above 0, a distance in the coordinates
 * themselves, which are those of all ranges. */
double trained_range_outside(const trained_range *range, hull_space *space, contact_place place);

#endif
