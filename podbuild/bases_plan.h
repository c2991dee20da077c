/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Memory plan and error budget for building a basis. The plan takes all rows as one block, or sets
 * the size of the blocks and the largest number of directions.
 * Called by main.c before any field is read, and by bases.c. */
#ifndef EHD_BASES_PLAN_H
#define EHD_BASES_PLAN_H

#include "podbuild/pod_stream.h"
#include "podbuild/snapshot_set.h"

typedef struct bases_settings {
    pod_settings pressure;
    pod_settings deformation; // unused if kind is DEFORMATION_COUPLED
    deformation_kind kind;
    // The number of modes is given, and no energy. The stream then omits only round-off until the
    // modes are chosen.
    bool exact;
    // The modes are written as a part file. The modes may omit SMALL_SHARE of the square root of
    // the allowed energy.
    bool as_part;
} bases_settings;

/* Fractions of the square root of the allowed energy. The distance of the snapshots from the
 * directions of a stream, and the energy that parts have omitted before, may each take SMALL_SHARE.
 * If there are parts, the modes take ROOT_SHARE. */
extern const double SMALL_SHARE, ROOT_SHARE;

typedef struct bases_plan {
    bool at_once;  // all rows are one block
    double limit;  // memory limit, bytes
    double bytes;  // upper bound of the memory of this plan, bytes
    double energy; // total energy that may be omitted, relative to the energy of the rows
    pod_stream_settings stream;
    size_t batch; // number of states that are projected together
} bases_plan;

/* Returns the plan that takes all rows as one block. */
bases_plan bases_plan_at_once(const snapshot_set *from, const bases_settings *settings);

/* Plans the memory for a limit, bytes. Takes all rows as one block if the limit allows it.
 * EHD_MEMORY: the limit is too small. */
ehd_status bases_plan_make(
    // output:
    bases_plan *plan,
    // input:
    const snapshot_set *from, const bases_settings *settings, double limit, ehd_error *error);

#endif
