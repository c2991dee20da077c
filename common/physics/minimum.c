/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/minimum.h"

#include <math.h>

/* Minimum of the quartic through five values one apart, near the middle one; NaN where there is
 * none within the five. */
static double minimum_of_five(const double *value) {
    // Taylor coefficients at the middle
    const double first = (value[0] - 8 * value[1] + 8 * value[3] - value[4]) / 12;
    const double second =
        (-value[0] + 16 * value[1] - 30 * value[2] + 16 * value[3] - value[4]) / 24;
    const double third = (-value[0] + 2 * value[1] - 2 * value[3] + value[4]) / 12;
    const double fourth = (value[0] - 4 * value[1] + 6 * value[2] - 4 * value[3] + value[4]) / 24;
    double t = 0;

    // Newton's iteration for the zero of the slope; a film has one minimum within a few nodes
    for (int i = 0; i < 20; i++) {
        double slope = first + t * (2 * second + t * (3 * third + t * 4 * fourth));
        double curvature = 2 * second + t * (6 * third + t * 12 * fourth);
        if (!(curvature > 0)) return NAN;
        t -= slope / curvature;
        if (!(fabs(t) <= 2)) return NAN;
        if (fabs(slope) < 1e-14 * curvature) break;
    }
    return value[2] + t * (first + t * (second + t * (third + t * fourth)));
}

/* The same around a node of a line; NaN where there is none. */
static double minimum_along(size_t node, double (*value)(const void *context, size_t node),
                            const void *context) {
    double values[5];

    for (size_t i = 0; i < 5; i++)
        values[i] = value(context, node - 2 + i);
    return minimum_of_five(values);
}

double minimum_around(const ehd_grid *grid, size_t node,
                      double (*value)(const void *context, size_t node), const void *context) {
    const size_t width = grid_width(grid), line = node / width, column = node % width;
    const double nodal = value(context, node);

    if (grid->discretization == DISCRETIZATION_PUBLISHED) return nodal;
    if (column < 2 || column + 2 >= width) return nodal;
    const double here = minimum_along(node, value, context);
    if (isnan(here)) return nodal;
    if (grid->inner_lines == 1) return here;
    if (line + 1 >= grid_lines(grid) || (line == 0 && !grid->half)) return here;
    const double right = minimum_along(node + width, value, context);
    const double left = minimum_along(line == 0 ? node + width : node - width, value, context);
    const double curvature = left - 2 * here + right, slope = (right - left) / 2;
    const bool inside = curvature > 0 && fabs(slope) <= curvature; // within a line of this one
    return inside ? here - slope * slope / (2 * curvature) : here;
}
