/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/trade.h"

#include <math.h>
#include <stdlib.h>

const double trade_quantiles[NUM_TRADE_QUANTILES] = {0.5, 0.95, 1};

void trade_free(trade_table *table) {
    free(table->positions);
    *table = (trade_table){0};
}

// ---- the ladder

static const double LEAST_MODES = 10;
static const double STRIDE = 1.4142; // from one number of modes to the next
static const double ROWS_PER_MODE[] = {1.2, 1.5, 2, INFINITY}; // up to what is stored
enum { NUM_ROWS_PER_MODE = sizeof ROWS_PER_MODE / sizeof *ROWS_PER_MODE };

static size_t num_strides(size_t most_modes) {
    double strides = round(log((double)most_modes / LEAST_MODES) / log(STRIDE));

    return (double)most_modes <= LEAST_MODES ? 0 : (size_t)fmax(strides, 1);
}

/* Adds the positions of a number of pressure modes. */
static void add_positions(trade_table *table, size_t modes, const ehdrom_properties *whole) {
    double part = (double)modes / (double)whole->pressure_modes;
    size_t deformation = (size_t)ceil(part * (double)whole->deformation_modes), last = 0;

    for (size_t i = 0; i < NUM_ROWS_PER_MODE; i++) {
        size_t rows = (size_t)fmin(ceil(ROWS_PER_MODE[i] * (double)modes), (double)whole->rows);
        if (rows == last) continue;
        last = rows;
        table->positions[table->num_positions++].sizes = (ehdrom_sizes){modes, deformation, rows};
    }
}

ehd_status trade_ladder(trade_table *table, const ehdrom_properties *whole, ehd_error *error) {
    size_t strides = num_strides(whole->pressure_modes);
    double most = (double)whole->pressure_modes;

    *table = (trade_table){0};
    table->positions = calloc((strides + 1) * NUM_ROWS_PER_MODE, sizeof *table->positions);
    if (!table->positions) return ehd_fail(error, EHD_MEMORY, "positions: found no memory");
    for (size_t k = 0; k < strides; k++)
        add_positions(
            table,
            (size_t)lround(LEAST_MODES * pow(most / LEAST_MODES, (double)k / (double)strides)),
            whole);
    add_positions(table, whole->pressure_modes, whole);
    return EHD_OK;
}

// ---- statistics

static int compare_values(const void *left, const void *right) {
    double a = *(const double *)left, b = *(const double *)right;

    return (a > b) - (a < b);
}

double trade_quantile_of(double *values, size_t count, double quantile) {
    if (count == 0) return NAN;
    qsort(values, count, sizeof *values, compare_values);
    size_t rank = (size_t)ceil(quantile * (double)count);
    return values[rank > 0 ? rank - 1 : 0];
}

// ---- choosing

static double worst_film(const trade_position *position) {
    return position->deviation[TRADE_CENTRAL_FILM][TRADE_WORST];
}

bool trade_is_beaten(const trade_table *table, size_t position) {
    const trade_position *self = &table->positions[position];

    if (self->num_failures > 0) return true;
    for (size_t i = 0; i < table->num_positions; i++) {
        const trade_position *other = &table->positions[i];
        if (other->num_failures == 0 && other->seconds <= self->seconds &&
            worst_film(other) <= worst_film(self) &&
            (other->seconds < self->seconds || worst_film(other) < worst_film(self)))
            return true;
    }
    return false;
}

size_t trade_cheapest(const trade_table *table, double deviation) {
    size_t best = table->num_positions;
    double seconds = INFINITY;

    for (size_t i = 0; i < table->num_positions; i++) {
        const trade_position *position = &table->positions[i];
        if (position->num_failures > 0 || !(worst_film(position) <= deviation) ||
            !(position->seconds < seconds))
            continue;
        best = i;
        seconds = position->seconds;
    }
    return best;
}

size_t trade_most_accurate(const trade_table *table) {
    size_t best = table->num_positions;
    double deviation = INFINITY;

    for (size_t i = 0; i < table->num_positions; i++) {
        const trade_position *position = &table->positions[i];
        if (position->num_failures > 0 || !(worst_film(position) < deviation)) continue;
        best = i;
        deviation = worst_film(position);
    }
    return best;
}

// ---- for people

void trade_name(char name[TRADE_NAME], const ehdrom_sizes *sizes) {
    if (sizes->deformation_modes > 0)
        snprintf(name, TRADE_NAME, "%zu pressure modes, %zu deformation modes, %zu rows",
                 sizes->pressure_modes, sizes->deformation_modes, sizes->rows);
    else
        snprintf(name, TRADE_NAME, "%zu pressure modes, %zu rows", sizes->pressure_modes,
                 sizes->rows);
}

void trade_print(const trade_table *table, FILE *stream) {
    const char *const quantities[NUM_TRADE_QUANTITIES] = {"central film", "minimum film",
                                                          "central pressure", "pressure / p_H"};

    fprintf(stream,
            "%zu scenes; deviations from the full model: median, 95 %%, worst\n"
            "* not beaten in both time and worst central film by a position without failures\n"
            "%19s",
            table->num_scenes, "");
    for (int q = 0; q < NUM_TRADE_QUANTITIES; q++)
        fprintf(stream, "  %-23s", quantities[q]);
    fprintf(stream, "  iterations\n  %5s%6s%6s", "modes", "+", "rows");
    for (int q = 0; q < NUM_TRADE_QUANTITIES; q++)
        fprintf(stream, "  %7s %7s %7s", "median", "95 %", "worst");
    fprintf(stream, "  %5s %4s  %6s  %s\n", "mean", "most", "ms", "failures");
    for (size_t i = 0; i < table->num_positions; i++) {
        const trade_position *position = &table->positions[i];
        fprintf(stream, "%c %5zu%6zu%6zu", trade_is_beaten(table, i) ? ' ' : '*',
                position->sizes.pressure_modes, position->sizes.deformation_modes,
                position->sizes.rows);
        for (int q = 0; q < NUM_TRADE_QUANTITIES; q++)
            fprintf(stream, "  %7.1e %7.1e %7.1e", position->deviation[q][TRADE_MEDIAN],
                    position->deviation[q][TRADE_95], position->deviation[q][TRADE_WORST]);
        fprintf(stream, "  %5.1f %4.0f  %6.3f  %zu\n", position->mean_iterations,
                position->most_iterations, position->seconds * 1e3, position->num_failures);
    }
}
