/* SPDX-License-Identifier: GPL-3.0-or-later */
/* snapshots.h5 of an adaptive training: its states are points of the plan in the order in which
 * they were chosen, and more of them come round by round. */
#ifndef EHD_ADAPTIVE_FILE_H
#define EHD_ADAPTIVE_FILE_H

#include "common/artefact/artefact.h"
#include "fullrun/training.h"
#include "snapgen/trial.h"

/* A point that was chosen. */
typedef struct adaptive_state {
    size_t point;          // of the set
    size_t round;          // from 0
    trial_verdict verdict; // by the model of the rounds before; NaN in the first round
} adaptive_state;

/* What a round came to. */
typedef struct adaptive_round {
    size_t num_points; // converged ones that its model is made of
    double indicated;  // worst of the remaining points; NaN: none, or no factor yet
    double deviation;  // worst of the points of the next round; NaN: there are none
    double seconds;    // since the start; NaN: in an earlier run
} adaptive_round;

/* A new file without states, streaming. Errors as artefact_create. */
ehd_status adaptive_file_create(artefact **file, const program *caller, const training_set *set,
                                const char *plan_path, ehd_error *error);

/* States first … first + count - 1 of `states` are to be solved. */
ehd_status adaptive_file_add(artefact *file, const training_set *set, const adaptive_state *states,
                             size_t first, size_t count, ehd_error *error);

/* Continues NAME.partial: the states that were chosen, and in `points` those of them that are done.
 * Errors as artefact_resume. */
ehd_status adaptive_file_resume(
    // output:
    artefact **file,
    adaptive_state *states, // [*num_states], room for all points of the set
    size_t *num_states,
    double (*films)[NUM_FILMS], // [num_points of the set] of those that are done and converged
    // in and out:
    training *points,
    // input:
    const program *caller, ehd_error *error);

/* The same of a file that another process goes on with, as it is; it is closed again. EHD_DATA: it is
 * of other settings than the points' set; else as artefact_open_unfinished. */
ehd_status adaptive_file_read(
    // output:
    adaptive_state *states, size_t *num_states, double (*films)[NUM_FILMS],
    // in and out:
    training *points,
    // input:
    const char *path, ehd_error *error);

/* Takes over what a piece, finished or not, has of states that are not done yet: to `file` and to
 * `points`. EHD_DATA: it is of other settings than the points' set, or a state of it is none of these;
 * else as artefact_open_unfinished and of writing. */
ehd_status adaptive_file_take(
    // in and out:
    artefact *file, training *points, double (*films)[NUM_FILMS],
    // input:
    const adaptive_state *states, size_t num_states, const char *path, ehd_error *error);

/* The curve; ends the streaming. */
ehd_status adaptive_file_put_curve(artefact *file, const adaptive_round *rounds, size_t num_rounds,
                                   ehd_error *error);

#endif
