/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/model/trade_file.h"

#include "common/program/arena.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>

const double trade_quantiles[NUM_TRADE_QUANTILES] = {0.5, 0.95, 1};
const double trade_parts[NUM_TRADE_PARTS] = {0.05, 0.5, 0.9, 0.95};
const double trade_time_parts[NUM_TIME_PARTS] = {0.5, 0.6, 0.7, 0.8, 0.9, 1};

void trade_free(trade_table *table) {
    free(table->positions);
    free(table->shown.of);
    *table = (trade_table){0};
}

const char *const trade_axes[] = {"position",     "quantile", "part", "bounded",
                                  "part_in_time", "shown",    NULL};

const indicator_shape plain_shape = {.share = 1, .offset_share = 1};

double trade_indicated(double factor, indicator_shape shape, double bound) {
    if (!isfinite(bound)) return bound;
    const double share = fmin(1, shape.share + shape.growth * bound);
    return factor * fmin(share * bound, shape.offset + shape.offset_share * bound);
}

static const char *const deviation_fields[NUM_TRADE_QUANTITIES] = {
    "deviation_central_film_thickness", "deviation_minimum_film_thickness",
    "deviation_central_pressure", "deviation_pressure"};

/* A member of trade_position with a dataset of its own. The members in the list `counts` are
 * size_t, all others are double. */
typedef struct column {
    const char *field;
    size_t offset;
    const char *axis; // axis whose length limits a number of modes or rows; NULL: no such axis
    bool in_time;     // true: the dataset exists only if trajectories were measured
} column;

static const column counts[] = {
    {"position_pressure_modes", offsetof(trade_position, sizes.pressure_modes), "pressure_mode",
     false},
    {"position_deformation_modes", offsetof(trade_position, sizes.deformation_modes),
     "deformation_mode", false},
    {"position_rows", offsetof(trade_position, sizes.rows), "row", false},
    {"position_failures", offsetof(trade_position, num_failures), NULL, false},
    {"position_lost_trajectories", offsetof(trade_position, num_lost), NULL, true}};

static const column reals[] = {
    {"position_mean_iterations", offsetof(trade_position, mean_iterations), NULL, false},
    {"position_most_iterations", offsetof(trade_position, max_iterations), NULL, false},
    {"position_seconds", offsetof(trade_position, seconds), NULL, false},
    {"worst_in_time_central_film_thickness",
     offsetof(trade_position, worst_in_time[TRADE_CENTRAL_FILM]), NULL, true},
    {"worst_in_time_minimum_film_thickness",
     offsetof(trade_position, worst_in_time[TRADE_MINIMUM_FILM]), NULL, true},
    {"worst_in_time_central_pressure",
     offsetof(trade_position, worst_in_time[TRADE_CENTRAL_PRESSURE]), NULL, true},
    {"position_step_iterations", offsetof(trade_position, step_iterations), NULL, true},
    {"position_step_seconds", offsetof(trade_position, step_seconds), NULL, true}};

/* Columns of the error estimates. Their values are at least 0. Older files may lack all columns
 * except the first one. If the factor of the minimum film is missing, the factor of the central
 * film is used. If the largest residuals are missing, any residual is accepted. If the factors of
 * other quantities are missing, these quantities have no estimate. */
static const column of_indicator[] = {
    {"indicator_factor", offsetof(trade_position, indicator_factor), NULL, false},
    {"indicator_factor_minimum", offsetof(trade_position, indicator_factor_minimum), NULL, false},
    {"position_largest_residual", offsetof(trade_position, largest_residual), NULL, false},
    {"indicator_factor_central_pressure",
     offsetof(trade_position, other_factor[INDICATED_CENTRAL_PRESSURE]), NULL, false},
    {"indicator_factor_exit_position",
     offsetof(trade_position, other_factor[INDICATED_EXIT_POSITION]), NULL, false},
    {"indicator_factor_load", offsetof(trade_position, other_factor[INDICATED_LOAD]), NULL, false},
    {"indicator_factor_pressure", offsetof(trade_position, other_factor[INDICATED_PRESSURE]), NULL,
     false},
    {"indicator_factor_film", offsetof(trade_position, other_factor[INDICATED_FILM]), NULL, false},
    {"indicator_factor_friction", offsetof(trade_position, other_factor[INDICATED_FRICTION]), NULL,
     false}};
enum { NUM_OF_INDICATOR = sizeof of_indicator / sizeof *of_indicator };

/* Columns of the error estimates in time. A file has all of these columns or none of them. Files
 * before schema 2.9 lack only the last column, whose values are then 0. */
static const column in_time[] = {
    {"indicator_factor_in_time", offsetof(trade_position, factor_in_time), NULL, true},
    {"indicator_factor_in_time_minimum", offsetof(trade_position, factor_in_time_minimum), NULL,
     true},
    {"indicator_floor_in_time_minimum", offsetof(trade_position, floor_in_time_minimum), NULL,
     true},
    {"indicator_floor_in_time", offsetof(trade_position, floor_in_time), NULL, true}};
enum { NUM_IN_TIME = sizeof in_time / sizeof *in_time };

enum { NUM_COUNTS = sizeof counts / sizeof *counts, NUM_REALS = sizeof reals / sizeof *reals };

static bool is_measured(const column *self, const trade_table *table) {
    return !self->in_time || table->num_trajectories > 0;
}

static void *member(trade_position *position, size_t offset) {
    return (char *)position + offset;
}

// ---- writing

static ehd_status put_counts(artefact *file, const trade_table *table, ehd_error *error) {
    int64_t *values = malloc(table->num_positions * sizeof *values);
    ehd_status status = values ? EHD_OK : ehd_no_memory(error, artefact_path(file));

    for (size_t c = 0; c < NUM_COUNTS && !status; c++) {
        if (!is_measured(&counts[c], table)) continue;
        for (size_t i = 0; i < table->num_positions; i++)
            values[i] = (int64_t) * (const size_t *)member(&table->positions[i], counts[c].offset);
        status = artefact_put_integers(file, counts[c].field, values, error);
    }
    free(values);
    return status;
}

static ehd_status put_column(artefact *file, double *values, const column *self,
                             const trade_table *table, ehd_error *error) {
    for (size_t i = 0; i < table->num_positions; i++)
        values[i] = *(const double *)member(&table->positions[i], self->offset);
    return artefact_put(file, self->field, values, error);
}

static ehd_status put_reals(artefact *file, const trade_table *table, ehd_error *error) {
    double *values = malloc(table->num_positions * NUM_TRADE_QUANTILES * sizeof *values);
    ehd_status status = values ? EHD_OK : ehd_no_memory(error, artefact_path(file));

    for (size_t c = 0; c < NUM_REALS && !status; c++) {
        if (!is_measured(&reals[c], table)) continue;
        status = put_column(file, values, &reals[c], table, error);
    }
    for (size_t q = 0; q < NUM_TRADE_QUANTITIES && !status; q++) {
        for (size_t i = 0; i < table->num_positions * NUM_TRADE_QUANTILES; i++)
            values[i] =
                table->positions[i / NUM_TRADE_QUANTILES].deviation[q][i % NUM_TRADE_QUANTILES];
        status = artefact_put(file, deviation_fields[q], values, error);
    }
    free(values);
    return status;
}

/* A member of indicator_shape and its dataset. */
static const struct shape_field {
    const char *name;
    size_t offset;
} shape_fields[] = {{"indicator_share", offsetof(indicator_shape, share)},
                    {"indicator_growth", offsetof(indicator_shape, growth)},
                    {"indicator_offset", offsetof(indicator_shape, offset)},
                    {"indicator_offset_share", offsetof(indicator_shape, offset_share)}};
enum { NUM_SHAPE_FIELDS = sizeof shape_fields / sizeof *shape_fields };

/* Returns the member at `offset` of shape number `entry`, in a dataset with `num_bounded` shapes
 * for each position. */
static double *shape_member(trade_table *table, size_t num_bounded, size_t entry, size_t offset) {
    trade_position *position = &table->positions[entry / num_bounded];

    void *place = (char *)&position->shape[entry % num_bounded] + offset;
    return place;
}

static ehd_status put_shapes(artefact *file, const trade_table *table, ehd_error *error) {
    const size_t count = table->num_positions * NUM_BOUNDED;
    trade_table all = *table;
    double *values = malloc((count + 1) * sizeof *values);
    ehd_status status = values ? EHD_OK : ehd_no_memory(error, artefact_path(file));

    if (!status) status = artefact_put_axis(file, "bounded", NUM_BOUNDED, NULL, error);
    for (size_t f = 0; f < NUM_SHAPE_FIELDS && !status; f++) {
        for (size_t i = 0; i < count; i++)
            values[i] = *shape_member(&all, NUM_BOUNDED, i, shape_fields[f].offset);
        status = artefact_put(file, shape_fields[f].name, values, error);
    }
    free(values);
    return status;
}

static ehd_status put_indicator(artefact *file, const trade_table *table, ehd_error *error) {
    size_t num_positions = table->num_positions;
    double *values = malloc(num_positions * NUM_TRADE_PARTS * sizeof *values);
    ehd_status status = values ? EHD_OK : ehd_no_memory(error, artefact_path(file));

    if (!status) status = artefact_put_axis(file, "part", NUM_TRADE_PARTS, trade_parts, error);
    for (size_t c = 0; c < NUM_OF_INDICATOR && !status; c++)
        status = put_column(file, values, &of_indicator[c], table, error);
    for (size_t i = 0; i < num_positions * NUM_TRADE_PARTS && !status; i++)
        values[i] = table->positions[i / NUM_TRADE_PARTS].indicated[i % NUM_TRADE_PARTS];
    if (!status) status = artefact_put(file, "indicated_deviation", values, error);
    for (size_t i = 0; i < num_positions * NUM_TRADE_PARTS && !status; i++)
        values[i] = table->positions[i / NUM_TRADE_PARTS].effectivity[i % NUM_TRADE_PARTS];
    if (!status) status = artefact_put(file, "indicator_effectivity", values, error);
    if (!status) status = put_shapes(file, table, error);
    free(values);
    return status;
}

static ehd_status put_in_time(artefact *file, const trade_table *table, ehd_error *error) {
    const size_t count = table->num_positions * NUM_TIME_PARTS;
    double *values = malloc(count * sizeof *values);
    ehd_status status = values ? EHD_OK : ehd_no_memory(error, artefact_path(file));

    if (!status)
        status = artefact_put_axis(file, "part_in_time", NUM_TIME_PARTS, trade_time_parts, error);
    for (size_t c = 0; c < NUM_IN_TIME && !status; c++)
        status = put_column(file, values, &in_time[c], table, error);
    for (size_t i = 0; i < count && !status; i++)
        values[i] = table->positions[i / NUM_TIME_PARTS].indicated_in_time[i % NUM_TIME_PARTS];
    if (!status) status = artefact_put(file, "indicated_in_time", values, error);
    free(values);
    return status;
}

ehd_status trade_write(artefact *file, const trade_table *table, ehd_error *error) {
    ehd_status status = artefact_put_axis(file, "position", table->num_positions, NULL, error);

    if (!status)
        status = artefact_put_axis(file, "quantile", NUM_TRADE_QUANTILES, trade_quantiles, error);
    if (!status)
        status =
            artefact_put_integer(file, "calibration_scenes", (int64_t)table->num_scenes, error);
    if (!status)
        status = artefact_put_integer(file, "calibration_trajectories",
                                      (int64_t)table->num_trajectories, error);
    if (!status) status = put_counts(file, table, error);
    if (!status) status = put_reals(file, table, error);
    if (!status && table->num_scenes > 0) status = put_indicator(file, table, error);
    if (!status && table->num_trajectories > 0) status = put_in_time(file, table, error);
    return status ? status : shown_put(file, &table->shown, error);
}

// ---- reading

static ehd_status get_counts(trade_table *table, artefact *file, ehd_error *error) {
    int64_t *values = array_new(table->num_positions, 1, sizeof *values);
    ehd_status status = values ? EHD_OK : ehd_no_memory(error, artefact_path(file));

    for (size_t c = 0; c < NUM_COUNTS && !status; c++) {
        if (!is_measured(&counts[c], table)) continue;
        const char *axis = counts[c].axis;
        int64_t max = (int64_t)(axis                ? artefact_length(file, axis)
                                : counts[c].in_time ? table->num_trajectories
                                                    : table->num_scenes);
        int64_t min = axis && max > 0 ? 1 : 0;
        status = artefact_get_integers(file, counts[c].field, values, table->num_positions, error);
        for (size_t i = 0; i < table->num_positions && !status; i++) {
            if (values[i] < min || values[i] > max)
                status = ehd_fail(error, EHD_DATA, "%s: %s: found %lld, expected %lld to %lld",
                                  artefact_path(file), counts[c].field, (long long)values[i],
                                  (long long)min, (long long)max);
            *(size_t *)member(&table->positions[i], counts[c].offset) = (size_t)values[i];
        }
    }
    free(values);
    return status;
}

/* Reads the columns of real numbers and the deviations. Unknown values are NaN. */
static ehd_status get_reals(trade_table *table, artefact *file, ehd_error *error) {
    size_t num_positions = table->num_positions;
    double *values = array_new(num_positions, NUM_TRADE_QUANTILES, sizeof *values);
    ehd_status status = values ? EHD_OK : ehd_no_memory(error, artefact_path(file));

    for (size_t c = 0; c < NUM_REALS && !status; c++) {
        if (!is_measured(&reals[c], table)) continue;
        status = artefact_get(file, reals[c].field, values, num_positions, error);
        for (size_t i = 0; i < num_positions && !status; i++)
            *(double *)member(&table->positions[i], reals[c].offset) = values[i];
    }
    for (size_t q = 0; q < NUM_TRADE_QUANTITIES && !status; q++) {
        status = artefact_get(file, deviation_fields[q], values,
                              num_positions * NUM_TRADE_QUANTILES, error);
        for (size_t i = 0; i < num_positions * NUM_TRADE_QUANTILES && !status; i++)
            table->positions[i / NUM_TRADE_QUANTILES].deviation[q][i % NUM_TRADE_QUANTILES] =
                values[i];
    }
    free(values);
    return status;
}

static ehd_status get_of_indicator(trade_table *table, double *values, const column *self,
                                   artefact *file, ehd_error *error) {
    ehd_status status = artefact_get(file, self->field, values, table->num_positions, error);

    for (size_t i = 0; i < table->num_positions && !status; i++)
        *(double *)member(&table->positions[i], self->offset) = values[i];
    return status;
}

/* Reads the shapes. If a table has no shapes, the estimate is the factor times the bound. An older
 * table has shapes for all quantities except friction. */
static ehd_status get_shapes(trade_table *table, artefact *file, ehd_error *error) {
    const size_t num_bounded = artefact_length(file, "bounded");
    const size_t count = table->num_positions * num_bounded;
    bool known = num_bounded == NUM_BOUNDED || num_bounded == OF_OTHERS + INDICATED_FRICTION;
    double *values = malloc((count + 1) * sizeof *values);
    ehd_status status = values ? EHD_OK : ehd_no_memory(error, artefact_path(file));

    for (size_t f = 0; f < NUM_SHAPE_FIELDS; f++)
        known = known && artefact_has(file, shape_fields[f].name);
    for (size_t i = 0; i < table->num_positions; i++)
        for (size_t q = 0; q < NUM_BOUNDED; q++)
            table->positions[i].shape[q] = plain_shape;
    for (size_t f = 0; f < NUM_SHAPE_FIELDS && known && !status; f++) {
        status = artefact_get(file, shape_fields[f].name, values, count, error);
        for (size_t i = 0; i < count && !status; i++)
            *shape_member(table, num_bounded, i, shape_fields[f].offset) = values[i];
    }
    free(values);
    return status;
}

static ehd_status get_indicator(trade_table *table, artefact *file, ehd_error *error) {
    size_t num_positions = table->num_positions;
    if (!artefact_has(file, "indicator_factor") || !artefact_has(file, "indicated_deviation") ||
        !artefact_has(file, "indicator_effectivity") ||
        artefact_length(file, "part") != NUM_TRADE_PARTS)
        return EHD_OK; // a table without error estimates
    double *values = array_new(num_positions, NUM_TRADE_PARTS, sizeof *values);
    ehd_status status = values ? EHD_OK : ehd_no_memory(error, artefact_path(file));

    for (size_t c = 0; c < NUM_OF_INDICATOR && !status; c++) {
        if (artefact_has(file, of_indicator[c].field))
            status = get_of_indicator(table, values, &of_indicator[c], file, error);
        for (size_t i = 0; i < num_positions && c == 0; i++) {
            table->positions[i].indicator_factor_minimum = table->positions[i].indicator_factor;
            table->positions[i].largest_residual = INFINITY;
        }
    }
    if (!status) status = get_shapes(table, file, error);
    if (!status)
        status = artefact_get(file, "indicated_deviation", values, num_positions * NUM_TRADE_PARTS,
                              error);
    for (size_t i = 0; i < num_positions * NUM_TRADE_PARTS && !status; i++)
        table->positions[i / NUM_TRADE_PARTS].indicated[i % NUM_TRADE_PARTS] = values[i];
    if (!status)
        status = artefact_get(file, "indicator_effectivity", values,
                              num_positions * NUM_TRADE_PARTS, error);
    for (size_t i = 0; i < num_positions * NUM_TRADE_PARTS && !status; i++)
        table->positions[i / NUM_TRADE_PARTS].effectivity[i % NUM_TRADE_PARTS] = values[i];
    free(values);
    return status;
}

static ehd_status get_in_time(trade_table *table, artefact *file, ehd_error *error) {
    const size_t count = table->num_positions * NUM_TIME_PARTS;
    double *values = array_new(table->num_positions, NUM_TIME_PARTS, sizeof *values);
    ehd_status status = values ? EHD_OK : ehd_no_memory(error, artefact_path(file));
    bool all = table->num_trajectories > 0 && artefact_has(file, "indicated_in_time") &&
               artefact_length(file, "part_in_time") == NUM_TIME_PARTS;

    for (size_t c = 0; c < NUM_IN_TIME - 1; c++)
        all = all && artefact_has(file, in_time[c].field);
    for (size_t c = 0; c < NUM_IN_TIME && all && !status; c++)
        if (artefact_has(file, in_time[c].field))
            status = get_of_indicator(table, values, &in_time[c], file, error);
    if (all && !status) status = artefact_get(file, "indicated_in_time", values, count, error);
    for (size_t i = 0; i < count && all && !status; i++)
        table->positions[i / NUM_TIME_PARTS].indicated_in_time[i % NUM_TIME_PARTS] = values[i];
    free(values);
    return status;
}

static ehd_status get_table(trade_table *table, artefact *file, ehd_error *error) {
    int64_t num_scenes = 0, num_trajectories = 0;
    ehd_status status = artefact_get_integer(file, "calibration_scenes", &num_scenes, error);

    if (!status)
        status = artefact_get_integer(file, "calibration_trajectories", &num_trajectories, error);
    if (!status && num_scenes == 0 && num_trajectories == 0)
        status = ehd_fail(error, EHD_DATA,
                          "%s: calibration_scenes: found %lld and %lld trajectories, expected some",
                          artefact_path(file), (long long)num_scenes, (long long)num_trajectories);
    if (!status && artefact_length(file, "quantile") != NUM_TRADE_QUANTILES)
        status =
            ehd_fail(error, EHD_DATA, "%s: quantile: found %zu entries, expected %d",
                     artefact_path(file), artefact_length(file, "quantile"), NUM_TRADE_QUANTILES);
    if (status) return status;
    table->num_scenes = (size_t)num_scenes;
    table->num_trajectories = (size_t)num_trajectories;
    table->num_positions = artefact_length(file, "position");
    table->positions = array_new(table->num_positions, 1, sizeof *table->positions);
    if (!table->positions) return ehd_no_memory(error, artefact_path(file));
    status = get_counts(table, file, error);
    if (!status) status = get_reals(table, file, error);
    if (!status) status = get_in_time(table, file, error);
    return status ? status : get_indicator(table, file, error);
}

ehd_status trade_get(trade_table *table, bool *calibrated, artefact *file, ehd_error *error) {
    ehd_status status = EHD_OK;

    *table = (trade_table){0};
    *calibrated = artefact_length(file, "position") > 0;
    if (*calibrated) status = get_table(table, file, error);
    if (status) trade_free(table);
    return status;
}

ehd_status trade_read(trade_table *table, const char *path, ehd_error *error) {
    static const artefact_schema *const kinds[] = {&schema_model, NULL};
    artefact *file = NULL;
    bool calibrated = false;
    ehd_status status = artefact_open(&file, path, kinds, error);

    *table = (trade_table){0};
    if (!status) status = trade_get(table, &calibrated, file, error);
    artefact_close(&file);
    if (!status && !calibrated)
        status = ehd_fail(error, EHD_DATA,
                          "%s: found a model that is not calibrated, expected one of romrun "
                          "calibrate, or of deimselect without --no-check",
                          path);
    return status;
}
