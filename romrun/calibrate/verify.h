/* SPDX-License-Identifier: GPL-3.0-or-later */
/* romrun --verify: evaluates the residual of the full model at a reduced solution, and makes one
 * Newton step of the full model (fullrun/README.md, Newton). Called by romrun/main.c. */
#ifndef EHD_VERIFY_H
#define EHD_VERIFY_H

#include "romrun/online/online.h"

typedef struct verification {
    double residual;         // largest scaled residual of all rows before the exit and of the load
                             // balance
    double tolerance;        // tolerance of fullrun
    double residual_seconds; // time for the residual, O(n log n)
    // Relative change of the central film in one Newton step of the full model at a fixed exit. To
    // first order this change is minus the relative error of the film. NaN: no step was possible.
    double film_change;
    double step_seconds;
} verification;

/* Verifies the last solution of `solver`. `result` is this solution, and `contact` its stationary
 * contact. The function changes none of these objects. Errors: those of online_fields and
 * full_solve. */
ehd_status verify(verification *outcome, online_solver *solver, const online_result *result,
                  const ehd_contact *contact, ehd_error *error);

#endif
