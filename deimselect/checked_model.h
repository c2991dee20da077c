/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes a new model that has been measured on scenes between the points of its training. */
#ifndef EHD_CHECKED_MODEL_H
#define EHD_CHECKED_MODEL_H

#include "romrun/model/model_file.h"

typedef struct check_task {
    const char *plan_text;     // of the training, as its files keep it; NULL: none
    const char *name;          // of the file that has it, for messages
    const char *settings;      // of the model
    const char *const *inputs; // paths, NULL at the end
    size_t num_workers;        // full solutions at a time
} check_task;

/* Solves the check scenes (check_scenes.h) with the full model, measures the sizes of the model as
 * romrun --calibrate does, writes caller->output with that table and warns where it is worth little.
 * EHD_UNTRUSTED: written without a table, since there is no scene to check it on, or none that the
 * full model solves; else nothing is written. EHD_INTERRUPTED, errors of model_write. */
enum { CHECK_REPORT = 512 };
ehd_status checked_model_write(
    // output:
    char worth[CHECK_REPORT], // lines that say what the model is worth
    // input:
    const reduced_model *model, const reduced_basis *basis, const model_origin *origin,
    const program *caller, const check_task *task, ehd_error *error);

#endif
