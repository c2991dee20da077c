/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scenes with their full solutions, and what the sizes of a model are worth on them. */
#ifndef EHD_VALIDATION_H
#define EHD_VALIDATION_H

#include "fullrun/training.h"
#include "romrun/calibrate/calibration.h"
#include "romrun/calibrate/recording.h"

typedef struct validation {
    training_set set;
    training solutions;       // by the full model
    contact_scalars *scalars; // [set.num_points]
    solved_scene *scenes;     // [num_scenes] those that converged
    size_t num_scenes;
    recording *recordings; // [set.num_trajectories], the usable ones first
    size_t num_recordings; // usable: ended, and inside the trained range
    size_t num_failed;     // points and trajectories that the full model did not solve
} validation;

/* Frees the set too. */
void validation_free(validation *self);

/* Solves the points and trajectories of the set with the full model. `name` stands for the set in
 * messages. EHD_NOT_CONVERGED: none of them; EHD_DATA: trajectories only, none of which stays inside
 * of the trained range; EHD_INTERRUPTED, with a text. */
ehd_status validation_solve(
    // in and out:
    validation *self, // zero but for its set
    // input:
    const trained_range *range, const program *caller, const char *name, size_t num_workers,
    ehd_error *error);

/* Measures each position of the ladder of a model. EHD_INTERRUPTED, with a text. */
ehd_status validation_measure(
    // output:
    trade_table *table, // free with trade_free
    // input:
    const validation *scenes, const program *caller, const char *model_path, ehd_error *error);

/* The scene on which the films of the whole model deviate most, or that it does not solve; NULL: there
 * are none. */
ehd_status validation_worst(const ehd_contact **worst, const validation *scenes,
                            const char *model_path, ehd_error *error);

#endif
