/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/online/film_errors.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

static double place(size_t i) {
    return (double)i * 2 / (NUM_ERROR_PLACES - 1) - 1;
}

static void fit(film_errors *self) {
    double x[NUM_ERROR_PLACES];

    for (size_t i = 0; i < NUM_ERROR_PLACES; i++)
        x[i] = place(i);
    spline_fit(self->spline, x, self->kept);
}

ehd_status film_errors_init(film_errors *self, ehd_error *error) {
    self->spline = spline_create(NUM_ERROR_PLACES);
    if (!self->spline) return ehd_fail(error, EHD_MEMORY, "errors of films: found no memory");
    film_errors_set(self, NULL);
    return EHD_OK;
}

void film_errors_free(film_errors *self) {
    self->spline = spline_free(self->spline);
}

void film_errors_set(film_errors *self, const double *kept) {
    memset(self->kept, 0, sizeof self->kept);
    memset(self->next, 0, sizeof self->next);
    if (kept) memcpy(self->kept, kept, sizeof self->kept);
    fit(self);
}

void film_errors_carry(film_errors *self, const contact_frame *then, const contact_frame *now) {
    const double stretch = frame_stretch(now, then), shift = frame_shift(now, then);
    const double ratio = frame_film_ratio(now, then);

    for (size_t i = 0; i < NUM_ERROR_PLACES; i++) {
        const double x = stretch * place(i) - shift;
        self->next[i] = fabs(x) <= 1 ? ratio * spline_at(self->spline, x) : 0;
    }
}

void film_errors_enter(film_errors *self, const contact_frame *then, const contact_frame *now,
                       double x, double value) {
    const double stretch = then ? frame_stretch(now, then) : 1;
    const double shift = then ? frame_shift(now, then) : 0;

    for (size_t i = 0; i < NUM_ERROR_PLACES; i++) {
        const bool entered = place(i) < x || stretch * place(i) - shift < -1;
        self->next[i] = entered ? value : fmax(self->next[i], 0); // splines overshoot
    }
}

void film_errors_add(film_errors *self, double factor, const double *errors, const double *x,
                     size_t num) {
    size_t k = 0;

    for (size_t i = 0; i < NUM_ERROR_PLACES && num > 1; i++) {
        if (place(i) < x[0]) continue;
        while (k + 1 < num && x[k + 1] < place(i))
            k++;
        if (k + 1 == num) return;
        const double part = (place(i) - x[k]) / (x[k + 1] - x[k]);
        self->next[i] += factor * ((1 - part) * errors[k] + part * errors[k + 1]);
    }
}

/* The place nearest to X. */
static size_t nearest_place(double x) {
    const double last = NUM_ERROR_PLACES - 1;

    return (size_t)round(fmin(fmax((x + 1) * last / 2, 0), last));
}

double film_errors_largest(const film_errors *self, double from, double to) {
    double largest = 0;

    for (size_t i = nearest_place(from); i <= nearest_place(to); i++)
        largest = fmax(largest, self->next[i]);
    return largest;
}

double film_errors_at(const film_errors *self, double x) {
    const double among = (x + 1) * (NUM_ERROR_PLACES - 1) / 2;
    const size_t last = NUM_ERROR_PLACES - 1;

    if (!(fabs(x) <= 1)) return 0;
    const size_t i = among < (double)last ? (size_t)among : last - 1;
    const double part = among - (double)i;
    return (1 - part) * self->next[i] + part * self->next[i + 1];
}

void film_errors_keep(film_errors *self) {
    memcpy(self->kept, self->next, sizeof self->kept);
    fit(self);
}
