/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chooses the scenes on which a new model is checked. They lie between the training points
 * (between.h; deimselect/README.md, The check).
 * Called by deimselect/checked_model.c, by snapgen/adaptive.c for the number of scenes, and by
 * snapgen/residuals.c for the trained points. */
#ifndef EHD_CHECK_SCENES_H
#define EHD_CHECK_SCENES_H

#include "common/training/training_set.h"
#include "romrun/model/reduced_model.h"

/* Returns the number of stationary check scenes for a model with `num_trained` stationary training
 * points. Fewer scenes may be available. `set` provides the lubricants. */
size_t check_scenes_count(size_t num_trained, const training_set *set);

/* Removes the points of a training's plan that failed or were not solved, so that they are not
 * among `states`. Keeps all trajectories. Errors: EHD_MEMORY. */
ehd_status check_scenes_keep_trained(training_set *set, const reduced_states *states,
                                     const char *name, ehd_error *error);

/* Chooses stationary scenes and trajectories on the grid of the model. Each lies half-way between
 * two neighbouring training points (between.h) and inside of the trained range, and none is a
 * training point.
 *
 * - Stationary scenes: half as many as training points, at least 10, and at most 30 for each pair
 *   of a viscosity law and a density law. Some scenes are chosen far from each other, with at least
 *   one scene of each lubricant and group. The other scenes are an even sample of the region.
 * - Trajectories: half as many as were trained, 1 to 3.
 *
 * EHD_DATA: the text is no plan, the plan has another grid, or no scene lies between training
 * points. EHD_NOINPUT: a table of the plan is missing. Other errors: EHD_MEMORY. */
ehd_status check_scenes_choose(
    // output:
    training_set *set, // free with training_set_free
    // input:
    const reduced_model *model,
    const char *plan_text, // plan of the whole training
    const char *name,      // name of the file with the plan, for error messages
    ehd_error *error);

#endif
