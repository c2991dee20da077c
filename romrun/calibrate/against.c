/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/calibrate/against.h"

#include "common/algebra/rounding.h"
#include "common/algebra/spline.h"
#include "common/output/grid_file.h"
#include "common/physics/traction.h"
#include "common/program/text.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>

static void print_deviation(const char *name, double reduced, double full) {
    if (isfinite(full) && full != 0)
        printf("  %-24s %13.8g against %13.8g  %+.4f permille\n", name, reduced, full,
               (reduced / full - 1) * 1e3);
}

/* Nodes and weights of an interpolation along an axis, from up to four neighbouring nodes. */
typedef struct stencil {
    size_t first, count;
    double weights[4];
} stencil;

/* Returns the weights of Lagrange's polynomial through the nodes around `place`. `place` is the
 * distance from the first of `num_nodes` nodes, in grid steps. */
static stencil stencil_at(double place, size_t num_nodes) {
    const size_t count = num_nodes < 4 ? num_nodes : 4;
    const double last = (double)(num_nodes - count);
    stencil self = {.first = (size_t)fmin(fmax(floor(place) - 1, 0), last), .count = count};
    const double x = place - (double)self.first;

    for (size_t i = 0; i < count; i++) {
        self.weights[i] = 1;
        for (size_t j = 0; j < count; j++)
            if (j != i) self.weights[i] *= (x - (double)j) / ((double)i - (double)j);
    }
    return self;
}

/* Returns the distance of a coordinate from the first node of an axis, in grid steps. If the
 * coordinate differs from a node only by round-off, returns the distance of this node. */
static double place_of(double coordinate, double first, double step) {
    const double place = (coordinate - first) / step, nearest = round(place);

    return fabs(place - nearest) < 1e-6 ? nearest : place;
}

/* Interpolates a field at a point. Returns NaN outside of the grid. */
static double field_at(const double *inner, const ehd_grid *grid, double x, double y) {
    const double along = place_of(x, grid->x_min, grid->step);
    const double across = place_of(y, grid->inner_lines > 1 ? -grid_extent_of(grid).y_max : 0,
                                   grid_step_across(grid));
    double sum = 0;
    if (!(along >= 0 && along <= (double)grid->inner_x - 1 && across >= 0 &&
          across <= (double)grid->inner_lines - 1))
        return NAN;

    const stencil columns = stencil_at(along, grid->inner_x);
    const stencil lines = stencil_at(across, grid->inner_lines);
    for (size_t l = 0; l < lines.count; l++)
        for (size_t c = 0; c < columns.count; c++)
            sum += lines.weights[l] * columns.weights[c] *
                   inner[(lines.first + l) * grid->inner_x + columns.first + c];
    return sum;
}

double against_difference(const double *nodes, const ehd_grid *grid, const double *inner,
                          const ehd_grid *other) {
    const ehd_grid whole = grid_whole(grid);
    double largest = 0;

    for (size_t row = 0; row < whole.num_inner; row++) {
        const size_t place = grid_node_of_row(&whole, row);
        const size_t node = grid_node_of_row(grid, grid_row_of_whole(grid, row));
        const double there = field_at(inner, other, grid_x(&whole, place), grid_y(&whole, place));
        largest = fmax(largest, fabs(nodes[node] - there)); // fmax ignores NaN
    }
    return largest;
}

/* Checks whether both grids have equal nodes. If the number of nodes of `other` is not known,
 * compares only the first node and the grid step. */
static bool same_nodes(const ehd_grid *grid, const ehd_grid *other) {
    ehd_grid like = *other;

    like.half = grid->half;
    const size_t columns = other->num_inner > 0 ? grid->inner_x : other->inner_x;
    const ehd_grid like_other =
        grid_like(&like, grid->x_min, grid->step, columns, grid->inner_lines);
    return grid_same(&like_other, other);
}

/* Prints the heading, which names differences of grid, discretisation and boundary. */
static void print_heading(const char *path, const ehd_grid *grid, const ehd_grid *other) {
    const ehd_grid whole = grid_whole(grid);
    const bool moved = !same_nodes(&whole, other);
    const bool bounded = grid->boundary != other->boundary;
    const bool discretized = grid->discretization != other->discretization;

    char shown[PATH_MAX];
    snprintf(shown, sizeof shown, "%s", path);
    text_make_printable(shown, "");
    printf("against %s", shown);
    if (moved) {
        printf(" (another grid, ");
        if (other->num_inner > 0)
            grid_print_nodes(other);
        else
            printf("from %g by %g", other->x_min, other->step);
    }
    if (discretized)
        printf("%sanother discretization, %s", moved ? ", " : " (",
               discretization_names[other->discretization]);
    if (bounded)
        printf("%sanother boundary, %s", moved || discretized ? ", " : " (",
               boundary_names[other->boundary]);
    printf("%s:\n", moved || discretized || bounded ? ": what it does is in the deviations)" : "");
}

ehd_status against_check(double moes_M, double alpha_p_H, double hertz_pressure,
                         flow_thinning thinning, const ehd_grid *grid, const char *path,
                         const ehd_contact *contact, ehd_error *error) {
    // Relative tolerance of M, alpha p_H, p_H and both thinnings. Scenes are written with this many
    // digits (reduced.bats, "--against prints the deviations").
    const double slack = 1e-6;
    const ehd_status status = grid_check_shape(grid, path, &contact->grid, "the scene", error);

    const flow_thinning expected = traction_thinning(contact);
    if (status) return status;
    if (!(fabs(thinning.sliding - expected.sliding) <= slack * expected.sliding))
        return ehd_fail(error, EHD_DATA,
                        "%s: thinning: found %g, expected the scene's %g (lubricant.shear.in_film)",
                        path, thinning.sliding, expected.sliding);
    if (!(fabs(thinning.gradient - expected.gradient) <= slack * expected.gradient))
        return ehd_fail(error, EHD_DATA,
                        "%s: gradient_thinning: found %g, expected the scene's %g "
                        "(lubricant.shear.in_film)",
                        path, thinning.gradient, expected.gradient);
    if (fabs(moes_M - contact->moes_M) <= slack * contact->moes_M &&
        fabs(hertz_pressure - contact->hertz_pressure) <=
            slack * fmax(contact->hertz_pressure, 1) &&
        fabs(alpha_p_H - contact->alpha_p_H) <= slack * fmax(contact->alpha_p_H, 1))
        return EHD_OK;
    return ehd_fail(error, EHD_DATA,
                    "%s: found a result of M = %g, alpha p_H = %g, %.6g GPa, expected the scene's "
                    "M = %g, alpha p_H = %g, %.6g GPa",
                    path, moes_M, alpha_p_H, hertz_pressure * 1e-9, contact->moes_M,
                    contact->alpha_p_H, contact->hertz_pressure * 1e-9);
}

void against_print(const run_result *result, const stored_result *stored, const char *path,
                   const ehd_contact *contact) {
    const ehd_grid *grid = &contact->grid, other = result_grid(stored);

    print_heading(path, grid, &other);
    print_deviation("central film thickness", result->scalars.central_film_thickness,
                    stored->central_film_thickness);
    print_deviation("minimum film thickness", result->scalars.minimum_film_thickness,
                    stored->minimum_film_thickness);
    print_deviation("central pressure", result->scalars.central_pressure, stored->central_pressure);
    print_deviation("exit position", result->scalars.exit_position, stored->exit_position);
    if (result->pressure && stored->pressure)
        printf("  %-24s %.2e of the Hertz pressure\n", "largest pressure error",
               against_difference(result->pressure, grid, stored->pressure, &other));
    if (result->film && stored->film)
        printf("  %-24s %.2e\n", "largest film error",
               against_difference(result->film, grid, stored->film, &other));
}

// ---- over time

/* Relative deviation of one quantity between two runs. It is evaluated at those time points of the
 * first run that lie in the time span of the second run. If the second run lacks a time point, a
 * cubic spline interpolates it. */
typedef struct time_deviation {
    double largest; // relative
    double at;      // time T of the largest deviation
    // sum: integral of |relative deviation| over T; length: length of the integrated intervals of T
    double sum, length;
} time_deviation;

/* Returns a value of the second run at a time. *near: index of the spline interval at which the
 * search begins; becomes the index of the interval found. */
static double value_at(double time, const double *other_time, const double *other_values,
                       const spline *between, size_t *near) {
    *near = spline_interval(between, time, *near);
    // does not interpolate if the second run has this time point, as with equal fixed time steps
    for (size_t i = *near; i <= *near + 1; i++)
        if (fabs(time - other_time[i]) <= ROUNDING * fmax(fabs(time), 1)) return other_values[i];
    return spline_value(between, time, *near);
}

/* Adds the deviations between a section of the first run and a section of the second run. The
 * second section has at least three time points. */
static ehd_status add_deviations(time_deviation *deviation, const double *time,
                                 const double *values, size_t num_times, const double *other_time,
                                 const double *other_values, size_t num_other, ehd_error *error) {
    double last = NAN;
    size_t near = 0;

    spline *between = spline_create(num_other);
    if (!between) return ehd_no_memory(error, "time");
    spline_fit(between, other_time, other_values);
    for (size_t i = 0; i < num_times; i++) {
        if (time[i] < other_time[0] || time[i] > other_time[num_other - 1]) continue;
        const double there = value_at(time[i], other_time, other_values, between, &near);
        const double relative = fabs(values[i] / there - 1);
        if (!isnan(deviation->largest) && !(relative <= deviation->largest)) {
            deviation->largest = relative;
            deviation->at = time[i];
        }
        if (!isnan(last)) {
            deviation->sum += relative * (time[i] - last);
            deviation->length += time[i] - last;
        }
        last = time[i];
    }
    spline_free(between);
    return EHD_OK;
}

/* A period of contact: in all entries from `begin` to `end` - 1 the bodies are in contact. */
typedef struct contact_period {
    size_t begin, end;
} contact_period;

/* Finds the next period of contact: neighbouring entries for which `sign` is not 0. Returns false
 * after the last period. */
static bool next_period(contact_period *period, const double *sign, size_t count) {
    period->begin = period->end;
    while (period->begin < count && sign[period->begin] == 0)
        period->begin++;
    period->end = period->begin;
    while (period->end < count && sign[period->end] != 0)
        period->end++;
    return period->begin < count;
}

/* Compares one quantity over all times at which the bodies are in contact in both runs. */
static ehd_status compare_contacts(time_deviation *deviation, const time_trace *trace,
                                   const double *reduced, const time_series *full,
                                   const double *other, ehd_error *error) {
    enum { MIN_SPLINE = 3 }; // smallest number of time points for an interpolation
    contact_period now = {0, 0}, then = {0, 0};
    bool more = next_period(&now, trace->central_pressure, trace->count) &&
                next_period(&then, full->load, full->num_times);
    ehd_status status = EHD_OK;

    *deviation = (time_deviation){0};
    while (more && !status) {
        if (then.end - then.begin >= MIN_SPLINE)
            status = add_deviations(deviation, trace->time + now.begin, reduced + now.begin,
                                    now.end - now.begin, full->time + then.begin,
                                    other + then.begin, then.end - then.begin, error);
        more = trace->time[now.end - 1] < full->time[then.end - 1]
                   ? next_period(&now, trace->central_pressure, trace->count)
                   : next_period(&then, full->load, full->num_times);
    }
    return status;
}

ehd_status against_print_in_time(const time_trace *trace, const time_series *full, const char *path,
                                 const ehd_grid *grid, ehd_error *error) {
    const struct {
        const char *name;
        const double *reduced, *full;
    } quantities[] = {
        {"central film thickness", trace->central_film_thickness, full->central_film_thickness},
        {"central pressure", trace->central_pressure, full->central_pressure}};
    contact_period now = {0, 0}, then = {0, 0};

    next_period(&now, trace->central_pressure, trace->count);
    next_period(&then, full->load, full->num_times);
    print_heading(path, grid, &full->grid);
    if (now.end - now.begin < trace->count || then.end - then.begin < full->num_times)
        printf("  while the bodies are in contact in both\n");
    for (size_t i = 0; i < sizeof quantities / sizeof *quantities; i++) {
        ehd_error cause = {""};
        time_deviation deviation;
        const ehd_status status = compare_contacts(&deviation, trace, quantities[i].reduced, full,
                                                   quantities[i].full, &cause);
        if (status) return ehd_fail(error, status, "%s: %s", path, cause.text);
        if (deviation.length == 0) {
            printf("  %-24s fewer than two times in common\n", quantities[i].name);
            continue;
        }
        printf("  %-24s at most %.3g %% off, at T = %.6g; %.2g %% in the mean\n",
               quantities[i].name, deviation.largest * 100, deviation.at,
               deviation.sum / deviation.length * 100);
    }
    return EHD_OK;
}
