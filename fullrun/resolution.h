/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Resolution of a stationary solution, and effects of domain and step on its films. */
#ifndef EHD_RESOLUTION_H
#define EHD_RESOLUTION_H

#include "common/output/film_effects.h"
#include "fullrun/full_solver.h"
#include <stddef.h>

typedef struct full_resolution {
    film_effects effects; // infinite: the grid is too coarse to tell
    double order;         // of convergence of H_c over steps h, 2h, 4h; NaN: none observed
    // at Y = 0:
    size_t inlet_nodes;  // between 10 and 90 % of the centre's viscous pressure
    size_t spike_nodes;  // above half the height of the pressure spike; 0: no spike
    size_t outlet_nodes; // from the minimum film behind X = 0 to the exit
} full_resolution;

/* Solves on grids of twice and four times the step, from the solution, and on one of them also with an
 * endless inlet or a larger domain.
 * Errors: EHD_MEMORY, EHD_INTERNAL, EHD_INTERRUPTED. */
ehd_status full_resolution_estimate(
    // output:
    full_resolution *resolution,
    // input:
    const full_state *state, // converged, stationary
    const ehd_contact *contact,
    team *threads, // that share the work on large grids; NULL: none
    ehd_error *error);

// ---- of which this is made, of films on grids of steps h, 2h and 4h; NaN: no solution there

/* Order of convergence that they show, NaN where none. */
double full_observed_order(const double films[3]);

/* Estimates the relative change from the first film to the limit of small steps by Richardson's extrapolation. Returns
 * its size. `order` is the order of convergence at best.
 *
 * - Two films may agree by chance. So the change from 2h to h counts as at least 2^-order times that from 4h to 2h.
 * - The order of the extrapolation is the observed one, at least 1 and at most `order`.
 * - Where the two changes have opposite signs, the limit is taken to lie half way.
 * - Where the changes do not shrink, the change from 2h to h is returned or, if that is above `limit`, infinity: the
 *   steps are too coarse to estimate. The same holds without a film at 2h. */
double full_step_effect(const double films[3], double order, double limit);

#endif
