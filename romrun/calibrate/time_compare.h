/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Comparison of two runs of a transient scene. */
#ifndef EHD_TIME_COMPARE_H
#define EHD_TIME_COMPARE_H

#include "common/program/status.h"
#include <stddef.h>

/* Relative deviation of one quantity, over the times of the first run that the second one covers.
 * The second is interpolated by a cubic spline where its times are others. */
typedef struct time_deviation {
    double largest; // 1
    double at;      // T
    double mean;    // 1, of its absolute value, over time
} time_deviation;

/* EHD_DATA: fewer than 3 times in common; EHD_MEMORY. */
ehd_status time_compare(
    // output:
    time_deviation *deviation,
    // input:
    const double *time, const double *values, size_t num_times, // the first run, increasing times
    const double *other_time, const double *other_values, size_t num_other, ehd_error *error);

#endif
