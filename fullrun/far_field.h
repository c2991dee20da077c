/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What lies before and beside the grid of a point contact. */
#ifndef EHD_FAR_FIELD_H
#define EHD_FAR_FIELD_H

#include "fullrun/full_solver.h"

/* Makes the grid one of an unbounded inlet: the pressure of the far field at the boundary nodes, where
 * else it is zero, and a closure that counts the load that is carried beyond them. Far away the film
 * is H = r^2/2 + c, for which P = lambda S(phi) r / (2 H)^2 solves the Reynolds equation up to terms
 * of c^2 / r^4, phi from the inlet's axis on, and S = 0.8 cos(phi) + b cosh(3 phi) ends with S = S' =
 * 0 at the exit. Of a stationary point contact. */
void far_field_join(
    // input and output:
    full_state *state, // with the film of a solution
    ehd_contact *contact);

#endif
