/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/online/trained_range.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

void trained_place(double place[2], double moes_M, double alpha_p_H) {
    const double least = 1e-3; // below, the viscosity rises by less than a thousandth

    place[0] = log(moes_M);
    place[1] = log(fmax(alpha_p_H, least));
}

typedef struct point {
    double M, pressure;
} point;

static int compare_points(const void *a, const void *b) {
    const point *p = a, *q = b;

    if (p->M != q->M) return p->M < q->M ? -1 : 1;
    return (p->pressure > q->pressure) - (p->pressure < q->pressure);
}

static double turn(point a, point b, point c) {
    return (b.M - a.M) * (c.pressure - a.pressure) - (b.pressure - a.pressure) * (c.M - a.M);
}

/* Convex hull by the monotone chain, counter-clockwise; `hull` has room for num + 1 points. */
static size_t convex_hull(point *hull, point *points, size_t num) {
    size_t count = 0;

    qsort(points, num, sizeof *points, compare_points);
    for (size_t i = 0; i < num; i++) {
        while (count >= 2 && turn(hull[count - 2], hull[count - 1], points[i]) <= 0)
            count--;
        hull[count++] = points[i];
    }
    size_t lower = count + 1;
    for (size_t i = num - 1; i-- > 0;) {
        while (count >= lower && turn(hull[count - 2], hull[count - 1], points[i]) <= 0)
            count--;
        hull[count++] = points[i];
    }
    return count > 1 ? count - 1 : count;
}

/* From a corner of the hull to the next one. */
typedef struct hull_edge {
    point start, direction; // of length 1
    double length;
} hull_edge;

struct trained_range {
    hull_edge *edges; // [count], counter-clockwise, in units of `extent`
    size_t count;
    point low, high; // of all points, in units of `extent`: rounding makes slivers of lines, which
                     // have no end
    point extent;
    double slack; // how far outside of the hull still counts as inside, in units of the extent
    double max_rate;
};

trained_range *trained_range_free(trained_range *self) {
    if (self) {
        free(self->edges);
        free(self);
    }
    return NULL;
}

static point place_of(double moes_M, double alpha_p_H) {
    double place[2];

    trained_place(place, moes_M, alpha_p_H);
    return (point){place[0], place[1]};
}

static point in_units(point place, const trained_range *self) {
    return (point){place.M / self->extent.M, place.pressure / self->extent.pressure};
}

static void find_extent(trained_range *self, const reduced_states *states) {
    point low = {INFINITY, INFINITY}, high = {-INFINITY, -INFINITY};
    bool stationary = true;

    for (size_t s = 0; s < states->num_states; s++) {
        const point here = place_of(states->moes_M[s], states->alpha_p_H[s]);
        low.M = fmin(low.M, here.M);
        high.M = fmax(high.M, here.M);
        low.pressure = fmin(low.pressure, here.pressure);
        high.pressure = fmax(high.pressure, here.pressure);
        self->max_rate = fmax(self->max_rate, states->rate[s]);
        stationary = stationary && states->stationary[s];
    }
    self->extent.M = high.M > low.M ? high.M - low.M : 1;
    self->extent.pressure = high.pressure > low.pressure ? high.pressure - low.pressure : 1;
    self->low = in_units(low, self);
    self->high = in_units(high, self);
    // training points count as inside, and so does what lies between the few states that are kept
    // of a trajectory, which is a curve
    self->slack = stationary ? 1e-9 : 2e-3;
}

static hull_edge edge_between(point a, point b) {
    double length = hypot(b.M - a.M, b.pressure - a.pressure), scale = 1 / fmax(length, 1e-300);

    return (hull_edge){a, {(b.M - a.M) * scale, (b.pressure - a.pressure) * scale}, length};
}

trained_range *trained_range_create(const reduced_model *model) {
    const reduced_states *states = &model->states;
    size_t num = states->num_states;
    trained_range *self = calloc(1, sizeof *self);
    point *points = malloc((num + 1) * sizeof *points), *hull = malloc((num + 2) * sizeof *hull);

    if (self) self->edges = malloc((num + 2) * sizeof *self->edges);
    if (self && self->edges && points && hull) {
        find_extent(self, states);
        for (size_t s = 0; s < num; s++)
            points[s] = in_units(place_of(states->moes_M[s], states->alpha_p_H[s]), self);
        self->count = num ? convex_hull(hull, points, num) : 0;
        for (size_t i = 0; i < self->count; i++)
            self->edges[i] = edge_between(hull[i], hull[(i + 1) % self->count]);
    } else {
        self = trained_range_free(self);
    }
    free(points);
    free(hull);
    return self;
}

/* Distance of a point to the right of an edge or, of a hull of two points, beyond its ends. */
static double outside_edge(const hull_edge *edge, point wanted, bool line) {
    point from = {wanted.M - edge->start.M, wanted.pressure - edge->start.pressure};
    double across = from.M * edge->direction.pressure - from.pressure * edge->direction.M;
    double along = from.M * edge->direction.M + from.pressure * edge->direction.pressure;

    return line ? fmax(across, along - edge->length) : across;
}

const char *trained_range_check(const trained_range *self, double moes_M, double alpha_p_H,
                                double rate) {
    const double rate_slack = 1.05, min_rate = 1e-3;
    const point wanted = in_units(place_of(moes_M, alpha_p_H), self), low = self->low,
                high = self->high;
    bool line = self->count <= 2;
    double outside = fmax(fmax(low.M - wanted.M, wanted.M - high.M),
                          fmax(low.pressure - wanted.pressure, wanted.pressure - high.pressure));

    if (self->count < 2) outside = INFINITY;
    for (size_t i = 0; i < self->count; i++) {
        double here = outside_edge(&self->edges[i], wanted, line);
        outside = here > outside ? here : outside;
    }
    if (!(outside <= self->slack)) return "outside of the trained range of M and alpha p_H";
    if (rate > fmax(rate_slack * self->max_rate, min_rate))
        return "a contact that changes faster than any in training";
    return NULL;
}
