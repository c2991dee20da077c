/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes natural cubic splines through nodes at equal distances, by the tridiagonal equations of
 * their second derivatives.
 * Called by common/time/film_errors.c and by romrun/state/film_splines.c. */
#ifndef EHD_NATURAL_SPLINE_H
#define EHD_NATURAL_SPLINE_H

#include <stdbool.h>
#include <stddef.h>

/* Computes the curvatures of `width` splines from their values at `num` nodes. A curvature is the
 * second derivative times d^2 / 6, where d is the distance between two nodes. Values of
 * neighbouring nodes are `stride` numbers apart. The equation is
 *
 *     curvature[k-1] + 4 curvature[k] + curvature[k+1] = second difference of the values
 *
 * On input `curvatures` holds the curvatures at the last node. Unless the splines are `even`, it
 * also holds the curvatures at the first node. Curvatures of 0 give natural splines. An `even`
 * spline is mirrored at the first node. `factor` is a work array [num]. The function is inline
 * because a single spline otherwise takes 2.6 times as many instructions. */
static inline void spline_curvatures(double *curvatures, double *factor, const double *values,
                                     size_t num, size_t stride, size_t width, bool even) {
    factor[0] = even ? 0.5 : 0; // if even: 2 curvature[0] + curvature[1] = value[1] - value[0]
    for (size_t j = 0; j < width && even; j++)
        curvatures[j] = 0.5 * (values[stride + j] - values[j]);
    for (size_t k = 1; k + 1 < num; k++) {
        const double *value = values + k * stride, *before = value - stride;
        double *curvature = curvatures + k * stride;
        factor[k] = 1 / (4 - factor[k - 1]);
        for (size_t j = 0; j < width; j++)
            curvature[j] = factor[k] * (before[j] - 2 * value[j] + value[stride + j] -
                                        curvatures[(k - 1) * stride + j]);
    }
    for (size_t k = num - 1; k-- > (even ? 0 : 1);)
        for (size_t j = 0; j < width; j++)
            // NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult): all set above
            curvatures[k * stride + j] -= factor[k] * curvatures[(k + 1) * stride + j];
}

enum { NUM_SPLINE_WEIGHTS = 4 };

/* A point between the nodes `node` and node + 1. The spline at this point is a weighted sum of four
 * numbers, in this order: value and curvature at `node`, value and curvature at node + 1. */
typedef struct spline_point {
    size_t node;
    double weight[NUM_SPLINE_WEIGHTS];
} spline_point;

/* Returns the point at a distance of `nodes` node spacings from the first of `num` nodes. Beyond
 * the first and the last node the spline is linear. */
static inline spline_point spline_at(double nodes, size_t num) {
    size_t last = num - 2;
    size_t first = nodes < (double)last ? nodes > 0 ? (size_t)nodes : 0 : last;
    double b = nodes - (double)first, a = 1 - b;
    spline_point at = {first, {a, (a * a - 1) * a, b, (b * b - 1) * b}};

    if (b < 0)
        at.weight[1] = -2 * b, at.weight[3] = -b;
    else if (a < 0)
        at.weight[1] = -a, at.weight[3] = -2 * a;
    return at;
}

#endif
