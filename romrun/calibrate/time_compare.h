/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compares two runs of a transient scene. */
#ifndef EHD_TIME_COMPARE_H
#define EHD_TIME_COMPARE_H

#include "common/program/status.h"
#include <stddef.h>

/* Relative deviation of one quantity, at the times of the first run that the second one covers. If
 * the times differ, the second run is interpolated by a cubic spline. */
typedef struct time_deviation {
    double largest;     // relative
    double at;          // time T of the largest deviation
    double sum, length; // integral over T of the relative size, and the time that it covers
} time_deviation;

/* Adds the deviations of a part of both runs. EHD_MEMORY. */
ehd_status time_compare(
    // input and output:
    time_deviation *deviation,
    // input:
    const double *time, const double *values, size_t num_times, // the first run, increasing times
    const double *other_time, const double *other_values, size_t num_other, // at least 3
    ehd_error *error);

#endif
