/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Estimates the errors that domain and step cause in the films of a stationary solution, and counts
 * the nodes that resolve the solution (README.md, Estimates of inlet and step; Richardson's
 * extrapolation). Called by main.c, by training.c for each trained point, and by romrun/main.c. */
#ifndef EHD_RESOLUTION_H
#define EHD_RESOLUTION_H

#include "common/output/film_effects.h"
#include "fullrun/full_solver.h"
#include <stddef.h>

typedef struct full_resolution {
    film_effects effects; // infinite: the grid is too coarse for an estimate
    double order;         // of convergence of H_c over steps h, 2h, 4h; NaN: none observed
    // numbers of nodes at Y = 0:
    size_t inlet_nodes;  // with 10 to 90 % of the viscous pressure at the centre
    size_t spike_nodes;  // above half of the height of the pressure spike; 0: no spike
    size_t outlet_nodes; // from the minimum film behind X = 0 to the exit
} full_resolution;

/* Largest relative error estimate of the minimum film and of the rolling resistance without a note.
 * They converge less regularly than the central film, whose limit is default_accuracy.
 *
 * On point and elliptic contacts with the accurate rows, an estimate of the central film above this
 * limit says nothing: in 17 random contacts it was 0.5 to 31 times the error. The step is then too
 * coarse for an estimate.
 *
 * If no order of convergence is observed, both limits decide too: a step is too coarse if the film
 * changes by more than the limit when the step is doubled (fullrun/README.md, Estimates of inlet and
 * step; test_resolution.c, too_coarse_to_tell; effects.bats, "a note of the minimum film"). */
extern const double resolution_limit;

/* Estimates the errors that the inlet or domain, and the step, cause in films and rolling
 * resistance (fullrun/README.md, Estimates of inlet and step). It solves the contact from the
 * solution on grids of twice and four times the step. On one of these grids, or on the grid of the
 * solution, it solves the contact again with an endless inlet, a larger domain or the far field
 * around. Errors: EHD_MEMORY, EHD_INTERNAL, EHD_INTERRUPTED. */
ehd_status full_resolution_estimate(
    // output:
    full_resolution *resolution,
    // input:
    const full_state *state, // converged, stationary
    const ehd_contact *contact,
    team *threads, // share the work on large grids; NULL: none
    ehd_error *error);

// ---- parts of the estimate: `films` are on grids of steps h, 2h and 4h; NaN: no solution

/* Returns the order of convergence that the films show, or NaN if they show none. */
double full_observed_order(const double films[3]);

/* Estimates the relative change from the first film to the limit of small steps by Richardson's
 * extrapolation. Returns its magnitude. `order` is the highest order of convergence.
 *
 * - Two films may agree by chance. So the change from 2h to h is taken as at least 2^-order times
 *   that from 4h to 2h.
 * - The order of the extrapolation is the observed one, at least 1 and at most `order`.
 * - If the two changes have opposite signs, the limit is taken to lie the fraction `opposite` of
 *   the way back.
 * - If the changes do not shrink, the change from 2h to h is returned or, if that is above
 *   `limit`, infinity: the steps are too coarse for an estimate.
 * - Without a film at 2h infinity is returned. */
double full_step_effect(const double films[3], double order, double limit, double opposite);

#endif
