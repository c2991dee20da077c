/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/deflection.h"

#include <fftw3.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

/* The kernel is even in x and y, so that its Fourier transform is real: a real-to-real transform
 * of the pressure turns the convolution into products with real numbers. On a half grid, which is
 * even across, a cosine transform replaces the one across. */
struct ehd_deflection {
    ehd_grid grid;
    size_t length, lines; // of the transform: along, and across
    double *kernel;       // [grid lines, grid width]
    double *transfer;     // [lines, length], of the kernel
    double *signal;       // [lines, length]
    fftw_plan forward, backward;
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

static void make_plans(ehd_deflection *self) {
    const bool line = self->lines == 1, half = self->grid.half;
    const int sizes[2] = {(int)self->lines, (int)self->length};
    const fftw_r2r_kind forward[2] = {half ? FFTW_REDFT00 : FFTW_R2HC, FFTW_R2HC};
    const fftw_r2r_kind backward[2] = {half ? FFTW_REDFT00 : FFTW_HC2R, FFTW_HC2R};
    double *signal = self->signal;

    // estimated plans: measured ones would differ, and with them the rounding, from run to run
    pthread_mutex_lock(&planner_lock);
    self->forward =
        fftw_plan_r2r(line ? 1 : 2, sizes + line, signal, signal, forward + line, FFTW_ESTIMATE);
    self->backward =
        fftw_plan_r2r(line ? 1 : 2, sizes + line, signal, signal, backward + line, FFTW_ESTIMATE);
    pthread_mutex_unlock(&planner_lock);
}

/* Distance in nodes of an index of a periodic signal from its origin. */
static size_t wrapped(size_t index, size_t period) {
    return index <= period / 2 ? index : period - index;
}

double deflection_influence(const contact_kind *kind, const ehd_grid *grid, double x, double y) {
    const double h = grid->step, here = kind->kernel(x, y, h);

    if (grid->discretization == DISCRETIZATION_PUBLISHED) return here;
    double curvature = kind->kernel(x - h, y, h) - 2 * here + kind->kernel(x + h, y, h);
    if (kind->dimensions > 1)
        curvature += kind->kernel(x, y - h, h) - 2 * here + kind->kernel(x, y + h, h);
    return here - curvature / 24;
}

static void make_transfer(ehd_deflection *self, const contact_kind *kind) {
    const ehd_grid *grid = &self->grid;
    size_t width = grid_width(grid), num_lines = grid_lines(grid);
    size_t period = self->lines > 1 ? period_across(grid) : 1;
    double step = grid->step, scale = 1 / ((double)self->length * (double)period);

    for (size_t l = 0; l < num_lines; l++)
        for (size_t d = 0; d < width; d++)
            self->kernel[l * width + d] =
                deflection_influence(kind, grid, (double)d * step, (double)l * step);
    for (size_t l = 0; l < self->lines; l++) {
        double y = (double)wrapped(l, period) * step;
        for (size_t d = 0; d < self->length; d++)
            self->signal[l * self->length + d] =
                deflection_influence(kind, grid, (double)wrapped(d, self->length) * step, y);
    }
    fftw_execute(self->forward);
    // an even signal has cosine coefficients only, which also multiply the sines of the pressure
    for (size_t l = 0; l < self->lines; l++) {
        size_t from = grid->half ? l : wrapped(l, period);
        for (size_t k = 0; k < self->length; k++)
            self->transfer[l * self->length + k] =
                scale * self->signal[from * self->length + wrapped(k, self->length)];
    }
}

ehd_deflection *deflection_create(const contact_kind *kind, const ehd_grid *grid) {
    ehd_deflection *self = calloc(1, sizeof *self);
    if (!self) return NULL;
    self->grid = *grid;
    self->length = smooth_length(2 * grid_width(grid));
    self->lines = kind->dimensions == 1 ? 1
                  : grid->half          ? period_across(grid) / 2 + 1
                                        : period_across(grid);

    size_t count = self->length * self->lines;
    self->kernel = malloc(grid->num_nodes * sizeof(double));
    self->transfer = malloc(count * sizeof(double));
    self->signal = fftw_alloc_real(count);
    if (!self->kernel || !self->transfer || !self->signal) return deflection_free(self);
    make_plans(self);
    if (!self->forward || !self->backward) return deflection_free(self);
    make_transfer(self, kind);
    return self;
}

ehd_deflection *deflection_free(ehd_deflection *self) {
    if (self) {
        pthread_mutex_lock(&planner_lock);
        if (self->forward) fftw_destroy_plan(self->forward);
        if (self->backward) fftw_destroy_plan(self->backward);
        pthread_mutex_unlock(&planner_lock);
        fftw_free(self->signal);
        free(self->transfer);
        free(self->kernel);
        free(self);
    }
    return NULL;
}

const double *deflection_kernel(const ehd_deflection *self) {
    return self->kernel;
}

void deflection_apply(double *delta, ehd_deflection *self, const double *pressure) {
    size_t width = grid_width(&self->grid), num_lines = grid_lines(&self->grid);
    size_t count = self->length * self->lines;

    memset(self->signal, 0, count * sizeof(double));
    for (size_t l = 0; l < num_lines; l++)
        memcpy(self->signal + l * self->length, pressure + l * width, width * sizeof(double));
    fftw_execute(self->forward);
    for (size_t k = 0; k < count; k++)
        self->signal[k] *= self->transfer[k];
    fftw_execute(self->backward);
    for (size_t l = 0; l < num_lines; l++)
        memcpy(delta + l * width, self->signal + l * self->length, width * sizeof(double));
}
