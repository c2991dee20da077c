/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/minimum.h"

#include <math.h>

/* Returns the minimum, near the middle, of the quartic through five values at the places -2 … 2.
 * NaN: there is no minimum between these places. */
static double minimum_of_five(const double *value) {
    // Taylor coefficients at the middle value
    const double first = (value[0] - 8 * value[1] + 8 * value[3] - value[4]) / 12;
    const double second =
        (-value[0] + 16 * value[1] - 30 * value[2] + 16 * value[3] - value[4]) / 24;
    const double third = (-value[0] + 2 * value[1] - 2 * value[3] + value[4]) / 12;
    const double fourth = (value[0] - 4 * value[1] + 6 * value[2] - 4 * value[3] + value[4]) / 24;
    double t = 0;

    // Newton's iteration for the zero of the slope. Within a few nodes a film has only one minimum
    for (int i = 0; i < 20; i++) {
        double slope = first + t * (2 * second + t * (3 * third + t * 4 * fourth));
        double curvature = 2 * second + t * (6 * third + t * 12 * fourth);
        if (!isgreater(curvature, 0)) return NAN;
        t -= slope / curvature;
        if (!(fabs(t) <= 2)) return NAN;
        if (fabs(slope) < 1e-14 * curvature) break;
    }
    return value[2] + t * (first + t * (second + t * (third + t * fourth)));
}

typedef struct film {
    double (*value)(const void *context, size_t node);
    const void *context;
    size_t width; // nodes in a line of the grid
} film;

static double film_at(const film *self, size_t node) {
    return self->value(self->context, node);
}

/* Descends along the line from a node to a minimum of the film, and returns the node of this
 * minimum. The first two and the last two nodes of the line are skipped. */
static size_t lowest_along(const film *self, size_t node) {
    const size_t first = node - node % self->width + 2, last = first + self->width - 5;

    while (node < last && film_at(self, node + 1) < film_at(self, node))
        node++;
    while (node > first && film_at(self, node - 1) < film_at(self, node))
        node--;
    return node;
}

/* Returns the minimum along the line around a node, or NaN if there is no minimum. */
static double minimum_along(const film *self, size_t node) {
    double values[5];

    for (size_t i = 0; i < 5; i++)
        values[i] = film_at(self, node - 2 + i);
    return minimum_of_five(values);
}

/* Finds the minima on five lines: the line of a node, and two lines on either side. From line to
 * line the search follows the valley through the node. The minimum of a missing line is NaN. */
static void follow_valley(double minima[5], const film *self, const ehd_grid *grid, size_t node) {
    const size_t lines = grid_lines(grid), line = node / self->width;

    minima[2] = minimum_along(self, node);
    for (int side = -1; side <= 1; side += 2) {
        size_t at = node, here = line;
        int towards = side; // direction of the search; reverses at a mirror line
        for (int apart = 1; apart <= 2; apart++) {
            double *minimum = &minima[2 + side * apart];
            *minimum = NAN;
            if (here == 0 && towards < 0 && grid->half) towards = 1;
            if ((here == 0 && towards < 0) || (here + 1 == lines && towards > 0)) continue;
            here = towards > 0 ? here + 1 : here - 1;
            at = towards > 0 ? at + self->width : at - self->width;
            at = lowest_along(self, at);
            *minimum = minimum_along(self, at);
        }
    }
}

double minimum_around(const ehd_grid *grid, size_t node,
                      double (*value)(const void *context, size_t node), const void *context) {
    const film self = {value, context, grid_width(grid)};
    const size_t column = node % self.width;
    const double nodal = value(context, node);
    double minima[5];

    if (grid->discretization == DISCRETIZATION_PUBLISHED) return nodal;
    if (column < 2 || column + 2 >= self.width) return nodal;
    const double here = minimum_along(&self, node);
    if (isnan(here)) return nodal;
    if (grid->inner_lines == 1) return here;
    follow_valley(minima, &self, grid, node);
    const double across = minimum_of_five(minima);
    return isnan(across) ? here : across;
}
