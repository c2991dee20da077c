/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/time/path_filter.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { ORDER = PATH_FILTER_ORDER, BAND = ORDER + 1 };

// Longest filter length, in steps of the grid. With 56 steps the factorisation fails by round-off
// (test_path_filter.c, a_length_of_too_many_steps_is_refused)
static const double MOST_STEPS = 50;

/* Returns alpha, the weight of the squared difference, at a place. For a wave of amplitude 1 with
 * the wave number k, the difference is (k h)^ORDER if k h << 1, where h is the grid step. */
static double weight_at(const ehd_grid *grid, double x, double y, double length) {
    const double inside = 1 - x * x - y * y;

    return inside > 0 ? pow(sqrt(inside) * length / (2 * grid->step), 2 * ORDER) : 0;
}

static const double binomial[BAND] = {-1, 5, -10, 10, -5, 1};

/* Assembles the lower half of I + D' alpha D: `matrix`[i, i - j]. */
static void assemble(double *matrix, const double *weight, size_t width) {
    for (size_t i = 0; i < width; i++)
        matrix[i * BAND] = 1;
    for (size_t i = 0; i + ORDER < width; i++)
        for (size_t a = 0; a <= ORDER; a++)
            for (size_t b = 0; b <= a; b++)
                matrix[(i + a) * BAND + (a - b)] += weight[i] * binomial[a] * binomial[b];
}

/* Replaces the matrix M by its Cholesky factor L, M = L L', with the reciprocals of its diagonal.
 * Returns false if round-off makes this impossible, because the filter length spans too many grid
 * steps. */
static bool factorise(double *matrix, size_t width) {
    for (size_t i = 0; i < width; i++) {
        double *row = matrix + i * BAND;
        for (size_t back = i < ORDER ? i : ORDER; back > 0; back--) {
            const double *other = matrix + (i - back) * BAND;
            for (size_t k = back + 1; k <= ORDER && k <= i; k++)
                row[back] -= row[k] * other[k - back];
            row[back] *= other[0];
        }
        for (size_t k = 1; k <= ORDER && k <= i; k++)
            row[0] -= row[k] * row[k];
        if (!(row[0] > 0)) return false;
        row[0] = 1 / sqrt(row[0]);
    }
    return true;
}

double path_filter_length(const ehd_contact *contact) {
    // filter length at the default tolerance, half widths, and this tolerance (README.md, Along
    // the path; test_path_filter.c, the_length_goes_with_the_tolerance)
    const double usual = 0.014, usual_tolerance = 1.5e-3;
    // at fronts the filter changes the central film in proportion to the third power of its length;
    // without a known tolerance `share` is 1
    const double share = fmin(cbrt(contact->time_tolerance / usual_tolerance), 1);

    if (!isnan(contact->smoothing)) return contact->smoothing;
    return fmax(share * usual, 0.85 * contact->grid.step);
}

ehd_carriage path_carriage(const ehd_contact *contact) {
    const bool path = contact->transport == TRANSPORT_PATH;

    return (ehd_carriage){contact->transport, path ? path_filter_length(contact) : NAN};
}

ehd_status path_filter_init(path_filter *self, const ehd_grid *grid, double length,
                            ehd_error *error) {
    const size_t width = grid_width(grid), lines = grid_lines(grid);

    *self = (path_filter){.num_columns = width, .num_lines = lines};
    self->weight = calloc(lines * width, sizeof *self->weight);
    self->factor = calloc(lines * width, BAND * sizeof *self->factor);
    self->work = malloc(2 * width * sizeof *self->work);
    if (!self->weight || !self->factor || !self->work) {
        path_filter_free(self);
        return ehd_no_memory(error, "path filter");
    }
    for (size_t l = 0; l < lines; l++) {
        double *weight = self->weight + l * width;
        for (size_t i = 0; i + ORDER < width; i++)
            weight[i] = weight_at(grid, (grid_x(grid, i) + grid_x(grid, i + ORDER)) / 2,
                                  grid_y(grid, l * width), length);
        assemble(self->factor + l * width * BAND, weight, width);
        if (factorise(self->factor + l * width * BAND, width)) continue;
        path_filter_free(self);
        return ehd_fail(error, EHD_DATA,
                        "transient.smoothing: found %g, expected at most about %g on steps of %g",
                        length, MOST_STEPS * grid->step, grid->step);
    }
    return EHD_OK;
}

void path_filter_free(path_filter *self) {
    free(self->weight);
    free(self->factor);
    free(self->work);
    memset(self, 0, sizeof *self);
}

/* Computes D' alpha D of the values. */
static void differences(double *result, double *work, const double *values, const double *weight,
                        size_t count, size_t stride) {
    memset(result, 0, count * sizeof *result);
    for (size_t i = 0; i + ORDER < count; i++) {
        work[i] = 0;
        for (size_t a = 0; a <= ORDER; a++)
            work[i] += binomial[a] * values[(i + a) * stride];
        for (size_t a = 0; a <= ORDER; a++)
            result[i + a] += binomial[a] * weight[i] * work[i];
    }
}

static void solve(double *values, const double *factor, size_t count) {
    for (size_t i = 0; i < count; i++) {
        for (size_t k = 1; k <= ORDER && k <= i; k++)
            values[i] -= factor[i * BAND + k] * values[i - k];
        values[i] *= factor[i * BAND];
    }
    for (size_t i = count; i-- > 0;) {
        for (size_t k = 1; k <= ORDER && i + k < count; k++)
            values[i] -= factor[(i + k) * BAND + k] * values[i + k];
        values[i] *= factor[i * BAND];
    }
}

void path_filter_apply(path_filter *self, double *values, size_t line, size_t stride,
                       double share) {
    const size_t count = self->num_columns;
    double *taken = self->work; // change by the filter: it is small, and so is its round-off

    differences(taken, taken + count, values, self->weight + line * count, count, stride);
    solve(taken, self->factor + line * count * BAND, count);
    for (size_t i = 0; i < count; i++)
        values[i * stride] -= share * taken[i];
}
