/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/calibrate/trade.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

// ---- the ladder

/* Numbers of modes in the ladder, the list of sizes. MIN_MODES: smallest number.
 * STRIDES_A_DOUBLING: number of strides in which the number of modes doubles. In the last
 * doubling, among the accurate sizes, the strides are halved (README.md, Calibration and the
 * accuracy dial; test_trade.c, the_ladder_goes_from_ten_modes_to_all). */
static const double MIN_MODES = 10;
static const size_t STRIDES_A_DOUBLING = 2;
static const double ROWS_PER_MODE[] = {1.2, 1.5, 2, 3, INFINITY}; // INFINITY: all stored rows
enum { NUM_ROWS_PER_MODE = sizeof ROWS_PER_MODE / sizeof *ROWS_PER_MODE };

static size_t num_strides(size_t max_modes) {
    double strides = round((double)STRIDES_A_DOUBLING * log2((double)max_modes / MIN_MODES));

    return (double)max_modes <= MIN_MODES ? 0 : (size_t)fmax(strides, 1);
}

static void add_positions(trade_table *table, size_t modes, const online_properties *whole) {
    double part = (double)modes / (double)whole->pressure_modes;
    size_t deformation = (size_t)ceil(part * (double)whole->deformation_modes), last = 0;

    for (size_t i = 0; i < NUM_ROWS_PER_MODE; i++) {
        size_t rows = (size_t)fmin(ceil(ROWS_PER_MODE[i] * (double)modes), (double)whole->rows);
        if (rows == last) continue;
        last = rows;
        table->positions[table->num_positions++].sizes = (model_sizes){modes, deformation, rows};
    }
}

ehd_status trade_ladder(trade_table *table, const online_properties *whole, ehd_error *error) {
    size_t strides = num_strides(whole->pressure_modes), last = 0;
    double max_modes = (double)whole->pressure_modes;

    *table = (trade_table){0};
    table->positions = calloc((2 * strides + 1) * NUM_ROWS_PER_MODE, sizeof *table->positions);
    if (!table->positions) return ehd_no_memory(error, "positions");
    for (size_t half = 0; half < 2 * strides; half++) {
        double part = 0.5 * (double)half / (double)strides;
        size_t modes = (size_t)lround(MIN_MODES * pow(max_modes / MIN_MODES, part));
        if ((half % 2 == 1 && half / 2 + STRIDES_A_DOUBLING < strides) || modes == last) continue;
        if (modes < whole->pressure_modes) add_positions(table, modes, whole);
        last = modes;
    }
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

const double trade_margin = 2;

const double trade_pressures_allowed = 3;

double trade_indicator_factor(const double *deviations, const double *bounds, size_t count) {
    double largest = 0;

    for (size_t i = 0; i < count; i++)
        if (bounds[i] > 0) largest = fmax(largest, deviations[i] / bounds[i]);
    return trade_margin * largest;
}

/* Ratios of deviation to bound of the scenes. The shape of an estimate must lie above all
 * ratios. */
typedef struct ratios {
    double *bound, *ratio; // [count]
    size_t count;
    double largest;
} ratios;

/* Computes the ratios of the scenes with a positive finite bound. Returns false if there is no
 * memory. */
static bool ratios_init(ratios *self, const double *deviations, const double *bounds,
                        size_t count) {
    self->bound = calloc(count + 1, sizeof *self->bound);
    self->ratio = calloc(count + 1, sizeof *self->ratio);
    self->count = 0;
    self->largest = 0;
    if (!self->bound || !self->ratio) return false;
    for (size_t i = 0; i < count; i++) {
        if (!(bounds[i] > 0 && isfinite(bounds[i]))) continue;
        self->bound[self->count] = bounds[i];
        self->ratio[self->count] = deviations[i] / bounds[i];
        self->largest = fmax(self->largest, self->ratio[self->count++]);
    }
    return true;
}

static void ratios_free(ratios *self) {
    free(self->bound);
    free(self->ratio);
}

/* Returns the sum of ln(estimate) over the scenes. The factor of the estimates is the largest
 * ratio. */
static double indicated_sum(const ratios *self, indicator_shape shape) {
    double sum = 0;

    for (size_t i = 0; i < self->count; i++)
        sum += log(trade_indicated(self->largest, shape, self->bound[i]));
    return sum;
}

static size_t smallest_bound(const ratios *self) {
    size_t smallest = 0;

    for (size_t i = 1; i < self->count; i++)
        if (self->bound[i] < self->bound[smallest]) smallest = i;
    return smallest;
}

/* Returns the straight line, as a function of the bound, that lies above the ratios of all scenes
 * and has the smallest indicated_sum. The candidates are the edges of the upper convex hull of the
 * points (bound, ratio), and the constant largest ratio. The hull begins at the bound 0, with the
 * ratio of the scene with the smallest bound. It ends at the largest ratio. */
static indicator_shape best_line(const ratios *self) {
    indicator_shape best = plain_shape;
    double least = indicated_sum(self, best), bound = 0;

    for (double ratio = self->ratio[smallest_bound(self)]; ratio < self->largest;) {
        double slope = 0, next = bound;
        for (size_t i = 0; i < self->count; i++) {
            const double rise = (self->ratio[i] - ratio) / (self->bound[i] - bound);
            if (!(self->bound[i] > bound && rise > slope)) continue;
            slope = rise;
            next = self->bound[i];
        }
        if (!(slope > 0)) break;
        indicator_shape edge = plain_shape;
        edge.share = (ratio - slope * bound) / self->largest;
        edge.growth = slope / self->largest;
        const double sum = indicated_sum(self, edge);
        if (sum < least) best = edge;
        least = fmin(sum, least);
        ratio += slope * (next - bound);
        bound = next;
    }
    return best;
}

/* Fits an offset, and the multiple of the bound that is added to the offset. The offset is the
 * deviation of one of the scenes. To first order a deviation equals the bound, so the multiple is
 * at least 1. If all ratios are below 1, the multiple is at least the largest ratio. With a smaller
 * multiple, the offset alone might cover all scenes of the calibration. Any other scene would then
 * get the offset as its estimate, whatever its residual is. */
static indicator_shape best_offset(const ratios *self, indicator_shape line) {
    const double first_order = fmin(1, self->largest);
    indicator_shape best = line;
    double least = indicated_sum(self, best);

    for (size_t i = 0; i < self->count; i++) {
        const double offset = self->ratio[i] * self->bound[i];
        double share = first_order;
        for (size_t j = 0; j < self->count; j++)
            share = fmax(share, self->ratio[j] - offset / self->bound[j]);
        indicator_shape with = line;
        with.offset = offset / self->largest;
        with.offset_share = share / self->largest;
        const double sum = indicated_sum(self, with);
        if (sum < least) best = with;
        least = fmin(sum, least);
    }
    return best;
}

ehd_status trade_indicator_shape(indicator_shape *shape, const double *deviations,
                                 const double *bounds, size_t count, bool with_offset,
                                 ehd_error *error) {
    ratios all = {0};
    const bool complete = ratios_init(&all, deviations, bounds, count);

    *shape = plain_shape;
    if (complete && all.largest > 0) *shape = best_line(&all);
    if (complete && all.largest > 0 && with_offset) *shape = best_offset(&all, *shape);
    ratios_free(&all);
    if (complete) return EHD_OK;
    return ehd_no_memory(error, "calibration");
}

// ---- choosing

trade_price trade_price_of(const trade_position *position, bool in_time) {
    if (in_time && position->factor_in_time > 0) {
        const double half = position->indicated_in_time[0];
        return (trade_price){half < 1 ? half : INFINITY, position->step_seconds,
                             position->num_lost};
    }
    if (in_time)
        return (trade_price){position->worst_in_time[TRADE_CENTRAL_FILM], position->step_seconds,
                             position->num_lost};
    if (position->indicator_factor > 0)
        return (trade_price){position->indicated[PART_90], position->seconds,
                             isfinite(position->indicated[PART_90]) ? 0 : position->num_failures};
    return (trade_price){fmax(position->deviation[TRADE_CENTRAL_FILM][TRADE_WORST],
                              position->deviation[TRADE_MINIMUM_FILM][TRADE_WORST]),
                         position->seconds, position->num_failures};
}

/* Checks whether a model size may be chosen in spite of failures. This is allowed for transient
 * contacts with error estimates, because all sizes may fail after jumps. */
static bool may_fail(const trade_position *position, bool in_time) {
    return in_time && position->factor_in_time > 0;
}

/* Checks whether a model size may be chosen for a deviation, regardless of the failures of other
 * sizes. */
static bool is_candidate(const trade_position *position, double deviation, bool in_time) {
    const trade_price price = trade_price_of(position, in_time);

    return (price.num_failures == 0 || may_fail(position, in_time)) && price.deviation <= deviation;
}

bool trade_is_dominated(const trade_table *table, size_t position, bool in_time) {
    const trade_price self = trade_price_of(&table->positions[position], in_time);

    if (!is_candidate(&table->positions[position], DBL_MAX, in_time)) return true;
    for (size_t i = 0; i < table->num_positions; i++) {
        const trade_price other = trade_price_of(&table->positions[i], in_time);
        if (other.num_failures <= self.num_failures && other.seconds <= self.seconds &&
            other.deviation <= self.deviation &&
            (other.seconds < self.seconds || other.deviation < self.deviation ||
             other.num_failures < self.num_failures))
            return true;
    }
    return false;
}

double trade_part_in_time(const trade_position *position, double deviation) {
    double part = 0;

    for (int i = 0; i < NUM_TIME_PARTS && position->factor_in_time > 0; i++)
        if (position->indicated_in_time[i] <= deviation) part = trade_time_parts[i];
    return part;
}

/* Returns the largest deviation of pressures over all scenes, in Hertz pressures. */
static double field_deviation(const trade_table *table, size_t position) {
    return table->positions[position].deviation[TRADE_PRESSURE][TRADE_WORST];
}

/* Returns the smallest number of failures among the candidates for a deviation. */
static size_t least_failures(const trade_table *table, double deviation, bool in_time) {
    size_t least = SIZE_MAX;

    for (size_t i = 0; i < table->num_positions; i++) {
        const size_t here = trade_price_of(&table->positions[i], in_time).num_failures;
        if (is_candidate(&table->positions[i], deviation, in_time) && here < least) least = here;
    }
    return least;
}

/* Returns the largest trade_part_in_time of the sizes with at most num_failures failures. */
static double largest_part(const trade_table *table, double deviation, size_t num_failures) {
    double most = 0;

    for (size_t i = 0; i < table->num_positions; i++)
        if (trade_price_of(&table->positions[i], true).num_failures <= num_failures)
            most = fmax(most, trade_part_in_time(&table->positions[i], deviation));
    return most;
}

size_t trade_cheapest(const trade_table *table, double deviation, bool in_time) {
    const double fields = trade_pressures_allowed * deviation;
    const size_t failures = least_failures(table, deviation, in_time);
    const double most = in_time ? largest_part(table, deviation, failures) : 0;
    size_t best = table->num_positions, smoothest = best;
    double seconds = INFINITY;

    for (size_t i = 0; i < table->num_positions; i++) {
        const trade_price price = trade_price_of(&table->positions[i], in_time);
        if (!is_candidate(&table->positions[i], deviation, in_time)) continue;
        if (price.num_failures > failures) continue;
        if (in_time && trade_part_in_time(&table->positions[i], deviation) < most) continue;
        if (!in_time && field_deviation(table, i) > fields) {
            if (smoothest == table->num_positions ||
                field_deviation(table, i) < field_deviation(table, smoothest))
                smoothest = i;
        } else if (price.seconds < seconds) {
            best = i;
            seconds = price.seconds;
        }
    }
    return best < table->num_positions ? best : smoothest;
}

/* Returns the measure that is smallest for the most accurate model size. It is the deviation of
 * trade_price_of. For transient contacts with error estimates, it is the geometric mean of the
 * quantiles of the estimates. A trajectory with a step that fails or is not trusted has the
 * estimate 1. */
static double inaccuracy(const trade_position *position, bool in_time) {
    double sum = 0;

    if (!may_fail(position, in_time)) return trade_price_of(position, in_time).deviation;
    for (int i = 0; i < NUM_TIME_PARTS; i++)
        sum += log(position->indicated_in_time[i]);
    return exp(sum / NUM_TIME_PARTS);
}

size_t trade_most_accurate(const trade_table *table, bool in_time) {
    size_t best = table->num_positions;
    double least = INFINITY;

    for (size_t i = 0; i < table->num_positions; i++) {
        const trade_position *position = &table->positions[i];
        if (!is_candidate(position, DBL_MAX, in_time)) continue;
        if (!(inaccuracy(position, in_time) < least)) continue;
        best = i;
        least = inaccuracy(position, in_time);
    }
    return best;
}

// ---- printing

void trade_name(char name[TRADE_NAME], const model_sizes *sizes) {
    if (sizes->deformation_modes > 0)
        snprintf(name, TRADE_NAME, "%zu pressure modes, %zu deformation modes, %zu rows",
                 sizes->pressure_modes, sizes->deformation_modes, sizes->rows);
    else
        snprintf(name, TRADE_NAME, "%zu pressure modes, %zu rows", sizes->pressure_modes,
                 sizes->rows);
}

static const char *const quantities[NUM_TRADE_QUANTITIES] = {"central film", "minimum film",
                                                             "central pressure", "pressure / p_H"};

static void print_sizes(const trade_table *table, size_t i, bool in_time, FILE *stream) {
    const model_sizes *sizes = &table->positions[i].sizes;

    fprintf(stream, "%c %5zu%6zu%6zu", trade_is_dominated(table, i, in_time) ? ' ' : '*',
            sizes->pressure_modes, sizes->deformation_modes, sizes->rows);
}

static void print_scenes(const trade_table *table, FILE *stream) {
    fprintf(stream, "%zu scenes: median, 95 %% and worst deviation from the full model\n%19s",
            table->num_scenes, "");
    for (int q = 0; q < NUM_TRADE_QUANTITIES; q++)
        fprintf(stream, "  %-23s", quantities[q]);
    fprintf(stream, "  iterations\n  %5s%6s%6s", "modes", "+", "rows");
    for (int q = 0; q < NUM_TRADE_QUANTITIES; q++)
        fprintf(stream, "  %7s %7s %7s", "median", "95 %", "worst");
    fprintf(stream, "  %5s %4s  %6s  %s\n", "mean", "most", "ms", "failures");
    for (size_t i = 0; i < table->num_positions; i++) {
        const trade_position *position = &table->positions[i];
        print_sizes(table, i, false, stream);
        for (int q = 0; q < NUM_TRADE_QUANTITIES; q++)
            fprintf(stream, "  %7.1e %7.1e %7.1e", position->deviation[q][TRADE_MEDIAN],
                    position->deviation[q][TRADE_95], position->deviation[q][TRADE_WORST]);
        fprintf(stream, "  %5.1f %4.0f  %6.3f  %zu\n", position->mean_iterations,
                position->max_iterations, position->seconds * 1e3, position->num_failures);
    }
}

static void print_indicator(const trade_table *table, FILE *stream) {
    fprintf(
        stream,
        "indicated deviation, the larger of both films: median, 90 %% and 95 %% of all scenes; "
        "over the true one, the smaller of both: 5 %%, median and 95 %%\n  %5s%6s%6s  %17s  %-23s  "
        "%s\n",
        "modes", "+", "rows", "factors", "indicated", "over true");
    for (size_t i = 0; i < table->num_positions; i++) {
        const trade_position *position = &table->positions[i];
        const double *indicated = position->indicated, *over = position->effectivity;
        if (!(position->indicator_factor > 0)) continue;
        print_sizes(table, i, false, stream);
        fprintf(stream, "  %8.2e %8.2e  %7.1e %7.1e %7.1e  %7.1e %7.1e %7.1e\n",
                position->indicator_factor, position->indicator_factor_minimum, indicated[PART_50],
                indicated[PART_90], indicated[PART_95], over[PART_5], over[PART_50], over[PART_95]);
    }
}

static void print_trajectories(const trade_table *table, FILE *stream) {
    fprintf(stream,
            "%zu trajectories: worst deviation from the full model with the same steps; iterations "
            "and time of a step\n  %5s%6s%6s",
            table->num_trajectories, "modes", "+", "rows");
    for (int q = 0; q < TRADE_PRESSURE; q++)
        fprintf(stream, "  %16s", quantities[q]);
    fprintf(stream, "  %10s  %6s  %s\n", "iterations", "ms", "failures");
    for (size_t i = 0; i < table->num_positions; i++) {
        const trade_position *position = &table->positions[i];
        print_sizes(table, i, true, stream);
        for (int q = 0; q < TRADE_PRESSURE; q++)
            fprintf(stream, "  %16.1e", position->worst_in_time[q]);
        fprintf(stream, "  %10.1f  %6.3f  %zu\n", position->step_iterations,
                position->step_seconds * 1e3, position->num_lost);
    }
}

void trade_print(const trade_table *table, FILE *stream) {
    fputs("* not beaten in both time and the deviation that --accuracy goes by\n", stream);
    if (table->num_scenes > 0) print_scenes(table, stream);
    if (table->num_scenes > 0) print_indicator(table, stream);
    if (table->num_trajectories > 0) print_trajectories(table, stream);
}
