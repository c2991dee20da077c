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

#endif
