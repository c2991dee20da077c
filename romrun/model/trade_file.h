/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of measured positions as part of a model file. */
#ifndef EHD_TRADE_FILE_H
#define EHD_TRADE_FILE_H

#include "common/artefact/artefact.h"
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

/* A size of the model, and what it came to on the scenes that it solved: NaN where it solved none. */
typedef struct trade_position {
    ehdrom_sizes sizes; // 0 only for the deformation modes of a coupled basis
    double deviation[NUM_TRADE_QUANTITIES][NUM_TRADE_QUANTILES];
    double mean_iterations, most_iterations; // Newton, of a scene
    double seconds;                          // of a solution, median
    size_t num_failures;                     // scenes not converged or not to be trusted
    // the indicator of the central film's deviation
    double indicator_factor;             // 0: not calibrated, and what follows is not known
    double indicated[NUM_TRADE_PARTS];   // deviation; of all scenes: infinite where not solved
    double effectivity[NUM_TRADE_PARTS]; // indicated over true deviation
    // on trajectories that were repeated with the steps of the full model
    double worst_in_time[TRADE_PRESSURE]; // of all steps; the pressure at all nodes is not compared
    double step_iterations, step_seconds; // of a step, mean
    size_t num_lost; // trajectories with a step that did not converge or was not to be trusted
} trade_position;

typedef struct trade_table {
    size_t num_scenes, num_trajectories; // what it was measured on
    size_t num_positions;
    trade_position *positions; // [num_positions]
} trade_table;

void trade_free(trade_table *table);

/* Axes of what a calibration adds to a model, NULL at the end: for artefact_copy to leave out. */
extern const char *const trade_axes[];

/* Into a model file that has no table yet. */
ehd_status trade_write(artefact *file, const trade_table *table, ehd_error *error);

/* EHD_DATA also for a model that is not calibrated, and for positions that it does not have. */
ehd_status trade_read(
    // output:
    trade_table *table, // free with trade_free
    // input:
    const char *path, ehd_error *error);

/* The same for any model; where it is not calibrated, *calibrated is false and there is no table. */
ehd_status trade_read_optional(trade_table *table, bool *calibrated, const char *path,
                               ehd_error *error);

#endif
