/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solves the training points again with the projected system: the modes and all rows (level i of
 * Maier et al. (2015), section 3.2). The iterations give the snapshots of the row selection.
 * Called by main.c for --basis, and by trial.c in adaptive training. */
#ifndef EHD_RESIDUALS_H
#define EHD_RESIDUALS_H

#include "common/program/program.h"
#include "common/training/training_set.h"
#include "deimselect/row_choice.h"

/* Solves every point of the set with the modes of the basis at `basis_path` and all Reynolds rows.
 * Writes to caller->output the weighted residual D f and the weighted Jacobian step D J dz of every
 * iteration that led to a solution (Maier et al. 2015, section 3.2). Each point starts from the
 * nearest trained solution of another point. If the solver does not converge from there, the point
 * starts from a guess that uses all trained solutions around it. A note reports points that do not
 * converge.
 * Errors: EHD_DATA: a basis of another grid or contact; EHD_NOT_CONVERGED: all points failed, and
 * nothing is written; EHD_INTERRUPTED, EHD_MEMORY, I/O. */
ehd_status residuals_run(
    // output:
    size_t *num_failed,
    // input:
    const program *caller,
    training_set *set, // afterwards it has only the points that were solved again
    const char *plan_path, const char *basis_path,
    bool trained_only, // leaves out points that are no states of the basis
    size_t num_workers, ehd_error *error);

/* Solves stationary points and collects their iterations in memory. The points start as in
 * residuals_run. `model` has all rows. */
ehd_status residuals_collect(
    // output:
    residual_snapshots *snapshots, // free with residual_snapshots_free
    // input:
    const program *caller, const training_set *set, const reduced_model *model, size_t num_workers,
    ehd_error *error);

#endif
