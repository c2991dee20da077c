/* SPDX-License-Identifier: GPL-3.0-or-later */
/* romrun calibrate: measures errors and time of each size of a model, and writes the model together
 * with a table of the results (README.md, Calibration and the accuracy dial). Called by
 * romrun/main.c, and by deimselect/checked_model.c for the settings text. */
#ifndef EHD_CALIBRATE_H
#define EHD_CALIBRATE_H

#include "common/program/program.h"
#include <stddef.h>

/* Solves the points and trajectories of the plan with the full model, and with each model size that
 * trade_ladder lists. Writes self->output. Scenes outside of the trained range are omitted with a
 * message.
 * - EHD_DATA: the model was trained on one of the points (trajectories are not checked), or no
 *   scene remains.
 * - EHD_NOT_CONVERGED: the full model did not solve some scenes, and the output is written without
 *   these scenes. If the full model solved no scene, no output is written. */
ehd_status calibrate(const program *self, const char *plan_path, const char *model_path,
                     size_t num_workers, ehd_error *error);

/* Returns the settings text of a calibrated model: the text of the model without an earlier
 * calibration, followed by the text of the plan (NULL: no plan). Returns NULL without memory. */
char *calibration_settings(const char *of_model, const char *of_plan); // free with free()

#endif
