/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/calibrate/reduced_result.h"

#include <stdio.h>

run_result reduced_result(const online_result *solution) {
    run_result result = {.scalars = solution->scalars,
                         .newton_iterations = solution->iterations,
                         .residual = solution->residual,
                         .indicated_deviation = solution->indicated,
                         .indicated_deviation_minimum = solution->indicated_minimum,
                         .status = solution->status,
                         .seconds = solution->seconds};

    snprintf(result.reason, sizeof result.reason, "%s", solution->reason);
    return result;
}

void reduced_result_judge(run_result *result, const char *unchecked, double accuracy,
                          const accuracy_limits *limits) {
    accuracy_judge(result, accuracy);
    if (unchecked && !result->status) {
        result->status = EHD_UNTRUSTED;
        snprintf(result->reason, sizeof result->reason, "%s", unchecked);
    }
    accuracy_judge_others(result, limits);
    accuracy_judge_rolling(result, limits);
}
