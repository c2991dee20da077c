/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Handles options --accuracy and --accuracy-of: chooses the sizes of a calibrated model, sets the
 * tolerance of the solver, and checks a result against the limits (README.md, Calibration and the
 * accuracy dial).
 * Called by romrun/main.c, by cases.c and reduced_result.c, and by podbuild and deimselect for the
 * limit. */
#ifndef EHD_ACCURACY_H
#define EHD_ACCURACY_H

#include "common/output/result.h"
#include "romrun/calibrate/trade.h"
#include <stdbool.h>

enum { ACCURACY_NOTE = 320 };
typedef struct accuracy_choice {
    model_sizes fastest;       // fastest model size that meets the accuracy in the calibration
    model_sizes most_accurate; // used where `fastest` is not accurate enough
    char note[ACCURACY_NOTE];  // text about `fastest` and its measured accuracy
} accuracy_choice;

/* Chooses the model size for a relative accuracy of both films. For transient contacts (`in_time`):
 * - If the model has no error estimates in time, the accuracy of the central film alone counts.
 * - If the model has error estimates in time, but no size meets the accuracy, the most accurate
 *   size is chosen.
 *
 * `name`: name of the model, for error messages. EHD_DATA: the model is not calibrated in this
 * regime, or no size meets the accuracy. */
ehd_status accuracy_choose(
    // output:
    accuracy_choice *choice,
    // input:
    const trade_table *table, double accuracy, bool in_time, const char *name, ehd_error *error);

/* Returns the tolerance for online_solver_set_tolerance: a fiftieth of the accuracy, at least
 * 1e-8. */
double accuracy_tolerance(double accuracy);

/* Returns the limit of the error estimates of both films: the accuracy, or 1 % if `accuracy` is 0,
 * which means that it is not given. */
double accuracy_limit(double accuracy);

/* Sets EHD_UNTRUSTED if the error estimate of the central or minimum film exceeds
 * accuracy_limit(accuracy). */
void accuracy_judge(run_result *result, double accuracy);

/* Sets EHD_UNTRUSTED if the error estimate of the largest pressure exceeds trade_pressures_allowed
 * times the accuracy, in Hertz pressures. The caller then solves the contact again with a more
 * accurate model size. */
void accuracy_judge_peak(run_result *result, double accuracy,
                         double peak); // result of online_indicate_peak; NaN: the estimate is not
                                       // known and changes nothing

/* Limits of --accuracy-of, indexed by indicated_quantity; 0: no limit. */
typedef struct accuracy_limits {
    double of[NUM_INDICATED];
    double rolling; // limit of the rolling resistance
} accuracy_limits;

/* Parses "NAME=X" and sets the limit of this quantity. EHD_USAGE: an unknown name (the message
 * lists the known ones), or X not above 0 and at most 1. */
ehd_status accuracy_read_limit(void *limits, const char *argument, ehd_error *error);

/* Checks whether any limit is set. */
bool accuracy_limits_any(const accuracy_limits *limits);

/* Writes each given limit to `stream`, the settings text, as a comment on a line of its own. */
void accuracy_write_limits(const accuracy_limits *limits, FILE *stream);

/* Sets EHD_UNTRUSTED if an error estimate in result->indicated exceeds its limit, or if a limit is
 * set for an estimate that is not known. */
void accuracy_judge_others(run_result *result, const accuracy_limits *limits);

/* Sets EHD_UNTRUSTED if the error estimate of the rolling resistance exceeds its limit, or if the
 * limit is set and the estimate is not known. The estimate is the error due to the grid
 * (result->effects). For a reduced result, the larger one of the error estimates of the central and
 * the minimum film is added to it. */
void accuracy_judge_rolling(run_result *result, const accuracy_limits *limits);

#endif
