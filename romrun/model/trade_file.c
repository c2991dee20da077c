/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/model/trade_file.h"

#include "common/output/columns.h"
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

// ---- columns

#define MEMBER(name, member) COLUMN(trade_position, name, member)
#define SHAPE(name, member)                                                                        \
    .field = (name), .offset = offsetof(trade_position, shape[0].member), .each = NUM_BOUNDED,     \
    .apart = sizeof(indicator_shape)

/* Numbers of modes and rows. In a file, the length of an axis limits each of these numbers. */
static const column sizes[] = {
    {MEMBER("position_pressure_modes", sizes.pressure_modes), .integer = true},
    {MEMBER("position_deformation_modes", sizes.deformation_modes), .integer = true},
    {MEMBER("position_rows", sizes.rows), .integer = true},
    {0}};
static const char *const size_axes[] = {"pressure_mode", "deformation_mode", "row"};

static const column of_scenes[] = {
    {MEMBER("position_failures", num_failures), .integer = true},
    {MEMBER("position_mean_iterations", mean_iterations)},
    {MEMBER("position_most_iterations", max_iterations)},
    {MEMBER("position_seconds", seconds)},
    {MEMBER("deviation_central_film_thickness", deviation[TRADE_CENTRAL_FILM])},
    {MEMBER("deviation_minimum_film_thickness", deviation[TRADE_MINIMUM_FILM])},
    {MEMBER("deviation_central_pressure", deviation[TRADE_CENTRAL_PRESSURE])},
    {MEMBER("deviation_pressure", deviation[TRADE_PRESSURE])},
    {0}};

static const column of_trajectories[] = {
    {MEMBER("position_lost_trajectories", num_lost), .integer = true},
    {MEMBER("worst_in_time_central_film_thickness", worst_in_time[TRADE_CENTRAL_FILM])},
    {MEMBER("worst_in_time_minimum_film_thickness", worst_in_time[TRADE_MINIMUM_FILM])},
    {MEMBER("worst_in_time_central_pressure", worst_in_time[TRADE_CENTRAL_PRESSURE])},
    {MEMBER("position_step_iterations", step_iterations)},
    {MEMBER("position_step_seconds", step_seconds)},
    {0}};

/* Columns of the error estimates. Their values are at least 0. If the factor of the minimum film is
 * missing, the factor of the central film is used. If the largest residuals are missing, any
 * residual is accepted. If the factors of other quantities are missing, these quantities have no
 * estimate. */
static const column of_indicator[] = {
    {MEMBER("indicator_factor", indicator_factor)},
    {MEMBER("indicated_deviation", indicated)},
    {MEMBER("indicator_effectivity", effectivity)},
    {MEMBER("indicator_factor_minimum", indicator_factor_minimum), .optional = true},
    {MEMBER("position_largest_residual", largest_residual), .optional = true},
    {MEMBER("indicator_factor_central_pressure", other_factor[INDICATED_CENTRAL_PRESSURE]),
     .optional = true},
    {MEMBER("indicator_factor_exit_position", other_factor[INDICATED_EXIT_POSITION]),
     .optional = true},
    {MEMBER("indicator_factor_load", other_factor[INDICATED_LOAD]), .optional = true},
    {MEMBER("indicator_factor_pressure", other_factor[INDICATED_PRESSURE]), .optional = true},
    {MEMBER("indicator_factor_film", other_factor[INDICATED_FILM]), .optional = true},
    {MEMBER("indicator_factor_friction", other_factor[INDICATED_FRICTION]), .optional = true},
    {0}};

static const column shapes[] = {{SHAPE("indicator_share", share)},
                                {SHAPE("indicator_growth", growth)},
                                {SHAPE("indicator_offset", offset)},
                                {SHAPE("indicator_offset_share", offset_share)},
                                {0}};

/* Columns of the error estimates in time. A file has all of these columns or none of them. Files
 * before schema 2.9 lack only the optional column, whose values are then 0. */
static const column in_time[] = {
    {MEMBER("indicator_factor_in_time", factor_in_time)},
    {MEMBER("indicator_factor_in_time_minimum", factor_in_time_minimum)},
    {MEMBER("indicator_floor_in_time_minimum", floor_in_time_minimum)},
    {MEMBER("indicator_floor_in_time", floor_in_time), .optional = true},
    {MEMBER("indicated_in_time", indicated_in_time)},
    {0}};

// ---- writing

static ehd_status put(artefact *file, const trade_table *table, const column *columns,
                      ehd_error *error) {
    return columns_put(file, columns, 0, table->positions, sizeof *table->positions,
                       table->num_positions, error);
}

static ehd_status put_indicator(artefact *file, const trade_table *table, ehd_error *error) {
    ehd_status status = artefact_put_axis(file, "part", NUM_TRADE_PARTS, trade_parts, error);

    if (!status) status = put(file, table, of_indicator, error);
    if (!status) status = artefact_put_axis(file, "bounded", NUM_BOUNDED, NULL, error);
    return status ? status : put(file, table, shapes, error);
}

static ehd_status put_trajectories(artefact *file, const trade_table *table, ehd_error *error) {
    ehd_status status = put(file, table, of_trajectories, error);

    if (!status)
        status = artefact_put_axis(file, "part_in_time", NUM_TIME_PARTS, trade_time_parts, error);
    return status ? status : put(file, table, in_time, error);
}

ehd_status trade_write(artefact *file, const trade_table *table, ehd_error *error) {
    const named_number scenes[] = {{"calibration_scenes", (double)table->num_scenes},
                                   {"calibration_trajectories", (double)table->num_trajectories},
                                   {0}};
    ehd_status status = artefact_put_axis(file, "position", table->num_positions, NULL, error);

    if (!status)
        status = artefact_put_axis(file, "quantile", NUM_TRADE_QUANTILES, trade_quantiles, error);
    if (!status) status = numbers_put(file, 0, scenes, error);
    if (!status) status = put(file, table, sizes, error);
    if (!status) status = put(file, table, of_scenes, error);
    if (!status && table->num_scenes > 0) status = put_indicator(file, table, error);
    if (!status && table->num_trajectories > 0) status = put_trajectories(file, table, error);
    return status ? status : shown_put(file, &table->shown, error);
}

// ---- reading

static ehd_status get(trade_table *table, const column *columns, artefact *file, ehd_error *error) {
    return columns_get(table->positions, sizeof *table->positions, table->num_positions, columns,
                       file, error);
}

static ehd_status check_counts(const trade_table *table, const column *counts, size_t min,
                               size_t max, const artefact *file, ehd_error *error) {
    for (size_t i = 0; i < table->num_positions; i++) {
        const void *place = (const char *)&table->positions[i] + counts->offset;
        const size_t found = *(const size_t *)place;
        if (found < min || found > max)
            return ehd_fail(error, EHD_DATA, "%s: %s: found %zu, expected %zu to %zu",
                            artefact_path(file), counts->field, found, min, max);
    }
    return EHD_OK;
}

static ehd_status get_sizes(trade_table *table, artefact *file, ehd_error *error) {
    ehd_status status = get(table, sizes, file, error);

    for (size_t i = 0; i < sizeof size_axes / sizeof *size_axes && !status; i++) {
        const size_t max = artefact_length(file, size_axes[i]);
        status = check_counts(table, &sizes[i], max > 0 ? 1 : 0, max, file, error);
    }
    return status;
}

static ehd_status get_scenes(trade_table *table, artefact *file, ehd_error *error) {
    const ehd_status status = get(table, of_scenes, file, error);

    return status ? status : check_counts(table, of_scenes, 0, table->num_scenes, file, error);
}

static ehd_status get_trajectories(trade_table *table, artefact *file, ehd_error *error) {
    ehd_status status = get(table, of_trajectories, file, error);

    if (!status)
        status = check_counts(table, of_trajectories, 0, table->num_trajectories, file, error);
    if (status || !columns_are_in(file, in_time) ||
        artefact_length(file, "part_in_time") != NUM_TIME_PARTS)
        return status;
    return get(table, in_time, file, error);
}

/* Reads the shapes. If a table has no shapes, the estimate is the factor times the bound. An older
 * table has shapes for all quantities except friction. */
static ehd_status get_shapes(trade_table *table, artefact *file, ehd_error *error) {
    const size_t num_bounded = artefact_length(file, "bounded");
    ehd_status status = EHD_OK;

    for (size_t i = 0; i < table->num_positions; i++)
        for (size_t q = 0; q < NUM_BOUNDED; q++)
            table->positions[i].shape[q] = plain_shape;
    if (!columns_are_in(file, shapes) ||
        (num_bounded != NUM_BOUNDED && num_bounded != OF_OTHERS + INDICATED_FRICTION))
        return EHD_OK;
    for (const column *of_all = shapes; of_all->field && !status; of_all++) {
        column found = *of_all;
        found.each = num_bounded;
        status = column_get(table->positions, sizeof *table->positions, table->num_positions,
                            &found, file, error);
    }
    return status;
}

static ehd_status get_indicator(trade_table *table, artefact *file, ehd_error *error) {
    if (!columns_are_in(file, of_indicator) || artefact_length(file, "part") != NUM_TRADE_PARTS)
        return EHD_OK; // a table without error estimates
    const bool has_minimum = artefact_has(file, "indicator_factor_minimum");
    const bool has_residual = artefact_has(file, "position_largest_residual");
    ehd_status status = get(table, of_indicator, file, error);

    for (size_t i = 0; i < table->num_positions; i++) {
        trade_position *position = &table->positions[i];
        if (!has_minimum) position->indicator_factor_minimum = position->indicator_factor;
        if (!has_residual) position->largest_residual = INFINITY;
    }
    return status ? status : get_shapes(table, file, error);
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
    status = get_sizes(table, file, error);
    if (!status) status = get_scenes(table, file, error);
    if (!status && num_trajectories > 0) status = get_trajectories(table, file, error);
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
