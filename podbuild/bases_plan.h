/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plans the memory for building a basis, and divides the allowed error between its causes. All rows
 * (snapshot_set.h) form one block, or the plan sets the size of the blocks and the largest number
 * of directions (pod_stream.h).
 * Called by main.c before any field is read, and by bases.c. */
#ifndef EHD_BASES_PLAN_H
#define EHD_BASES_PLAN_H

#include "podbuild/pod_stream.h"
#include "podbuild/snapshot_set.h"

typedef struct bases_settings {
    pod_settings pressure;
    pod_settings deformation; // unused if kind is DEFORMATION_COUPLED
    deformation_kind kind;
    // Set if the number of modes is given, but not --energy. Before the modes are chosen, the
    // stream then omits only round-off.
    bool exact;
    // Set if the modes are written as a part file. These modes may omit SMALL_SHARE of the square
    // root of the allowed energy.
    bool as_part;
} bases_settings;

/* Fractions of the square root of the allowed energy. SMALL_SHARE is the fraction for the distance
 * of the snapshots from the directions of a stream. It is also the fraction for the energy that
 * part files have omitted. */
extern const double SMALL_SHARE;

/* Returns the fraction for the omitted modes if there are part files: what the other two leave. */
double bases_modes_share(void);

typedef struct bases_plan {
    bool at_once;  // all rows are one block
    double limit;  // memory limit, bytes
    double bytes;  // upper bound of the memory of this plan, bytes
    double energy; // total energy that may be omitted, relative to the energy of the rows
    pod_stream_settings stream;
    size_t batch; // number of states that are projected onto the modes together
} bases_plan;

/* Returns the plan that takes all rows as one block. */
bases_plan bases_plan_at_once(const snapshot_set *from, const bases_settings *settings);

/* Plans the memory for a limit in bytes. If the limit allows it, all rows are one block.
 * EHD_MEMORY: the limit is too small. */
ehd_status bases_plan_make(
    // output:
    bases_plan *plan,
    // input:
    const snapshot_set *from, const bases_settings *settings, double limit, ehd_error *error);

#endif
