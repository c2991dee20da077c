/* SPDX-License-Identifier: GPL-3.0-or-later */
/* snapshots.h5: what training_run stores, point by point. */
#ifndef EHD_SNAPSHOTS_H
#define EHD_SNAPSHOTS_H

#include "common/artefact/artefact.h"
#include "snapgen/training.h"
#include "snapgen/trajectory.h"

/* A new file with all points still to come, streaming. Errors as artefact_create. */
ehd_status snapshots_create(
    // output:
    artefact **file, // free with artefact_finish or artefact_close
    // input:
    const program *caller, const training_set *set, const char *plan_path, ehd_error *error);

/* Continues NAME.partial and marks its points in `points` as done. Errors as artefact_resume. */
ehd_status snapshots_resume(artefact **file, training *points, const program *caller,
                            ehd_error *error);

/* After training_run: what the trajectories left behind. */
ehd_status snapshots_put_trajectories(artefact *file, const training_set *set,
                                      const trajectories *trained, ehd_error *error);

/* Entry `store` of a training; `sink` is the artefact. */
ehd_status snapshots_store(void *sink, const training_set *set, size_t point,
                           const snapshot *solution, ehd_error *error);

#endif
