/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Training on as many points of a plan as a wanted accuracy needs, where they are needed. */
#ifndef EHD_ADAPTIVE_H
#define EHD_ADAPTIVE_H

#include "common/program/program.h"
#include "common/training/training_set.h"

typedef struct adaptive_settings {
    double accuracy;         // wanted relative deviation of central and minimum film
    size_t start;            // points of the first round, at least the corners of the region
    size_t batch;            // points of each further round; 0: a fifth of those before
    size_t max_points;       // points in all
    double discarded_energy; // of the bases (podbuild --energy)
    bool cold;               // every point starts cold
} adaptive_settings;

adaptive_settings adaptive_default_settings(void);

/* What a call does. */
typedef struct adaptive_task {
    training_set *set; // of all candidates
    const char *plan_path;
    const adaptive_settings *settings;
    bool resume;
    size_t allowed_failures;
    size_t num_workers;
    // a training in parts, each a call of its own
    bool only_choose;          // end where points are to be solved, without solving them
    const char *const *pieces; // [num_pieces] outputs of adaptive_solve
    size_t num_pieces;
    const char *parts;     // file for a list of parts (parts_write); NULL: always one model
    const char *chosen_in; // for adaptive_solve: the .partial with the points that are to be solved
    shard piece;           // the same: which of them
} adaptive_task;

/* The points of the set are candidates. Round by round some are solved with the full model, a
 * reduced model is made of all that are solved, and judges the others by its indicator
 * (romrun/online/indicator.h), whose factor is fitted to the points of the last round, which the
 * model before had judged. The worst ones come next, until none is indicated to deviate more than
 * is wanted. The next ones are a check: some of the worst, and some as far from all others as
 * there are. When the model that judged them is found to be as accurate as wanted there, training
 * ends with them; else it goes on. Written to caller->output, which grows and can be resumed. The
 * points that are chosen and their solutions do not depend on num_workers, on interruptions, or on
 * who solved them: what the pieces hold of the last round is taken as it is. With `parts` a training
 * that one model is not expected to end soon is left, and the list of its parts is written in place
 * of the output (README.md). EHD_NOT_CONVERGED: more
 * points than allowed failed in the full model, or all; EHD_DATA: trajectories in the plan, a piece
 * of another training or round; EHD_INTERRUPTED; else as snapshots_create and snapshots_resume. */
ehd_status adaptive_train(const program *caller, const adaptive_task *task, ehd_error *error);

/* Solves a piece of what is to be solved: every N-th of the points in `chosen_in` that are not done,
 * written to caller->output, which can be resumed. Points that do not converge are stored as such.
 * EHD_USAGE: fewer points than pieces; EHD_DATA: `chosen_in` is of another training, nothing is to be
 * solved; EHD_INTERRUPTED; else as adaptive_train. */
ehd_status adaptive_solve(const program *caller, const adaptive_task *task, ehd_error *error);

#endif
