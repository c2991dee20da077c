/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/deflection.h"

#include <fftw3.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

/* Kernel and pressure are real, and the kernel is even in x and y, so that its Fourier transform is
 * real too. All transforms are FFTW's of real numbers to complex ones, which take a third of the
 * time of its real-to-real ones. On a half grid, which is even across, those across come first: of
 * the mirrored columns, whose transforms are real again and their own inverse. */
struct ehd_deflection {
    ehd_grid grid;
    size_t length, period; // of the transforms along and across
    size_t lines;          // of the transform across that differ: of a half grid half of the period
    double *kernel;        // [grid lines, grid width]
    double *transfer;      // [lines, length / 2 + 1], of the kernel
    double *signal;        // [lines, length]
    fftw_complex *spectrum; // [lines, length / 2 + 1], of the signal
    fftw_plan forward, backward;
    // of a half grid:
    double *column;     // [grid width, period] mirrored columns, in the spectrum's memory
    fftw_complex *wave; // [grid width, period / 2 + 1] their transforms
    fftw_plan across;
};

// FFTW's planner is not thread-safe
static pthread_mutex_t planner_lock = PTHREAD_MUTEX_INITIALIZER;

/* Smallest even 2^a 3^b 5^c that is at least `min_length`, for a fast transform. */
static size_t smooth_length(size_t min_length) {
    for (size_t length = min_length + (min_length & 1);; length += 2) {
        size_t rest = length;
        while (rest % 2 == 0)
            rest /= 2;
        while (rest % 3 == 0)
            rest /= 3;
        while (rest % 5 == 0)
            rest /= 5;
        if (rest == 1) return length;
    }
}

/* Period of the circular convolution across: twice the lines of the full grid, so that it equals
 * the linear one. */
static size_t period_across(const ehd_grid *grid) {
    size_t lines = grid_lines(grid);

    return smooth_length(grid->half ? 4 * lines : 2 * lines);
}

static size_t spectrum_width(const ehd_deflection *self) {
    return self->length / 2 + 1;
}

static void make_plans(ehd_deflection *self) {
    const int sizes[2] = {(int)self->period, (int)self->length};
    const int width = (int)grid_width(&self->grid), half_period = sizes[0] / 2 + 1;
    const bool half = self->column != NULL;
    // a half grid's lines one by one
    const int rank = half || self->period == 1 ? 1 : 2, count = half ? (int)self->lines : 1;
    const int wide = (int)spectrum_width(self);

    // estimated plans: measured ones would differ, and with them the rounding, from run to run
    pthread_mutex_lock(&planner_lock);
    self->forward = fftw_plan_many_dft_r2c(rank, sizes + 2 - rank, count, self->signal, NULL, 1,
                                           sizes[1], self->spectrum, NULL, 1, wide, FFTW_ESTIMATE);
    self->backward = fftw_plan_many_dft_c2r(rank, sizes + 2 - rank, count, self->spectrum, NULL, 1,
                                            wide, self->signal, NULL, 1, sizes[1], FFTW_ESTIMATE);
    if (half)
        self->across = fftw_plan_many_dft_r2c(1, sizes, width, self->column, NULL, 1, sizes[0],
                                              self->wave, NULL, 1, half_period, FFTW_ESTIMATE);
    pthread_mutex_unlock(&planner_lock);
}

/* Distance in nodes of an index of a periodic signal from its origin. */
static size_t wrapped(size_t index, size_t period) {
    return index <= period / 2 ? index : period - index;
}

double deflection_influence(const contact_kind *kind, const ehd_grid *grid, double x, double y) {
    const contact_shape *shape = &grid->shape;
    const double h = grid->step, across = grid_step_across(grid);
    const double here = kind->kernel(shape, x, y, h);

    if (grid->discretization == DISCRETIZATION_PUBLISHED) return here;
    double curvature =
        kind->kernel(shape, x - h, y, h) - 2 * here + kind->kernel(shape, x + h, y, h);
    if (kind->dimensions > 1)
        curvature += kind->kernel(shape, x, y - across, h) - 2 * here +
                     kind->kernel(shape, x, y + across, h);
    return here - curvature / 24;
}

/* The kernel's transform; false: no memory. */
static bool make_transfer(ehd_deflection *self, const contact_kind *kind) {
    const ehd_grid *grid = &self->grid;
    const size_t width = grid_width(grid), wide = spectrum_width(self);
    const double step = grid->step, step_across = grid_step_across(grid);
    const double scale = 1 / ((double)self->length * (double)self->period);
    double *signal = fftw_alloc_real(self->period * self->length);
    fftw_complex *spectrum = fftw_alloc_complex(self->period * wide);
    fftw_plan plan = NULL;

    if (signal && spectrum) {
        pthread_mutex_lock(&planner_lock);
        plan = fftw_plan_dft_r2c_2d((int)self->period, (int)self->length, signal, spectrum,
                                    FFTW_ESTIMATE);
        pthread_mutex_unlock(&planner_lock);
    }
    for (size_t l = 0; l < grid_lines(grid); l++)
        for (size_t d = 0; d < width; d++)
            self->kernel[l * width + d] =
                deflection_influence(kind, grid, (double)d * step, (double)l * step_across);
    for (size_t l = 0; l < self->period && plan; l++)
        for (size_t d = 0; d < self->length; d++) {
            const size_t across = wrapped(l, self->period), along = wrapped(d, self->length);
            signal[l * self->length + d] =
                along < d || across < l // a mirrored one, that stands there already
                    ? signal[across * self->length + along]
                    : deflection_influence(kind, grid, (double)d * step, (double)l * step_across);
        }
    if (plan) fftw_execute(plan);
    for (size_t k = 0; k < self->lines * wide && plan; k++)
        self->transfer[k] = scale * spectrum[k][0];
    pthread_mutex_lock(&planner_lock);
    if (plan) fftw_destroy_plan(plan);
    pthread_mutex_unlock(&planner_lock);
    fftw_free(signal);
    fftw_free(spectrum);
    return plan != NULL;
}

ehd_deflection *deflection_create(const contact_kind *kind, const ehd_grid *grid) {
    ehd_deflection *self = calloc(1, sizeof *self);
    if (!self) return NULL;
    const size_t width = grid_width(grid);
    const bool half = kind->dimensions > 1 && grid->half;

    self->grid = *grid;
    self->length = smooth_length(2 * width);
    self->period = kind->dimensions > 1 ? period_across(grid) : 1;
    self->lines = half ? self->period / 2 + 1 : self->period;

    const size_t in_spectrum = self->lines * spectrum_width(self);
    const size_t in_columns = half ? width * (self->period / 2 + 1) : 0;
    self->kernel = malloc(grid->num_nodes * sizeof(double));
    self->transfer = malloc(in_spectrum * sizeof(double));
    self->signal = fftw_alloc_real(self->lines * self->length);
    self->spectrum = fftw_alloc_complex(in_spectrum > in_columns ? in_spectrum : in_columns);
    if (half) self->wave = fftw_alloc_complex(in_columns);
    if (!self->kernel || !self->transfer || !self->signal || !self->spectrum ||
        (half && !self->wave))
        return deflection_free(self);
    if (half) self->column = &self->spectrum[0][0];
    make_plans(self);
    if (!self->forward || !self->backward || (half && !self->across) || !make_transfer(self, kind))
        return deflection_free(self);
    return self;
}

ehd_deflection *deflection_free(ehd_deflection *self) {
    if (self) {
        pthread_mutex_lock(&planner_lock);
        if (self->forward) fftw_destroy_plan(self->forward);
        if (self->backward) fftw_destroy_plan(self->backward);
        if (self->across) fftw_destroy_plan(self->across);
        pthread_mutex_unlock(&planner_lock);
        fftw_free(self->signal);
        fftw_free(self->spectrum);
        fftw_free(self->wave);
        free(self->transfer);
        free(self->kernel);
        free(self);
    }
    return NULL;
}

const double *deflection_kernel(const ehd_deflection *self) {
    return self->kernel;
}

/* Transforms the columns of `count` lines, `stride` apart, mirrored at the first one and at half of
 * the period: to self->wave. */
static void transform_across(ehd_deflection *self, const double *lines, size_t count,
                             size_t stride) {
    const size_t width = grid_width(&self->grid), period = self->period;

    memset(self->column, 0, width * period * sizeof(double));
    for (size_t c = 0; c < width; c++) {
        double *column = self->column + c * period;
        for (size_t l = 0; l < count; l++) {
            column[l] = lines[l * stride + c];
            if (l > 0) column[period - l] = column[l];
        }
    }
    fftw_execute(self->across);
}

/* The real part of self->wave, on lines again. */
static void take_lines(double *lines, const ehd_deflection *self, size_t count, size_t stride) {
    const size_t width = grid_width(&self->grid), half_period = self->period / 2 + 1;

    for (size_t l = 0; l < count; l++)
        for (size_t c = 0; c < width; c++)
            lines[l * stride + c] = self->wave[c * half_period + l][0];
}

/* The transform along, times the kernel's, and back. */
static void convolve(ehd_deflection *self) {
    const size_t count = self->lines * spectrum_width(self);

    fftw_execute(self->forward);
    for (size_t k = 0; k < count; k++) {
        self->spectrum[k][0] *= self->transfer[k];
        self->spectrum[k][1] *= self->transfer[k];
    }
    fftw_execute(self->backward);
}

void deflection_apply(double *delta, ehd_deflection *self, const double *pressure) {
    const size_t width = grid_width(&self->grid), num_lines = grid_lines(&self->grid);

    memset(self->signal, 0, self->lines * self->length * sizeof(double));
    if (self->across) {
        transform_across(self, pressure, num_lines, width);
        take_lines(self->signal, self, self->lines, self->length);
        convolve(self);
        transform_across(self, self->signal, self->lines, self->length);
        take_lines(delta, self, num_lines, width);
        return;
    }
    for (size_t l = 0; l < num_lines; l++)
        memcpy(self->signal + l * self->length, pressure + l * width, width * sizeof(double));
    convolve(self);
    for (size_t l = 0; l < num_lines; l++)
        memcpy(delta + l * width, self->signal + l * self->length, width * sizeof(double));
}
