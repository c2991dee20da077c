/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/deflection.h"

#include <fftw3.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

/* Number of columns that are transformed together. A cache line holds this many numbers. */
enum { COLUMNS = 8 };
/* Padding after a column or a line, in numbers. Without the padding, columns whose length is a
 * power of two would share places in the cache. */
enum { APART = 8 };
/* Number of lines that are transformed together. */
enum { LINES = 2 };

/* Kernel and pressure are real, and the kernel is even in x and y, so the Fourier transform of the
 * kernel is also real. All transforms are FFTW's real-to-complex transforms, which take a third of
 * the time of FFTW's real-to-real transforms. On a half grid the pressure is even in y, and is
 * transformed in y first. The transform of a mirrored column is real, so this transform is also its
 * own inverse, up to a factor. The columns and lines of a half grid are transformed one by one, in
 * a work space that stays in the cache. */
struct ehd_deflection {
    ehd_grid grid;
    size_t length, period;  // lengths of the transforms along and across
    size_t lines;           // number of different lines of the transform across; on a half grid
                            // period / 2 + 1
    double *kernel;         // [grid lines, grid width]
    double *transfer;       // [lines, length / 2 + 1], transform of the kernel
    double *signal;         // Full grid: [lines, length] the pressure, padded with zeros, then the
                            // deflection. Half grid: [lines, grid width] the pressure transformed
                            // in y, then the transformed deflection
    fftw_complex *spectrum; // [lines, length / 2 + 1], transform of `signal`; NULL on a half grid
    fftw_plan forward, backward; // on a half grid these are the transforms of one line
    // for a half grid only:
    fftw_plan across;   // transform of one column
    team *threads;      // threads that share the transforms; NULL: one thread
    size_t work_size;   // numbers in the work space of one thread
    double *work_space; // [team_size, work_size]
};

// FFTW's planner is not thread-safe
static pthread_mutex_t planner_lock = PTHREAD_MUTEX_INITIALIZER;

/* Returns the smallest even 2^a 3^b 5^c that is at least `min_length`, for a fast transform. */
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

/* Returns the period of the circular convolution across. The period is at least twice the number of
 * lines of the full grid, so that the circular convolution equals the linear convolution. */
static size_t period_across(const ehd_grid *grid) {
    size_t lines = grid_lines(grid);

    return smooth_length(grid->half ? 4 * lines : 2 * lines);
}

static size_t spectrum_width(const ehd_deflection *self) {
    return self->length / 2 + 1;
}

/* Returns how many numbers a mirrored column has with its padding. A work space (work_size) has
 * room for COLUMNS such columns and the transform of one column, or for one line and its
 * transform. */
static size_t column_size(const ehd_deflection *self) {
    return self->period + APART;
}

static size_t work_size(const ehd_deflection *self) {
    const size_t columns = COLUMNS * column_size(self) + self->period + 2;
    const size_t line = self->length + APART + 2 * spectrum_width(self);

    return ((columns > line ? columns : line) / APART + 2) * APART;
}

static double *work_of(const ehd_deflection *self, const team_part *part) {
    return self->work_space + part->member * self->work_size;
}

static void make_plans(ehd_deflection *self) {
    const int sizes[2] = {(int)self->period, (int)self->length};
    double *work = self->work_space;

    // FFTW_ESTIMATE, because measured plans would differ from run to run, and round-off with them
    pthread_mutex_lock(&planner_lock);
    if (work) { // half grid: plans of one line and one column
        fftw_complex *line = (fftw_complex *)(work + self->length + APART);
        fftw_complex *column = (fftw_complex *)(work + COLUMNS * column_size(self));
        self->forward = fftw_plan_dft_r2c_1d(sizes[1], work, line, FFTW_ESTIMATE);
        self->backward = fftw_plan_dft_c2r_1d(sizes[1], line, work, FFTW_ESTIMATE);
        self->across = fftw_plan_dft_r2c_1d(sizes[0], work, column, FFTW_ESTIMATE);
    } else {
        const int rank = self->period == 1 ? 1 : 2;
        self->forward =
            fftw_plan_dft_r2c(rank, sizes + 2 - rank, self->signal, self->spectrum, FFTW_ESTIMATE);
        self->backward =
            fftw_plan_dft_c2r(rank, sizes + 2 - rank, self->spectrum, self->signal, FFTW_ESTIMATE);
    }
    pthread_mutex_unlock(&planner_lock);
}

/* Returns the distance, in nodes, between an index and the origin of a periodic signal. */
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

typedef struct kernel_task {
    const contact_kind *kind;
    ehd_deflection *of;
    double *signal; // [period, length] periodic and mirrored
} kernel_task;

/* Evaluates the kernel on one part of the lines 0 … period / 2. */
static void evaluate_kernel(void *context, const team_part *part) {
    const kernel_task *task = context;
    const ehd_deflection *self = task->of;
    const ehd_grid *grid = &self->grid;
    const size_t width = grid_width(grid);

    for (size_t l = part->first; l < part->end; l++) {
        double *line = task->signal + l * self->length;
        for (size_t d = 0; d < self->length; d++) {
            const size_t along = wrapped(d, self->length);
            line[d] = along < d ? line[along]
                                : deflection_influence(task->kind, grid, (double)d * grid->step,
                                                       (double)l * grid_step_across(grid));
        }
        if (l < grid_lines(grid)) memcpy(self->kernel + l * width, line, width * sizeof *line);
    }
}

/* Computes the transform of the kernel. Returns false when out of memory. */
static bool make_transfer(ehd_deflection *self, const contact_kind *kind) {
    const size_t wide = spectrum_width(self);
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
    kernel_task task = {kind, self, signal};
    if (plan) {
        team_share(self->threads, self->period / 2 + 1, LINES, evaluate_kernel, &task);
        for (size_t l = self->period / 2 + 1; l < self->period; l++)
            memcpy(signal + l * self->length, signal + (self->period - l) * self->length,
                   self->length * sizeof *signal);
        fftw_execute(plan);
    }
    for (size_t k = 0; k < self->lines * wide && plan; k++)
        self->transfer[k] = scale * spectrum[k][0];
    pthread_mutex_lock(&planner_lock);
    if (plan) fftw_destroy_plan(plan);
    pthread_mutex_unlock(&planner_lock);
    fftw_free(signal);
    fftw_free(spectrum);
    return plan != NULL;
}

ehd_deflection *deflection_create_shared(const contact_kind *kind, const ehd_grid *grid,
                                         team *threads) {
    ehd_deflection *self = calloc(1, sizeof *self);
    if (!self) return NULL;
    const size_t width = grid_width(grid);
    const bool half = kind->dimensions > 1 && grid->half;

    self->grid = *grid;
    self->threads = threads;
    self->length = smooth_length(2 * width);
    self->period = kind->dimensions > 1 ? period_across(grid) : 1;
    self->lines = half ? self->period / 2 + 1 : self->period;

    const size_t in_spectrum = self->lines * spectrum_width(self);
    self->kernel = malloc(grid->num_nodes * sizeof(double));
    self->transfer = malloc(in_spectrum * sizeof(double));
    self->signal = fftw_alloc_real(self->lines * (half ? width : self->length));
    if (half) {
        self->work_size = work_size(self);
        self->work_space = fftw_alloc_real(team_size(threads) * self->work_size);
    } else
        self->spectrum = fftw_alloc_complex(in_spectrum);
    if (!self->kernel || !self->transfer || !self->signal ||
        !(half ? (void *)self->work_space : (void *)self->spectrum))
        return deflection_free(self);
    make_plans(self);
    if (!self->forward || !self->backward || (half && !self->across) || !make_transfer(self, kind))
        return deflection_free(self);
    return self;
}

ehd_deflection *deflection_create(const contact_kind *kind, const ehd_grid *grid) {
    return deflection_create_shared(kind, grid, NULL);
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
        fftw_free(self->work_space);
        free(self->transfer);
        free(self->kernel);
        free(self);
    }
    return NULL;
}

const double *deflection_kernel(const ehd_deflection *self) {
    return self->kernel;
}

/* Context of a transform in y: from the lines of the half grid to the lines of the transform, or
 * back. */
typedef struct across_task {
    ehd_deflection *of;
    const double *from; // [num_from, grid width]
    double *to;         // [num_to, grid width]
    size_t num_from, num_to;
} across_task;

/* Transforms some columns in y. Each column is mirrored at its first line and at period / 2. */
static void transform_columns(void *context, const team_part *part) {
    const across_task *task = context;
    const ehd_deflection *self = task->of;
    const size_t width = grid_width(&self->grid), period = self->period, apart = column_size(self);
    const size_t count = part->end - part->first;
    double *columns = work_of(self, part);
    fftw_complex *wave = (fftw_complex *)(columns + COLUMNS * apart);

    for (size_t l = 0; l < task->num_from; l++)
        for (size_t c = 0; c < count; c++) {
            double *column = columns + c * apart;
            column[l] = task->from[l * width + part->first + c];
            if (l > 0) column[period - l] = column[l];
        }
    for (size_t c = 0; c < count; c++) {
        double *column = columns + c * apart;
        for (size_t l = task->num_from; l + task->num_from <= period; l++)
            column[l] = 0;
        fftw_execute_dft_r2c(self->across, column, wave);
        for (size_t l = 0; l < task->num_to; l++) // real, up to round-off
            column[l] = wave[l][0];
    }
    for (size_t l = 0; l < task->num_to; l++)
        for (size_t c = 0; c < count; c++)
            task->to[l * width + part->first + c] = columns[c * apart + l];
}

static void transform_across(ehd_deflection *self, double *to, size_t num_to, const double *from,
                             size_t num_from) {
    across_task task = {self, from, to, num_from, num_to};

    team_share(self->threads, grid_width(&self->grid), COLUMNS, transform_columns, &task);
}

static void filter(fftw_complex *spectrum, const double *transfer, size_t count) {
    for (size_t k = 0; k < count; k++) {
        spectrum[k][0] *= transfer[k];
        spectrum[k][1] *= transfer[k];
    }
}

/* Transforms some lines along x, multiplies them by the transform of the kernel, and transforms
 * them back. */
static void convolve_lines(void *context, const team_part *part) {
    const ehd_deflection *self = context;
    const size_t width = grid_width(&self->grid), wide = spectrum_width(self);
    double *line = work_of(self, part);
    fftw_complex *spectrum = (fftw_complex *)(line + self->length + APART);

    for (size_t l = part->first; l < part->end; l++) {
        memcpy(line, self->signal + l * width, width * sizeof *line);
        memset(line + width, 0, (self->length - width) * sizeof *line);
        fftw_execute_dft_r2c(self->forward, line, spectrum);
        filter(spectrum, self->transfer + l * wide, wide);
        fftw_execute_dft_c2r(self->backward, spectrum, line);
        memcpy(self->signal + l * width, line, width * sizeof *line);
    }
}

static void apply_to_half(double *delta, ehd_deflection *self, const double *pressure) {
    const size_t num_lines = grid_lines(&self->grid);

    transform_across(self, self->signal, self->lines, pressure, num_lines);
    team_share(self->threads, self->lines, LINES, convolve_lines, self);
    transform_across(self, delta, num_lines, self->signal, self->lines);
}

void deflection_apply(double *delta, ehd_deflection *self, const double *pressure) {
    const size_t width = grid_width(&self->grid), num_lines = grid_lines(&self->grid);

    if (self->across) {
        apply_to_half(delta, self, pressure);
        return;
    }
    memset(self->signal, 0, self->lines * self->length * sizeof(double));
    for (size_t l = 0; l < num_lines; l++)
        memcpy(self->signal + l * self->length, pressure + l * width, width * sizeof(double));
    fftw_execute(self->forward);
    filter(self->spectrum, self->transfer, self->lines * spectrum_width(self));
    fftw_execute(self->backward);
    for (size_t l = 0; l < num_lines; l++)
        memcpy(delta + l * width, self->signal + l * self->length, width * sizeof(double));
}
