/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Holds the sizes of a model, with their measured errors and time, and chooses a size (README.md,
 * Calibration and the accuracy dial). A *position* is the entry of one size in the table.
 * Called by accuracy.c, calibration.c and validation.c, by romrun/main.c, and by
 * snapgen/adaptive.c. */
#ifndef EHD_TRADE_H
#define EHD_TRADE_H

#include "romrun/model/trade_file.h"
#include "romrun/online/online.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* Creates the list (ladder) of model sizes to measure. The number of pressure modes grows from
 * about 10 to all modes by factors of about sqrt(2), at the end by the square root of this factor.
 * The number of deformation modes is in proportion. The numbers of rows are 1.2, 1.5, 2 and 3 times
 * the number of pressure modes, and all rows. Errors: EHD_MEMORY. */
ehd_status trade_ladder(
    // output:
    trade_table *table, // free with trade_free; only the sizes are filled
    // input:
    const online_properties *whole, ehd_error *error);

/* Returns a quantile of the values (nearest rank), which are sorted by the call. NaN: there are no
 * values. */
double trade_quantile_of(double *values, size_t count, double quantile);

/* Checks whether a position is not Pareto-optimal. This is true in two cases: the position may not
 * be chosen, or another position is at least as good in failures, time and deviation, and better in
 * one of these. `in_time`, here and below: uses the measurements on trajectories instead of the
 * measurements on stationary scenes. */
bool trade_is_dominated(const trade_table *table, size_t position, bool in_time);

/* Returns the fastest position that meets a relative deviation of the films; num_positions if there
 * is none.
 *
 * Stationary: candidates have no failures and film deviations of at most `deviation`
 * (trade_price_of). The worst pressure deviation, in Hertz pressures, must be at most
 * trade_pressures_allowed times `deviation`, because false spikes may occur where the films are
 * right. If no candidate meets this limit, the candidate with the smallest worst pressure deviation
 * is returned.
 *
 * Transient, with error estimates: the estimates of a candidate are within `deviation` on at least
 * half of the trajectories. This is enough, because the estimates mark the steps that exceed
 * `deviation`. Three criteria decide in this order: fewest lost trajectories, most trajectories
 * within `deviation`, shortest time. Lost trajectories (a step failed or was not trusted) are
 * allowed, because all sizes fail on 5 of 20 random histories. The films of these histories rupture
 * in the inlet after a jump or fill the outlet (scenes/studies/silent-in-time). */
size_t trade_cheapest(const trade_table *table, double deviation, bool in_time);

/* Returns the position without failures that has the smallest deviation (trade_price_of);
 * num_positions if there is none. For transient contacts with error estimates, the function
 * compares the positions that solve at least half of the trajectories. It returns the position with
 * the smallest geometric mean of the quantiles of the estimates. A trajectory with a step that
 * fails or is not trusted has the estimate 1. */
size_t trade_most_accurate(const trade_table *table, bool in_time);

/* Deviation, time and failures by which model sizes are chosen. Error estimates mark the scenes
 * that deviate by more than is wanted. If a model has error estimates, it is therefore enough if
 * the estimates of 90 % of the scenes are at most the wanted deviation. */
typedef struct trade_price {
    // stationary: the worst deviation of the films; with error estimates, the 90 % quantile of the
    // estimates. Transient: the worst deviation of the central film; with error estimates, the
    // median of the estimates over the trajectories (infinite if more than half of the trajectories
    // are lost: a step failed or is not trusted)
    double deviation;
    double seconds; // time of a solution or of a time step
    // stationary: number of scenes that fail; with error estimates, 0 if at most 10 % of the scenes
    // fail. Transient: number of lost trajectories
    size_t num_failures;
} trade_price;
trade_price trade_price_of(const trade_position *position, bool in_time);

/* Returns the fraction of the trajectories whose error estimates are at most `deviation`, rounded
 * down to a value of trade_time_parts. Returns 0 if the fraction is less than half, or without
 * error estimates. */
double trade_part_in_time(const trade_position *position, double deviation);

/* Writes the sizes as text, for example "80 pressure modes, 120 rows". */
enum { TRADE_NAME = 96 };
void trade_name(char name[TRADE_NAME], const model_sizes *sizes);

/* Safety factor of error estimates, for scenes that differ from the scenes of the calibration
 * (romrun/trust/README.md, Error estimates; scenes/studies/silent-failures; test_trade.c,
 * the_factor_leaves_a_margin). */
extern const double trade_margin;

/* Allowed error of the pressure, in Hertz pressures, divided by the allowed relative error of the
 * films. A pressure spike may be wrong where the films are right (romrun/calibrate/README.md,
 * Calibration and the accuracy dial; test_trade.c, pressures_may_be_off_three_times_as_much). */
extern const double trade_pressures_allowed;

/* Returns the factor of the error estimate of a film (indicator.h). It is the smallest factor with
 * which the estimate of each scene is at least trade_margin times its deviation. Returns 0 without
 * scenes. */
double trade_indicator_factor(const double *deviations, const double *bounds, size_t count);

/* Fits the dependence of the factor on the bound (romrun/trust/README.md, The factor grows with the
 * bound). The estimate of each scene remains at least trade_margin times its deviation, as with a
 * constant factor. As a function of the bound, the factor becomes a straight line above the ratios
 * of deviation to bound of all scenes. Of all such lines, the fit takes the line with the smallest
 * geometric mean of the estimates. At a bound of zero the line is not below the ratio of the scene
 * with the smallest bound.
 *
 * `with_offset`: the function also fits an offset plus a multiple of the bound, and the estimate is
 * the smaller value of both fits. This fit too minimises the geometric mean of the estimates.
 * Without scenes the shape is plain_shape. Errors: EHD_MEMORY. */
ehd_status trade_indicator_shape(
    // output:
    indicator_shape *shape,
    // input:
    const double *deviations, const double *bounds, size_t count, bool with_offset,
    ehd_error *error);

void trade_print(const trade_table *table, FILE *stream);

#endif
