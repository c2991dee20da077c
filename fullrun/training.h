/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solves the points of a training set with the full model, each from its parent's solution. */
#ifndef EHD_TRAINING_H
#define EHD_TRAINING_H

#include "common/output/film_effects.h"
#include "common/program/program.h"
#include "common/training/training_set.h"
#include "fullrun/full_solver.h"
#include "fullrun/judge.h"
#include <stdbool.h>
#include <stddef.h>

/* One solved point. */
typedef struct snapshot {
    ehd_status status;         // EHD_OK or EHD_NOT_CONVERGED
    char reason[JUDGE_REASON]; // why it is not EHD_OK, or ""
    full_state state;          // meaningful only with EHD_OK
    contact_scalars scalars;   // meaningful only with EHD_OK
    size_t newton_iterations;
    double residual;
    double complementarity; // as in full_info
    film_effects effects;   // of the grid, where wanted and with EHD_OK
} snapshot;

/* What is kept of a point for the points that start from it. */
typedef struct trained_point {
    bool done;
    ehd_status status;
    double *pressure; // [num_nodes], NULL unless status is EHD_OK and the point is done
    double rigid_approach;
    size_t exit;
} trained_point;

typedef struct training {
    const program *program; // for messages and progress
    const training_set *set;
    trained_point *points; // [num_points of the set]
    const bool *wanted;    // [num_points] to solve; NULL: all
    bool with_effects;     // of the grid too, at the points of which the set wants them
    size_t num_failed;     // done, but not EHD_OK
    size_t num_done;
    /* Stores a finished point. Called by one thread at a time. */
    ehd_status (*store)(void *sink, const training_set *set, size_t point, const snapshot *solution,
                        ehd_error *error);
    void *sink;
    progress progress;
    size_t num_before; // points done by an earlier run
    double rest;       // for the progress: what comes behind the points
    bool more;
} training;

/* Reports the memory that a plan needs with num_jobs points or trajectories at a time: solvers, and
 * pressures kept as starts. EHD_MEMORY: more than there is, for point contacts. */
ehd_status training_check_memory(const training_set *set, const program *caller,
                                 const char *plan_path, size_t num_jobs, ehd_error *error);

/* A training of which no point is done; the set must outlive it. EHD_MEMORY. */
ehd_status training_init(training *self, const program *caller, const training_set *set,
                         ehd_error *error); // free with training_free
void training_free(training *self);

/* Marks a point as done by an earlier run. `pressure`: [num_inner]; NULL: not converged. */
ehd_status training_restore(training *self, size_t point, const double *pressure,
                            double rigid_approach, size_t exit, ehd_error *error);

/* Solves all wanted points that are not done. One that does not converge is counted, with a
 * warning, and its children start cold. A point's solution depends on the set alone, neither on
 * num_workers nor on earlier runs. EHD_INTERRUPTED, EHD_MEMORY, EHD_INTERNAL, errors of `store`. */
ehd_status training_run(training *self, size_t num_workers, ehd_error *error);

#endif
