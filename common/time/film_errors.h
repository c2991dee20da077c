/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the errors of rho H that time steps and the filter cause, on the central line of the dry
 * contact. A film accumulates these errors, and the fluid carries them along
 * (common/time/README.md, Errors in time).
 * Called by bdf_march.c, by fullrun/full_march.c, and by reduced_march.c and time_indicator.c in
 * romrun. */
#ifndef EHD_FILM_ERRORS_H
#define EHD_FILM_ERRORS_H

#include "common/time/frame.h"

#include <stddef.h>

enum { NUM_ERROR_PLACES = 201 }; // number of places, evenly spaced from X = -1 to 1

/* Errors at the places. A zero struct has no errors. */
typedef struct film_errors {
    double kept[NUM_ERROR_PLACES];      // errors of the last accepted state, in its frame
    double curvature[NUM_ERROR_PLACES]; // curvature of the natural spline through `kept`
    double next[NUM_ERROR_PLACES];      // errors of the attempt
} film_errors;

/* Returns X of a place. */
double film_errors_place(size_t i);

/* Sets the kept errors, [NUM_ERROR_PLACES]. If `kept` is NULL, they are zero. */
void film_errors_set(film_errors *self, const double *kept);

/* Computes the difference between two films, [num_nodes] each. The result at a place is the largest
 * difference at the nodes around this place. Only nodes of the central line upstream of the exit,
 * which is at column `end`, are used. */
void film_errors_between(
    // output:
    double errors[NUM_ERROR_PLACES],
    // input:
    const double *film, const double *other, const ehd_grid *grid, size_t end);

/* Carries the kept errors along with the fluid, from the frame `then` to the frame `now`, and
 * stores the result in `next`. Fluid that was upstream of the dry contact has no error. */
void film_errors_carry(film_errors *self, const contact_frame *then, const contact_frame *now);

/* Sets the error of entering fluid in `next` to `value`, after film_errors_carry. The caller uses
 * the errors as upper bounds, so negative values are set to 0. `value` is set at the places
 * upstream of `x` and, unless `then` is NULL, at the places whose fluid has entered the dry contact
 * since the state `then`. */
void film_errors_enter(film_errors *self, const contact_frame *then, const contact_frame *now,
                       double x, double value);

/* Adds `factor` times given errors to the errors of the attempt. `x`: [num] ascending X of the
 * given errors, which are interpolated linearly. */
void film_errors_add(film_errors *self, double factor, const double *errors, const double *x,
                     size_t num);

/* Returns the error of the attempt at X; 0 outside of the dry contact. */
double film_errors_at(const film_errors *self, double x);

/* Returns the largest error of the attempt between two places X. If both lie upstream of the dry
 * contact, or both downstream of it, returns the error at the nearer edge of the dry contact. */
double film_errors_largest(const film_errors *self, double from, double to);

/* Accepts the errors of the attempt. */
void film_errors_keep(film_errors *self);

#endif
