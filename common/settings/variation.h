/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The settings that a group of a plan varies: columns of values, from the plan itself or from a CSV
 * file, and settings that vary between bounds. */
#ifndef EHD_VARIATION_H
#define EHD_VARIATION_H

#include "common/settings/csv.h"
#include "common/settings/default_histories.h"
#include "common/settings/scene_source.h"
#include <stdbool.h>
#include <stddef.h>

enum { MAX_POINTS = 1000000, MAX_RANGES = 6, DEFAULT_CANDIDATES = 1000 };

typedef struct variation_column {
    const setting *row;
    size_t num_values;
    const char **texts; // [num_values], owned by the YAML tree, by `points` or by `with_units`
    place *places;      // [num_values]
} variation_column;

/* A setting that varies between bounds, on a logarithmic scale if the bounds are positive. */
typedef struct variation_range {
    const setting *row;
    place where;
    const char *texts[2]; // lowest and highest value as in the plan, owned by the YAML tree
    double low, high;
} variation_range;

typedef struct variation {
    variation_column columns[MAX_SETTINGS];
    size_t num_columns;
    // true: all combinations of the columns' values are points, and the last column varies fastest;
    // false: each row of values is one point
    bool grid;
    variation_range ranges[MAX_RANGES];
    size_t num_ranges;           // 0: no region
    size_t num_candidates;       // number of candidates in the region; each combination of columns
                                 // has the same candidates
    double *candidates;          // [num_candidates, num_ranges] coordinates 0 to 1; NULL: no region
    default_histories histories; // has no quantities if the group has no histories
    size_t num_histories;        // trajectories of each combination of columns; 0: no histories
    size_t num_points;           // at most MAX_POINTS; candidates or histories vary fastest
    csv_file points;             // owns the texts that come from a CSV file
    char **with_units;           // [num_with_units], texts of a CSV file with the column's unit
    size_t num_with_units;
} variation;

/* Reads what a group varies. A group may have columns (`vary` and `combine`, or `points`), and
 * either a `region` with its `candidates` or `histories`. A group without any of these has one
 * point.
 *
 * The candidates are the corners of the region, points along its edges, and points inside. The
 * points inside follow Sobol's sequence (gsl_qrng_sobol), which leaves no gaps for any number of
 * candidates. The number of candidates that the group gives is multiplied by `times`.
 *
 * `plan_path` is the plan's file, for errors; the path in `points` is relative to its folder.
 * Errors: EHD_DATA, EHD_NOINPUT, EHD_IO, EHD_MEMORY. */
ehd_status variation_read(
    // output:
    variation *self, // free with variation_free
    // input:
    const tree_node *group, double times, const char *plan_path, ehd_error *error);

/* Finds the setting of each column of a table. A column with the name `beside` is not a setting and
 * gets NULL. If `beside` is NULL, all columns must be settings. Returns EHD_DATA, with a list of
 * all columns, if a column has no name, or if a setting is unknown or comes twice. */
ehd_status table_settings(
    // output:
    const setting **rows, // [table->width]
    // input:
    const csv_file *table, const char *beside, ehd_error *error);

/* Checks that --set gives no setting that varies. Returns EHD_DATA otherwise. `path` is the plan's
 * file, for the error. */
ehd_status variation_check_overrides(const variation *self, const scene_source *base,
                                     const char *path, ehd_error *error);

/* Assigns the values of one point. Returns EHD_DATA for a bad value. */
ehd_status variation_apply(const variation *self, size_t point, scene_source *source,
                           ehd_error *error);

/* Writes the values of one point: "moes.M=5, moes.L=1". */
void variation_show(const variation *self, size_t point, char *shown, size_t size);

void variation_free(variation *self);

#endif
