/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of measured positions as part of a model file. */
#ifndef EHD_TRADE_FILE_H
#define EHD_TRADE_FILE_H

#include "common/artefact/artefact.h"
#include "romrun/trade.h"
#include <stdbool.h>

/* Axes of what a calibration adds to a model, NULL at the end: for artefact_copy to leave out. */
extern const char *const trade_axes[];

/* Into a model file that has no table yet. */
ehd_status trade_write(artefact *file, const trade_table *table, ehd_error *error);

/* EHD_DATA also for a model that is not calibrated, and for positions that it does not have. */
ehd_status trade_read(
    // output:
    trade_table *table, // free with trade_free
    // input:
    const char *path, ehd_error *error);

/* The same for any model; where it is not calibrated, *calibrated is false and there is no table. */
ehd_status trade_read_optional(trade_table *table, bool *calibrated, const char *path,
                               ehd_error *error);

#endif
