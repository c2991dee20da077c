/* SPDX-License-Identifier: GPL-3.0-or-later */
/* romrun --fallback full: the full model solves what the reduced one does not solve well enough. */
#ifndef EHD_FALLBACK_H
#define EHD_FALLBACK_H

#include "common/output/result.h"
#include "fullrun/full_solver.h"
#include "fullrun/judge.h"
#include "romrun/online/online.h"

/* The full model's solution. */
typedef struct fallback {
    full_state state;
    full_info info;    // of the run of median time
    bool from_reduced; // it started from the reduced solution, else cold
    double *exits;     // [lines of the whole grid]
    ehd_status status; // of full_judge: EHD_OK or EHD_NOT_CONVERGED
    char reason[JUDGE_REASON];
} fallback;

void fallback_free(fallback *self); // of one that is zero too

/* A full state from the last solution of `solver`, `result` of the stationary `contact`. Errors of
 * online_fields. */
ehd_status fallback_load(full_state *state, online_solver *solver, const online_result *result,
                         const ehd_contact *contact, ehd_error *error);

/* Solves the stationary contact with the full model, `repeats` times. It starts from the last
 * solution of `solver`, `result` of the same contact; cold where that did not converge, is no state
 * of a contact, or leads to none. Not converged is an outcome in self->status. Errors of online_fields and of
 * full_solve. */
ehd_status fallback_solve(
    // output:
    fallback *self, // free with fallback_free, also after a failure
    // input:
    online_solver *solver, const online_result *result, const ehd_contact *contact, size_t repeats,
    ehd_error *error);

/* As a result: a view of it, which deviates by nothing from the full model. */
run_result fallback_result(const fallback *self, const ehd_contact *contact, bool with_fields);

#endif
