/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Errors of rho H that films take up on the central line of the dry contact and carry along with them
 * (common/time/README.md, Errors in time): what steps and filter do to the films. */
#ifndef EHD_FILM_ERRORS_H
#define EHD_FILM_ERRORS_H

#include "common/time/frame.h"

#include <stddef.h>

enum { NUM_ERROR_PLACES = 201 }; // from X = -1 to 1

/* All zero: none. */
typedef struct film_errors {
    double kept[NUM_ERROR_PLACES];      // of the last accepted state, in its frame
    double curvature[NUM_ERROR_PLACES]; // of the natural spline through them
    double next[NUM_ERROR_PLACES];      // of the attempt
} film_errors;

/* Sets those kept, [NUM_ERROR_PLACES]; NULL: none. */
void film_errors_set(film_errors *self, const double *kept);

/* What one film differs by from another, [num_nodes] each: at each place the largest of the nodes around
 * on the central line before the column `end`, where fluid still comes to the centre or the exit. */
void film_errors_between(
    // output:
    double errors[NUM_ERROR_PLACES],
    // input:
    const double *film, const double *other, const ehd_grid *grid, size_t end);

/* Takes the kept ones to where the fluid is now; what was before the dry contact has none. */
void film_errors_carry(film_errors *self, const contact_frame *then, const contact_frame *now);

/* Of a bound, which is not negative, once it is carried: what lies before X, and what has entered the
 * dry contact since the state `then`, has this value. Everything before X alone where that is NULL. */
void film_errors_enter(film_errors *self, const contact_frame *then, const contact_frame *now,
                       double x, double value);

/* Adds to those of the attempt `factor` times errors told at ascending places, linear in between. */
void film_errors_add(film_errors *self, double factor, const double *errors, const double *x,
                     size_t num);

/* Of the attempt at X; none outside of the dry contact. */
double film_errors_at(const film_errors *self, double x);

/* Largest of the attempt between two places; that at the dry contact's edge where both are outside. */
double film_errors_largest(const film_errors *self, double from, double to);

/* The attempt is accepted. */
void film_errors_keep(film_errors *self);

#endif
