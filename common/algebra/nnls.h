/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solves non-negative least squares problems by the method of active sets (Lawson and Hanson 1974).
 * Called by hull.c for distances, and by deimselect/cubature.c for weights of nodes. */
#ifndef EHD_NNLS_H
#define EHD_NNLS_H

#include "common/program/status.h"
#include <stddef.h>

/* Finds the x >= 0 that minimises |A x - b|, by active sets (C. L. Lawson, R. J. Hanson, Solving
 * Least Squares Problems, 1974, chapter 23). Let r = b - A x be the residual of the solution. A
 * column a of A whose x is positive (a column in use) has a^T r = 0. All other columns have a^T r
 * <= 0. Both conditions hold to 1e-9 |a| |b|. Columns of zeros are omitted. Columns that depend
 * linearly on the columns in use, to 1e-9 of their length, are omitted too. The iteration ends
 * earlier, with fewer columns in use, if |r| is at most tolerance |b|.
 *
 * Returns EHD_OK, EHD_DATA (a number is not finite), EHD_NOT_CONVERGED, EHD_MEMORY or EHD_INTERNAL.
 * EHD_NOT_CONVERGED: no solution was found within ten changes of the set of columns in use, per
 * column of A. *x is then non-negative, but not optimal. */
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
/* Like nnls_solve, but uses memory that the caller keeps between calls. Returns EHD_INTERNAL also
 * if this memory is too small. */
ehd_status nnls_solve_in(
    // output:
    double *x, // [num_columns]
    // in and out:
    nnls_space *space,
    // input:
    const double *matrix, const double *right, size_t num_rows, size_t num_columns,
    double tolerance, ehd_error *error);

#endif
