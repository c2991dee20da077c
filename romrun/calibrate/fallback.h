/* SPDX-License-Identifier: GPL-3.0-or-later */
/* romrun --fallback full: solves a contact with the full model if the reduced model does not solve
 * it well (README.md, Fallback).
 * Called by romrun/main.c, and by verify.c to make a full state. */
#ifndef EHD_FALLBACK_H
#define EHD_FALLBACK_H

#include "common/output/result.h"
#include "fullrun/full_solver.h"
#include "fullrun/judge.h"
#include "romrun/online/online.h"

/* Solution of the full model. */
typedef struct fallback {
    full_state state;
    full_info info;    // info of the solution with the median time
    bool from_reduced; // true: started from the reduced solution; false: cold start
    double *exits;     // [lines of the whole grid] X of the exit; NULL for a line contact
    ehd_status status; // outcome of full_judge: EHD_OK, EHD_NOT_CONVERGED or EHD_UNTRUSTED
    char reason[JUDGE_REASON];
} fallback;

void fallback_free(fallback *self); // also accepts a zero struct

/* Fills a full state from the last solution of `solver`. `result` is this solution, and `contact`
 * its stationary contact. `state` must be allocated. Errors: those of online_fields. */
ehd_status fallback_load(full_state *state, online_solver *solver, const online_result *result,
                         const ehd_contact *contact, ehd_error *error);

/* Solves the stationary contact with the full model, `repeats` times. The full model starts from
 * the last solution of `solver`, which is the `result` of this contact. It starts cold if that
 * solution did not converge, is not physical, or leads to no full solution. If the full model does
 * not converge either, self->status is EHD_NOT_CONVERGED. Errors: those of online_fields and
 * full_solve. */
ehd_status fallback_solve(
    // output:
    fallback *self, // free with fallback_free, also after a failure
    // input:
    online_solver *solver, const online_result *result, const ehd_contact *contact, size_t repeats,
    ehd_error *error);

/* Returns the solution as a result that refers to the arrays of `self`. The result has error
 * estimates of zero, because they are relative to the full model. */
run_result fallback_result(const fallback *self, const ehd_contact *contact, bool with_fields);

#endif
