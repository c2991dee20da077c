/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the minimum of a film between the nodes, by quartics through five nodes.
 * Called by fullrun/scalars.c and romrun/state/node_state.c for the minimum film. */
#ifndef EHD_MINIMUM_H
#define EHD_MINIMUM_H

#include "common/physics/contact.h"

/* Returns the minimum of the interpolated film near `node`, the node with the smallest film. Along
 * the entrainment the film is interpolated by the quartic through five nodes. In point contacts
 * another quartic interpolates the minima of five lines across. On each line the minimum is taken
 * around the lowest node of the valley, because the valley (the constriction) may shift by several
 * nodes from one line to the next.
 *
 * If one of the five lines is missing, the result is the minimum on the line of `node`. If a node
 * of this line is missing (its `value` is NaN), the result is the value at `node`. In the published
 * discretisation the result is always the value at `node`. */
double minimum_around(const ehd_grid *grid, size_t node,
                      double (*value)(const void *context, size_t node), const void *context);

#endif
