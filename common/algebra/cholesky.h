/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cholesky factors of symmetric positive definite matrices of a few hundred rows. */
#ifndef EHD_CHOLESKY_H
#define EHD_CHOLESKY_H

#include <stdbool.h>
#include <stddef.h>

/* Replaces the lower part of a matrix, by columns, by its factor L with L L^T = matrix. The part
 * above the diagonal is not read, and has no meaning afterwards. Returns false for a matrix that is
 * not positive definite, or not finite. */
bool cholesky_factorise(double *matrix, // [size, size]
                        size_t size);

/* Replaces x by (L L^T)^-1 x. */
void cholesky_solve(
    // output:
    double *x, // [size]
    // input:
    const double *factor, // L, [size, size] lower part by columns
    size_t size);

#endif
