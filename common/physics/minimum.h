/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the minimum of a film between the nodes, by quartics through five nodes.
 * Called by fullrun/scalars.c and romrun/state/node_state.c for the minimum film. */
#ifndef EHD_MINIMUM_H
#define EHD_MINIMUM_H

#include "common/physics/contact.h"

/* Returns the minimum of the film interpolated around `node`, where it is smallest at the nodes.
 * Along the entrainment the interpolation is the quartic through five nodes. Across it is the
 * quartic through the minima of five lines, each around the lowest node of the valley. The
 * constriction of a point contact is a valley that crosses several nodes from one line to the next.
 * If lines are missing, the result is the minimum of the node's line. If a node of this line is
 * missing (its `value` is NaN), or in the published discretisation, the result is the value at the
 * node. */
double minimum_around(const ehd_grid *grid, size_t node,
                      double (*value)(const void *context, size_t node), const void *context);

#endif
