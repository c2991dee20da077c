/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solves the points of a training set with the full model, each from its parent's solution. */
#ifndef EHD_TRAINING_H
#define EHD_TRAINING_H

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
    trained_point *points; // [num_points of the set]; those of an earlier run are done before
    const bool *wanted;    // [num_points], the others stay as they are; NULL: all
    size_t num_failed;     // done, but not EHD_OK
    size_t num_done;
    /* Takes a finished point away. Called by one thread at a time. */
    ehd_status (*store)(void *sink, const training_set *set, size_t point, const snapshot *solution,
                        ehd_error *error);
    void *sink;
    progress progress;
    size_t num_before; // points done by an earlier run
} training;

/* Says what solving the points and trajectories of a plan, num_jobs at a time, takes of memory before it is taken: the
 * solvers, and the pressures that further points start from. EHD_MEMORY: more than there is, of point contacts. */
ehd_status training_check_memory(const training_set *set, const program *caller,
                                 const char *plan_path, size_t num_jobs, ehd_error *error);

ehd_status training_init(training *self, const program *caller, const training_set *set,
                         ehd_error *error); // free with training_free
void training_free(training *self);

/* Marks a point as done by an earlier run. `pressure`: [num_inner], NULL when it did not converge. */
ehd_status training_restore(training *self, size_t point, const double *pressure,
                            double rigid_approach, size_t exit, ehd_error *error);

/* Solves all wanted points that are not done. A point that does not converge is a warning and counted; the
 * points below it start cold. The solution of a point depends on the set alone, not on num_workers or
 * on what was done before. EHD_INTERRUPTED, EHD_MEMORY, EHD_INTERNAL, or what `store` returns. */
ehd_status training_run(training *self, size_t num_workers, ehd_error *error);

#endif
