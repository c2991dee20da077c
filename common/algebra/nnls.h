/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solves non-negative least squares by active sets (Lawson and Hanson 1974).
 * Called by hull.c for distances, and by deimselect/cubature.c for weights of nodes. */
#ifndef EHD_NNLS_H
#define EHD_NNLS_H

#include "common/program/status.h"
#include <stddef.h>

/* Solves min |A x - b|, x >= 0, by active sets (C. L. Lawson, R. J. Hanson, Solving Least Squares
 * Problems, 1974, chapter 23). At the solution, with the residual r = b - A x, columns with x > 0
 * have a^T r = 0 and all others a^T r <= 0, to 1e-11 of |a| |b|. Columns of zeros are omitted, and
 * so are columns that depend on the columns in use to 1e-10 of their length. The iteration ends
 * earlier, with fewer columns in use, if |r| is at most tolerance |b|.
 *
 * EHD_DATA: a number that is not finite. EHD_NOT_CONVERGED: no solution after ten changes per
 * column; *x is then not negative, but not optimal. EHD_MEMORY, EHD_INTERNAL. */
ehd_status nnls_solve(
    // output:
    double *x, // [num_columns]
    // input:
    const double *matrix, // A [num_rows, num_columns]
    const double *right,  // b [num_rows]
    size_t num_rows, size_t num_columns, double tolerance, ehd_error *error);

/* Memory for nnls_solve_in with at most max_rows rows and max_columns columns. */
typedef struct nnls_space nnls_space;
nnls_space *nnls_space_create(size_t max_rows, size_t max_columns); // NULL when out of memory
nnls_space *nnls_space_free(nnls_space *space);                     // accepts and returns NULL
/* Like nnls_solve, but in memory that is kept. EHD_INTERNAL also if the memory is too small. */
ehd_status nnls_solve_in(
    // output:
    double *x, // [num_columns]
    // in and out:
    nnls_space *space,
    // input:
    const double *matrix, const double *right, size_t num_rows, size_t num_columns,
    double tolerance, ehd_error *error);

#endif
