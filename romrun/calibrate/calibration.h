/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures a model at one of its sizes on scenes whose full solutions are known. */
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

/* Solves each scene, repeatedly for the time, as romrun does, on one thread. `model` is open at the
 * sizes of the position. Errors of online_solve; EHD_INTERRUPTED with an empty text. */
ehd_status calibration_measure(
    // output:
    trade_position *position, // its members for scenes
    // input:
    const online_model *model, const solved_scene *scenes, size_t num_scenes, ehd_error *error);

/* Repeats trajectories with the same steps; prepares the model for that. Errors as before. */
ehd_status calibration_measure_in_time(
    // output:
    trade_position *position, // its members for trajectories
    // in and out:
    online_model *model,
    // input:
    const recording *recordings, size_t num_recordings, ehd_error *error);

#endif
