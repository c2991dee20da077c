/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Declares what the benchmarks share: statistics of repeated measurements, and functions that end
 * the program on errors. */
#ifndef EHD_MEASURE_H
#define EHD_MEASURE_H

#include "common/program/status.h"
#include <stddef.h>

typedef struct spread {
    double median, least, most;
} spread;

/* Returns median and extremes of at least one value; sorts the values. */
spread spread_of(double *values, size_t count);

/* Writes a spread as "0.123 (0.120 to 0.140)", in multiples of `unit`, with `digits` decimals;
 * returns `text`. */
enum { SPREAD_TEXT = 96 };
const char *spread_text(char text[SPREAD_TEXT], const spread *self, double unit, int digits);

/* Returns the slope of ln(value) over ln(nodes), by least squares. */
double growth_exponent(const double *nodes, const double *values, size_t count);

/* Runs `work` in a child process, so that the peak memory is that of `work` alone. */
void run_apart(
    // output:
    void *result, size_t bytes, // copy of the child's result
    double *megabytes,          // peak memory
    // input:
    void work(void *result, const void *task), const void *task);

/* End the program on an error. */
void must(ehd_status status, const ehd_error *error);
void *must_allocate(size_t bytes); // zeros; free with free()

#endif
