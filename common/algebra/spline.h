/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes natural cubic splines, by the tridiagonal equations of their second derivatives. GSL's
 * splines are not used: they end the process when out of memory, and when x lies outside of the
 * nodes.
 * Called by history.c and surface.c in common/time, by fullrun/previous.c, and by
 * romrun/calibrate/against.c. */
#ifndef EHD_SPLINE_H
#define EHD_SPLINE_H

#include <stddef.h>

typedef struct spline spline;

/* Creates a spline with `num` nodes, at least 2. All values are NaN until spline_fit. Returns NULL
 * when out of memory. */
spline *spline_create(size_t num);
spline *spline_free(spline *self); // accepts and returns NULL
double spline_bytes(size_t num);

/* Creates `count` splines. Returns NULL when out of memory. */
spline **splines_create(size_t count, size_t num);
spline **splines_free(spline **splines, size_t count); // accepts and returns NULL

/* Fits the spline to values at increasing x. Both arrays are [num], and the spline copies them. */
void spline_fit(spline *self, const double *x, const double *values);

/* Returns the interval i that contains x, between the nodes i and i + 1. The interval `near` is
 * tried first. If x lies outside of the nodes, returns the first or the last interval, whose cubic
 * is then extrapolated. */
size_t spline_interval(const spline *self, double x, size_t near);

/* Returns the value at x. `interval` is the interval that contains x (spline_interval). */
double spline_value(const spline *self, double x, size_t interval);

/* Return the value, the first derivative and the second derivative at x. */
double spline_at(const spline *self, double x);
double spline_slope(const spline *self, double x);
double spline_bend(const spline *self, double x);

/* Returns the integral from the first node to x. */
double spline_integral(const spline *self, double x);

#endif
