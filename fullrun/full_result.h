/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts a stationary solution of the full model to a result, and chooses one of several equal
 * solutions by its computing time.
 * Called by main.c and by romrun/calibrate/fallback.c. */
#ifndef EHD_FULL_RESULT_H
#define EHD_FULL_RESULT_H

#include "common/output/result.h"
#include "fullrun/full_solver.h"

/* Converts a solution to a result without status, reason, exits and error estimates. The fields, if
 * wanted, are those of `state`. */
run_result full_result(const full_info *info, const full_state *state, const ehd_contact *contact,
                       bool with_fields);

/* Lists X of the exit on each grid line in a new array. For a line contact *exits is NULL. Errors:
 * EHD_MEMORY. */
ehd_status full_exits(
    // output:
    double **exits, // [lines of the whole grid], free with free()
    // input:
    const full_state *state, const ehd_grid *grid, ehd_error *error);

/* Returns the info with the median computing time. Sorts the array. */
full_info full_median_run(full_info *runs, size_t count);

#endif
