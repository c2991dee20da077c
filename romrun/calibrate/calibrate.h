/* SPDX-License-Identifier: GPL-3.0-or-later */
/* romrun --calibrate: measures accuracy and time of a model's sizes and stores the table in it. */
#ifndef EHD_CALIBRATE_H
#define EHD_CALIBRATE_H

#include "common/program/program.h"
#include <stddef.h>

/* Solves the points and trajectories of the plan with the full model and with each position of the
 * ladder, and writes self->output. Scenes outside of the trained range are left out with a note.
 * EHD_DATA: a point that the model was trained on (trajectories are not checked), or no scene is
 * left. EHD_NOT_CONVERGED: written without the scenes that the full model did not solve, or, if it
 * solved none, not written. */
ehd_status calibrate(const program *self, const char *plan_path, const char *model_path,
                     size_t num_workers, ehd_error *error);

/* The settings of a calibrated model: its own, without those of an earlier calibration, and the text
 * of the plan (NULL: none). NULL: no memory. */
char *calibration_settings(const char *of_model, const char *of_plan); // free with free()

#endif
