/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes initial states (starts) of stationary solutions from the trained solutions, by moving
 * least squares (README.md, Starts).
 * Called by romrun/online, and by residuals.c and trial.c of snapgen. */
#ifndef EHD_GUESS_H
#define EHD_GUESS_H

#include "common/physics/contact_place.h"
#include "romrun/solve/reduced_solver.h"

/* Sets the initial state to a quadratic fit through the trained solutions nearest in (ln M, ln(1 +
 * alpha p_H)/2). If this fit would extrapolate, the function uses an affine fit or, if that fit
 * would extrapolate too, the nearest solution. Pressures are added in a coordinate in which all
 * spikes lie at the same place (start_shift.h). The fits are also linear in the differences of
 * viscosity and density, at the same Hertz pressure, and of the thinning. These differences also
 * count in the distance of a trained solution. */
void reduced_guess(reduced_state *state, const reduced_model *model, contact_place place);

/* Solves a contact, starting from the initial state of reduced_guess. If the iteration does not
 * converge, the function starts again from each of the nearest trained solutions, one after the
 * other, until one start succeeds. Iterations and times in `info` are summed over all starts.
 * Errors: those of reduced_solve. */
ehd_status reduced_solve_from_training(
    // output:
    reduced_info *info, reduced_state *state,
    // input:
    reduced_solver *solver, const reduced_model *model, const ehd_contact *contact,
    ehd_error *error);

/* Sets the initial state to the nearest trained solution other than the solution of this
 * contact. */
void reduced_neighbour(reduced_state *state, const reduced_model *model, contact_place place);

/* Returns error estimates of the films due to the full model's grid. They are interpolated between
 * trained solutions with known estimates, by the fits of reduced_guess. NaN: no solution has an
 * estimate. Infinite: the grid is too coarse for an estimate. */
film_effects reduced_effects(const reduced_model *model, contact_place place);

#endif
