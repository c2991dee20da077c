/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes products of matrices, for the small matrices of reduced models. These functions replace
 * BLAS for two reasons. The library and FMUs do not contain BLAS. An OpenBLAS that does not
 * recognise the processor runs kernels that were made for processors of 2004.
 * Called by cholesky.c, and by the folders model, state, solve, trust and online of romrun. */
#ifndef EHD_PRODUCT_H
#define EHD_PRODUCT_H

#include <stddef.h>

/* Adds A x to y. */
void add_product(
    // output:
    double *y, // [num_rows]
    // input:
    const double *matrix, // A, [num_rows, num_columns], rows `stride` numbers apart
    size_t stride, size_t num_rows, size_t num_columns,
    const double *x // [num_columns]
);

/* Adds factor A^T x to y. */
void add_transposed_product(
    // output:
    double *y, // [num_columns]
    // input:
    double factor,
    const double *matrix, // A, [num_rows, num_columns] row-major
    size_t num_rows, size_t num_columns,
    const double *x // [num_rows]
);

/* Element (i, r) of a matrix is at numbers[i * by_row + r * by_column]. */
typedef struct strided {
    const double *numbers;
    size_t by_row, by_column;
} strided;

/* Adds factor A B to C. */
void add_matrix_product(
    // output:
    double *product, // C, [num_rows, num_columns], rows `stride` numbers apart
    size_t stride,
    // input:
    double factor,
    strided left,        // A, [num_rows, num_inner]
    const double *right, // B, [num_inner, num_columns], rows `right_stride` numbers apart
    size_t right_stride, size_t num_rows, size_t num_columns, size_t num_inner);

/* Computes the lower triangle of J^T J, stored by columns. The numbers above the diagonal must not
 * be used. */
void gram_matrix(
    // output:
    double *gram, // [num_columns, num_columns]
    // input:
    const double *matrix, // J, [num_rows, num_columns] row-major
    size_t num_rows, size_t num_columns);

#endif
