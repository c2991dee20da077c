/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures the errors of one size of a model on scenes with known full solutions, and fits the
 * factors of the error estimates (romrun/trust/README.md, Error estimates).
 * Called by validation.c for each size. */
#ifndef EHD_CALIBRATION_H
#define EHD_CALIBRATION_H

#include "romrun/calibrate/recording.h"
#include "romrun/calibrate/trade.h"

/* A scene and its full solution. */
typedef struct solved_scene {
    const ehd_contact *contact;
    const double *pressure; // [num_nodes] of the contact's grid
    contact_scalars scalars;
} solved_scene;

/* Measures errors and computing time of one model size on stationary scenes. The caller has opened
 * `model` with this size, position->sizes. Each scene is solved several times on one thread, as
 * romrun does. Errors: those of online_solve; EHD_INTERRUPTED, with an empty text. */
ehd_status calibration_measure(
    // output:
    trade_position *position, // only the members about stationary scenes are set
    // input:
    const online_model *model, const solved_scene *scenes, size_t num_scenes, ehd_error *error);

/* Measures errors and computing time of one model size on trajectories (transient scenes). The
 * reduced model repeats each trajectory with the time steps of the full model. The function
 * prepares the model for transient scenes. Errors: those of calibration_measure. */
ehd_status calibration_measure_in_time(
    // output:
    trade_position *position, // only the members about trajectories are set
    // in and out:
    online_model *model,
    // input:
    const recording *recordings, size_t num_recordings, ehd_error *error);

#endif
