/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reduces a matrix to triangular form by reflections (Householder 1958), and solves least squares
 * problems.
 * Called by nnls.c, by common/physics/far_angle.c and by romrun/solve/least_squares.c. */
#ifndef EHD_QR_H
#define EHD_QR_H

#include <stddef.h>

/* A reflection 1 + factor v v^T. */
typedef struct reflection {
    const double *direction; // v, [count]
    double factor;
    double end; // first number of the reflected column, whose other numbers are zero
} reflection;

/* Returns the reflection that turns the vector `column` onto the first axis. */
reflection reflection_of(
    // output:
    double *direction, // [count]
    // input:
    const double *column, // [count]
    size_t count,
    double length); // length of the column, above 0

/* Applies a reflection to a column. */
void reflect(double *column, const reflection *by, size_t count);

/* Replaces a matrix by R of its QR factorisation, with zeros below the diagonal. A column b that is
 * appended to the matrix, such as a right side, becomes Q^T b. */
void qr_reduce(
    // in and out:
    double *columns, // [num_columns, num_rows], by columns
    // output:
    double *direction, // [num_rows]
    // input:
    size_t num_rows, size_t num_columns);

/* Finds the x that minimises |A x - b|. x is not finite if a column of A depends exactly on the
 * columns before it. Replaces [A b] by [R Q^T b]. */
void qr_solve(
    // output:
    double *x, // [num_columns]
    // in and out:
    double *columns, // [num_columns + 1, num_rows], by columns
    // output:
    double *direction, // [num_rows]
    // input:
    size_t num_rows, // at least num_columns
    size_t num_columns);

#endif
