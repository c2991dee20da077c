/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Speed for accuracy: what each size of a model was measured to deviate and to cost. */
#ifndef EHD_TRADE_H
#define EHD_TRADE_H

#include "romrun/model/trade_file.h"
#include "romrun/online/ehdrom.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* The sizes to measure: pressure modes from about 10 to all in strides of about sqrt(2), half of it in
 * the end, deformation modes in proportion; rows 1.2, 1.5, 2 and 3 times the pressure modes, and all. EHD_MEMORY. */
ehd_status trade_ladder(
    // output:
    trade_table *table, // free with trade_free; only the sizes are filled
    // input:
    const ehdrom_properties *whole, ehd_error *error);

/* The value that the part `quantile` of the values does not exceed (nearest rank); sorts them. NaN of none. */
double trade_quantile_of(double *values, size_t count, double quantile);

/* Whether a position with no failures is as fast and as accurate in the worst central film as this one, and
 * better in one of the two; or this one had failures, and there is nothing to beat. `in_time`: in what was
 * measured on trajectories, here and below. */
bool trade_is_beaten(const trade_table *table, size_t position, bool in_time);

/* The fastest position without failures whose worst central film deviates by no more; num_positions: there is
 * none. */
size_t trade_cheapest(const trade_table *table, double deviation, bool in_time);

/* The position without failures with the smallest of the worst central film; num_positions: all failed. */
size_t trade_most_accurate(const trade_table *table, bool in_time);

/* What these choose by. Where there is an indicator, which tells the scenes that deviate more, it is enough
 * that 90 % of the scenes are solved and indicated to deviate by no more. */
typedef struct trade_price {
    double deviation;    // central film: worst, or what is indicated for 90 %
    double seconds;      // of a solution or a step
    size_t num_failures; // with an indicator 0 up to 10 % of the scenes
} trade_price;
trade_price trade_price_of(const trade_position *position, bool in_time);

/* "80 pressure modes, 120 rows" */
enum { TRADE_NAME = 96 };
void trade_name(char name[TRADE_NAME], const ehdrom_sizes *sizes);

/* Factor of the indicator that was fitted to scenes: each is indicated to deviate at least twice as much as
 * it does (indicator.h). 0: no scenes. */
double trade_indicator_factor(const double *deviations, const double *bounds, size_t count);

void trade_print(const trade_table *table, FILE *stream);

#endif
