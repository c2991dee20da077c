/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes a reduced model of the points solved so far, and estimates its errors at other contacts
 * (README.md, Training where it matters).
 * Called by adaptive.c in each round. */
#ifndef EHD_TRIAL_H
#define EHD_TRIAL_H

#include "common/program/program.h"
#include "common/training/training_set.h"
#include "podbuild/snapshot_set.h"
#include "romrun/model/reduced_model.h"

/* Seconds that podbuild, snapgen --basis and deimselect without a check would take. */
typedef struct trial_costs {
    double basis, residuals, rows;
} trial_costs;

/* Makes a model of stationary solutions in memory, as podbuild --energy, snapgen --basis and
 * deimselect make it with their defaults.
 * Errors: EHD_DATA: too few solutions; EHD_INTERRUPTED with an empty text;
 * EHD_MEMORY, EHD_INTERNAL. */
ehd_status trial_build(
    // output:
    reduced_model *model, // free with reduced_model_free
    trial_costs *costs,
    // input:
    const program *caller,      // messages of the three computations are not shown
    const training_set *set,    // the points of the solutions
    const solved_state *states, // [num_points of the set]
    double discarded_energy, size_t num_workers, ehd_error *error);

/* The films whose error is estimated. */
enum { FILM_CENTRAL, FILM_MINIMUM, NUM_FILMS };

/* Error bounds and films that the model gives for a contact. */
typedef struct trial_verdict {
    double bound[NUM_FILMS]; // indicator_bound, indicator_bound_minimum; infinite if not converged
    double film[NUM_FILMS];  // H; NaN if not converged
} trial_verdict;

/* Solves the contacts for which `wanted` is set, and estimates their errors. Each solution starts
 * from a guess for its contact, so that a verdict depends on model and contact alone.
 * EHD_INTERRUPTED with an empty text; EHD_MEMORY. */
ehd_status trial_judge(
    // output:
    trial_verdict *verdicts, // [num_contacts], unchanged for contacts that are not wanted
    // input:
    const reduced_model *model, const ehd_contact *contacts, const bool *wanted,
    size_t num_contacts, size_t num_workers, ehd_error *error);

#endif
