/* SPDX-License-Identifier: GPL-3.0-or-later */
/* snapshots.h5: what training_run stores, point by point. */
#ifndef EHD_SNAPSHOTS_H
#define EHD_SNAPSHOTS_H

#include "common/artefact/artefact.h"
#include "fullrun/training.h"
#include "snapgen/trajectory.h"

/* A new file with all points still to come, streaming. Errors as artefact_create. */
ehd_status snapshots_create(
    // output:
    artefact **file, // free with artefact_finish or artefact_close
    // input:
    const program *caller, const training_set *set, const char *plan_path, ehd_error *error);

/* Opens NAME.partial of an earlier run on the same grid. Errors as artefact_resume; EHD_DATA also for
 * another grid, which equal plans may have where they leave it to their contacts. */
ehd_status snapshots_open_partial(artefact **file, const training_set *set, const program *caller,
                                  ehd_error *error);

/* Continues NAME.partial and marks its points in `points` as done. Errors as artefact_resume. */
ehd_status snapshots_resume(artefact **file, training *points, const program *caller,
                            ehd_error *error);

/* After training_run: what the trajectories left behind. */
ehd_status snapshots_put_trajectories(artefact *file, const training_set *set,
                                      const trajectories *trained, ehd_error *error);

/* Entry `store` of a training; `sink` is the artefact, `state` the point. */
ehd_status snapshots_store(void *sink, const training_set *set, size_t state,
                           const snapshot *solution, ehd_error *error);

// ---- of which these are made

/* Fields along the states; those of trajectories, of adaptive training and of what the grid does
 * where there are any. */
ehd_status snapshots_declare(artefact *file, const training_set *set, bool adaptive,
                             ehd_error *error);

/* What is known of a point before it is solved. */
ehd_status snapshots_put_contact(artefact *file, size_t state, const ehd_contact *contact,
                                 ehd_error *error);

/* Marks a point as done that `file` holds as `state`, with its `outcome` there, if it is whole: a power
 * cut may leave the outcome there without what it speaks of. */
ehd_status snapshots_restore(
    // output:
    bool *whole, training *points,
    // input:
    size_t point, artefact *file, size_t state, int64_t outcome, ehd_error *error);

#endif
