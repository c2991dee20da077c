/* SPDX-License-Identifier: GPL-3.0-or-later */
/* --accuracy: choice of a calibrated model's sizes, their tolerance, and the check of a result. */
#ifndef EHD_ACCURACY_H
#define EHD_ACCURACY_H

#include "common/output/result.h"
#include "romrun/calibrate/trade.h"
#include <stdbool.h>

enum { ACCURACY_NOTE = 320 };
typedef struct accuracy_choice {
    model_sizes fastest;       // of those measured to be accurate enough
    model_sizes most_accurate; // fallback sizes, where the result of the fastest is not
    char note[ACCURACY_NOTE];  // the fastest sizes and their measured accuracy
} accuracy_choice;

/* Chooses the sizes for a relative deviation of the films, in time without an indicator of the central
 * one. In time, with an indicator, the most accurate ones where none are that accurate: each step is then
 * judged by its own error estimate. `name`: of the model, for errors. EHD_DATA: not calibrated in this
 * regime, or no sizes are that accurate. */
ehd_status accuracy_choose(
    // output:
    accuracy_choice *choice,
    // input:
    const trade_table *table, double accuracy, bool in_time, const char *name, ehd_error *error);

/* Tolerance for online_solver_set_tolerance: a fiftieth of the accuracy, at least 1e-8. */
double accuracy_tolerance(double accuracy);

/* What holds for both films: the accuracy, 1 % where that is 0: not given. */
double accuracy_limit(double accuracy);

/* Sets EHD_UNTRUSTED where the central or the minimum film is indicated to deviate by more than the
 * accuracy, 1 % where that is 0: not given. */
void accuracy_judge(run_result *result, double accuracy);

/* Sets EHD_UNTRUSTED where the largest pressure is indicated to deviate by more than goes with the
 * accuracy: where there is a more accurate size, that is to solve it. */
void accuracy_judge_peak(run_result *result, double accuracy,
                         double peak); // of online_indicate_peak; NaN: not known, and so let pass

/* Limits of --accuracy-of, by indicated_quantity; 0: none. */
typedef struct accuracy_limits {
    double of[NUM_INDICATED];
    double rolling; // of the rolling resistance
} accuracy_limits;

/* Reads "NAME=X" into one of them. EHD_USAGE: no such name, with those there are; X not between 0
 * and 1. */
ehd_status accuracy_read_limit(void *limits, const char *argument, ehd_error *error);

/* Whether there is one. */
bool accuracy_limits_any(const accuracy_limits *limits);

/* Writes them as comments of settings, a line each; nothing where there is none. */
void accuracy_write_limits(const accuracy_limits *limits, FILE *stream);

/* Sets EHD_UNTRUSTED where one of result->indicated is above its limit, or not known. */
void accuracy_judge_others(run_result *result, const accuracy_limits *limits);

/* Sets EHD_UNTRUSTED where the error estimate of the rolling resistance is above its limit, or not
 * known. The estimate is the sum of result->effects and, of a reduced result, the films' larger one. */
void accuracy_judge_rolling(run_result *result, const accuracy_limits *limits);

#endif
