/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The training repeated with the projected system (level i), for the row selection's snapshots. */
#ifndef EHD_RESIDUALS_H
#define EHD_RESIDUALS_H

#include "common/program/program.h"
#include "common/training/training_set.h"
#include "deimselect/row_choice.h"

/* Solves every point of the set with all Reynolds rows of the basis at `basis_path`, each from the
 * trained solution nearest to it that is not its own or, where that does not converge, from a guess of
 * all around it, and writes D f and D J dz of every iteration that led to a solution to caller->output
 * (Maier et al. 2015, section 3.2). A point that does not converge is a note and counted.
 * EHD_DATA: a basis of another grid or contact; EHD_NOT_CONVERGED: all failed, and nothing is
 * written; EHD_INTERRUPTED, EHD_MEMORY, I/O. */
ehd_status residuals_run(
    // output:
    size_t *num_failed,
    // input:
    const program *caller,
    training_set *set, // left with the points that were repeated
    const char *plan_path, const char *basis_path,
    bool trained_only, // leave out the points that are no states of the basis
    size_t num_workers, ehd_error *error);

/* The same for stationary points and in memory, with `model` of all rows. */
ehd_status residuals_collect(
    // output:
    residual_snapshots *snapshots, // free with residual_snapshots_free
    // input:
    const program *caller, const training_set *set, const reduced_model *model, size_t num_workers,
    ehd_error *error);

#endif
