/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts a reduced solution to a result and judges whether it is trusted
 * (romrun/trust/README.md, Results that are rejected).
 * Called by romrun/main.c, and by cases.c for each case. */
#ifndef EHD_REDUCED_RESULT_H
#define EHD_REDUCED_RESULT_H

#include "common/output/result.h"
#include "romrun/calibrate/accuracy.h"
#include "romrun/online/online.h"

/* Converts a solution to a result. The result has no fields, no exits and, except for the films, no
 * error estimates. */
run_result reduced_result(const online_result *solution);

/* Sets EHD_UNTRUSTED in each of these cases: the error estimate of a film exceeds
 * accuracy_limit(accuracy), the model was never checked, or the estimate of another quantity
 * exceeds its limit. `unchecked`: the reason of online_unchecked; NULL: the model was checked. */
void reduced_result_judge(run_result *result, const char *unchecked, double accuracy,
                          const accuracy_limits *limits);

#endif
