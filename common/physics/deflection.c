/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/deflection.h"

#include <complex.h>
#include <fftw3.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

struct ehd_deflection {
    size_t num_nodes;
    size_t length;          // of the circular convolution, >= 2 num_nodes - 1
    double *kernel;         // [num_nodes]
    double *transfer;       // [length/2 + 1], transform of the kernel (real: it is even), / length
    double *signal;         // [length]
    fftw_complex *spectrum; // [length/2 + 1]
    fftw_plan forward, backward;
};

static pthread_mutex_t planner_lock =
    PTHREAD_MUTEX_INITIALIZER; // FFTW's planner is not thread-safe

/* Smallest even 2^a 3^b 5^c that is at least `least`. */
static size_t smooth_length(size_t least) {
    for (size_t length = least + (least & 1);; length += 2) {
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

ehd_deflection *deflection_create(const contact_kind *kind, const ehd_grid *grid) {
    ehd_deflection *self = calloc(1, sizeof *self);
    if (!self) return NULL;
    size_t n = self->num_nodes = grid->num_nodes;
    size_t length = self->length = smooth_length(2 * n);

    self->kernel = malloc(n * sizeof(double));
    self->transfer = malloc((length / 2 + 1) * sizeof(double));
    self->signal = fftw_alloc_real(length);
    self->spectrum = fftw_alloc_complex(length / 2 + 1);
    if (!self->kernel || !self->transfer || !self->signal || !self->spectrum)
        return deflection_free(self);

    // an estimated plan, not a measured one: the same bits at every run
    pthread_mutex_lock(&planner_lock);
    self->forward = fftw_plan_dft_r2c_1d((int)length, self->signal, self->spectrum, FFTW_ESTIMATE);
    self->backward = fftw_plan_dft_c2r_1d((int)length, self->spectrum, self->signal, FFTW_ESTIMATE);
    pthread_mutex_unlock(&planner_lock);
    if (!self->forward || !self->backward) return deflection_free(self);

    memset(self->signal, 0, length * sizeof(double));
    for (size_t d = 0; d < n; d++) {
        self->kernel[d] = kind->kernel((double)d * grid->step, grid->step);
        self->signal[d] = self->kernel[d];
        if (d > 0) self->signal[length - d] = self->kernel[d];
    }
    fftw_execute(self->forward);
    for (size_t k = 0; k <= length / 2; k++)
        self->transfer[k] = creal(self->spectrum[k]) / (double)length;
    return self;
}

ehd_deflection *deflection_free(ehd_deflection *self) {
    if (self) {
        pthread_mutex_lock(&planner_lock);
        if (self->forward) fftw_destroy_plan(self->forward);
        if (self->backward) fftw_destroy_plan(self->backward);
        pthread_mutex_unlock(&planner_lock);
        fftw_free(self->spectrum);
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
    size_t n = self->num_nodes;

    memcpy(self->signal, pressure, n * sizeof(double));
    memset(self->signal + n, 0, (self->length - n) * sizeof(double));
    fftw_execute(self->forward);
    for (size_t k = 0; k <= self->length / 2; k++)
        self->spectrum[k] *= self->transfer[k];
    fftw_execute(self->backward);
    memcpy(delta, self->signal, n * sizeof(double));
}
