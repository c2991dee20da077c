/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solves the points of a training set with the full model, each from its parent's solution
 * (tree.h; README.md, Starts).
 * Called by main.c and adaptive.c of snapgen, and by romrun/calibrate/validation.c. */
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
    ehd_status status;         // EHD_OK, EHD_NOT_CONVERGED or EHD_UNTRUSTED (full_judge)
    char reason[JUDGE_REASON]; // why it is not EHD_OK, or ""
    full_state state;          // meaningful only with EHD_OK
    contact_scalars scalars;   // meaningful only with EHD_OK
    size_t newton_iterations;
    double residual;
    double complementarity; // as in full_info
    film_effects effects;   // error estimates of the grid, if wanted and with EHD_OK
} snapshot;

/* The part of a solution that is kept for the points that start from it. */
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
    const bool *wanted;    // [num_points] whether to solve a point; NULL: all
    bool with_effects;     // also estimates errors of the grid, at the points marked in the set
    size_t num_failed;     // done, but not EHD_OK
    size_t num_done;
    /* Stores a finished point. Called by one thread at a time. */
    ehd_status (*store)(void *sink, const training_set *set, size_t point, const snapshot *solution,
                        ehd_error *error);
    void *sink;
    progress progress;
    size_t num_before; // points done by an earlier run
    double rest;       // s, for the progress: duration of the work that follows in this stage
    bool more;         // for the progress: further work may follow after that
} training;

/* Reports the memory that a plan needs for num_jobs points or trajectories at a time: solvers,
 * and pressures kept as starts. EHD_MEMORY: point contacts need more than is free. */
ehd_status training_check_memory(const training_set *set, const program *caller,
                                 const char *plan_path, size_t num_jobs, ehd_error *error);

/* Starts a training of which no point is done. The set must outlive it. EHD_MEMORY. */
ehd_status training_init(training *self, const program *caller, const training_set *set,
                         ehd_error *error); // free with training_free
void training_free(training *self);

/* Marks a point as done by an earlier run. `pressure`: [num_inner]; NULL: not converged. */
ehd_status training_restore(training *self, size_t point, const double *pressure,
                            double rigid_approach, size_t exit, ehd_error *error);

/* Solves all wanted points that are not done. A point that does not converge is counted, with a
 * warning, and its children start cold. A point's solution depends on the set alone, neither on
 * num_workers nor on earlier runs.
 * Errors: EHD_INTERRUPTED, EHD_MEMORY, EHD_INTERNAL, those of `store`. */
ehd_status training_run(training *self, size_t num_workers, ehd_error *error);

#endif
