/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/algebra/hull.h"

#include "common/algebra/nnls.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

double hull_distance(const double *points, size_t num_points, size_t num_axes,
                     const double *place) {
    const size_t num_rows = num_axes + 1;
    double *matrix = malloc((num_rows + 1) * num_points * sizeof *matrix);
    double right[HULL_AXES + 1], square = INFINITY;

    if (!matrix) return INFINITY;
    double *x = matrix + num_rows * num_points;
    memcpy(matrix, points, num_axes * num_points * sizeof *matrix);
    memcpy(right, place, num_axes * sizeof *right);
    right[num_axes] = 1;
    for (size_t i = 0; i < num_points; i++)
        matrix[num_axes * num_points + i] = 1;
    if (!nnls_solve(x, matrix, right, num_rows, num_points, 1e-12, NULL)) {
        square = 0;
        for (size_t r = 0; r < num_rows; r++) {
            double left = right[r];
            for (size_t i = 0; i < num_points; i++)
                left -= matrix[r * num_points + i] * x[i];
            square += left * left;
        }
    }
    free(matrix);
    return sqrt(square);
}
