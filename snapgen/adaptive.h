/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Trains adaptively: solves as many points of a plan as a wanted accuracy needs, where they are
 * needed (README.md, Training where it matters).
 * Called by main.c for --adaptive. */
#ifndef EHD_ADAPTIVE_H
#define EHD_ADAPTIVE_H

#include "common/program/program.h"
#include "common/training/training_set.h"

typedef struct adaptive_settings {
    double accuracy;         // wanted relative error of central and minimum film
    size_t start;            // points of the first round, at least the corners of the region
    size_t batch;            // points of each further round; 0: a fifth of the points so far
    size_t max_points;       // largest number of points in all
    double discarded_energy; // of the bases (podbuild --energy)
    bool cold;               // every point starts cold
} adaptive_settings;

adaptive_settings adaptive_default_settings(void);

/* A call of adaptive_train or adaptive_solve. */
typedef struct adaptive_task {
    training_set *set; // all candidates
    const char *plan_path;
    const adaptive_settings *settings;
    bool resume;
    size_t allowed_failures;
    size_t num_workers;
    // for a training in pieces, with one call for each piece
    bool only_choose;          // ends as soon as there are points to solve
    const char *const *pieces; // [num_pieces] outputs of adaptive_solve to take over
    size_t num_pieces;
    const char *parts;     // file for a list of parts (parts_write); NULL: always one model
    const char *chosen_in; // for adaptive_solve: the .partial file that contains its points
    shard piece;           // for adaptive_solve: its piece of these points
} adaptive_task;

/* Trains on points that are chosen among the candidates, the points of the set, round by round.
 * - A round is solved with the full model. A reduced model of all solved points estimates the
 *   errors of the other candidates (romrun/trust/indicator.h). The factor of the estimates is
 *   fitted to the points of the last round, for which the previous model had estimates.
 * - The candidates with the largest estimates come next, until no estimate exceeds the accuracy.
 * - The next round is a check: some points with the largest estimates, and some as far as possible
 *   from all others. If the previous model was as accurate as wanted at these points, training ends
 *   with them. Otherwise training goes on.
 *
 * The output, caller->output, grows and can be resumed. The chosen points and their solutions
 * depend neither on num_workers, nor on interruptions, nor on which process solved them. Solutions
 * of the last round in `pieces` are taken over. With `parts` a training ends early if one model is
 * not expected to suffice soon. The list of its parts is then written in place of the output
 * (README.md, Parts of a region).
 * Errors: EHD_NOT_CONVERGED: more points than allowed, or all points, failed in the full model;
 * EHD_DATA: trajectories in the plan, a piece of another training or round; EHD_INTERRUPTED; those
 * of snapshots_create and snapshots_resume. */
ehd_status adaptive_train(const program *caller, const adaptive_task *task, ehd_error *error);

/* Solves a piece of a round: every N-th of the points in `chosen_in` that are not done. The
 * output, caller->output, can be resumed. Points that do not converge are stored as such.
 * Errors: EHD_USAGE: fewer points than pieces; EHD_DATA: `chosen_in` is of another training or has
 * no point to solve; EHD_INTERRUPTED; those of adaptive_train. */
ehd_status adaptive_solve(const program *caller, const adaptive_task *task, ehd_error *error);

#endif
