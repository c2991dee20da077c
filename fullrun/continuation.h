/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes initial states for Newton's iteration: from coarser grids, from the dry contact, or by
 * continuation in M and L (README.md, Starts). The main functions of this file, full_solve_cold and
 * full_solve_from, are declared in full_solver.h.
 * Called by main.c, training.c, full_march.c and resolution.c, and by
 * romrun/calibrate/fallback.c. */
#ifndef EHD_CONTINUATION_H
#define EHD_CONTINUATION_H

#include "fullrun/full_solver.h"

/* Smallest stride of a continuation, as a fraction of the whole way. Of 89 cold starts by
 * continuation (M 0.5 to 1000, L 0 to 50, line and point contacts of three laws) 43 converge, with
 * strides of 1/8 or more. Of 120 approaches (line and point contacts, M 5 to 100, L 0 to 10, H0
 * from -6 to 2) 73 are reached, with strides of 1/128 or more. In the other cases the film falls to
 * zero on the grid, or the bodies separate. The number of solutions until the search is given up
 * grows with the logarithm of this stride (test_continuation.c, far_start_is_given_up_early;
 * test_full_march.c, start_from_an_approach_far_away; test_surface.c,
 * one_at_rest_is_part_of_the_start). */
static const double MIN_STRIDE = 1. / 256;

/* Sets the state to the dry contact: the Hertz pressure and the film of this pressure. A constant
 * is added to the film, so that the film at X = 0 is `central_film`. */
void full_start_dry(
    // output:
    full_state *state,
    // input:
    full_solver *solver, const ehd_contact *contact, double central_film);

/* Returns the grid with twice the step. Inner column c of the result is column 2c - 1 of the given
 * grid. */
ehd_grid full_coarser_grid(const ehd_grid *grid);

#endif
