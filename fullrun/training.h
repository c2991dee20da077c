/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solves the points of a training set with the full model. Each point starts from the solution of
 * its parent (tree.h; README.md, Starts).
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
    char reason[JUDGE_REASON]; // why the status is not EHD_OK, or ""
    full_state state;          // meaningful only with EHD_OK
    contact_scalars scalars;   // meaningful only with EHD_OK
    size_t newton_iterations;
    double residual;
    double complementarity; // as in full_info
    film_effects effects;   // error estimates for inlet and grid step, if wanted and with EHD_OK
} snapshot;

/* The part of a solution that is kept because other points start from it. */
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
    const bool *wanted;    // [num_points] whether to solve a point; NULL: all points are solved
    bool with_effects;     // also estimates the errors due to inlet and grid step, at points that
                           // are marked as `estimated` in the set
    size_t num_failed;     // number of points that are done, but whose status is not EHD_OK
    size_t num_done;
    /* Stores a finished point. Called by one thread at a time. */
    ehd_status (*store)(void *sink, const training_set *set, size_t point, const snapshot *solution,
                        ehd_error *error);
    void *sink;
    progress progress;
    size_t num_before; // number of points that an earlier run has done
    double rest;       // for the progress line: duration of the work that follows in this stage, s
    bool more;         // for the progress line: more work of unknown duration may follow
} training;

/* Reports the memory that a plan needs if num_jobs points or trajectories are solved at the same
 * time. This is the memory of the solvers and of the pressures from which other points start.
 * EHD_MEMORY: point contacts need more memory than is free. */
ehd_status training_check_memory(const training_set *set, const program *caller,
                                 const char *plan_path, size_t num_jobs, ehd_error *error);

/* Initialises a training without finished points. The set must outlive the training. EHD_MEMORY. */
ehd_status training_init(training *self, const program *caller, const training_set *set,
                         ehd_error *error); // free with training_free
void training_free(training *self);

/* Marks a point as done by an earlier run. `pressure`: [num_inner]; NULL: the point did not
 * converge. */
ehd_status training_restore(training *self, size_t point, const double *pressure,
                            double rigid_approach, size_t exit, ehd_error *error);

/* Solves all wanted points that are not done. A point that does not converge is counted, with a
 * warning, and its children start cold. The solution of a point depends only on the set, not on
 * num_workers or on earlier runs.
 * Errors: EHD_INTERRUPTED, EHD_MEMORY, EHD_INTERNAL, and the errors of `store`. */
ehd_status training_run(training *self, size_t num_workers, ehd_error *error);

#endif
