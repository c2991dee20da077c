/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the Cholesky factorisation of symmetric positive definite matrices with a few hundred
 * rows, in blocks of rows. Solves linear systems with the factor.
 * Called by least_squares.c and guess.c in romrun/solve, and by romrun/model/start_shift.c. */
#ifndef EHD_CHOLESKY_H
#define EHD_CHOLESKY_H

#include <stdbool.h>
#include <stddef.h>

/* Replaces the lower triangle of a matrix, stored by columns, by its Cholesky factor L. The matrix
 * is L L^T. The numbers above the diagonal are not read and are undefined afterwards. Returns false
 * for a matrix that is not positive definite, or not finite. */
bool cholesky_factorise(double *matrix, // [size, size]
                        size_t size);

/* Replaces x by (L L^T)^-1 x. */
void cholesky_solve(
    // output:
    double *x, // [size]
    // input:
    const double *factor, // L, [size, size] lower triangle by columns
    size_t size);

#endif
