/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solves scenes with the full model, and measures on these scenes the errors of all sizes of a
 * reduced model (README.md, Calibration and the accuracy dial).
 * Called by calibrate.c, and by deimselect/checked_model.c. */
#ifndef EHD_VALIDATION_H
#define EHD_VALIDATION_H

#include "common/program/arena.h"
#include "fullrun/training.h"
#include "romrun/calibrate/calibration.h"
#include "romrun/calibrate/recording.h"

typedef struct validation {
    training_set set;
    training solutions;       // solutions of the full model
    contact_scalars *scalars; // [set.num_points]
    solved_scene *scenes;     // [num_scenes] scenes whose full solutions converged
    size_t num_scenes;
    recording *recordings; // [set.num_trajectories]; usable recordings come first
    size_t num_recordings; // number of usable recordings: complete, and inside of the trained range
    size_t num_failed;     // number of points and trajectories that the full model did not solve
    arena memory;
} validation;

/* Frees all members, the set included. */
void validation_free(validation *self);

/* Solves the points and trajectories of the set with the full model. `name`: name of the set, for
 * messages. EHD_NOT_CONVERGED: the full model solved none of them. EHD_DATA: there are only
 * trajectories, and none of them stays inside of the trained range. EHD_INTERRUPTED: with a
 * text. */
ehd_status validation_solve(
    // in and out:
    validation *self, // all zero except `set`
    // input:
    const trained_range *range, const program *caller, const char *name, size_t num_workers,
    ehd_error *error);

/* Measures each model size that trade_ladder lists. EHD_INTERRUPTED: with a text. */
ehd_status validation_measure(
    // output:
    trade_table *table, // free with trade_free
    // input:
    const validation *scenes, const program *caller, const char *model_path, ehd_error *error);

/* Finds the worst scene: a scene that the whole model does not solve or, if there is none, the
 * scene with the largest film error of the whole model. *worst is NULL if there are no scenes. */
ehd_status validation_worst(const ehd_contact **worst, const validation *scenes,
                            const char *model_path, ehd_error *error);

#endif
