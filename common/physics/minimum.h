/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The minimum of a film between the nodes. */
#ifndef EHD_MINIMUM_H
#define EHD_MINIMUM_H

#include "common/physics/contact.h"

/* Minimum of the film interpolated around `node`, where it is smallest at the nodes: along by the
 * quartic through five nodes, across by the quartic through the minima of five lines, each around
 * the lowest node of the valley. The constriction of a point contact is a valley that crosses
 * several nodes from one line to the next. Where lines are missing it is the minimum of the node's
 * line. Without interpolation in the published discretisation, and where a node of the line is
 * missing, whose `value` is NaN. */
double minimum_around(const ehd_grid *grid, size_t node,
                      double (*value)(const void *context, size_t node), const void *context);

#endif
