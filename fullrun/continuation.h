/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes initial states for Newton's iteration: from coarser grids, from the dry contact, or by
 * continuation in M and L (README.md, Starts). The main functions of this file, full_solve_cold and
 * full_solve_from, are declared in full_solver.h.
 * Called by main.c, training.c, full_march.c and resolution.c, and by
 * romrun/calibrate/fallback.c. */
#ifndef EHD_CONTINUATION_H
#define EHD_CONTINUATION_H

#include "fullrun/full_solver.h"

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
