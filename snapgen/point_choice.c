/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "snapgen/point_choice.h"

#include "common/algebra/hull.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

// ---- corners

typedef struct hull {
    const double (*places)[RANGE_AXES];
    size_t num_points;
    double tolerance;
    size_t *corners;
    size_t count;
} hull;

/* Returns how far a point lies to the left of the line from one corner to another. If both corners
 * have equal coordinates, returns the distance from them. */
static double distance_outside(const hull *self, size_t from, size_t to, size_t point) {
    const double *a = self->places[from], *b = self->places[to], *p = self->places[point];
    double along[2] = {b[0] - a[0], b[1] - a[1]}, there[2] = {p[0] - a[0], p[1] - a[1]};
    double length = hypot(along[0], along[1]);

    if (length == 0) return hypot(there[0], there[1]);
    return (along[0] * there[1] - along[1] * there[0]) / length;
}

/* Adds all corners that lie to the left of the line from one known corner to another. */
static void add_between(hull *self, size_t from, size_t to) {
    size_t furthest = NO_PARENT;
    double farthest = self->tolerance;

    for (size_t i = 0; i < self->num_points; i++) {
        double outside = distance_outside(self, from, to, i);
        if (outside > farthest) {
            farthest = outside;
            furthest = i;
        }
    }
    if (furthest == NO_PARENT) return;
    self->corners[self->count++] = furthest;
    add_between(self, from, furthest);
    add_between(self, furthest, to);
}

static size_t corners_in_plane(hull self) {
    const double(*places)[RANGE_AXES] = self.places;
    size_t first = 0, last = 0, *corners = self.corners, num_points = self.num_points;

    for (size_t i = 1; i < num_points; i++) {
        const double *place = places[i], *low = places[first], *high = places[last];
        if (place[0] < low[0] || (place[0] == low[0] && place[1] < low[1])) first = i;
        if (place[0] > high[0] || (place[0] == high[0] && place[1] > high[1])) last = i;
    }
    corners[self.count++] = first;
    if (last == first) return self.count;
    corners[self.count++] = last;
    add_between(&self, first, last);
    add_between(&self, last, first);
    return self.count;
}

static bool is_plane(const hull *self) {
    for (size_t i = 1; i < self->num_points; i++)
        for (int axis = 2; axis < RANGE_AXES; axis++)
            if (self->places[i][axis] != self->places[0][axis]) return false;
    return true;
}

/* For each coordinate, adds the first point with the smallest value and the first point with the
 * largest value. */
static void add_extremes(hull *self) {
    for (int axis = 0; axis < RANGE_AXES; axis++) {
        size_t least = 0, most = 0;
        for (size_t i = 1; i < self->num_points; i++) {
            if (self->places[i][axis] < self->places[least][axis]) least = i;
            if (self->places[i][axis] > self->places[most][axis]) most = i;
        }
        self->corners[self->count++] = least;
        self->corners[self->count++] = most;
    }
}

static void drop_repeated(hull *self) {
    size_t count = 0;

    for (size_t i = 0; i < self->count; i++) {
        size_t j = 0;
        while (j < count && self->corners[j] != self->corners[i])
            j++;
        if (j == count) self->corners[count++] = self->corners[i];
    }
    self->count = count;
}

/* Repeatedly adds the point that lies furthest outside the hull of the corners, until no point lies
 * outside. `outside` [num_points] and `columns` [RANGE_AXES, num_points] are scratch memory. */
static void add_furthest(hull *self, double *outside, double *columns) {
    const double *origin = self->places[0];
    size_t furthest = 0;

    for (size_t i = 0; i < self->num_points; i++)
        outside[i] = INFINITY;
    for (; furthest != NO_PARENT && self->count < self->num_points;) {
        for (size_t c = 0; c < self->count; c++)
            for (int axis = 0; axis < RANGE_AXES; axis++)
                columns[(size_t)axis * self->count + c] =
                    self->places[self->corners[c]][axis] - origin[axis];
        furthest = NO_PARENT;
        for (size_t i = 0; i < self->num_points; i++) {
            double here[RANGE_AXES];
            if (!(outside[i] > self->tolerance)) continue; // inside the hull, and stays inside
            for (int axis = 0; axis < RANGE_AXES; axis++)
                here[axis] = self->places[i][axis] - origin[axis];
            outside[i] = hull_distance(columns, self->count, RANGE_AXES, here);
            if (outside[i] > self->tolerance &&
                (furthest == NO_PARENT || outside[i] > outside[furthest]))
                furthest = i;
        }
        if (furthest != NO_PARENT) self->corners[self->count++] = furthest;
    }
}

size_t point_choice_corners(size_t *corners, const double (*places)[RANGE_AXES], size_t num_points,
                            double tolerance) {
    hull self = {places, num_points, tolerance, corners, 0};

    if (num_points == 0) return 0;
    if (is_plane(&self)) return corners_in_plane(self);
    double *memory = malloc((1 + RANGE_AXES) * num_points * sizeof *memory);
    size_t *extremes = malloc(2 * RANGE_AXES * sizeof *extremes);
    if (memory && extremes) {
        self.corners = extremes; // a separate array: `corners` may be shorter
        add_extremes(&self);
        drop_repeated(&self);
        for (size_t i = 0; i < self.count; i++)
            corners[i] = extremes[i];
        self.corners = corners;
        add_furthest(&self, memory, memory + num_points);
    }
    free(memory);
    free(extremes);
    return self.count;
}

// ---- worst

typedef struct nearness {
    double *trained; // [num_points] distance to the nearest point trained before
    double *chosen;  // [num_points] distance to the nearest point chosen in this call
    double scale[TREE_AXES];
} nearness;

static void approach(double *nearest, const candidates *from, const double scale[TREE_AXES],
                     size_t point) {
    for (size_t i = 0; i < from->num_points; i++)
        nearest[i] = fmin(nearest[i], tree_distance(&from->points[i], &from->points[point], scale));
}

/* Checks whether candidate i is chosen before candidate j. */
static bool is_worse(const candidates *from, const nearness *near, size_t i, size_t j) {
    if (from->indicated[i] != from->indicated[j]) return from->indicated[i] > from->indicated[j];
    return fmin(near->trained[i], near->chosen[i]) > fmin(near->trained[j], near->chosen[j]);
}

/* Returns the candidate with the largest error estimate (is_worse) among the candidates that are
 * far enough from the candidates chosen in this call: the distance is at least `part` times the
 * distance from the points trained before. Returns NO_PARENT if there is no such candidate.
 * `known`: considers only candidates with a finite error estimate. */
static size_t worst(const candidates *from, const nearness *near, double part, bool known) {
    size_t best = NO_PARENT;

    for (size_t i = 0; i < from->num_points; i++) {
        // a chosen candidate has the distance 0 to itself
        bool far = near->chosen[i] > 0 && near->chosen[i] >= part * near->trained[i];
        if (from->trained[i] || !far || !(from->indicated[i] > from->accuracy)) continue;
        if (known && !isfinite(from->indicated[i])) continue;
        if (best == NO_PARENT || is_worse(from, near, i, best)) best = i;
    }
    return best;
}

/* Calls `worst` with part = 1, then with half of the previous part, until it returns a candidate.
 * Stops at DBL_EPSILON, so that two candidates that differ only by round-off are not both chosen.
 * Then returns NO_PARENT. */
static size_t furthest_worst(const candidates *from, const nearness *near, bool known) {
    size_t found = NO_PARENT;

    for (double part = 1; part > DBL_EPSILON && found == NO_PARENT; part /= 2)
        found = worst(from, near, part, known);
    return found;
}

ehd_status point_choice_worst(size_t *chosen, size_t *num_chosen, const candidates *from,
                              size_t max_chosen, ehd_error *error) {
    size_t count = 0;
    nearness near = {malloc((from->num_points + 1) * sizeof(double)),
                     malloc((from->num_points + 1) * sizeof(double)),
                     {1, 1, 1}};
    ehd_status status = EHD_OK;

    if (!near.trained || !near.chosen) status = ehd_no_memory(error, "choice");
    tree_scale(near.scale, from->points, from->num_points);
    for (size_t i = 0; i < from->num_points && !status; i++)
        near.trained[i] = near.chosen[i] = INFINITY;
    for (size_t i = 0; i < from->num_points && !status; i++)
        if (from->trained[i]) approach(near.trained, from, near.scale, i);
    while (count < max_chosen && !status) {
        size_t next = NO_PARENT;
        if (count % 2 == 1) next = furthest_worst(from, &near, true);
        if (next == NO_PARENT) next = furthest_worst(from, &near, false);
        if (next == NO_PARENT) break;
        chosen[count++] = next;
        approach(near.chosen, from, near.scale, next);
    }
    *num_chosen = count;
    free(near.trained);
    free(near.chosen);
    return status;
}
