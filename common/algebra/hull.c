/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/algebra/hull.h"

#include "common/algebra/nnls.h"
#include "common/program/arena.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct hull_space {
    size_t max_points;
    double *matrix, *x; // [HULL_AXES + 1, max_points], [max_points]
    nnls_space *nnls;
};

hull_space *hull_space_free(hull_space *self) {
    if (!self) return NULL;
    free(self->matrix);
    nnls_space_free(self->nnls);
    free(self);
    return NULL;
}

hull_space *hull_space_create(size_t max_points) {
    hull_space *self = calloc(1, sizeof *self);

    if (!self) return NULL;
    self->max_points = max_points;
    self->matrix = array_new(HULL_AXES + 2, max_points, sizeof *self->matrix);
    self->nnls = nnls_space_create(HULL_AXES + 1, max_points);
    if (!self->matrix || !self->nnls) return hull_space_free(self);
    self->x = self->matrix + (HULL_AXES + 1) * max_points;
    return self;
}

double hull_distance_in(hull_space *self, const double *points, size_t num_points, size_t num_axes,
                        const double *place) {
    const size_t num_rows = num_axes + 1;
    double *matrix = self->matrix, *x = self->x;
    double right[HULL_AXES + 1], square = 0;

    if (num_points > self->max_points) return INFINITY;
    memcpy(matrix, points, num_axes * num_points * sizeof *matrix);
    memcpy(right, place, num_axes * sizeof *right);
    right[num_axes] = 1;
    for (size_t i = 0; i < num_points; i++)
        matrix[num_axes * num_points + i] = 1;
    if (nnls_solve_in(x, self->nnls, matrix, right, num_rows, num_points, 1e-12, NULL))
        return INFINITY;
    for (size_t r = 0; r < num_rows; r++) {
        double left = right[r];
        for (size_t i = 0; i < num_points; i++)
            left -= matrix[r * num_points + i] * x[i];
        square += left * left;
    }
    return sqrt(square);
}

double hull_distance(const double *points, size_t num_points, size_t num_axes,
                     const double *place) {
    hull_space *space = hull_space_create(num_points);
    const double distance =
        space ? hull_distance_in(space, points, num_points, num_axes, place) : INFINITY;

    hull_space_free(space);
    return distance;
}
