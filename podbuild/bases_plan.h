/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Memory plan and error budget of a basis: whether all rows are one block, or how large the blocks
 * are. Called by main.c before any field is read, and by bases.c. */
#ifndef EHD_BASES_PLAN_H
#define EHD_BASES_PLAN_H

#include "podbuild/pod_stream.h"
#include "podbuild/snapshot_set.h"

typedef struct bases_settings {
    pod_settings pressure;
    pod_settings deformation; // unused if kind is DEFORMATION_COUPLED
    deformation_kind kind;
    bool exact; // the number of modes is given and no energy: a stream omits only noise before the
                // modes are chosen
    // the modes are those of a part, which may omit PART_SHARE of the root of the energy
    bool as_part;
} bases_settings;

/* Parts of the root of the allowed energy: of the distance of the snapshots from the directions of
 * a stream, of the energy that parts omitted before, and of the modes of rows that hold parts. */
extern const double LOCAL_SHARE, PART_SHARE, ROOT_SHARE;

typedef struct bases_plan {
    bool at_once;  // all rows are one block
    double limit;  // memory limit, bytes
    double bytes;  // upper bound of the memory of this plan, bytes
    double energy; // part of the energy that may be omitted in all
    pod_stream_settings stream;
    size_t batch; // number of states that are projected at once
} bases_plan;

/* Returns the plan to take all rows as one block. */
bases_plan bases_plan_at_once(const snapshot_set *from, const bases_settings *settings);

/* Plans the memory. EHD_MEMORY: the limit is too small. */
ehd_status bases_plan_make(
    // output:
    bases_plan *plan,
    // input:
    const snapshot_set *from, const bases_settings *settings, double limit, ehd_error *error);

#endif
