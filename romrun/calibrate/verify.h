/* SPDX-License-Identifier: GPL-3.0-or-later */
/* romrun --verify: the full model's residual and one of its Newton steps at a reduced solution. */
#ifndef EHD_VERIFY_H
#define EHD_VERIFY_H

#include "romrun/online/online.h"

typedef struct verification {
    double residual;         // largest scaled one of all rows before the exit and of the closure
    double tolerance;        // of fullrun
    double residual_seconds; // O(n log n)
    // relative change of the central film by one Newton step of the full model at this exit: to
    // first order minus the deviation; NaN: no step could be made
    double film_change;
    double step_seconds;
} verification;

/* Verifies the last solution of `solver`, `result` of the stationary `contact`, and changes none of
 * them. Errors of online_fields and of full_solve. */
ehd_status verify(verification *outcome, online_solver *solver, const online_result *result,
                  const ehd_contact *contact, ehd_error *error);

#endif
