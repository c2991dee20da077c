/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which scenes a new model is checked on: some between the points that it was trained on. */
#ifndef EHD_CHECK_SCENES_H
#define EHD_CHECK_SCENES_H

#include "common/training/training_set.h"
#include "romrun/model/reduced_model.h"

/* How many stationary scenes a model of `num_trained` ones is checked on, where there are as many;
 * the lubricants are those of the set. */
size_t check_scenes_count(size_t num_trained, const training_set *set);

/* Chooses stationary scenes and trajectories half-way between those of the training (between.h),
 * inside of the trained range and none of them trained on: half as many stationary ones as were
 * trained, but at least 10 and at most 30 for each pair of a viscosity and a density law, some far
 * from one another, of each lubricant and group at least one, the others a sample of the region;
 * trajectories half as many as were trained, 1 to 3. On the grid of the model. EHD_DATA: the text
 * is of no plan or of another grid, or nothing lies between; EHD_NOINPUT: a table of the plan is
 * missing; EHD_MEMORY. */
ehd_status check_scenes_choose(
    // output:
    training_set *set, // free with training_set_free
    // input:
    const reduced_model *model,
    const char *plan_text, // of all of the training
    const char *name,      // of the file that it is from, for errors
    ehd_error *error);

#endif
