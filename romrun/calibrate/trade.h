/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Trade of accuracy for speed: the sizes of a model, by their measured deviation and time. */
#ifndef EHD_TRADE_H
#define EHD_TRADE_H

#include "romrun/model/trade_file.h"
#include "romrun/online/online.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* The ladder, sizes to measure: pressure modes from about 10 to all in strides of about sqrt(2),
 * halved at the end, deformation modes in proportion; rows 1.2, 1.5, 2 and 3 times the pressure
 * modes, and all. EHD_MEMORY. */
ehd_status trade_ladder(
    // output:
    trade_table *table, // free with trade_free; only the sizes are filled
    // input:
    const online_properties *whole, ehd_error *error);

/* Quantile of the values (nearest rank), which are sorted; NaN: no values. */
double trade_quantile_of(double *values, size_t count, double quantile);

/* Whether a position is not Pareto-optimal: it may not be chosen, or another one has no more failures, is as
 * fast and as accurate, and better in one of the three. `in_time`, here and below: as measured on
 * trajectories. */
bool trade_is_dominated(const trade_table *table, size_t position, bool in_time);

/* The fastest position without failures whose films deviate by no more, and of which the pressures of all scenes
 * do by no more than three times that, in Hertz pressures: spikes may be false where films are right. Where none has such
 * pressures, the one with the best. num_positions: none has such films. In time, with an indicator, which marks the steps
 * that deviate by more, at least half of the trajectories are indicated to deviate by no more; of such positions those
 * with the fewest lost trajectories, of these those with the most trajectories within the deviation, and of these the
 * fastest. Films that rupture in the inlet after a jump, or fill the outlet, are lost or off at all sizes, 5 of 20 random
 * histories (scenes/studies/silent-in-time). */
size_t trade_cheapest(const trade_table *table, double deviation, bool in_time);

/* The position without failures whose worst central film deviates least; num_positions: none. In time, with an
 * indicator, of those that solve half of the trajectories the one with the least geometric mean of what is indicated on
 * the parts of the trajectories, lost ones counting as 1. */
size_t trade_most_accurate(const trade_table *table, bool in_time);

/* Deviation and time by which these choose. With an indicator, which marks the scenes that deviate
 * by more, it is enough that 90 % of the scenes are solved and indicated to deviate by no more. */
typedef struct trade_price {
    // of the films: worst or, with an indicator, the 90 % quantile of the indicated; in time that
    // of half of the trajectories (infinite: more are lost), without an indicator the worst, of the
    // central film alone
    double deviation;
    double seconds;      // of a solution or a step
    size_t num_failures; // with an indicator 0 up to 10 % of the scenes, in time lost trajectories
} trade_price;
trade_price trade_price_of(const trade_position *position, bool in_time);

/* The largest part of the trajectories (trade_time_parts) that are indicated to deviate by no more;
 * 0: less than half, or nothing is indicated. */
double trade_part_in_time(const trade_position *position, double deviation);

/* "80 pressure modes, 120 rows" */
enum { TRADE_NAME = 96 };
void trade_name(char name[TRADE_NAME], const model_sizes *sizes);

/* What a factor has beyond the scenes that were measured, for kinds that were not: 2. */
extern const double trade_margin;

/* What pressures may be off, in Hertz pressures, over what films may. */
extern const double trade_pressures_allowed;

/* Factor of a film's indicator (indicator.h) with which each scene is indicated to deviate at
 * least twice as much as it does. 0: no scenes. */
double trade_indicator_factor(const double *deviations, const double *bounds, size_t count);

/* How that factor depends on the bound, so that each scene is covered as by the factor: the line that
 * is above the deviation over the bound of each, by which they are indicated to deviate least in the
 * geometric mean, towards zero as the smallest bound; and, `with_offset`, the offset and share for
 * which what both indicate is least. plain_shape: no scenes. EHD_MEMORY. */
ehd_status trade_indicator_shape(
    // output:
    indicator_shape *shape,
    // input:
    const double *deviations, const double *bounds, size_t count, bool with_offset,
    ehd_error *error);

void trade_print(const trade_table *table, FILE *stream);

#endif
