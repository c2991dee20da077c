/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes traction of a state from its values at nodes, by the model's cubature
 * (romrun/solve/README.md, Traction). No array has the size of the grid. Called by reduced_solver.c
 * (reduced_traction) and by romrun/trust/functionals.c. */
#ifndef EHD_NODE_TRACTION_H
#define EHD_NODE_TRACTION_H

#include "common/physics/traction.h"
#include "romrun/state/node_state.h"

/* Returns the traction of the present state, which must have been computed by nodes_expand_state.
 * The model must have a cubature. */
contact_traction nodes_traction(node_state *self, const double *z, const ehd_contact *contact,
                                const contact_scalars *scalars); // scalars of the state

/* Adds the derivatives of int tau dA with respect to the coordinates to `target`, [num_unknowns].
 * Neglects the cell behind the last node with pressure, where the viscosity is low. */
void nodes_add_friction(double *target,
                        double *influence, // [nodes of the band] work array
                        node_state *self, const double *z, const ehd_contact *contact);

/* Estimates the change of int tau dA due to exits that are wrong by one node. On each grid line the
 * change is the contribution of the last node with pressure times `risk`, the risk that the exit of
 * this line is wrong. The result is the root of the sum of squares over the lines, because the
 * lines are taken as independent. */
double nodes_friction_of_exits(node_state *self, const double *z, const ehd_contact *contact,
                               const double *risk); // [num_lines]

#endif
