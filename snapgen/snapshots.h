/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes snapshots.h5 (schemas/snapshots.md), in which training_run stores its points one by one.
 * Called by main.c, and by adaptive.c and adaptive_file.c. */
#ifndef EHD_SNAPSHOTS_H
#define EHD_SNAPSHOTS_H

#include "common/artefact/artefact.h"
#include "fullrun/training.h"
#include "snapgen/trajectory.h"

/* Creates a file in streaming mode, in which all points are still to be solved. Errors: as
 * artefact_create. */
ehd_status snapshots_create(
    // output:
    artefact **file, // free with artefact_finish or artefact_close
    // input:
    const program *caller, const training_set *set, const char *plan_path, ehd_error *error);

/* Opens NAME.partial of an earlier run on the same grid. Errors: as artefact_resume, and
 * EHD_DATA: the file has another grid. This is possible even for equal settings, if the grid
 * follows from the contacts. */
ehd_status snapshots_open_partial(artefact **file, const training_set *set, const program *caller,
                                  ehd_error *error);

/* Opens NAME.partial to continue it, and marks in `points` the points that are done. Errors: as
 * artefact_resume. */
ehd_status snapshots_resume(artefact **file, training *points, const program *caller,
                            ehd_error *error);

/* Writes the kept states and the compressed snapshots of the trajectories, after training_run. */
ehd_status snapshots_put_trajectories(artefact *file, const training_set *set,
                                      const trajectories *trained, ehd_error *error);

/* Stores a solved point. This function is the member `store` of a training. `sink` is the artefact.
 * `state` is the number of the point in the artefact. */
ehd_status snapshots_store(void *sink, const training_set *set, size_t state,
                           const snapshot *solution, ehd_error *error);

// ---- used by the functions above, and by adaptive training

/* Declares the datasets with the axis `state`. The datasets of trajectories, of adaptive training,
 * of thinned flows and of errors due to the grid are declared only if the set has such data. */
ehd_status snapshots_declare(artefact *file, const training_set *set, bool adaptive,
                             ehd_error *error);

/* Writes the numbers of a contact that are known before the contact is solved. */
ehd_status snapshots_put_contact(artefact *file, size_t state, const ehd_contact *contact,
                                 ehd_error *error);

/* If `file` has all data of the state of a point, marks the point as done. `outcome` is the outcome
 * that the file has for this state. A power cut may leave an outcome without the other data. In
 * this case *whole is false. */
ehd_status snapshots_restore(
    // output:
    bool *whole, training *points,
    // input:
    size_t point, artefact *file, size_t state, int64_t outcome, ehd_error *error);

#endif
