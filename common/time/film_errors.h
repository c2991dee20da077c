/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Errors of rho H by steps and filter, which films take up on the central line of the dry contact
 * and carry along with them (common/time/README.md, Errors in time). */
#ifndef EHD_FILM_ERRORS_H
#define EHD_FILM_ERRORS_H

#include "common/time/frame.h"

#include <stddef.h>

enum { NUM_ERROR_PLACES = 201 }; // places from X = -1 to 1

/* Errors at the places. All zero: no errors. */
typedef struct film_errors {
    double kept[NUM_ERROR_PLACES];      // errors of the last accepted state, in its frame
    double curvature[NUM_ERROR_PLACES]; // curvature of the natural spline through `kept`
    double next[NUM_ERROR_PLACES];      // errors of the attempt
} film_errors;

/* Returns X of a place. */
double film_errors_place(size_t i);

/* Sets the kept errors, [NUM_ERROR_PLACES]; NULL: none. */
void film_errors_set(film_errors *self, const double *kept);

/* Computes the difference of two films, [num_nodes] each. A place gets the largest difference of
 * the nodes around it, on the central line before column `end`, where fluid still comes to the
 * centre or the exit. */
void film_errors_between(
    // output:
    double errors[NUM_ERROR_PLACES],
    // input:
    const double *film, const double *other, const ehd_grid *grid, size_t end);

/* Carries the kept errors to where the fluid is now. Fluid that was before the dry contact has
 * none. */
void film_errors_carry(film_errors *self, const contact_frame *then, const contact_frame *now);

/* Sets entering errors in a bound, which is not negative, after it has been carried. Everything
 * before X, and everything that has entered the dry contact since the state `then`, gets `value`.
 * `then` NULL: only what lies before X. */
void film_errors_enter(film_errors *self, const contact_frame *then, const contact_frame *now,
                       double x, double value);

/* Adds `factor` times errors at ascending places `x` to those of the attempt, linear in between. */
void film_errors_add(film_errors *self, double factor, const double *errors, const double *x,
                     size_t num);

/* Returns the error of the attempt at X; 0 outside of the dry contact. */
double film_errors_at(const film_errors *self, double x);

/* Returns the largest error of the attempt between two places. If both lie outside of the dry
 * contact, it is the error at the edge. */
double film_errors_largest(const film_errors *self, double from, double to);

/* Accepts the errors of the attempt. */
void film_errors_keep(film_errors *self);

#endif
