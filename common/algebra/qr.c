/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/algebra/qr.h"

#include "common/algebra/vectors.h"

#include <math.h>
#include <string.h>

reflection reflection_of(double *direction, const double *column, size_t count, double length) {
    // Source: range of a double. Squares of lengths between these limits neither underflow nor
    // overflow.
    const double least = 0x1p-500, most = 0x1p500;
    const double end = column[0] > 0 ? -length : length;
    double size = length;

    memcpy(direction, column, count * sizeof *direction);
    direction[0] -= end;
    if (length < least || length > most) { // the square of the length underflows or overflows
        const int most_exponent = 1000;    // Source: range of a double; 2^1000 is finite
        const int exponent = -ilogb(length);
        const double scale = ldexp(1, exponent < most_exponent ? exponent : most_exponent);
        vector_scale(direction, scale, count);
        size *= scale;
    }
    return (reflection){direction, -1 / (size * fabs(direction[0])), end}; // -2/|v|^2
}

void reflect(double *column, const reflection *by, size_t count) {
    axpy(column, by->factor * dot(by->direction, column, count), by->direction, count);
}

void qr_reduce(double *columns, double *direction, size_t num_rows, size_t num_columns) {
    for (size_t j = 0; j < num_columns && j + 1 < num_rows; j++) {
        double *column = columns + j * num_rows + j;
        const size_t left = num_rows - j;
        const double length = vector_norm(column, left);
        if (length == 0) continue;
        const reflection by = reflection_of(direction, column, left, length);
        for (size_t k = 1; k < num_columns - j; k++)
            reflect(column + k * num_rows, &by, left);
        memset(column, 0, left * sizeof *column);
        *column = by.end;
    }
}

void qr_solve(double *x, double *columns, double *direction, size_t num_rows, size_t num_columns) {
    qr_reduce(columns, direction, num_rows, num_columns + 1);
    memcpy(x, columns + num_columns * num_rows, num_columns * sizeof *x);
    for (size_t j = num_columns; j-- > 0;) {
        x[j] /= columns[j * num_rows + j];
        axpy(x, -x[j], columns + j * num_rows, j);
    }
}
