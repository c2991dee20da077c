/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Least squares whose unknowns are not negative. */
#ifndef EHD_NNLS_H
#define EHD_NNLS_H

#include "common/program/status.h"
#include <stddef.h>

/* min |A x - b|, x >= 0, by active sets (C. L. Lawson, R. J. Hanson, Solving Least Squares
 * Problems, 1974, chapter 23): with the residual r = b - A x, columns with x > 0 have a^T r = 0 and
 * all others a^T r <= 0, to 1e-11 of |a| |b|. Columns that depend on those in use to 1e-10 of their
 * length are left out, as columns of zeros are. It ends before, with fewer columns in use, where
 * |r| is at most tolerance |b|. EHD_DATA: a number that is not finite; EHD_NOT_CONVERGED: still not
 * there after ten changes a column, *x is then not negative but not the best; EHD_MEMORY,
 * EHD_INTERNAL. */
ehd_status nnls_solve(
    // output:
    double *x, // [num_columns]
    // input:
    const double *matrix, // A [num_rows, num_columns]
    const double *right,  // b [num_rows]
    size_t num_rows, size_t num_columns, double tolerance, ehd_error *error);

/* The same in memory that is kept, of problems of at most so many rows and columns; NULL: there is none.
 * EHD_INTERNAL also of a larger one. */
typedef struct nnls_space nnls_space;
nnls_space *nnls_space_create(size_t max_rows, size_t max_columns);
nnls_space *nnls_space_free(nnls_space *space); // accepts and returns NULL
ehd_status nnls_solve_in(
    // output:
    double *x, // [num_columns]
    // in and out:
    nnls_space *space,
    // input:
    const double *matrix, const double *right, size_t num_rows, size_t num_columns,
    double tolerance, ehd_error *error);

#endif
