/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the benchmarks share: medians and extremes of repeated measurements, and an end where
 * something fails. */
#ifndef EHD_MEASURE_H
#define EHD_MEASURE_H

#include "common/program/status.h"
#include <stddef.h>

typedef struct spread {
    double median, least, most;
} spread;

/* Of at least one value; sorts them. */
spread spread_of(double *values, size_t count);

/* "0.123 (0.120 to 0.140)": in units, with so many digits behind the point. */
enum { SPREAD_TEXT = 96 };
const char *spread_text(char text[SPREAD_TEXT], const spread *self, double unit, int digits);

/* Slope of ln(value) over ln(nodes) by least squares. */
double growth_exponent(const double *nodes, const double *values, size_t count);

/* Runs `work` in a process of its own, so that its peak memory is that of this work alone. */
void run_apart(
    // output:
    void *result, size_t bytes, // what `work` leaves in its own copy of it
    double *megabytes,          // peak
    // input:
    void work(void *result, const void *task), const void *task);

/* End the program where something failed. */
void must(ehd_status status, const ehd_error *error);
void *must_allocate(size_t bytes); // zeros; free with free()

#endif
