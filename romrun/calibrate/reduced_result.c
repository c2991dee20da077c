/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/calibrate/reduced_result.h"

#include <stdio.h>

run_result reduced_result(const online_result *solution) {
    run_result result = {.central_film_thickness = solution->scalars.central_film_thickness,
                         .minimum_film_thickness = solution->scalars.minimum_film_thickness,
                         .central_pressure = solution->scalars.central_pressure,
                         .rigid_approach = solution->scalars.rigid_approach,
                         .exit_position = solution->scalars.exit_position,
                         .load = solution->scalars.load,
                         .newton_iterations = solution->iterations,
                         .residual = solution->residual,
                         .indicated_deviation = solution->indicated,
                         .indicated_deviation_minimum = solution->indicated_minimum,
                         .status = solution->status,
                         .seconds = solution->seconds,
                         .seconds_rows = solution->seconds_rows,
                         .seconds_linear = solution->seconds_linear,
                         .seconds_exit = solution->seconds_exit};

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
