/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The accuracy-speed table of a calibrated model, as part of its file. */
#ifndef EHD_TRADE_FILE_H
#define EHD_TRADE_FILE_H

#include "common/artefact/artefact.h"
#include "common/output/indicated.h"
#include "romrun/model/shown.h"
#include "romrun/model/sizes.h"
#include <stdbool.h>
#include <stddef.h>

enum trade_quantity {
    TRADE_CENTRAL_FILM,
    TRADE_MINIMUM_FILM,
    TRADE_CENTRAL_PRESSURE,
    TRADE_PRESSURE, // largest difference of all nodes, in Hertz pressures; the others are relative
    NUM_TRADE_QUANTITIES
};
enum trade_quantile { TRADE_MEDIAN, TRADE_95, TRADE_WORST, NUM_TRADE_QUANTILES };
extern const double trade_quantiles[NUM_TRADE_QUANTILES]; // 0.5, 0.95, 1
enum trade_part { PART_5, PART_50, PART_90, PART_95, NUM_TRADE_PARTS };
extern const double trade_parts[NUM_TRADE_PARTS]; // 0.05, 0.5, 0.9, 0.95
enum { NUM_TIME_PARTS = 6 };
extern const double trade_time_parts[NUM_TIME_PARTS]; // of trajectories: 0.5, 0.6, ... 1

/* The films, and then the other quantities by indicated_quantity. */
enum { OF_CENTRAL_FILM, OF_MINIMUM_FILM, OF_OTHERS, NUM_BOUNDED = OF_OTHERS + NUM_INDICATED };

/* What a bound indicates, over its factor: the least of
 *   bound                            all scenes by one factor,
 *   (share + growth bound) bound     one that grows, as linear influences do not hold far away,
 *   offset + offset_share bound      and deviations that no residual tells, where exits are nodes. */
typedef struct indicator_shape {
    double share, growth;
    double offset, offset_share;
} indicator_shape;

/* Of the bound alone. */
extern const indicator_shape plain_shape;

/* The deviation that a bound indicates. NaN and infinite bounds stay what they are. */
double trade_indicated(double factor, indicator_shape shape, double bound);

/* Sizes of the model, with accuracy and time on the scenes that they solved (NaN: none). */
typedef struct trade_position {
    model_sizes sizes; // 0 only for the deformation modes of a coupled basis
    double deviation[NUM_TRADE_QUANTITIES][NUM_TRADE_QUANTILES];
    double mean_iterations, max_iterations; // Newton, of a scene
    double seconds;                         // of a solution, median
    size_t num_failures;                    // scenes not converged or not to be trusted
    // the indicator of the films' deviations
    double indicator_factor;             // central film; 0: not calibrated, what follows is unknown
    double indicator_factor_minimum;     // minimum film
    double indicated[NUM_TRADE_PARTS];   // larger deviation, over all scenes; infinite: not solved
    double effectivity[NUM_TRADE_PARTS]; // indicated over true deviation, the smaller one
    double largest_residual;             // of the least squares; infinite: not known
    double other_factor[NUM_INDICATED];  // of the indicators of other quantities; 0: not known
    indicator_shape shape[NUM_BOUNDED];  // of these factors
    // on trajectories that were repeated with the steps of the full model
    double worst_in_time[TRADE_PRESSURE]; // over all steps; TRADE_PRESSURE is not compared
    double step_iterations, step_seconds; // of a step, mean
    double factor_in_time;         // of the indicator in time, central film; 0: not calibrated
    double factor_in_time_minimum; // of what arises at the minimum film
    double floor_in_time;          // added to the central film's, 0 in models of before 2.9
    double floor_in_time_minimum;  // added to the minimum film's
    // larger deviation of both films at all steps of a part of the trajectories; 1: they are lost
    double indicated_in_time[NUM_TIME_PARTS];
    size_t num_lost; // trajectories with a step not converged or not trusted
} trade_position;

typedef struct trade_table {
    size_t num_scenes, num_trajectories; // what it was measured on
    size_t num_positions;
    trade_position *positions; // [num_positions]
    shown_lubricants shown;    // lubricants that it was measured on; trade_get does not read them
} trade_table;

void trade_free(trade_table *table);

/* Axes that a calibration adds to a model, which artefact_copy leaves out; NULL at the end. */
extern const char *const trade_axes[];

/* Adds the table to a model file that has none. */
ehd_status trade_write(artefact *file, const trade_table *table, ehd_error *error);

/* EHD_DATA also for a model that is not calibrated, and for sizes that it does not have. */
ehd_status trade_read(
    // output:
    trade_table *table, // free with trade_free
    // input:
    const char *path, ehd_error *error);

/* The same of a model that is open, calibrated or not; *calibrated false: there is no table. */
ehd_status trade_get(trade_table *table, bool *calibrated, artefact *file, ehd_error *error);

#endif
