/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Starts from the trained solutions, and the range that was trained. */
#include "romrun/reduced_solver.h"

#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { NUM_NEIGHBOURS = 6 };

/* Place of a contact among the training points: the film follows M and the viscosity's rise in
 * powers, so logarithms make neighbours alike. */
static void place_of(double place[2], double moes_M, double alpha_p_H) {
    place[0] = log(moes_M);
    place[1] = 0.5 * log1p(alpha_p_H);
}

typedef struct neighbour {
    size_t state;
    double distance, away[2];
} neighbour;

/* The nearest states further away than `beyond`, ascending in distance; returns their number. */
static size_t nearest_states(neighbour *nearest, const reduced_states *states, const double here[2],
                             double beyond) {
    size_t count = 0;

    for (size_t s = 0; s < states->num_states; s++) {
        double there[2];
        place_of(there, states->moes_M[s], states->alpha_p_H[s]);
        neighbour fresh = {s,
                           hypot(there[0] - here[0], there[1] - here[1]),
                           {there[0] - here[0], there[1] - here[1]}};
        if (!(fresh.distance > beyond) ||
            (count == NUM_NEIGHBOURS && fresh.distance >= nearest[count - 1].distance))
            continue;
        size_t i = count < NUM_NEIGHBOURS ? count++ : count - 1;
        for (; i > 0 && nearest[i - 1].distance > fresh.distance; i--)
            nearest[i] = nearest[i - 1];
        nearest[i] = fresh;
    }
    return count;
}

/* Weights of the neighbours in an affine fit through them, taken at the wanted place (moving least
 * squares). Returns 0 where they do not span a plane or the fit would extrapolate. */
static int affine_weights(double *weights, const neighbour *nearest, size_t count) {
    double normal[9] = {0}, unit[3] = {1, 0, 0}, largest = 0;

    if (count < 3) return 0;
    for (size_t i = 0; i < count; i++) {
        double term[3] = {1, nearest[i].away[0], nearest[i].away[1]};
        double strength = 1 / (nearest[i].distance * nearest[i].distance + 1e-6);
        for (int p = 0; p < 3; p++)
            for (int q = 0; q < 3; q++)
                normal[3 * p + q] += strength * term[p] * term[q];
    }
    if (LAPACKE_dposv_work(LAPACK_COL_MAJOR, 'L', 3, 1, normal, 3, unit, 3)) return 0;
    for (size_t i = 0; i < count; i++) {
        double strength = 1 / (nearest[i].distance * nearest[i].distance + 1e-6);
        weights[i] =
            strength * (unit[0] + unit[1] * nearest[i].away[0] + unit[2] * nearest[i].away[1]);
        largest = fmax(largest, fabs(weights[i]));
    }
    return largest < 1.5;
}

/* state = sum of weights[i] times the states given. */
static void combine_states(reduced_state *state, const reduced_model *model,
                           const neighbour *nearest, const double *weights, size_t count) {
    const reduced_states *states = &model->states;
    size_t n = model->num_unknowns;
    double exit = 0;

    memset(state->coordinates, 0, n * sizeof(double));
    for (size_t i = 0; i < count; i++) {
        const double *source = states->coordinates + nearest[i].state * n;
        exit += weights[i] * (double)states->exit[nearest[i].state];
        for (size_t j = 0; j < n; j++)
            state->coordinates[j] += weights[i] * source[j];
    }
    exit = fmin(fmax(exit, (double)model->least_exit), (double)model->most_exit);
    state->exit = (size_t)lround(exit);
}

void reduced_guess(reduced_state *state, const reduced_model *model, double moes_M,
                   double alpha_p_H) {
    neighbour nearest[NUM_NEIGHBOURS];
    double here[2], weights[NUM_NEIGHBOURS], one = 1;

    place_of(here, moes_M, alpha_p_H);
    size_t count = nearest_states(nearest, &model->states, here, -1);
    if (affine_weights(weights, nearest, count))
        combine_states(state, model, nearest, weights, count);
    else
        combine_states(state, model, nearest, &one, 1);
}

void reduced_neighbour(reduced_state *state, const reduced_model *model, double moes_M,
                       double alpha_p_H) {
    const double same = 1e-9;
    neighbour nearest[NUM_NEIGHBOURS];
    double here[2], one = 1;

    place_of(here, moes_M, alpha_p_H);
    if (nearest_states(nearest, &model->states, here, same) > 0)
        combine_states(state, model, nearest, &one, 1);
    else
        reduced_guess(state, model, moes_M, alpha_p_H);
}

// ---- trained range

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

int reduced_trained(const reduced_model *model, double moes_M, double alpha_p_H) {
    const double slack = 1e-9; // of the extent, so that training points themselves count as inside
    size_t num = model->states.num_states;
    point *points = malloc((2 * num + 2) * sizeof *points);
    int inside = 1;

    if (!points) return 0;
    for (size_t s = 0; s < num; s++) {
        point trained = {model->states.moes_M[s], model->states.alpha_p_H[s]};
        points[s] = trained;
    }
    point *hull = points + num, wanted = {moes_M, alpha_p_H};
    size_t count = num ? convex_hull(hull, points, num) : 0;
    for (size_t i = 0; i < count; i++) {
        point a = hull[i], b = hull[(i + 1) % count];
        double size = hypot(b.M - a.M, b.pressure - a.pressure) + 1;
        if (turn(a, b, wanted) < -slack * size * size) inside = 0;
    }
    free(points);
    return count > 2 && inside;
}
