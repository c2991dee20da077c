/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Natural cubic splines. GSL's end the process that is refused memory, or asked for a value outside. */
#ifndef EHD_SPLINE_H
#define EHD_SPLINE_H

#include <stddef.h>

typedef struct spline spline;

/* For `num` nodes, at least 2; all values are NaN until it is fitted. NULL: no memory. */
spline *spline_create(size_t num);
spline *spline_free(spline *self); // accepts and returns NULL
double spline_bytes(size_t num);

/* Through values at increasing places, which it copies. */
void spline_fit(spline *self, const double *x, const double *values);

/* The interval around a place, of which its nodes are the `i`-th and the next; `near`: one that is
 * looked at first. Places outside are in the first or last one, whose cubic goes on there. */
size_t spline_interval(const spline *self, double x, size_t near);

/* Value at a place in that interval. */
double spline_value(const spline *self, double x, size_t interval);

/* The values at its nodes, [num]. */
const double *spline_values(const spline *self);

/* Value, first and second derivative at a place. */
double spline_at(const spline *self, double x);
double spline_slope(const spline *self, double x);
double spline_bend(const spline *self, double x);

/* From the first node to a place. */
double spline_integral(const spline *self, double x);

#endif
