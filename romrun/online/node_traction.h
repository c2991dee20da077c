/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Traction of a state at nodes, by the model's cubature (README.md, traction): nothing has the size
 * of the grid. */
#ifndef EHD_NODE_TRACTION_H
#define EHD_NODE_TRACTION_H

#include "common/physics/traction.h"
#include "romrun/online/node_state.h"

/* Of the present state, which has been expanded; the model has a cubature. */
contact_traction nodes_traction(node_state *self, const double *z, const ehd_contact *contact,
                                const contact_scalars *scalars); // of the state: load and exit

/* Adds the derivatives of int tau dA by the coordinates to [num_unknowns]; but for what the cell
 * behind the last node with pressure has, where the fluid is thin. */
void nodes_add_friction(double *target,
                        double *influence, // [nodes of the band], is lost
                        node_state *self, const double *z, const ehd_contact *contact);

/* What int tau dA changes by where exits are a node off: on each line that of its last node times its
 * risk, as if lines had nothing to do with each other. */
double nodes_friction_of_exits(node_state *self, const double *z, const ehd_contact *contact,
                               const double *risk); // [num_lines]

#endif
