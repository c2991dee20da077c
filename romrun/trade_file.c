/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/trade_file.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>

const char *const trade_axes[] = {"position", "quantile", NULL};

static const char *const deviation_fields[NUM_TRADE_QUANTITIES] = {
    "deviation_central_film_thickness", "deviation_minimum_film_thickness",
    "deviation_central_pressure", "deviation_pressure"};

/* Members that are written as they are; counts are size_t, the others double. */
static const struct {
    const char *field;
    size_t offset;
    const char *axis; // that a count of modes or rows belongs to, and does not exceed; NULL: none
} counts[] = {{"position_pressure_modes", offsetof(trade_position, sizes.pressure_modes),
               "pressure_mode"},
              {"position_deformation_modes", offsetof(trade_position, sizes.deformation_modes),
               "deformation_mode"},
              {"position_rows", offsetof(trade_position, sizes.rows), "row"},
              {"position_failures", offsetof(trade_position, num_failures), NULL}},
  reals[] = {{"position_mean_iterations", offsetof(trade_position, mean_iterations), NULL},
             {"position_most_iterations", offsetof(trade_position, most_iterations), NULL},
             {"position_seconds", offsetof(trade_position, seconds), NULL}};
enum { NUM_COUNTS = sizeof counts / sizeof *counts, NUM_REALS = sizeof reals / sizeof *reals };

static void *member(trade_position *position, size_t offset) {
    return (char *)position + offset;
}

static ehd_status no_memory(const artefact *file, ehd_error *error) {
    return ehd_fail(error, EHD_MEMORY, "%s: found no memory", artefact_path(file));
}

// ---- writing

static ehd_status put_counts(artefact *file, const trade_table *table, ehd_error *error) {
    int64_t *column = malloc(table->num_positions * sizeof *column);
    ehd_status status = column ? EHD_OK : no_memory(file, error);

    for (size_t c = 0; c < NUM_COUNTS && !status; c++) {
        for (size_t i = 0; i < table->num_positions; i++)
            column[i] = (int64_t) * (const size_t *)member(&table->positions[i], counts[c].offset);
        status = artefact_put_integers(file, counts[c].field, column, error);
    }
    free(column);
    return status;
}

static ehd_status put_reals(artefact *file, const trade_table *table, ehd_error *error) {
    double *column = malloc(table->num_positions * NUM_TRADE_QUANTILES * sizeof *column);
    ehd_status status = column ? EHD_OK : no_memory(file, error);

    for (size_t c = 0; c < NUM_REALS && !status; c++) {
        for (size_t i = 0; i < table->num_positions; i++)
            column[i] = *(const double *)member(&table->positions[i], reals[c].offset);
        status = artefact_put(file, reals[c].field, column, error);
    }
    for (size_t q = 0; q < NUM_TRADE_QUANTITIES && !status; q++) {
        for (size_t i = 0; i < table->num_positions * NUM_TRADE_QUANTILES; i++)
            column[i] =
                table->positions[i / NUM_TRADE_QUANTILES].deviation[q][i % NUM_TRADE_QUANTILES];
        status = artefact_put(file, deviation_fields[q], column, error);
    }
    free(column);
    return status;
}

ehd_status trade_write(artefact *file, const trade_table *table, ehd_error *error) {
    ehd_status status = artefact_put_axis(file, "position", table->num_positions, NULL, error);

    if (!status)
        status = artefact_put_axis(file, "quantile", NUM_TRADE_QUANTILES, trade_quantiles, error);
    if (!status)
        status =
            artefact_put_integer(file, "calibration_scenes", (int64_t)table->num_scenes, error);
    if (!status) status = put_counts(file, table, error);
    if (!status) status = put_reals(file, table, error);
    return status;
}

// ---- reading

static ehd_status get_counts(trade_table *table, artefact *file, ehd_error *error) {
    int64_t *column = malloc(table->num_positions * sizeof *column);
    ehd_status status = column ? EHD_OK : no_memory(file, error);

    for (size_t c = 0; c < NUM_COUNTS && !status; c++) {
        const char *axis = counts[c].axis;
        int64_t most = (int64_t)(axis ? artefact_length(file, axis) : table->num_scenes);
        int64_t least = axis && most > 0 ? 1 : 0;
        status = artefact_get_integers(file, counts[c].field, column, error);
        for (size_t i = 0; i < table->num_positions && !status; i++) {
            if (column[i] < least || column[i] > most)
                status = ehd_fail(error, EHD_DATA, "%s: %s: found %lld, expected %lld to %lld",
                                  artefact_path(file), counts[c].field, (long long)column[i],
                                  (long long)least, (long long)most);
            *(size_t *)member(&table->positions[i], counts[c].offset) = (size_t)column[i];
        }
    }
    free(column);
    return status;
}

/* What is not known is NaN, and nothing is negative. */
static ehd_status get_reals(trade_table *table, artefact *file, ehd_error *error) {
    size_t num_positions = table->num_positions;
    double *column = malloc(num_positions * NUM_TRADE_QUANTILES * sizeof *column);
    ehd_status status = column ? EHD_OK : no_memory(file, error);

    for (size_t c = 0; c < NUM_REALS && !status; c++) {
        status = artefact_get(file, reals[c].field, column, error);
        for (size_t i = 0; i < num_positions && !status; i++)
            *(double *)member(&table->positions[i], reals[c].offset) = column[i];
    }
    for (size_t q = 0; q < NUM_TRADE_QUANTITIES && !status; q++) {
        status = artefact_get(file, deviation_fields[q], column, error);
        for (size_t i = 0; i < num_positions * NUM_TRADE_QUANTILES && !status; i++) {
            table->positions[i / NUM_TRADE_QUANTILES].deviation[q][i % NUM_TRADE_QUANTILES] =
                column[i];
            if (column[i] < 0)
                status = ehd_fail(error, EHD_DATA, "%s: %s: found %g, expected at least 0",
                                  artefact_path(file), deviation_fields[q], column[i]);
        }
    }
    free(column);
    return status;
}

static ehd_status get_table(trade_table *table, artefact *file, ehd_error *error) {
    int64_t num_scenes = 0;
    ehd_status status = artefact_get_integer(file, "calibration_scenes", &num_scenes, error);

    if (!status && num_scenes < 1)
        status = ehd_fail(error, EHD_DATA, "%s: calibration_scenes: found %lld, expected some",
                          artefact_path(file), (long long)num_scenes);
    if (!status && artefact_length(file, "quantile") != NUM_TRADE_QUANTILES)
        status =
            ehd_fail(error, EHD_DATA, "%s: quantile: found %zu entries, expected %d",
                     artefact_path(file), artefact_length(file, "quantile"), NUM_TRADE_QUANTILES);
    if (status) return status;
    table->num_scenes = (size_t)num_scenes;
    table->num_positions = artefact_length(file, "position");
    table->positions = calloc(table->num_positions, sizeof *table->positions);
    if (!table->positions) return no_memory(file, error);
    status = get_counts(table, file, error);
    return status ? status : get_reals(table, file, error);
}

ehd_status trade_read(trade_table *table, const char *path, ehd_error *error) {
    static const artefact_schema *const kinds[] = {&schema_model, NULL};
    artefact *file = NULL;
    ehd_status status = artefact_open(&file, path, kinds, error);

    *table = (trade_table){0};
    if (!status && artefact_length(file, "position") == 0)
        status = ehd_fail(error, EHD_DATA,
                          "%s: found a model that is not calibrated, expected one of romrun "
                          "--calibrate",
                          path);
    if (!status) status = get_table(table, file, error);
    artefact_close(&file);
    if (status) trade_free(table);
    return status;
}
