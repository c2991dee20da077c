/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks a new model on scenes between its training points and writes it (README.md, The check).
 * Called by main.c. */
#ifndef EHD_CHECKED_MODEL_H
#define EHD_CHECKED_MODEL_H

#include "romrun/model/model_file.h"

typedef struct check_task {
    const char *plan_text;     // text of the plan, as the training files store it; NULL: no plan
    const char *name;          // name of the file with the plan, for messages
    const char *settings;      // settings text of the model
    const char *const *inputs; // paths of the input files; ends with NULL
    size_t num_workers;        // number of threads for the full solutions
} check_task;

/* Solves the check scenes (check_scenes.h) with the full model and measures the error of each model
 * size like romrun calibrate. Writes caller->output with the table of model sizes. Warns if an
 * error of the whole model, the largest size, exceeds the default accuracy, or if the model does
 * not solve a scene.
 *
 * EHD_UNTRUSTED: the model is written, but is not to be trusted, for one of two reasons:
 * - The model has no table, because no scene lies between the training points, or because the full
 *   model solves none of these scenes.
 * - The model solves none of the scenes, or none of the trajectories.
 *
 * Other errors: EHD_INTERRUPTED, and the errors of model_write. After these errors no file is
 * written. */
enum { CHECK_REPORT = 512 };
ehd_status checked_model_write(
    // output:
    char worth[CHECK_REPORT], // errors on the check scenes, as lines of text
    // input:
    const reduced_model *model, const reduced_basis *basis, const model_origin *origin,
    const program *caller, const check_task *task, ehd_error *error);

#endif
