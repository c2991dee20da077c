/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes starts of stationary solutions from the trained ones, by moving least squares
 * (README.md, Starts).
 * Called by romrun/online, and by residuals.c and trial.c of snapgen. */
#ifndef EHD_GUESS_H
#define EHD_GUESS_H

#include "common/physics/contact_place.h"
#include "romrun/solve/reduced_solver.h"

/* Sets a start from the trained solutions nearest in (ln M, ln(1 + alpha p_H)/2): a quadratic fit;
 * if it would extrapolate, an affine fit; if this would extrapolate, the nearest solution.
 * Pressures are added with their spikes at the same place (start_shift.h). Lubricants are compared
 * at the same Hertz pressure: the more similar viscosity and density are, the nearer is the state.
 * The fit is linear in these differences, and in the difference of the thinning. */
void reduced_guess(reduced_state *state, const reduced_model *model, contact_place place);

/* Solves from reduced_guess. If that does not converge, it starts from each of the nearest trained
 * solutions, one after the other. The result's iterations and times are summed over all tries.
 * Errors: those of reduced_solve. */
ehd_status reduced_solve_from_training(
    // output:
    reduced_info *info, reduced_state *state,
    // input:
    reduced_solver *solver, const reduced_model *model, const ehd_contact *contact,
    ehd_error *error);

/* Sets a start: the nearest trained solution that is not this contact's own. */
void reduced_neighbour(reduced_state *state, const reduced_model *model, contact_place place);

/* Returns error estimates of the films due to the full model's grid, interpolated between trained
 * solutions with known estimates, as starts are. NaN: no solution has an estimate. Infinite: the
 * grid is too coarse for an estimate. */
film_effects reduced_effects(const reduced_model *model, contact_place place);

#endif
