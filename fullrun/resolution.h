/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Resolution of a stationary solution, and effects of domain and step on its central film. */
#ifndef EHD_RESOLUTION_H
#define EHD_RESOLUTION_H

#include "fullrun/full_solver.h"
#include <stddef.h>

typedef struct full_resolution {
    // estimated relative change of H_c:
    double inlet_effect; // by an inlet from minus infinity; NaN for a point contact
    double step_effect;  // in the limit of small steps; NaN: twice the step does not converge
    double order;        // of convergence of H_c over steps h, 2h, 4h; NaN: none observed
    // at Y = 0:
    size_t inlet_nodes;  // between 10 and 90 % of the centre's viscous pressure
    size_t spike_nodes;  // above half the height of the pressure spike; 0: no spike
    size_t outlet_nodes; // from the minimum film behind X = 0 to the exit
} full_resolution;

/* Solves on grids of twice and four times the step, from the solution: about a fifth of its cost.
 * Errors: EHD_MEMORY, EHD_INTERNAL, EHD_INTERRUPTED. */
ehd_status full_resolution_estimate(
    // output:
    full_resolution *resolution,
    // input:
    const full_state *state, // converged, stationary
    const ehd_contact *contact, ehd_error *error);

#endif
