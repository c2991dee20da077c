/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far the central film of a reduced solution may be off, from what a few rows cost.
 *
 * Rows that the solution does not fulfil, selected ones (the least squares leave a rest) and control rows,
 * are a sample of how badly the Reynolds equation is fulfilled everywhere. What an error of that norm in
 * the rows moves H_c by is known from the factors of the last iteration. The product is a bound but for a
 * factor, which calibration finds. */
#ifndef EHD_INDICATOR_H
#define EHD_INDICATOR_H

#include "romrun/online/reduced_solver.h"

typedef struct indicator indicator;

/* The model must outlive it. NULL: no memory. */
indicator *indicator_create(const reduced_model *model);
indicator *indicator_free(indicator *self); // accepts and returns NULL

/* |D f| over the control rows before the exit, of a stationary state. */
double indicator_control_residual(indicator *self, const reduced_state *state,
                                  const ehd_contact *contact);

/* Of the relative deviation of the central film, but for the factor of a calibration (trade_indicator_factor);
 * grows faster where the error is no longer small. `solver` has just solved `state` for
 * `contact`, stationary, with the outcome `scalars`. */
double indicator_bound(indicator *self, reduced_solver *solver, const reduced_state *state,
                       const ehd_contact *contact, const contact_scalars *scalars);

#endif
