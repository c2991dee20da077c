/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads and writes the table of sizes of a calibrated model, with the accuracy and the computing
 * time of each size. The table is a part of the model's file (schemas/model.md). Called by
 * deimselect/checked_model.c, romrun/calibrate and romrun/online/part.c. */
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
    TRADE_PRESSURE, // largest deviation at a node, in Hertz pressures; other quantities: relative
    NUM_TRADE_QUANTITIES
};
enum trade_quantile { TRADE_MEDIAN, TRADE_95, TRADE_WORST, NUM_TRADE_QUANTILES };
extern const double trade_quantiles[NUM_TRADE_QUANTILES]; // 0.5, 0.95, 1
enum trade_part { PART_5, PART_50, PART_90, PART_95, NUM_TRADE_PARTS };
extern const double trade_parts[NUM_TRADE_PARTS]; // quantiles: 0.05, 0.5, 0.9, 0.95
enum { NUM_TIME_PARTS = 6 };
extern const double trade_time_parts[NUM_TIME_PARTS]; // quantiles: 0.5, 0.6, ... 1

/* Quantities with an error bound: both films, then the other quantities in the order of
 * indicated_quantity. */
enum { OF_CENTRAL_FILM, OF_MINIMUM_FILM, OF_OTHERS, NUM_BOUNDED = OF_OTHERS + NUM_INDICATED };

/* Shape of an error estimate. The estimate is a factor times the least of three terms:
 *   bound                            the factor is the same for all scenes
 *   (share + growth bound) bound     the factor grows with the bound: the effect of residuals on
 *                                    results is linearised, which holds only for small errors
 *   offset + offset_share bound      for exits at nodes, whose errors no residual contains */
typedef struct indicator_shape {
    double share, growth;
    double offset, offset_share;
} indicator_shape;

/* The shape for which the estimate is the factor times the bound. */
extern const indicator_shape plain_shape;

/* Returns the error estimate that belongs to a bound. NaN and infinite bounds are returned
 * unchanged. */
double trade_indicated(double factor, indicator_shape shape, double bound);

/* One model size, with its accuracy and computing time on the scenes that the model solved with
 * this size. Both are NaN if it solved no scene. */
typedef struct trade_position {
    model_sizes sizes; // all numbers are above 0, except deformation_modes of a coupled basis
    double deviation[NUM_TRADE_QUANTITIES][NUM_TRADE_QUANTILES];
    double mean_iterations, max_iterations; // Newton iterations of a scene
    double seconds;                         // median time of a solution
    size_t num_failures;                    // scenes that did not converge or are not trusted
    // error estimates of the films
    double indicator_factor; // factor of the error estimate of the central film; 0: this size was
                             // not calibrated, and the members below are unknown
    double indicator_factor_minimum;     // factor of the error estimate of the minimum film
    double indicated[NUM_TRADE_PARTS];   // quantiles, over all scenes, of the larger of the two
                                         // film estimates; infinite for a scene not solved
    double effectivity[NUM_TRADE_PARTS]; // quantiles of the ratio of estimate to error; in each
                                         // scene the smaller ratio of the two films
    double largest_residual;             // largest residual of the least squares; infinite: unknown
    double other_factor[NUM_INDICATED];  // factors for the other quantities; 0: not known
    indicator_shape shape[NUM_BOUNDED];  // shapes of the error estimates, without their factors
    // results on trajectories, which the reduced model solved with the time steps of the full model
    double worst_in_time[TRADE_PRESSURE]; // largest errors of a time step, without TRADE_PRESSURE
    double step_iterations, step_seconds; // means over time steps
    // factor of the error estimate of the central film in a transient run; 0: this size was not
    // calibrated on trajectories
    double factor_in_time;
    double factor_in_time_minimum; // factor of the local errors (time_indicator.h), minimum film
    double floor_in_time;          // added to the estimate of the central film; 0 in files before
                                   // schema 2.9
    double floor_in_time_minimum;  // added to the estimate of the minimum film
    // quantiles, over the trajectories, of the largest film estimate on each trajectory; a lost
    // trajectory (num_lost) has the estimate 1
    double indicated_in_time[NUM_TIME_PARTS];
    size_t num_lost; // trajectories with a step that did not converge or is not trusted
} trade_position;

typedef struct trade_table {
    size_t num_scenes, num_trajectories; // numbers of scenes and trajectories of the calibration
    size_t num_positions;
    trade_position *positions; // [num_positions]
    shown_lubricants shown;    // lubricants of the calibration; trade_get does not read them
} trade_table;

void trade_free(trade_table *table);

/* Axes that a calibration adds to a model file. artefact_copy has to omit these axes when a model
 * is calibrated again. The list ends with NULL. */
extern const char *const trade_axes[];

/* Adds the table to a model file that has no table. */
ehd_status trade_write(artefact *file, const trade_table *table, ehd_error *error);

/* Reads the table of a model file. EHD_DATA is returned also if the model is not calibrated, or is
 * smaller than a size in the table. */
ehd_status trade_read(
    // output:
    trade_table *table, // free with trade_free
    // input:
    const char *path, ehd_error *error);

/* Reads the table of an open model file. If the file has no table, *calibrated is false. */
ehd_status trade_get(trade_table *table, bool *calibrated, artefact *file, ehd_error *error);

#endif
