/* SPDX-License-Identifier: GPL-3.0-or-later */
/* romrun --calibrate: a model with the table of what its sizes deviate and cost. */
#ifndef EHD_CALIBRATE_H
#define EHD_CALIBRATE_H

#include "common/program/program.h"
#include <stddef.h>

/* Solves the points and trajectories of the plan with the full model, then with each position of the ladder, and
 * writes self->output. What lies outside of the model's trained range is left out with a note; a point that it was
 * trained on is EHD_DATA, and so is a plan of which nothing is left. Of trajectories the model does not know which
 * it was trained on. EHD_NOT_CONVERGED: written, but without what the full model did not solve; or nothing
 * converged, and nothing is written. */
ehd_status calibrate(const program *self, const char *plan_path, const char *model_path,
                     size_t num_workers, ehd_error *error);

#endif
