/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plans the memory of row selection: whether residual snapshots are read at once or streamed
 * (README.md, More than fits in memory).
 * Called by main.c. */
#ifndef EHD_ROW_PLAN_H
#define EHD_ROW_PLAN_H

#include "deimselect/row_choice.h"
#include <stdbool.h>

typedef struct row_plan {
    bool direct;  // all snapshots fit in memory and are read at once
    double limit; // memory limit, bytes
    double bytes; // upper bound of the memory of this plan, bytes; the tables of the model and the
                  // check of the model are not included
    size_t block, max_rank; // settings of the streams (pod_stream.h); not set if `direct`
} row_plan;

/* Makes the plan before the snapshots are read. The number of snapshots and their states must be
 * known. EHD_MEMORY: the limit is too small, or an allocation failed. */
ehd_status row_plan_make(
    // output:
    row_plan *plan,
    // input:
    const residual_snapshots *snapshots, const reduced_basis *basis, const row_settings *settings,
    double limit, ehd_error *error);

#endif
