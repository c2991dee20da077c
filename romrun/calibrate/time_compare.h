/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compares two runs of a transient scene. */
#ifndef EHD_TIME_COMPARE_H
#define EHD_TIME_COMPARE_H

#include "common/program/status.h"
#include <stddef.h>

/* Relative deviation of one quantity, at the times of the first run that the second one covers. If
 * the times differ, the second run is interpolated by a cubic spline. */
typedef struct time_deviation {
    double largest; // relative
    double at;      // time T of the largest deviation
    double mean;    // relative, mean of the absolute value over time
} time_deviation;

/* Computes the deviation. EHD_DATA: fewer than 3 common times; EHD_MEMORY. */
ehd_status time_compare(
    // output:
    time_deviation *deviation,
    // input:
    const double *time, const double *values, size_t num_times, // the first run, increasing times
    const double *other_time, const double *other_values, size_t num_other, ehd_error *error);

#endif
