/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/calibrate/accuracy.h"

#include "common/algebra/rounding.h"
#include "romrun/solve/reduced_solver.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Describes the chosen sizes and their measured accuracy. */
static void explain(accuracy_choice *choice, const trade_table *table,
                    const trade_position *position, double accuracy, bool in_time) {
    const trade_price price = trade_price_of(position, in_time);
    const bool indicated = in_time ? position->factor_in_time > 0 : position->indicator_factor > 0;
    char sizes[TRADE_NAME], part[32] = "";

    if (indicated)
        snprintf(part, sizeof part, "%.0f %% of ",
                 in_time ? 100 * trade_part_in_time(position, accuracy) : 90.0);

    trade_name(sizes, &position->sizes);
    snprintf(choice->note, sizeof choice->note,
             "%s, the fastest of %zu sizes whose %s%s at most so far off: %.3g on %s%zu %s, in "
             "%.3g ms%s",
             sizes, table->num_positions, in_time && !indicated ? "central film was" : "films were",
             indicated ? " indicated to be" : "", in_time && indicated ? accuracy : price.deviation,
             part, in_time ? table->num_trajectories : table->num_scenes,
             in_time ? "trajectories" : "scenes", price.seconds * 1e3, in_time ? " a step" : "");
}

/* Rounds up to three digits, as many as %.3g prints. --accuracy must accept the printed value
 * (test_trade.c, accuracy_names_what_it_can_give). */
static double round_up(double value) {
    const double unit = pow(10, floor(log10(value)) - 2);

    return unit * ceil(value * (1 + ROUNDING) / unit);
}

ehd_status accuracy_choose(accuracy_choice *choice, const trade_table *table, double accuracy,
                           bool in_time, const char *name, ehd_error *error) {
    size_t num_measured = in_time ? table->num_trajectories : table->num_scenes;
    size_t chosen = trade_cheapest(table, accuracy, in_time);
    size_t best = trade_most_accurate(table, in_time);
    const char *what = in_time ? "trajectories" : "scenes";
    char sizes[TRADE_NAME];

    if (num_measured == 0)
        return ehd_fail(error, EHD_DATA, "%s: found a calibration without %s, expected some", name,
                        what);
    if (best == table->num_positions)
        return ehd_fail(error, EHD_DATA,
                        "--accuracy: found no size of %s that solved enough of the %zu %s of its "
                        "calibration, expected one",
                        name, num_measured, what);
    const trade_position *most_accurate = &table->positions[best];
    trade_name(sizes, &most_accurate->sizes);
    choice->most_accurate = most_accurate->sizes;
    // this is no error: each time step has its own error estimate, which may be smaller than the
    // estimates in the calibration
    if (chosen == table->num_positions && in_time && most_accurate->factor_in_time > 0) {
        choice->fastest = most_accurate->sizes;
        snprintf(choice->note, sizeof choice->note,
                 "%s, the most accurate of %zu sizes: on half of %zu trajectories its films were "
                 "indicated to be at most %.3g off, more than that; each step is judged by its own",
                 sizes, table->num_positions, table->num_trajectories,
                 trade_price_of(most_accurate, true).deviation);
        return EHD_OK;
    }
    if (chosen == table->num_positions)
        return ehd_fail(error, EHD_DATA,
                        "--accuracy: found %g, expected at least %.3g, the best that %s was "
                        "measured to give (%s)",
                        accuracy, round_up(trade_price_of(most_accurate, in_time).deviation), name,
                        sizes);
    choice->fastest = table->positions[chosen].sizes;
    explain(choice, table, &table->positions[chosen], accuracy, in_time);
    return EHD_OK;
}

double accuracy_tolerance(double accuracy) {
    // Relative tolerance of the central film, as a part of the accuracy. An iteration that ends
    // early adds less than a fiftieth of the accuracy to the error (README.md, Calibration and the
    // accuracy dial; test_trade.c, a_promise_is_kept_or_the_result_flagged).
    const double part = 0.02;

    return fmax(reduced_defaults.tolerance, part * accuracy);
}

double accuracy_limit(double accuracy) {
    return isgreater(accuracy, 0) ? accuracy : default_accuracy;
}

void accuracy_judge(run_result *result, double accuracy) {
    const double central = result->indicated_deviation;
    const double minimum = result->indicated_deviation_minimum;
    const bool of_minimum = isgreater(minimum, central), given = isgreater(accuracy, 0);
    const double larger = of_minimum ? minimum : central;
    const double limit = accuracy_limit(accuracy);

    if (result->status || isnan(central) || larger <= limit) return;
    result->status = EHD_UNTRUSTED;
    snprintf(result->reason, sizeof result->reason,
             "an indicated deviation of %.2g of the %s film, more than %s%g", larger,
             of_minimum ? "minimum" : "central",
             given ? "the --accuracy of " : "holds without --accuracy, ", limit);
}

void accuracy_judge_peak(run_result *result, double accuracy, double peak) {
    if (result->status || !(peak > trade_pressures_allowed * accuracy)) return;
    result->status = EHD_UNTRUSTED;
    snprintf(result->reason, sizeof result->reason,
             "an indicated deviation of %.2g p_H of the largest pressure, more than %g times that",
             peak, trade_pressures_allowed);
}

static const char rolling_name[] = "rolling_resistance";

/* Returns the limit of the quantity with this name, or NULL if there is none. */
static double *limit_of(accuracy_limits *self, const char *name, size_t length) {
    for (int q = 0; q < NUM_INDICATED; q++)
        if (strlen(indicated_entries[q].name) == length &&
            strncmp(indicated_entries[q].name, name, length) == 0)
            return &self->of[q];
    return strlen(rolling_name) == length && strncmp(rolling_name, name, length) == 0
               ? &self->rolling
               : NULL;
}

ehd_status accuracy_read_limit(void *limits, const char *argument, ehd_error *error) {
    accuracy_limits *self = limits;
    const char *equals = strchr(argument, '=');
    const size_t length = equals ? (size_t)(equals - argument) : strlen(argument);
    char names[ACCURACY_NOTE] = "", *end = NULL;
    double *limit = limit_of(self, argument, length);

    for (int q = 0; q < NUM_INDICATED && !limit; q++)
        snprintf(names + strlen(names), sizeof names - strlen(names), "%s, ",
                 indicated_entries[q].name);
    if (!limit)
        return ehd_fail(error, EHD_USAGE,
                        "--accuracy-of: found %s, expected NAME=X with NAME one of %s%s", argument,
                        names, rolling_name);
    *limit = equals ? strtod(equals + 1, &end) : NAN;
    if (end && *limit > 0 && *limit <= 1 && *end == '\0') return EHD_OK;
    return ehd_fail(error, EHD_USAGE,
                    "--accuracy-of: found %s, expected %.*s=X with X above 0, at most 1", argument,
                    (int)length, argument);
}

bool accuracy_limits_any(const accuracy_limits *limits) {
    for (int q = 0; q < NUM_INDICATED; q++)
        if (limits->of[q] > 0) return true;
    return limits->rolling > 0;
}

void accuracy_write_limits(const accuracy_limits *limits, FILE *stream) {
    for (int q = 0; q < NUM_INDICATED; q++)
        if (limits->of[q] > 0)
            fprintf(stream, "# accuracy of %s %.17g\n", indicated_entries[q].name, limits->of[q]);
    if (limits->rolling > 0)
        fprintf(stream, "# accuracy of rolling_resistance %.17g\n", limits->rolling);
}

void accuracy_judge_others(run_result *result, const accuracy_limits *limits) {
    for (int q = 0; q < NUM_INDICATED && !result->status; q++) {
        const indicated_entry *entry = &indicated_entries[q];
        const double found = result->indicated ? result->indicated[q] : NAN;
        if (!(limits->of[q] > 0) || found <= limits->of[q]) continue;
        result->status = EHD_UNTRUSTED;
        if (isnan(found))
            snprintf(result->reason, sizeof result->reason,
                     "no indicated deviation of the %s, for which --accuracy-of asks", entry->text);
        else
            snprintf(
                result->reason, sizeof result->reason,
                "an indicated deviation of %.2g%s of the %s, more than the --accuracy-of %s=%g",
                found, entry->unit, entry->text, entry->name, limits->of[q]);
    }
}

void accuracy_judge_rolling(run_result *result, const accuracy_limits *limits) {
    if (!(limits->rolling > 0) || result->status) return;
    const double central = result->indicated_deviation;
    const double minimum = result->indicated_deviation_minimum;
    double films = isnan(central + minimum) ? NAN : fmax(central, minimum);

    // a result of the full model has only the error due to the grid
    if (result->solved_by == SOLVED_BY_FULL) films = 0;
    const double found = result->traction && result->effects && !isnan(films)
                             ? film_effects_of_rolling(result->effects) + films
                             : NAN;

    if (found <= limits->rolling) return;
    result->status = EHD_UNTRUSTED;
    if (isnan(found))
        snprintf(result->reason, sizeof result->reason,
                 "no error estimate of the rolling resistance, for which --accuracy-of asks");
    else
        snprintf(result->reason, sizeof result->reason,
                 "an error estimate of %.2g of the rolling resistance, more than the --accuracy-of "
                 "%s=%g",
                 found, rolling_name, limits->rolling);
}
