/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Normal equations with scaled columns, which cost a fifth of a QR; QR where their Cholesky
 * factorisation is not safe. Newton's limit is given by J^T f = 0, evaluated from J itself, so that
 * the squared condition number affects the convergence only. */
#include "romrun/online/least_squares.h"

#include "common/program/arena.h"
#include "romrun/online/dot.h"
#include "romrun/online/gram.h"
#include <cblas.h>
#include <lapacke.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

struct least_squares {
    size_t num_columns;
    size_t longest;       // of rows and columns
    double *scale;        // [num_columns] 1 / norm of the column
    double *scaled;       // [longest, num_columns] for QR
    double *gram;         // [num_columns, num_columns]
    const double *factor; // lower, of the Gram matrix: within `gram`, or within `scaled` after a QR
    size_t factor_size;   // its order: num_columns without zero columns
    double *right;        // [longest]
    double *work;         // [num_work] of LAPACK
    int num_work;
    arena memory; // of all arrays
};

/* Of the Gram matrix, below which QR is taken. Measured on random columns: the solution's error
 * is 1e-5 at a condition of 1e6 and up to 1e-3 at 1e7, where this lies; at 1e8 no digit is left. */
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
    self->longest = longest;
    self->num_columns = num_columns;
    self->num_work = (int)(64 * (longest + num_columns));
    self->scale = arena_array(memory, num_columns, sizeof(double));
    self->scaled = arena_array(memory, longest * num_columns, sizeof(double));
    self->gram = arena_array(memory, num_columns * num_columns, sizeof(double));
    self->right = arena_array(memory, longest, sizeof(double));
    self->work = arena_array(memory, (size_t)self->num_work, sizeof(double));
    return memory->failed ? least_squares_free(self) : self;
}

/* Gram matrix of the columns scaled to unit norm, lower part. Zero columns get the scale zero, those
 * that are not finite NaN: taken for zero columns they would leave a solution of the others. */
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

/* Cholesky of the Gram matrix; false when it is not safely positive definite. */
static int factorise_gram(least_squares *self, const double *matrix, size_t num_rows) {
    int n = (int)self->num_columns;
    double norm, rcond = 0;

    scaled_gram(self, matrix, num_rows);
    norm = n; // columns have unit norm, so the 1-norm is at most n
    if (LAPACKE_dpotrf_work(LAPACK_COL_MAJOR, 'L', n, self->gram, n)) return 0;
    // the diagonal of the factor bounds the condition from one side, cheaply
    double smallest = INFINITY, largest = 0;
    for (int j = 0; j < n; j++) {
        smallest = fmin(smallest, self->gram[j * n + j]);
        largest = fmax(largest, self->gram[j * n + j]);
    }
    self->factor = self->gram;
    self->factor_size = self->num_columns;
    rcond = smallest * smallest / (largest * largest * norm);
    return rcond > MIN_RCOND;
}

/* x = (L L^T)^-1 x of a lower factor by columns, L's two at a time. Two times cblas_dtrsv takes 1.6 times
 * the instructions (121 columns) and, for 61, 121, 171 and 301 columns, 1.53, 3.5, 5.85 and 13.6 us in
 * place of 1.25, 2.95, 4.89 and 12.7. */
static void solve_factor(double *restrict x, const double *restrict factor, size_t n) {
    size_t j = 0;

    for (; j + 1 < n; j += 2) {
        const double *first = factor + j * n, *second = first + n;
        const double a = x[j] / first[j], b = (x[j + 1] - a * first[j + 1]) / second[j + 1];
        x[j] = a;
        x[j + 1] = b;
        for (size_t i = j + 2; i < n; i++)
            x[i] -= a * first[i] + b * second[i];
    }
    if (j < n) x[j] /= factor[j * n + j];
    for (j = n; j-- > 0;) {
        const double *below = factor + j * n + j + 1;
        x[j] = (x[j] - dot(below, x + j + 1, n - j - 1)) / factor[j * n + j];
    }
}

static void solve_gram(double *solution, const least_squares *self, const double *matrix,
                       const double *right, size_t num_rows) {
    int n = (int)self->num_columns;

    cblas_dgemv(CblasColMajor, CblasNoTrans, n, (int)num_rows, -1, matrix, n, right, 1, 0, solution,
                1);
    for (int j = 0; j < n; j++)
        solution[j] *= self->scale[j];
    solve_factor(solution, self->gram, self->num_columns);
}

/* Removes the zero columns from the scaled matrix; returns the number of the others. */
static size_t drop_zero_columns(least_squares *self, size_t num_rows) {
    size_t n = self->num_columns, kept = 0;

    for (size_t j = 0; j < n; j++)
        kept += self->scale[j] > 0;
    for (size_t r = 0, to = 0; r < num_rows && kept < n; r++)
        for (size_t j = 0; j < n; j++)
            if (self->scale[j] > 0) self->scaled[to++] = self->scaled[r * n + j];
    return kept;
}

/* QR of the scaled matrix without its zero columns. NaN with fewer rows than columns. */
static void solve_qr(double *solution, least_squares *self, const double *matrix,
                     const double *right, size_t num_rows) {
    size_t n = self->num_columns;
    int info = -1;

    for (size_t r = 0; r < num_rows; r++)
        for (size_t j = 0; j < n; j++)
            self->scaled[r * n + j] = matrix[r * n + j] * self->scale[j];
    size_t kept = drop_zero_columns(self, num_rows);
    // row-major J is column-major J^T: the transposed problem of dgels
    for (size_t r = 0; r < num_rows; r++)
        self->right[r] = -right[r];
    if (kept > 0 && kept <= num_rows) // LAPACK says of none so on standard output
        info = LAPACKE_dgels_work(LAPACK_COL_MAJOR, 'T', (int)kept, (int)num_rows, 1, self->scaled,
                                  (int)kept, self->right, (int)self->longest, self->work,
                                  self->num_work);
    self->factor = self->scaled;
    self->factor_size = kept;
    for (size_t j = 0, from = 0; j < n; j++)
        solution[j] = info ? NAN : self->scale[j] > 0 ? self->right[from++] : 0;
}

/* Undoes the scaling of the columns. */
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
    if (self->factor != self->gram) return EHD_NOT_CONVERGED;
    solve_gram(solution, self, matrix, right, num_rows);
    return unscale(solution, self);
}

void least_squares_dual(double *dual, least_squares *self, const double *functional) {
    const bool all = self->factor_size == self->num_columns;
    size_t count = 0;

    for (size_t j = 0; j < self->num_columns; j++)
        if (self->scale[j] > 0 || all) self->right[count++] = functional[j] * self->scale[j];
    solve_factor(self->right, self->factor, self->factor_size);
    count = 0;
    for (size_t j = 0; j < self->num_columns; j++)
        dual[j] = self->scale[j] > 0 || all ? self->right[count++] * self->scale[j] : 0;
}

/* The functionals times the scales of the columns. */
static void scale_rows(double *functionals, const least_squares *self, size_t num) {
    for (size_t k = 0; k < num; k++)
        for (size_t j = 0; j < self->num_columns; j++)
            functionals[k * self->num_columns + j] *= self->scale[j];
}

void least_squares_duals(double *functionals, least_squares *self, size_t num) {
    const int n = (int)self->num_columns, count = (int)num;

    if (self->factor_size != self->num_columns) { // there are zero columns
        for (size_t k = 0; k < num; k++)
            least_squares_dual(functionals + k * self->num_columns, self,
                               functionals + k * self->num_columns);
        return;
    }
    scale_rows(functionals, self, num);
    cblas_dtrsm(CblasColMajor, CblasLeft, CblasLower, CblasNoTrans, CblasNonUnit, n, count, 1,
                self->factor, n, functionals, n);
    cblas_dtrsm(CblasColMajor, CblasLeft, CblasLower, CblasTrans, CblasNonUnit, n, count, 1,
                self->factor, n, functionals, n);
    scale_rows(functionals, self, num);
}
