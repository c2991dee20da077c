/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Turns the points of a plan into contacts on one grid (common/physics/README.md, Default grid).
 * Also finds the order in which the contacts are solved (tree.h).
 * Called by snapgen, podbuild and romrun/calibrate, which read plans. */
#ifndef EHD_TRAINING_SET_H
#define EHD_TRAINING_SET_H

#include "common/physics/contact.h"
#include "common/settings/scene.h"
#include "common/time/history.h"
#include "common/training/tree.h"
#include <stdbool.h>
#include <stddef.h>

/* A piece of a plan: the k-th of N pieces; 1/1 is the whole plan. */
typedef struct shard {
    size_t number; // number of the shard, from 1
    size_t total;
} shard;

/* A transient scene of the plan. */
typedef struct trajectory_scene {
    size_t number; // number of the point in the plan
    scene scene;
    ehd_histories *histories; // read with the plan, so that threads need no HDF5
    ehd_contact contact;      // contact in its reference state
    grid_extent needed;       // extent of the grid that the trajectory needs for all times
} trajectory_scene;

typedef struct training_set {
    char *text;    // identifies plan and shard, for --resume
    ehd_grid grid; // grid of all points: given by scenes, or else what all points need together
    const contact_kind *kind;
    size_t num_points;     // stationary points
    ehd_contact *contacts; // [num_points], in the order of the plan
    size_t *numbers;       // [num_points], numbers of the points in the plan
    size_t *groups;        // [num_points], group of each point in the plan
    bool *estimated;       // [num_points], whether the error due to the grid is estimated
    size_t *parent;        // [num_points], point that each point starts from; NO_PARENT: cold start
    size_t *order;         // [num_points], parents first (tree_order)
    size_t num_trajectories;
    trajectory_scene *trajectories; // [num_trajectories], in the order of the plan
    size_t num_dropped;             // number of points of the plan outside of its `where` bounds
} training_set;

/* Makes the contacts of a plan, and a tree that connects neighbouring points. The solution of each
 * point starts from the solution of its parent in the tree. Neighbours are near in ln M, in the
 * Moes number L that belongs to the Hertz pressure, and in the thinning. Neighbours have the same
 * group, lubricant and branch.
 *
 * A branch is a run of successive points of the plan. Only the plan determines the branches. A
 * shard consists of whole branches. Therefore a shard needs no solution of another shard, and each
 * of its points has the same parent as without shards. If the shards are joined in their order, the
 * points are in the order of the plan. The shards get the trajectories in turn, one at a time.
 * Shards without points come first, so that no shard is empty.
 *
 * Returns EHD_DATA if a point is not a contact, if the grids differ, or if no point is left.
 * Returns EHD_USAGE if there are more shards than branches and trajectories. Other errors:
 * EHD_MEMORY. */
ehd_status training_set_init(
    // output:
    training_set *set, // free with training_set_free
    // input:
    const plan *plan, const char *plan_path, shard piece, ehd_error *error);

/* Puts the points on another grid, such as the grid of a basis or model, if their scenes allow this
 * (contact_take_grid). */
void training_set_take_grid(training_set *set, const ehd_grid *grid);

/* Adds a line to the text by which --resume distinguishes trainings. Errors: EHD_MEMORY. */
ehd_status training_set_add_text(training_set *set, const char *line, const char *plan_path,
                                 ehd_error *error);

/* Removes the neighbours, so that every point starts cold and its solution depends on the point
 * alone. Errors: EHD_MEMORY. */
ehd_status training_set_make_cold(training_set *set, const char *plan_path, ehd_error *error);

/* Computes the points from which the tree is built; `places` is [num_points]. */
void training_set_places(tree_point *places, const training_set *set);

/* Removes the points for which `keep`, [num_points], is false. Then makes the branches of a plan
 * that has only the remaining points. Errors: EHD_MEMORY. */
ehd_status training_set_keep(training_set *set, const bool *keep, const char *plan_path,
                             ehd_error *error);

void training_set_free(training_set *set);

/* Returns EHD_NOT_CONVERGED if all points and trajectories of a training failed. */
ehd_status training_check_outcome(const training_set *set, size_t num_failed, const char *plan_path,
                                  ehd_error *error);

/* Returns the paths of the files that the training reads, with NULL at the end: the plan, the basis
 * (unless basis_path is NULL) and the tables of the trajectories. These paths point into plan_path,
 * basis_path and the set. Returns NULL when out of memory. */
const char **training_inputs(const training_set *set, const char *plan_path,
                             const char *basis_path); // free with free()

enum { POINT_NAME = 64 };
/* Writes the name of a point, such as "M=12 L=7". */
void training_point_name(char name[POINT_NAME], const ehd_contact *contact);

#endif
