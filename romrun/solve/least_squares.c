/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solves normal equations with scaled columns, at a fifth of the cost of QR. If the Cholesky
 * factors are not accurate enough, QR is used. The normal equations have the squared condition
 * number, but this affects only the speed of convergence: the limit of Newton's iteration is given
 * by J^T f = 0, which is computed from J itself. */
#include "romrun/solve/least_squares.h"

#include "common/algebra/cholesky.h"
#include "common/algebra/product.h"
#include "common/algebra/qr.h"
#include "common/program/arena.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

struct least_squares {
    size_t num_columns;
    double *scale;      // [num_columns] 1 / norm of the column
    double *scaled;     // [num_columns + 1, longest] scaled columns and right side, for QR
    double *gram;       // [num_columns, num_columns] Gram matrix, then its lower factor
    size_t factor_size; // order of the factor; with QR the number of columns that are not zero
    bool by_qr;         // true: the factor comes from QR
    double *right;      // [longest]
    double *direction;  // [longest] work of qr_solve
    arena memory;
};

/* Reciprocal condition number of the Gram matrix below which QR is used. Measured on random
 * matrices: if the condition number of the matrix is 1e6, the error of the solution is 1e-5. At
 * 1e7, where this limit lies, the error is up to 1e-3. At 1e8 no digit is right
 * (test_least_squares.c, qr_takes_over_where_normal_equations_fail; docs/history.md,
 * conditioning). */
static const double MIN_RCOND = 1e-13;

least_squares *least_squares_free(least_squares *self) {
    if (self) arena_free(&self->memory);
    free(self);
    return NULL;
}

least_squares *least_squares_create(size_t max_rows, size_t num_columns) {
    least_squares *self = calloc(1, sizeof *self);
    if (!self) return NULL;
    size_t longest = max_rows > num_columns ? max_rows : num_columns;
    arena *memory = &self->memory;
    self->num_columns = num_columns;
    self->scale = arena_array(memory, num_columns, sizeof(double));
    self->scaled = arena_table(memory, num_columns + 1, longest, sizeof(double));
    self->gram = arena_array(memory, num_columns * num_columns, sizeof(double));
    self->right = arena_array(memory, longest, sizeof(double));
    self->direction = arena_array(memory, longest, sizeof(double));
    return memory->failed ? least_squares_free(self) : self;
}

/* Scales the columns to unit norm and computes the lower part of their Gram matrix. Zero columns
 * get the scale zero. Columns that are not finite get the scale NaN, so that no solution is found.
 * With the scale zero for these columns, the other columns would still have a solution. */
static void scaled_gram(least_squares *self, const double *matrix, size_t num_rows) {
    size_t n = self->num_columns;

    gram_matrix(self->gram, matrix, num_rows, n);
    for (size_t j = 0; j < n; j++) {
        double square = self->gram[j * n + j];
        self->scale[j] = square == 0 ? 0 : isfinite(square) ? 1 / sqrt(square) : NAN;
    }
    for (size_t j = 0; j < n; j++) {
        for (size_t i = j + 1; i < n; i++)
            self->gram[j * n + i] *= self->scale[i] * self->scale[j];
        if (isfinite(self->gram[j * n + j])) self->gram[j * n + j] = 1;
    }
}

/* Factorises the Gram matrix by Cholesky. Returns 0 if the matrix is not positive definite, or if
 * its condition number is too large (MIN_RCOND). */
static int factorise_gram(least_squares *self, const double *matrix, size_t num_rows) {
    int n = (int)self->num_columns;
    double norm, rcond = 0;

    scaled_gram(self, matrix, num_rows);
    norm = n; // columns have unit norm, so the 1-norm is at most n
    if (!cholesky_factorise(self->gram, self->num_columns)) return 0;
    // the diagonal of the factor gives a cheap one-sided bound of the condition number
    double smallest = INFINITY, largest = 0;
    for (int j = 0; j < n; j++) {
        smallest = fmin(smallest, self->gram[j * n + j]);
        largest = fmax(largest, self->gram[j * n + j]);
    }
    self->by_qr = false;
    self->factor_size = self->num_columns;
    rcond = smallest * smallest / (largest * largest * norm);
    return rcond > MIN_RCOND;
}

static void solve_gram(double *solution, const least_squares *self, const double *matrix,
                       const double *right, size_t num_rows) {
    const size_t n = self->num_columns;

    memset(solution, 0, n * sizeof *solution);
    add_transposed_product(solution, -1, matrix, num_rows, n, right);
    for (size_t j = 0; j < n; j++)
        solution[j] *= self->scale[j];
    cholesky_solve(solution, self->gram, n);
}

/* Fills `scaled` with the scaled columns that are not zero, and then with the right side. Returns
 * the number of columns, without the right side. */
static size_t fill_scaled(least_squares *self, const double *matrix, const double *right,
                          size_t num_rows) {
    const size_t n = self->num_columns;
    double *target = self->scaled;
    size_t kept = 0;

    for (size_t j = 0; j < n; j++) {
        if (!(self->scale[j] > 0)) continue;
        for (size_t r = 0; r < num_rows; r++)
            *target++ = matrix[r * n + j] * self->scale[j];
        kept++;
    }
    for (size_t r = 0; r < num_rows; r++)
        *target++ = -right[r];
    return kept;
}

/* Solves by QR of the scaled matrix without its zero columns. The solution is NaN if there are
 * fewer rows than columns. */
static void solve_qr(double *solution, least_squares *self, const double *matrix,
                     const double *right, size_t num_rows) {
    const size_t n = self->num_columns, kept = fill_scaled(self, matrix, right, num_rows);
    const bool solvable = kept > 0 && kept <= num_rows;

    if (solvable) qr_solve(self->right, self->scaled, self->direction, num_rows, kept);
    self->by_qr = true;
    self->factor_size = kept;
    for (size_t j = 0; j < kept && solvable; j++) // stores R^T by columns
        for (size_t i = j; i < kept; i++)
            self->gram[j * kept + i] = self->scaled[i * num_rows + j];
    for (size_t j = 0, from = 0; j < n; j++)
        solution[j] = !solvable ? NAN : self->scale[j] > 0 ? self->right[from++] : 0;
}

/* Undoes the scaling of the columns. EHD_NOT_CONVERGED: the solution is not finite. */
static ehd_status unscale(double *solution, const least_squares *self) {
    for (size_t j = 0; j < self->num_columns; j++) {
        solution[j] *= self->scale[j];
        if (!isfinite(solution[j])) return EHD_NOT_CONVERGED;
    }
    return EHD_OK;
}

ehd_status least_squares_solve(double *solution, least_squares *self, const double *matrix,
                               const double *right, size_t num_rows) {
    if (factorise_gram(self, matrix, num_rows))
        solve_gram(solution, self, matrix, right, num_rows);
    else
        solve_qr(solution, self, matrix, right, num_rows);
    return unscale(solution, self);
}

ehd_status least_squares_factorise(least_squares *self, const double *matrix, size_t num_rows) {
    return factorise_gram(self, matrix, num_rows) ? EHD_OK : EHD_NOT_CONVERGED;
}

ehd_status least_squares_again(double *solution, const least_squares *self, const double *matrix,
                               const double *right, size_t num_rows) {
    if (self->by_qr) return EHD_NOT_CONVERGED;
    solve_gram(solution, self, matrix, right, num_rows);
    return unscale(solution, self);
}

void least_squares_dual(double *dual, least_squares *self, const double *functional) {
    const bool all = self->factor_size == self->num_columns;
    size_t count = 0;

    for (size_t j = 0; j < self->num_columns; j++)
        if (self->scale[j] > 0 || all) self->right[count++] = functional[j] * self->scale[j];
    cholesky_solve(self->right, self->gram, self->factor_size);
    count = 0;
    for (size_t j = 0; j < self->num_columns; j++)
        dual[j] = self->scale[j] > 0 || all ? self->right[count++] * self->scale[j] : 0;
}

void least_squares_duals(double *functionals, least_squares *self, size_t num) {
    for (size_t k = 0; k < num; k++)
        least_squares_dual(functionals + k * self->num_columns, self,
                           functionals + k * self->num_columns);
}
