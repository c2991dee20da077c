/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/time/film_errors.h"

#include "common/algebra/natural_spline.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

double film_errors_place(size_t i) {
    return (double)i * 2 / (NUM_ERROR_PLACES - 1) - 1;
}

static void fit(film_errors *self) {
    double factor[NUM_ERROR_PLACES];

    spline_curvatures(self->curvature, factor, self->kept, NUM_ERROR_PLACES, 1, 1, false);
}

/* Positions of the fluid in the frame of `kept`: the fluid that is now at place i was at place
 * first + stretch i. */
typedef struct origins {
    double first, stretch;
} origins;

static origins origins_in(const contact_frame *then, const contact_frame *now) {
    const double half = (NUM_ERROR_PLACES - 1) / 2.0;
    const double stretch = frame_stretch(now, then);

    return (origins){half * (1 - stretch - frame_shift(now, then)), stretch};
}

/* Returns the kept error at `among`, the index of a place plus a fraction. */
static double kept_at(const film_errors *self, double among) {
    const spline_point at = spline_at(among, NUM_ERROR_PLACES);
    const double *value = self->kept + at.node, *curvature = self->curvature + at.node;

    return at.weight[0] * value[0] + at.weight[1] * curvature[0] + at.weight[2] * value[1] +
           at.weight[3] * curvature[1];
}

void film_errors_set(film_errors *self, const double *kept) {
    *self = (film_errors){0};
    if (kept) memcpy(self->kept, kept, sizeof self->kept);
    fit(self);
}

void film_errors_between(double errors[NUM_ERROR_PLACES], const double *film, const double *other,
                         const ehd_grid *grid, size_t end) {
    const size_t first = grid_central_line(grid);

    memset(errors, 0, NUM_ERROR_PLACES * sizeof *errors);
    for (size_t k = first; k < first + end; k++) {
        const double among = (grid_x(grid, k) + 1) / 2 * (NUM_ERROR_PLACES - 1);
        const double here = fabs(film[k] - other[k]);
        if (!(among >= 0 && among < NUM_ERROR_PLACES - 1)) continue;
        const size_t below = (size_t)among;
        errors[below] = fmax(errors[below], here);
        errors[below + 1] = fmax(errors[below + 1], here);
    }
}

void film_errors_carry(film_errors *self, const contact_frame *then, const contact_frame *now) {
    const origins from = origins_in(then, now);
    const double ratio = frame_film_ratio(now, then), last = NUM_ERROR_PLACES - 1;

    for (size_t i = 0; i < NUM_ERROR_PLACES; i++) {
        const double among = from.first + from.stretch * (double)i;
        self->next[i] = among >= 0 && among <= last ? ratio * kept_at(self, among) : 0;
    }
}

void film_errors_enter(film_errors *self, const contact_frame *then, const contact_frame *now,
                       double x, double value) {
    const origins from = then ? origins_in(then, now) : (origins){0, 1};

    for (size_t i = 0; i < NUM_ERROR_PLACES; i++) {
        const bool entered = film_errors_place(i) < x || from.first + from.stretch * (double)i < 0;
        // a spline may be negative between positive values
        self->next[i] = entered ? value : fmax(self->next[i], 0);
    }
}

void film_errors_add(film_errors *self, double factor, const double *errors, const double *x,
                     size_t num) {
    size_t k = 0;

    for (size_t i = 0; i < NUM_ERROR_PLACES && num > 1; i++) {
        if (film_errors_place(i) < x[0]) continue;
        while (k + 1 < num && x[k + 1] < film_errors_place(i))
            k++;
        if (k + 1 == num) return;
        const double part = (film_errors_place(i) - x[k]) / (x[k + 1] - x[k]);
        self->next[i] += factor * ((1 - part) * errors[k] + part * errors[k + 1]);
    }
}

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
