/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which contacts a model was trained for. */
#ifndef EHD_TRAINED_RANGE_H
#define EHD_TRAINED_RANGE_H

#include "romrun/model/reduced_model.h"

/* Coordinates of a contact in the trained range: ln M and ln(alpha p_H). Regions of load and speed, or
 * of M and L, are polygons in them, and what varies in one of these alone is a straight line. */
void trained_place(double place[2], double moes_M, double alpha_p_H);

/* The trained range: convex hull of the training points in these coordinates, and fastest change. */
typedef struct trained_range trained_range;
trained_range *trained_range_create(const reduced_model *model); // NULL: no memory
trained_range *trained_range_free(trained_range *range);         // accepts and returns NULL

/* Why a contact lies outside, or NULL. `rate`: frame_rate, 0 when stationary. */
const char *trained_range_check(const trained_range *range, double moes_M, double alpha_p_H,
                                double rate);

#endif
