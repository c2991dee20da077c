/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The points of a plan as contacts on one grid, and the order in which they are solved. */
#ifndef EHD_TRAINING_SET_H
#define EHD_TRAINING_SET_H

#include "common/physics/contact.h"
#include "common/settings/scene.h"
#include "common/training/tree.h"
#include <stdbool.h>
#include <stddef.h>

/* A piece of a plan: the k-th of N, 1/1 for all of it. */
typedef struct shard {
    size_t number; // from 1
    size_t total;
} shard;

/* A transient scene of the plan. */
typedef struct trajectory_scene {
    size_t number; // of the plan's point
    scene scene;
    ehd_contact contact; // the reference
} trajectory_scene;

typedef struct training_set {
    char *text;    // identifies plan and shard, for --resume
    ehd_grid grid; // of all points: where their scenes do not say, what all need together
    const contact_kind *kind;
    size_t num_points;     // stationary ones
    ehd_contact *contacts; // [num_points], in the order of the plan
    size_t *numbers;       // [num_points], of the plan's points
    size_t *groups;        // [num_points], the plan's group of each
    bool *estimated;       // [num_points], whether what the grid does to it is wanted too
    size_t *parent;        // [num_points], where each starts from; NO_PARENT: cold
    size_t *order;         // [num_points], parents first (tree_order)
    size_t num_trajectories;
    trajectory_scene *trajectories; // [num_trajectories], in the order of the plan
    size_t num_dropped;             // points of the plan outside of its `where` bounds
} training_set;

/* Neighbours are near in ln M and in the Moes number L that belongs to the Hertz pressure; they are
 * of one group and of one branch and have the same lubricant. Branches are pieces of the list of
 * points and depend on the plan alone; a shard has whole ones, so that it needs no other shard, and
 * each of its points starts from where it starts without shards. All shards, one after another, have
 * the points of the plan in its order. Trajectories are dealt out in turn, and none of the shards is
 * empty. EHD_DATA: a point that is no contact, different grids, no point left; EHD_USAGE: more shards
 * than branches and trajectories; EHD_MEMORY. */
ehd_status training_set_init(
    // output:
    training_set *set, // free with training_set_free
    // input:
    const plan *plan, const char *plan_path, shard piece, ehd_error *error);

/* Puts its points on another grid, that of a basis or model, where their scenes say nothing else
 * (contact_take_grid). */
void training_set_take_grid(training_set *set, const ehd_grid *grid);

/* Adds a line that --resume tells this training from others by. EHD_MEMORY. */
ehd_status training_set_add_text(training_set *set, const char *line, const char *plan_path,
                                 ehd_error *error);

/* Takes the neighbours away, so that every point starts cold and its solution depends on the point
 * alone. EHD_MEMORY. */
ehd_status training_set_make_cold(training_set *set, const char *plan_path, ehd_error *error);

/* The points as the tree sees them, [num_points]. */
void training_set_places(tree_point *places, const training_set *set);

/* Leaves only the points that `keep`, [num_points], says, in branches as a plan of these alone has
 * them. EHD_MEMORY. */
ehd_status training_set_keep(training_set *set, const bool *keep, const char *plan_path,
                             ehd_error *error);

void training_set_free(training_set *set);

/* Of a training whose points and trajectories all failed nothing can be made: EHD_NOT_CONVERGED. */
ehd_status training_check_outcome(const training_set *set, size_t num_failed, const char *plan_path,
                                  ehd_error *error);

/* Paths of the files that the training reads: the plan, the basis (NULL: none) and the tables of
 * the trajectories, NULL at the end. They point into plan_path, basis_path and the set. NULL: no
 * memory. */
const char **training_inputs(const training_set *set, const char *plan_path,
                             const char *basis_path); // free with free()

/* "M=12 L=7" */
enum { POINT_NAME = 64 };
void training_point_name(char name[POINT_NAME], const ehd_contact *contact);

#endif
