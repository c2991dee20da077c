/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How well the grid resolves a stationary solution, and what domain and step do to the central film. */
#ifndef EHD_RESOLUTION_H
#define EHD_RESOLUTION_H

#include "fullrun/full_solver.h"
#include <stddef.h>

typedef struct full_resolution {
    // estimated relative change of H_c
    double
        inlet_effect; // with an inlet of any length, not from x_min on; NaN of a point contact, whose
                      // film far away is another
    double
        step_effect; // with ever smaller steps; NaN where a grid of twice the step does not converge
    double
        order; // of convergence of H_c, observed over steps h, 2h and 4h; NaN where there is none
    // at Y = 0:
    size_t inlet_nodes;  // where the viscous pressure builds up, from 10 to 90 % of it
    size_t spike_nodes;  // above half the height of the pressure spike; 0: there is none
    size_t outlet_nodes; // from the smallest film behind X = 0 to the exit
} full_resolution;

/* Costs two solves on coarser grids, that start from the solution: less than the solution did.
 * Errors: EHD_MEMORY, EHD_INTERNAL, EHD_INTERRUPTED. */
ehd_status full_resolution_estimate(
    // output:
    full_resolution *resolution,
    // input:
    const full_state *state, // converged, stationary
    const ehd_contact *contact, ehd_error *error);

#endif
