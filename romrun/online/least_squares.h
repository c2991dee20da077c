/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The small overdetermined systems of the reduced Newton iteration (paper, eq. 28). */
#ifndef EHD_LEAST_SQUARES_H
#define EHD_LEAST_SQUARES_H

#include "common/program/status.h"
#include <stddef.h>

typedef struct least_squares least_squares;

least_squares *least_squares_create(size_t most_rows, size_t num_columns); // NULL: no memory
least_squares *least_squares_free(least_squares *workspace); // accepts and returns NULL

/* solution = argmin |matrix solution + right|. Columns that are zero (modes that the exit cut away
 * entirely) get a zero. Returns EHD_OK, or EHD_NOT_CONVERGED when the matrix is not finite or the
 * others are exactly dependent, such as more than there are rows. */
ehd_status least_squares_solve(
    // output:
    double *solution, // [num_columns]
    // input:
    least_squares *workspace, const double *matrix, // [num_rows, num_columns] row-major
    const double *right,                            // [num_rows]
    size_t num_rows);

/* Factors of the normal equations, for least_squares_again. EHD_NOT_CONVERGED: they are not safe. */
ehd_status least_squares_factorise(
    // in and out:
    least_squares *workspace,
    // input:
    const double *matrix, size_t num_rows); // [num_rows, num_columns]

/* solution = -(J^T J)^-1 matrix^T right, J of the last least_squares_solve or least_squares_factorise. With the
 * same matrix that is the least-squares solution; with one near it a step of an iteration whose fixed point is
 * that of `matrix` alone. EHD_NOT_CONVERGED: there are no factors of normal equations. */
ehd_status least_squares_again(
    // output:
    double *solution, // [num_columns]
    // input:
    const least_squares *workspace, const double *matrix, // [num_rows, num_columns]
    const double *right,                                  // [num_rows]
    size_t num_rows);

/* How far functional^T solution moves at most by a change of the right side of norm 1, for the matrix solved
 * with last: |(J^T J)^-1/2 functional|. With errors of equal size in all rows it is the standard error of
 * least squares, a unit of theirs. Infinite where the factors are singular. */
double least_squares_sensitivity(least_squares *workspace, const double *functional);

#endif
