/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the full model says of a reduced solution, without solving it. */
#ifndef EHD_VERIFY_H
#define EHD_VERIFY_H

#include "romrun/online/ehdrom.h"

typedef struct verification {
    double residual;         // largest scaled one of all rows before the exit and of the closure
    double tolerance;        // below which fullrun stops
    double residual_seconds; // O(n log n)
    /* What one Newton step of the full model, at this exit, adds to the central film, relative: the deviation
     * to first order, its sign turned. NaN: no step could be made. */
    double film_change;
    double step_seconds;
} verification;

/* Of the last solution of `solver`, which solved `contact`, stationary, with `result`. Nothing of theirs
 * changes. Errors of ehdrom_fields and of full_solve. */
ehd_status verify(verification *outcome, ehdrom_solver *solver, const ehdrom_result *result,
                  const ehd_contact *contact, ehd_error *error);

#endif
