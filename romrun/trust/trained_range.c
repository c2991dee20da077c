/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/trust/trained_range.h"

#include "common/algebra/hull.h"
#include "common/algebra/rounding.h"
#include "common/program/arena.h"
#include "romrun/trust/known_lubricants.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

_Static_assert((int)RANGE_AXES <= (int)HULL_AXES, "axes of a hull");

void trained_place(double place[RANGE_AXES], contact_place of) {
    // Smaller values of alpha p_H are replaced by this value. Below it the viscosity rises by less
    // than a thousandth (README.md, Results that are rejected).
    const double least = 1e-3;

    place[0] = log(of.moes_M);
    place[1] = log(fmax(of.alpha_p_H, least));
    place[2] = thinning_coordinate(of.thinning.sliding);
    place[3] = gradient_coordinate(of.thinning.gradient);
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

/* Finds the convex hull by the monotone chain, counter-clockwise. `hull` has space for num + 1
 * points. Returns the number of its corners. */
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

/* An edge from a corner of the hull to the next one. */
typedef struct hull_edge {
    point start, direction; // `direction` has length 1
    double length;
} hull_edge;

/* Axes of the thinning of the flow. */
enum { FIRST_THINNED = 2, NUM_THINNED = RANGE_AXES - FIRST_THINNED };

typedef struct thinning_range {
    double least, most; // smallest and largest coordinate in training
} thinning_range;

struct trained_range {
    hull_edge *edges; // [count], counter-clockwise, in units of `extent`
    size_t count;
    // limits of all points, in units of `extent`. They are needed if all points lie on a straight
    // line: because of round-off, the edges of the hull may then not bound the range along it
    point low, high;
    point extent;
    double slack;     // distance outside of the hull accepted as inside, in units of `extent`
    frame_rates most; // largest trained rates of change
    thinning_range by[NUM_THINNED];
    size_t num_points, num_outer;
    double *points; // [RANGE_AXES, num_points] training points, divided by the extents; NULL: all
                    // flows of the training are Newtonian
    double *outer;  // [RANGE_AXES, num_outer] training points farthest out in some direction
    known_lubricants *lubricants;
    arena memory;
};

struct range_memory {
    hull_space *hull;
    lubricant_memory *lubricants;
};

trained_range *trained_range_free(trained_range *self) {
    if (self) {
        arena_free(&self->memory);
        known_lubricants_free(self->lubricants);
        free(self);
    }
    return NULL;
}

static contact_place place_of_state(const reduced_states *states, size_t state) {
    return (contact_place){.moes_M = states->moes_M[state],
                           .alpha_p_H = states->alpha_p_H[state],
                           .thinning = states->thinning[state]};
}

static point point_of(const double place[RANGE_AXES]) {
    return (point){place[0], place[1]};
}

static point point_of_state(const reduced_states *states, size_t state) {
    double place[RANGE_AXES];

    trained_place(place, place_of_state(states, state));
    return point_of(place);
}

static point in_units(point place, const trained_range *self) {
    return (point){place.M / self->extent.M, place.pressure / self->extent.pressure};
}

static void find_extent(trained_range *self, const reduced_states *states) {
    point low = {INFINITY, INFINITY}, high = {-INFINITY, -INFINITY};
    bool stationary = true;

    for (size_t s = 0; s < states->num_states; s++) {
        const point here = point_of_state(states, s);
        low.M = fmin(low.M, here.M);
        high.M = fmax(high.M, here.M);
        low.pressure = fmin(low.pressure, here.pressure);
        high.pressure = fmax(high.pressure, here.pressure);
        self->most.all = fmax(self->most.all, states->rate[s]);
        self->most.load = fmax(self->most.load, states->load_rate[s]);
        stationary = stationary && states->stationary[s];
    }
    self->extent.M = high.M > low.M ? high.M - low.M : 1;
    self->extent.pressure = high.pressure > low.pressure ? high.pressure - low.pressure : 1;
    self->low = in_units(low, self);
    self->high = in_units(high, self);
    // The smaller slack accepts the training points themselves. A trajectory is a curve of which
    // only a few states are stored; the larger slack also accepts the points between these states.
    self->slack = stationary ? ROUNDING : 2e-3;
}

/* Writes a place, relative to the lower limits and divided by the extents, as a column. */
static void put_column(double *column, size_t stride, const double place[RANGE_AXES],
                       const trained_range *self) {
    const point here = in_units(point_of(place), self);

    column[0] = here.M - self->low.M;
    column[stride] = here.pressure - self->low.pressure;
    for (size_t t = 0; t < NUM_THINNED; t++) {
        const double width = self->by[t].most - self->by[t].least;
        column[(FIRST_THINNED + t) * stride] =
            (place[FIRST_THINNED + t] - self->by[t].least) / (width > 0 ? width : 1);
    }
}

/* Returns the index of the training point that lies farthest out in a direction. */
static size_t farthest(const trained_range *self, const int direction[RANGE_AXES]) {
    double most = -INFINITY;
    size_t found = 0;

    for (size_t i = 0; i < self->num_points; i++) {
        double along = 0;
        for (size_t axis = 0; axis < RANGE_AXES; axis++)
            along += direction[axis] * self->points[axis * self->num_points + i];
        if (!(along > most)) continue;
        most = along;
        found = i;
    }
    return found;
}

/* Fills self->outer with the training points farthest out along the axes and the diagonals. A point
 * may occur several times. Checks first use the hull of these few points, because most places
 * inside of the range lie inside of this hull. A check with all points takes 293 thousand
 * instructions for a model of 188 states. */
static void list_outer(trained_range *self) {
    size_t num = 1, count = 0;

    for (size_t axis = 0; axis < RANGE_AXES; axis++)
        num *= 3;
    self->num_outer = num - 1; // without the zero direction
    self->outer = arena_table(&self->memory, RANGE_AXES, self->num_outer, sizeof *self->outer);
    for (size_t code = 0; code < num && self->outer; code++) {
        int direction[RANGE_AXES], length = 0;
        size_t rest = code;
        for (size_t axis = 0; axis < RANGE_AXES; axis++, rest /= 3) {
            direction[axis] = (int)(rest % 3) - 1;
            length += abs(direction[axis]);
        }
        if (length == 0) continue;
        const size_t i = farthest(self, direction);
        for (size_t axis = 0; axis < RANGE_AXES; axis++)
            self->outer[axis * self->num_outer + count] = self->points[axis * self->num_points + i];
        count++;
    }
}

/* Fills self->by and, if flows of the training are thinned, self->points and self->outer. */
static void list_thinned(trained_range *self, const reduced_states *states) {
    const size_t num = states->num_states;
    double place[RANGE_AXES];

    for (size_t t = 0; t < NUM_THINNED; t++)
        self->by[t] = (thinning_range){INFINITY, -INFINITY};
    for (size_t s = 0; s < num; s++) {
        trained_place(place, place_of_state(states, s));
        for (size_t t = 0; t < NUM_THINNED; t++) {
            self->by[t].least = fmin(self->by[t].least, place[FIRST_THINNED + t]);
            self->by[t].most = fmax(self->by[t].most, place[FIRST_THINNED + t]);
        }
    }
    if (!(self->by[0].most > thinning_coordinate(0) || self->by[1].most > gradient_coordinate(0)))
        return;
    self->num_points = num;
    self->points = arena_table(&self->memory, RANGE_AXES, num, sizeof *self->points);
    for (size_t s = 0; s < num && self->points; s++) {
        trained_place(place, place_of_state(states, s));
        put_column(self->points + s, num, place, self);
    }
    if (self->points) list_outer(self);
}

static hull_edge edge_between(point a, point b) {
    double length = hypot(b.M - a.M, b.pressure - a.pressure), scale = 1 / fmax(length, 1e-300);

    return (hull_edge){a, {(b.M - a.M) * scale, (b.pressure - a.pressure) * scale}, length};
}

trained_range *trained_range_create(const reduced_model *model) {
    const reduced_states *states = &model->states;
    size_t num = states->num_states;
    trained_range *self = calloc(1, sizeof *self);
    arena work = {0};

    if (!self) return NULL;
    point *points = arena_array(&work, num, sizeof *points);
    point *hull = arena_array(&work, num + 2, sizeof *hull);
    self->edges = arena_array(&self->memory, num + 2, sizeof *self->edges);
    self->lubricants = known_lubricants_create(model);
    const bool whole = self->edges && self->lubricants && !work.failed;
    if (whole) {
        find_extent(self, states);
        for (size_t s = 0; s < num; s++)
            points[s] = in_units(point_of_state(states, s), self);
        self->count = num ? convex_hull(hull, points, num) : 0;
        for (size_t i = 0; i < self->count; i++)
            self->edges[i] = edge_between(hull[i], hull[(i + 1) % self->count]);
        list_thinned(self, states);
    }
    arena_free(&work);
    return whole && !self->memory.failed ? self : trained_range_free(self);
}

/* Returns how far a point lies to the right of an edge or, for a hull of two points, beyond the
 * edge's end. */
static double outside_edge(const hull_edge *edge, point wanted, bool line) {
    point from = {wanted.M - edge->start.M, wanted.pressure - edge->start.pressure};
    double across = from.M * edge->direction.pressure - from.pressure * edge->direction.M;
    double along = from.M * edge->direction.M + from.pressure * edge->direction.pressure;

    return line ? fmax(across, along - edge->length) : across;
}

/* Returns how far outside of the hull of M and alpha p_H a place lies, in units of the extent. */
static double outside_plane(const trained_range *self, const double place[RANGE_AXES]) {
    const point wanted = in_units(point_of(place), self), low = self->low, high = self->high;
    bool line = self->count <= 2;
    double outside = fmax(fmax(low.M - wanted.M, wanted.M - high.M),
                          fmax(low.pressure - wanted.pressure, wanted.pressure - high.pressure));

    if (self->count < 2) outside = INFINITY;
    for (size_t i = 0; i < self->count; i++) {
        double here = outside_edge(&self->edges[i], wanted, line);
        outside = here > outside ? here : outside;
    }
    return outside;
}

range_memory *range_memory_free(range_memory *self) {
    if (!self) return NULL;
    hull_space_free(self->hull);
    lubricant_memory_free(self->lubricants);
    free(self);
    return NULL;
}

range_memory *range_memory_create(const trained_range *of) {
    const size_t num_points = of->points ? of->num_points : 1;
    range_memory *self = calloc(1, sizeof *self);

    if (!self) return NULL;
    self->hull = hull_space_create(num_points > of->num_outer ? num_points : of->num_outer);
    self->lubricants = lubricant_memory_create(of->lubricants);
    return self->hull && self->lubricants ? self : range_memory_free(self);
}

static bool is_faster(double rate, double trained) {
    // `slack`: factor on the trained rate, since the trained rate is a mean between two states.
    // `least`: rate per unit of T that is accepted for any contact (README.md, Error estimates in
    // time).
    const double slack = 1.05, least = 1e-3;

    return rate > fmax(slack * trained, least);
}

static const char *const thinned_less[NUM_THINNED] = {
    "a flow that is thinned less than any in training",
    "a flow that the pressure gradient thins less than any in training"};
static const char *const thinned_more[NUM_THINNED] = {
    "a flow that is thinned more than any in training",
    "a flow that the pressure gradient thins more than any in training"};

static const char *check(const trained_range *self, range_memory *memory, contact_place of,
                         const frame_rates *rates) {
    double place[RANGE_AXES], here[RANGE_AXES];

    trained_place(place, of);
    for (size_t t = 0; t < NUM_THINNED; t++) {
        if (place[FIRST_THINNED + t] < self->by[t].least - self->slack) return thinned_less[t];
        if (place[FIRST_THINNED + t] > self->by[t].most + self->slack) return thinned_more[t];
    }
    if (!(outside_plane(self, place) <= self->slack))
        return "outside of the trained range of M and alpha p_H";
    if (self->points) {
        put_column(here, 1, place, self);
        // accepts candidates that adaptive training (snapgen/adaptive.c) did not take as corners of
        // the hull, since they lie outside of the hull of the corners only by round-off
        const double slack = fmax(self->slack, 1e-8);
        if (!(hull_distance_in(memory->hull, self->outer, self->num_outer, RANGE_AXES, here) <=
              slack) &&
            !(hull_distance_in(memory->hull, self->points, self->num_points, RANGE_AXES, here) <=
              slack))
            return "outside of the trained range of M, alpha p_H and thinning";
    }
    const char *lubricant = of.lubricant
                                ? known_lubricants_check(self->lubricants, memory->lubricants,
                                                         of.lubricant, rates != NULL)
                                : NULL;
    if (lubricant) return lubricant;
    if (rates && is_faster(rates->all, self->most.all))
        return "a contact that changes faster than any in training";
    if (rates && is_faster(rates->load, self->most.load))
        return "a load that changes faster than any in training";
    return NULL;
}

const char *trained_range_check(const trained_range *self, range_memory *memory, contact_place of,
                                const frame_rates *rates) {
    range_memory *own = memory ? NULL : range_memory_create(self);

    if (!memory && !own) return "no memory to compare the contact with the training";
    const char *reason = check(self, memory ? memory : own, of, rates);
    if (own && reason == lubricant_memory_reason(own->lubricants))
        reason = "a lubricant that is not in training";
    range_memory_free(own);
    return reason;
}

/* Returns how far outside of the box around the training points a place lies, in the coordinates of
 * trained_place. */
static double outside_box(const trained_range *self, const double place[RANGE_AXES]) {
    const double low[] = {self->low.M * self->extent.M, self->low.pressure * self->extent.pressure,
                          self->by[0].least, self->by[1].least};
    const double high[] = {self->high.M * self->extent.M,
                           self->high.pressure * self->extent.pressure, self->by[0].most,
                           self->by[1].most};
    double outside = 0;

    for (int axis = 0; axis < RANGE_AXES; axis++)
        outside = fmax(outside, fmax(low[axis] - place[axis], place[axis] - high[axis]));
    return outside;
}

double trained_range_outside(const trained_range *self, range_memory *memory, contact_place of) {
    double place[RANGE_AXES];

    trained_place(place, of);
    const double of_plane = outside_plane(self, place);
    if (!trained_range_check(self, memory, of, NULL)) return fmin(of_plane, 0);
    // for a place inside of the box but outside of the hull: the distance from the hull, converted
    // from units of the extents by the smaller extent
    const double beside = fmin(self->extent.M, self->extent.pressure) * of_plane;
    return fmax(fmax(outside_box(self, place), beside), DBL_MIN);
}
