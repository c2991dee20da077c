/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Resolution of a stationary solution, and effects of domain and step on its films. */
#ifndef EHD_RESOLUTION_H
#define EHD_RESOLUTION_H

#include "common/output/film_effects.h"
#include "fullrun/full_solver.h"
#include <stddef.h>

typedef struct full_resolution {
    film_effects effects; // where twice the step does not converge, of the step infinite, and of
                          // the inlet NaN for a point contact
    double order;         // of convergence of H_c over steps h, 2h, 4h; NaN: none observed
    // at Y = 0:
    size_t inlet_nodes;  // between 10 and 90 % of the centre's viscous pressure
    size_t spike_nodes;  // above half the height of the pressure spike; 0: no spike
    size_t outlet_nodes; // from the minimum film behind X = 0 to the exit
} full_resolution;

/* Solves on grids of twice and four times the step, from the solution, of a point contact also with
 * the far field around the first: about a fifth of its cost.
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

/* Richardson's estimate of the relative change from the first film to the limit of small steps,
 * with the observed order, 2 where there is none, within 1 and 2. Infinite without a second film. */
double full_step_effect(const double films[3]);

/* The same of a minimum film, which does not converge as regularly: at least as large as what
 * order 2 leaves of the change from 4h to 2h, so that two films that agree by chance are not taken
 * for convergence. */
double full_step_effect_minimum(const double films[3]);

/* The same of the accurate rows, whose errors often change their sign from grid to grid, so that no
 * order is seen: with the observed one within these, 2 where there is none, and at least as large as
 * what order 4 leaves of the change from 4h to 2h. */
double full_step_effect_accurate(const double films[3], double least, double most);

#endif
