/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Trains on trajectories. Every step of a transient scene is a snapshot. The snapshots are
 * compressed while the steps are computed (pod_stream.h), so that neither memory nor files grow
 * with the number of steps.
 * Called by main.c for the full model, and by residuals.c for the projected system. */
#ifndef EHD_TRAJECTORY_H
#define EHD_TRAJECTORY_H

#include "common/program/arena.h"
#include "common/program/program.h"
#include "common/training/training_set.h"
#include "podbuild/pod.h"
#include "romrun/solve/reduced_solver.h"
#include "romrun/state/film_splines.h"
#include "snapgen/kept_states.h"
#include <stdbool.h>
#include <stddef.h>

/* The results of the trajectories. */
typedef struct trajectories {
    size_t num_trajectories, num_failed;
    kept_states *kept; // [num_trajectories]
    bool *failed;      // [num_trajectories]; states of failed trajectories are not used
    size_t num_steps;
    // PODs of all trajectories. Full model: `first` is the POD of the pressures, `second` is empty.
    // Reduced model: `first` is the POD of D f, `second` is the POD of D J dz. The trajectories are
    // merged in the order of the plan, for any number of threads.
    pod_basis first, second;
    arena memory; // memory of `kept` and `failed`
} trajectories;

void trajectories_free(trajectories *self);

/* Runs the trajectories of a set with the full model. A trajectory that does not reach its end,
 * or is not to be trusted, is counted as failed, with a warning. */
ehd_status trajectories_train(
    // output:
    trajectories *self, // free with trajectories_free
    // input:
    const program *caller, const training_set *set, size_t num_workers, ehd_error *error);

/* Runs the trajectories of a set with the projected system. `model` has all rows. */
ehd_status trajectories_repeat(trajectories *self, const program *caller, const training_set *set,
                               const reduced_model *model, const film_splines *splines,
                               size_t num_workers, ehd_error *error);

#endif
