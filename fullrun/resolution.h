/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Estimates the errors that the size of the domain and the grid step cause in the films of a
 * stationary solution, and counts the nodes that resolve the solution (README.md, Estimates of
 * inlet and step; Richardson's extrapolation). Called by main.c, by training.c for trained points,
 * and by romrun/main.c. */
#ifndef EHD_RESOLUTION_H
#define EHD_RESOLUTION_H

#include "common/output/film_effects.h"
#include "fullrun/full_solver.h"
#include <stddef.h>

typedef struct full_resolution {
    film_effects effects; // infinite values: the grid is too coarse for an estimate
    double order;         // order of convergence of H_c with the steps h, 2h and 4h; NaN: the
                          // films show no order
    // numbers of nodes at Y = 0:
    size_t inlet_nodes;  // nodes at which the viscous pressure, int dP / viscosity ratio, is 10 to
                         // 90 % of its value at the centre
    size_t spike_nodes;  // nodes above half of the height of the pressure spike; 0: no spike
    size_t outlet_nodes; // nodes from the minimum film behind X = 0 to the exit
} full_resolution;

/* Largest relative error estimate of the minimum film, or of the rolling resistance, for which no
 * note is printed. Both converge less regularly than the central film, whose limit is
 * default_accuracy.
 *
 * In two cases the limit also decides whether a grid step is too coarse for an estimate:
 * - On a point or elliptic contact with the accurate rows, the step is too coarse if the estimate
 *   of the central film exceeds this limit. In 21 random contacts such estimates were 0.5 to 31
 *   times the error.
 * - If no order of convergence is observed, the step is too coarse if a doubled step changes the
 *   minimum film by more than this limit, or the central film by more than default_accuracy
 *   (fullrun/README.md, Estimates of inlet and step; test_resolution.c, too_coarse_to_tell;
 *   effects.bats, "a note of the minimum film"). */
extern const double resolution_limit;

/* Estimates the errors of the films and the rolling resistance: the errors due to the inlet (line
 * contact) or domain (point contact), and the errors due to the grid step (fullrun/README.md,
 * Estimates of inlet and step). Starting from the solution, it solves the contact on grids with
 * twice and four times the step. On one of these grids, or on the grid of the solution, it solves
 * the contact once more: with an endless inlet, on a larger domain, or with the far field around
 * the grid. Errors: EHD_MEMORY, EHD_INTERNAL, EHD_INTERRUPTED. */
ehd_status full_resolution_estimate(
    // output:
    full_resolution *resolution,
    // input:
    const full_state *state, // converged, stationary
    const ehd_contact *contact,
    team *threads, // threads that share the work on large grids; NULL: one thread does all work
    ehd_error *error);

// ---- parts of the estimate; `films` are the films on grids with the steps h, 2h and 4h; NaN: no
// solution

/* Returns the order of convergence that the films show, or NaN if they show no order. */
double full_observed_order(const double films[3]);

/* Estimates the relative change from the first film to the limit of small grid steps by
 * Richardson's extrapolation. Returns the magnitude of this change. `order` is the highest order of
 * convergence.
 *
 * - Two films may agree by chance. So the change from 2h to h is taken as at least 2^-order times
 *   the change from 4h to 2h.
 * - The order of the extrapolation is the observed order, but at least 1 and at most `order`.
 * - If the two changes have opposite signs, the result is the change from 2h to h, since the limit
 *   need not lie between these two films, but at least an eighth of the change from 4h to 2h.
 * - If the changes do not shrink, the result is the change from 2h to h. If this change exceeds
 *   `limit`, the result is infinity: the grid steps are too coarse for an estimate.
 * - If there is no film at 2h, the result is infinity. */
double full_step_effect(const double films[3], double order, double limit);

#endif
