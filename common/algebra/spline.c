/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/algebra/spline.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct spline {
    size_t num;
    double *x, *value, *bend; // [num]; bend: second derivative
    double *factor;           // [num] work
    double numbers[];         // storage of the arrays above
};

enum { NUM_ARRAYS = 4 };

double spline_bytes(size_t num) {
    return (double)(sizeof(spline) + NUM_ARRAYS * num * sizeof(double));
}

spline *spline_create(size_t num) {
    size_t bytes;

    if (__builtin_mul_overflow(num, NUM_ARRAYS * sizeof(double), &bytes) ||
        __builtin_add_overflow(bytes, sizeof(spline), &bytes))
        return NULL;
    spline *self = malloc(bytes);
    if (!self) return NULL;
    self->num = num;
    self->x = self->numbers;
    self->value = self->x + num;
    self->bend = self->value + num;
    self->factor = self->bend + num;
    for (size_t i = 0; i < NUM_ARRAYS * num; i++)
        self->numbers[i] = NAN;
    return self;
}

spline *spline_free(spline *self) {
    free(self);
    return NULL;
}

spline **splines_free(spline **splines, size_t count) {
    for (size_t i = 0; splines && i < count; i++)
        spline_free(splines[i]);
    free(splines);
    return NULL;
}

spline **splines_create(size_t count, size_t num) {
    spline **splines = calloc(count, sizeof(spline *));

    for (size_t i = 0; splines && i < count; i++) {
        splines[i] = spline_create(num);
        if (!splines[i]) splines = splines_free(splines, count);
    }
    return splines;
}

/* Returns the slope of the chord between the nodes i and i + 1. */
static double chord(const spline *self, size_t i) {
    return (self->value[i + 1] - self->value[i]) / (self->x[i + 1] - self->x[i]);
}

void spline_fit(spline *self, const double *x, const double *values) {
    const size_t last = self->num - 1;
    double *bend = self->bend, *factor = self->factor;

    memcpy(self->x, x, self->num * sizeof *x);
    memcpy(self->value, values, self->num * sizeof *values);
    // h[i-1] bend[i-1] + 2 (h[i-1] + h[i]) bend[i] + h[i] bend[i+1] = 6 (chord[i] - chord[i-1])
    bend[0] = bend[last] = factor[0] = 0;
    for (size_t i = 1; i < last; i++) {
        const double before = x[i] - x[i - 1], after = x[i + 1] - x[i];
        const double pivot = 2 * (before + after) - before * factor[i - 1];
        factor[i] = after / pivot;
        bend[i] = (6 * (chord(self, i) - chord(self, i - 1)) - before * bend[i - 1]) / pivot;
    }
    for (size_t i = last; i-- > 1;)
        bend[i] -= factor[i] * bend[i + 1];
}

size_t spline_interval(const spline *self, double x, size_t near) {
    size_t low = 0, high = self->num - 1;

    if (near < high && x >= self->x[near] && x < self->x[near + 1]) return near;
    while (high - low > 1) {
        const size_t middle = (low + high) / 2;
        if (self->x[middle] <= x)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* Computes the linear, quadratic and cubic coefficients of the polynomial on interval i. The
 * variable of the polynomial is the distance from node i. */
static void coefficients(double of[3], const spline *self, size_t i) {
    const double width = self->x[i + 1] - self->x[i];

    of[0] = chord(self, i) - width * (2 * self->bend[i] + self->bend[i + 1]) / 6;
    of[1] = self->bend[i] / 2;
    of[2] = (self->bend[i + 1] - self->bend[i]) / (6 * width);
}

double spline_value(const spline *self, double x, size_t i) {
    const double along = x - self->x[i];
    double of[3];

    coefficients(of, self, i);
    return self->value[i] + along * (of[0] + along * (of[1] + along * of[2]));
}

double spline_at(const spline *self, double x) {
    return spline_value(self, x, spline_interval(self, x, 0));
}

double spline_slope(const spline *self, double x) {
    const size_t i = spline_interval(self, x, 0);
    const double along = x - self->x[i];
    double of[3];

    coefficients(of, self, i);
    return of[0] + along * (2 * of[1] + along * 3 * of[2]);
}

double spline_bend(const spline *self, double x) {
    const size_t i = spline_interval(self, x, 0);
    double of[3];

    coefficients(of, self, i);
    return 2 * of[1] + 6 * of[2] * (x - self->x[i]);
}

/* Returns the integral over interval i, from node i to a point at the distance `along` from it. */
static double integral_in(const spline *self, size_t i, double along) {
    double of[3];

    coefficients(of, self, i);
    return along * (self->value[i] + along * (of[0] / 2 + along * (of[1] / 3 + along * of[2] / 4)));
}

double spline_integral(const spline *self, double x) {
    const size_t last = spline_interval(self, x, 0);
    double sum = 0;

    for (size_t i = 0; i < last; i++)
        sum += integral_in(self, i, self->x[i + 1] - self->x[i]);
    return sum + integral_in(self, last, x - self->x[last]);
}
