/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solves the overdetermined systems of the reduced Newton iteration (Maier et al. (2015), eq. 28;
 * README.md, Normal equations).
 * Called by reduced_solver.c in each iteration, by kept_factors.c, and by functionals.c and
 * reduced_tangent.c. */
#ifndef EHD_LEAST_SQUARES_H
#define EHD_LEAST_SQUARES_H

#include "common/program/status.h"
#include <stddef.h>

typedef struct least_squares least_squares;

least_squares *least_squares_create(size_t max_rows, size_t num_columns); // NULL: no memory
least_squares *least_squares_free(least_squares *workspace); // accepts and returns NULL

/* Computes solution = argmin |matrix solution + right|. The solution is zero for zero columns
 * (modes that lie behind the exit). EHD_NOT_CONVERGED: the matrix is not finite, or the non-zero
 * columns are exactly dependent, for example if there are more columns than rows. */
ehd_status least_squares_solve(
    // output:
    double *solution, // [num_columns]
    // input:
    least_squares *workspace, const double *matrix, // [num_rows, num_columns] row-major
    const double *right,                            // [num_rows]
    size_t num_rows);

/* Factorises the normal equations by Cholesky, for least_squares_again. EHD_NOT_CONVERGED: the
 * factors would not be accurate enough. */
ehd_status least_squares_factorise(
    // in and out:
    least_squares *workspace,
    // input:
    const double *matrix, size_t num_rows); // [num_rows, num_columns]

/* Computes solution = -(J^T J)^-1 matrix^T right with the J of the last least_squares_solve or
 * least_squares_factorise. If J is `matrix`, this is the least-squares solution. If J is only near
 * `matrix`, this is a step of an iteration whose fixed point depends on `matrix` alone.
 * EHD_NOT_CONVERGED: J was factorised by QR, or the solution is not finite. */
ehd_status least_squares_again(
    // output:
    double *solution, // [num_columns]
    // input:
    const least_squares *workspace, const double *matrix, // [num_rows, num_columns]
    const double *right,                                  // [num_rows]
    size_t num_rows);

/* Computes dual = (J^T J)^-1 functional for the last factorised J. Entry r of J dual is the change
 * of functional^T solution caused by an error of 1 in row r. The result is not finite if the
 * factors are singular. */
void least_squares_dual(
    // output:
    double *dual, // [num_columns]
    // input:
    least_squares *workspace, const double *functional); // [num_columns]

/* Replaces each of `num` functionals by its dual. */
void least_squares_duals(
    // in and out:
    double *functionals, // [num, num_columns]
    least_squares *workspace, size_t num);

#endif
