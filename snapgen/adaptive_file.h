/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads and writes snapshots.h5 of an adaptive training (schemas/snapshots.md). The states in this
 * file are points of the plan in the order in which they were chosen. Each round adds states.
 * Called by adaptive.c in each round. */
#ifndef EHD_ADAPTIVE_FILE_H
#define EHD_ADAPTIVE_FILE_H

#include "common/artefact/artefact.h"
#include "fullrun/training.h"
#include "snapgen/trial.h"

/* A point that was chosen. */
typedef struct adaptive_state {
    size_t point;          // number in the set
    size_t round;          // from 0
    trial_verdict verdict; // estimates by the model of the previous rounds; NaN: first round
} adaptive_state;

/* The outcome of a round. */
typedef struct adaptive_round {
    size_t num_points; // number of converged points from which the round's model is made
    double indicated;  // largest error estimate at points that are not trained on; NaN: there are
                       // no such points, or the factor of the estimates is not known
    double deviation;  // largest error of the round's model at the points of the next round; NaN:
                       // there are none
    double seconds;    // s, since the start; NaN: the round is of an earlier run
} adaptive_round;

/* Creates a file without states, in streaming mode. Errors: as artefact_create. */
ehd_status adaptive_file_create(artefact **file, const program *caller, const training_set *set,
                                const char *plan_path, ehd_error *error);

/* Adds states first … first + count - 1 of `states`, which are still to be solved. */
ehd_status adaptive_file_add(artefact *file, const training_set *set, const adaptive_state *states,
                             size_t first, size_t count, ehd_error *error);

/* Opens NAME.partial to continue it. Reads the chosen states. If a state is done, restores it in
 * `points`. Errors: as artefact_resume. */
ehd_status adaptive_file_resume(
    // output:
    artefact **file,
    adaptive_state *states, // [*num_states], room for all points of the set
    size_t *num_states,
    double (*films)[NUM_FILMS], // [num_points of the set] films of points that have converged
    // in and out:
    training *points,
    // input:
    const program *caller, ehd_error *error);

/* Reads states and points like adaptive_file_resume from a file that another process continues.
 * Closes the file unchanged. Errors: EHD_DATA: the file has other settings than the points' set;
 * errors of artefact_open_unfinished. */
ehd_status adaptive_file_read(
    // output:
    adaptive_state *states, size_t *num_states, double (*films)[NUM_FILMS],
    // in and out:
    training *points,
    // input:
    const char *path, ehd_error *error);

/* Copies the solutions of states that are not done yet to `file` and `points`. Reads them from a
 * piece at `path`, the output of adaptive_solve, which may be unfinished. Errors: EHD_DATA:
 * the piece has other settings than the points' set, or a state that is not in `states`; errors of
 * artefact_open_unfinished and of writing. */
ehd_status adaptive_file_take(
    // in and out:
    artefact *file, training *points, double (*films)[NUM_FILMS],
    // input:
    const adaptive_state *states, size_t num_states, const char *path, ehd_error *error);

/* Writes the outcomes of all rounds, and ends the streaming mode. */
ehd_status adaptive_file_put_curve(artefact *file, const adaptive_round *rounds, size_t num_rounds,
                                   ehd_error *error);

#endif
