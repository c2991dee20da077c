/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Trains adaptively: chooses points of a plan by error estimates, and solves as many of them as the
 * wanted accuracy needs (README.md, Training where it matters).
 * Called by main.c for --adaptive. */
#ifndef EHD_ADAPTIVE_H
#define EHD_ADAPTIVE_H

#include "common/program/program.h"
#include "common/training/training_set.h"

typedef struct adaptive_settings {
    double accuracy;         // wanted relative error of central and minimum film
    size_t start;            // points of the first round; more if the region has more corners
    size_t batch;            // points of each further round; 0: a fifth of the points so far
    size_t max_points;       // largest number of points in all
    double discarded_energy; // energy that bases may omit (podbuild --energy)
    bool cold;               // no point starts from the solution of another point
} adaptive_settings;

adaptive_settings adaptive_default_settings(void);

/* Arguments of adaptive_train and adaptive_solve. */
typedef struct adaptive_task {
    training_set *set; // all candidates
    const char *plan_path;
    const adaptive_settings *settings;
    bool resume;
    size_t allowed_failures;
    size_t num_workers;
    // for a training whose rounds are solved in pieces, with one call for each piece:
    bool only_choose;          // adaptive_train ends as soon as there are points to solve
    const char *const *pieces; // [num_pieces] outputs of adaptive_solve, whose solutions are copied
    size_t num_pieces;
    const char *parts;     // file for a list of parts (parts_write); NULL: always one model
    const char *chosen_in; // for adaptive_solve: the .partial file with the chosen points
    shard piece;           // for adaptive_solve: the piece of these points to solve
} adaptive_task;

/* Trains round by round on points that are chosen among the candidates, the points of the set.
 * - The points of a round are solved with the full model. A reduced model of all solved points
 *   estimates the errors of the other candidates (romrun/trust/indicator.h). The factor of the
 *   estimates is fitted to the points of the last round, because the previous model had estimated
 *   the errors of these points.
 * - The next round has the candidates with the largest estimates.
 * - If no estimate exceeds the accuracy, the next round is a check of some points with the largest
 *   estimates, and some points as far as possible from all others. Training ends if the model made
 *   before the check was accurate at these points, and no estimate exceeds the accuracy afterwards.
 *
 * The output file, caller->output, grows from round to round, and an interrupted training can be
 * resumed. The chosen points and their solutions do not depend on num_workers, on interruptions, or
 * on the process that solved a point.
 *
 * Several processes may share the points of a round. Each process calls adaptive_solve, which
 * solves a part of the points (a *piece* of the round) and writes the solutions to a file.
 * task->pieces lists these files. adaptive_train then copies the solutions from them.
 *
 * If task->parts is set and one model would need too many points, the training ends early. It then
 * writes no output, but a list of parts of the region (README.md, Parts of a region).
 *
 * Errors: EHD_NOT_CONVERGED: more points than allowed, or all points, failed in the full model;
 * EHD_DATA: trajectories in the plan, a piece of another training or round; EHD_INTERRUPTED; errors
 * of snapshots_create and snapshots_resume. */
ehd_status adaptive_train(const program *caller, const adaptive_task *task, ehd_error *error);

/* Solves a piece of a round: every N-th of the points in `chosen_in` that are not done, where N is
 * task->piece.total. An interrupted output, caller->output, can be resumed. Points that do not
 * converge are stored as not converged.
 * Errors: EHD_USAGE: fewer points than pieces; EHD_DATA: `chosen_in` is of another training or has
 * no point to solve; EHD_INTERRUPTED; errors of adaptive_train. */
ehd_status adaptive_solve(const program *caller, const adaptive_task *task, ehd_error *error);

#endif
