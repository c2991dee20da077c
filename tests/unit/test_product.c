/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Matrix products, Cholesky factors and QR factors, compared with sums by definition. The matrices
 * have all sizes near multiples of the block size. */
#include "common/algebra/cholesky.h"
#include "common/algebra/product.h"
#include "common/algebra/qr.h"
#include "common/algebra/vectors.h"
#include "tests/unit/check.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 100, NUM_ROWS = 37, LONG = 600 };

static double matrix[LONG * MOST], gram[MOST * MOST + 1];

static void fill(double *numbers, size_t count) {
    for (size_t i = 0; i < count; i++)
        numbers[i] = sin((double)(i * i));
}

/* Each entry of the Gram matrix is the product of two columns, whatever its block. Memory behind
 * the last entry is not changed. */
static void gram_is_the_product_of_columns(void **state) {
    const double guard = 17;
    (void)state;

    fill(matrix, NUM_ROWS * MOST);
    for (size_t n = 1; n <= MOST; n++)
        for (size_t num_rows = 1; num_rows <= NUM_ROWS; num_rows += 12) {
            gram[n * n] = guard;
            gram_matrix(gram, matrix, num_rows, n);
            assert_true(gram[n * n] == guard);
            for (size_t j = 0; j < n; j++)
                for (size_t i = j; i < n; i++) {
                    double product = 0;
                    for (size_t r = 0; r < num_rows; r++)
                        product += matrix[r * n + i] * matrix[r * n + j];
                    check_close(gram[j * n + i], product, 0, 1e-13);
                }
        }
}

static void not_finite_columns_show(void **state) {
    const size_t n = 33, bad = 20;
    (void)state;

    for (size_t i = 0; i < NUM_ROWS * n; i++)
        matrix[i] = 1;
    matrix[5 * n + bad] = NAN;
    gram_matrix(gram, matrix, NUM_ROWS, n);
    for (size_t j = 0; j < n; j++)
        for (size_t i = j; i < n; i++)
            assert_true(isnan(gram[j * n + i]) == (i == bad || j == bad));
}

/* Checks that factor * A B is added to C, where A is stored by rows or by columns. C is a part of a
 * larger array, and the rest of this array must not change. */
static void matrix_product(void **state) {
    static double left[LONG * MOST], found[30 * (MOST + 3)], expected[30 * (MOST + 3)];
    const size_t inner[] = {0, 1, 16, 300, LONG};
    (void)state;

    fill(matrix, LONG * MOST);
    for (size_t i = 0; i < LONG * MOST; i++)
        left[i] = cos((double)(3 * i));
    for (size_t rows = 1; rows <= 30; rows += rows < 18 ? 1 : 6)
        for (size_t columns = 1; columns <= 40; columns += columns < 18 ? 1 : 7)
            for (size_t of = 0; of < 5; of++) {
                const size_t n = inner[of], stride = columns + 3;
                const strided by_rows = {left, n, 1}, by_columns = {left, 1, rows};
                for (int kind = 0; kind < 2; kind++) {
                    const strided a = kind ? by_rows : by_columns;
                    fill(found, rows * stride);
                    memcpy(expected, found, rows * stride * sizeof *found);
                    for (size_t i = 0; i < rows; i++)
                        for (size_t j = 0; j < columns; j++)
                            for (size_t r = 0; r < n; r++)
                                expected[i * stride + j] -=
                                    0.5 * a.numbers[i * a.by_row + r * a.by_column] *
                                    matrix[r * MOST + j];
                    add_matrix_product(found, stride, -0.5, a, matrix, MOST, rows, columns, n);
                    check_close_array(found, expected, rows * stride, 0, 2e-13);
                }
            }
}

static void products_with_a_vector(void **state) {
    double x[MOST], found[MOST], expected[MOST];
    (void)state;

    fill(matrix, MOST * MOST);
    for (size_t i = 0; i < MOST; i++)
        x[i] = cos((double)i);
    for (size_t rows = 0; rows <= 21; rows++)
        for (size_t columns = 1; columns <= 21; columns++) {
            const size_t stride = columns + 2;
            fill(found, MOST);
            memcpy(expected, found, sizeof found);
            for (size_t i = 0; i < rows; i++)
                for (size_t j = 0; j < columns; j++)
                    expected[i] += matrix[i * stride + j] * x[j];
            add_product(found, matrix, stride, rows, columns, x);
            check_close_array(found, expected, MOST, 0, 1e-14);
            for (size_t i = 0; i < rows; i++)
                for (size_t j = 0; j < columns; j++)
                    expected[j] -= 2 * matrix[i * columns + j] * x[i];
            add_transposed_product(found, -2, matrix, rows, columns, x);
            check_close_array(found, expected, MOST, 0, 1e-13);
        }
}

static void sums_of_vectors(void **state) {
    double a[30], b[30];
    (void)state;

    for (size_t n = 0; n <= 30; n++) {
        double sum = 0, reversed = 0;
        for (size_t i = 0; i < n; i++) {
            a[i] = (double)(i + 1);
            b[i] = (double)(i * i);
            sum += a[i] * b[i];
        }
        for (size_t i = 0; i < n; i++)
            reversed += a[n - 1 - i] * b[i];
        assert_true(dot(a, b, n) == sum); // equal, because the numbers are small integers
        assert_true(dot_reversed(a, b, n) == reversed);
    }
}

/* Norms are also right if the squares of the numbers overflow or underflow. */
static void norms(void **state) {
    const double sizes[] = {1, 1e-170, DBL_MIN, 1e160, 1e300};
    (void)state;

    for (size_t i = 0; i < 5; i++)
        check_close(vector_norm((const double[]){3 * sizes[i], 0, -4 * sizes[i]}, 3), 5 * sizes[i],
                    1e-15, 0);
    assert_true(vector_norm((const double[]){0, 0}, 2) == 0);
    assert_true(isinf(vector_norm((const double[]){-INFINITY, 1}, 2)));
    assert_true(isnan(vector_norm((const double[]){NAN, 1e300}, 2)));
}

/* Checks, for all sizes, the factors of A = J^T J + 1 and the solution of A x = b. */
static void cholesky_solves(void **state) {
    double x[MOST], solution[MOST];
    (void)state;

    fill(matrix, NUM_ROWS * MOST);
    for (size_t n = 1; n <= MOST; n++) {
        gram_matrix(gram, matrix, NUM_ROWS, n);
        for (size_t i = 0; i < n; i++) {
            gram[i * n + i] += 1;
            solution[i] = cos((double)i);
        }
        for (size_t i = 0; i < n; i++) {
            x[i] = 0;
            for (size_t j = 0; j < n; j++)
                x[i] += gram[(i < j ? i : j) * n + (i < j ? j : i)] * solution[j];
        }
        assert_true(cholesky_factorise(gram, n));
        cholesky_solve(x, gram, n);
        check_close_array(x, solution, n, 0, 1e-11);
    }
}

static void cholesky_refuses(void **state) {
    double not_definite[] = {1, 2, 0, 1}, not_finite[] = {1, 0, 0, NAN}, zero[] = {0};
    (void)state;

    assert_false(cholesky_factorise(not_definite, 2));
    assert_false(cholesky_factorise(not_finite, 2));
    assert_false(cholesky_factorise(zero, 1));
}

/* The residual of [A b] is orthogonal to the columns of A, and R^T R = A^T A. */
static void qr_is_least_squares(void **state) {
    static double columns[LONG * 31];
    double x[30], work[LONG];
    (void)state;

    for (size_t n = 1; n <= 30; n += 4)
        for (size_t rows = n; rows <= 60; rows += 13) {
            fill(columns + 1, rows * (n + 1) - 1);
            columns[0] = 1;
            memcpy(matrix, columns, rows * (n + 1) * sizeof *columns);
            qr_solve(x, columns, work, rows, n);
            memcpy(work, matrix + n * rows, rows * sizeof *work);
            for (size_t j = 0; j < n; j++)
                axpy(work, -x[j], matrix + j * rows, rows);
            for (size_t i = 0; i < n; i++) {
                check_close(dot(matrix + i * rows, work, rows), 0, 0, 1e-9);
                for (size_t j = 0; j <= i; j++)
                    check_close(dot(columns + i * rows, columns + j * rows, rows),
                                dot(matrix + i * rows, matrix + j * rows, rows), 0, 1e-12);
                for (size_t r = i + 1; r < rows; r++)
                    assert_true(columns[i * rows + r] == 0);
            }
        }
}

/* The solution is also right if the squares of the numbers in the columns underflow or overflow. */
static void qr_is_that_of_any_size(void **state) {
    static const double sizes[] = {1e-300, 1e-200, 1e-160, 1e-150, 1e150, 1e160, 1e200, 1e300};
    enum { ROWS = 7, COLUMNS = 3 };
    double first[ROWS * (COLUMNS + 1)], columns[ROWS * (COLUMNS + 1)], work[ROWS];
    double expected[COLUMNS], x[COLUMNS];
    (void)state;

    fill(first, ROWS * (COLUMNS + 1));
    memcpy(columns, first, sizeof columns);
    qr_solve(expected, columns, work, ROWS, COLUMNS);
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        for (size_t k = 0; k < sizeof first / sizeof *first; k++)
            columns[k] = first[k] * sizes[i];
        qr_solve(x, columns, work, ROWS, COLUMNS);
        for (size_t k = 0; k < COLUMNS; k++)
            check_close(x[k], expected[k], 1e-9, 0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(qr_is_that_of_any_size),
        cmocka_unit_test(gram_is_the_product_of_columns),
        cmocka_unit_test(not_finite_columns_show),
        cmocka_unit_test(matrix_product),
        cmocka_unit_test(products_with_a_vector),
        cmocka_unit_test(sums_of_vectors),
        cmocka_unit_test(norms),
        cmocka_unit_test(cholesky_solves),
        cmocka_unit_test(cholesky_refuses),
        cmocka_unit_test(qr_is_least_squares),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
