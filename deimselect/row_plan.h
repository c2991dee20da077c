/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What row selection takes of memory, and whether residual snapshots are read at once or one by one. */
#ifndef EHD_ROW_PLAN_H
#define EHD_ROW_PLAN_H

#include "deimselect/row_choice.h"
#include <stdbool.h>

typedef struct row_plan {
    bool direct;  // all snapshots at once, as they fit
    double limit; // bytes
    double bytes; // that this way takes at most, beside the tables of the model and its check
    size_t block, max_rank; // of the streams otherwise
} row_plan;

/* Before the snapshots are read: their number and states are known. EHD_MEMORY: the limit is too
 * small, or there is no memory. */
ehd_status row_plan_make(
    // output:
    row_plan *plan,
    // input:
    const residual_snapshots *snapshots, const reduced_basis *basis, const row_settings *settings,
    double limit, ehd_error *error);

#endif
