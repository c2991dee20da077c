/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Nonnegative least squares, checked by optimality conditions and known solutions. */
#include "common/algebra/nnls.h"
#include "tests/unit/allocation.h"
#include "tests/unit/check.h"
#include "tests/unit/random.h"

#include <cblas.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS = 60, COLUMNS = 90 };

static ehd_error error;

/* Returns the next number of a random sequence in [-1, 1), which is the same in each run. */
static double next_number(void) {
    static uint64_t seed = 7;

    return 2 * random_next(&seed) - 1;
}

static void fill(double *values, size_t count, double offset) {
    for (size_t i = 0; i < count; i++)
        values[i] = next_number() + offset;
}

/* Checks the Karush-Kuhn-Tucker conditions: no unknown is negative, no column reduces the residual,
 * and for columns in use the gradient is zero. Returns the number of columns in use. */
static size_t check_optimal(const double *x, const double *matrix, const double *right, size_t rows,
                            size_t columns) {
    double residual[4 * ROWS], length = cblas_dnrm2((int)rows, right, 1);
    size_t num_used = 0;

    memcpy(residual, right, rows * sizeof *residual);
    cblas_dgemv(CblasRowMajor, CblasNoTrans, (int)rows, (int)columns, -1, matrix, (int)columns, x,
                1, 1, residual, 1);
    for (size_t j = 0; j < columns; j++) {
        const double descent = cblas_ddot((int)rows, matrix + j, (int)columns, residual, 1) /
                               fmax(cblas_dnrm2((int)rows, matrix + j, (int)columns), 1e-300);
        assert_true(x[j] >= 0);
        assert_true(descent <= 1e-10 * length);
        if (x[j] > 0) check_close(descent, 0, 0, 1e-10 * length);
        num_used += x[j] > 0;
    }
    return num_used;
}

static void solutions_are_optimal(void **state) {
    static const size_t rows[] = {ROWS, 4 * ROWS, 5, 1, ROWS}, columns[] = {20, COLUMNS, 40, 3, 1};
    double x[COLUMNS], right[4 * ROWS], *matrix = calloc(4 * ROWS * COLUMNS, sizeof *matrix);
    size_t num_used = 0, num_columns = 0;
    (void)state;

    assert_non_null(matrix);
    for (int trial = 0; trial < 60; trial++) {
        const size_t of = (size_t)trial % 5;
        fill(matrix, rows[of] * columns[of], trial < 30 ? 0 : 0.9);
        fill(right, rows[of], trial < 30 ? 0 : 0.5);
        assert_int_equal(nnls_solve(x, matrix, right, rows[of], columns[of], 0, &error), EHD_OK);
        num_used += check_optimal(x, matrix, right, rows[of], columns[of]);
        num_columns += columns[of];
    }
    assert_in_range(num_used, num_columns / 10,
                    9 * num_columns / 10); // some unknowns are zero and some are not
    free(matrix);
}

/* The right-hand side is computed from nonnegative unknowns. The solution equals these unknowns,
 * although the norms of the columns differ by orders of magnitude. */
static void what_is_not_negative_is_found_again(void **state) {
    double matrix[ROWS * 20], right[ROWS], x[20], expected[20];
    (void)state;

    fill(matrix, ROWS * 20, 0);
    for (size_t j = 0; j < 20; j++) {
        expected[j] = j % 3 == 0 ? 0 : (double)j * pow(10, (double)j - 10);
        cblas_dscal(ROWS, pow(10, 10 - (double)j), matrix + j, 20);
    }
    cblas_dgemv(CblasRowMajor, CblasNoTrans, ROWS, 20, 1, matrix, 20, expected, 1, 0, right, 1);
    assert_int_equal(nnls_solve(x, matrix, right, ROWS, 20, 0, &error), EHD_OK);
    for (size_t j = 0; j < 20; j++)
        check_close(x[j] * pow(10, 10 - (double)j), expected[j] * pow(10, 10 - (double)j), 1e-9,
                    1e-9);
}

/* With the unit matrix the solution is the positive part of the right-hand side. If no column
 * points towards the right-hand side, the solution is zero. */
static void simple_ones_are_known(void **state) {
    static const double unit[] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, right[] = {2, -3, 0.5};
    static const double away[] = {-1, -1, -1};
    double x[3];
    (void)state;

    assert_int_equal(nnls_solve(x, unit, right, 3, 3, 0, &error), EHD_OK);
    check_close_array(x, ((const double[]){2, 0, 0.5}), 3, 1e-15, 0);
    assert_int_equal(nnls_solve(x, unit, away, 3, 3, 0, &error), EHD_OK);
    check_close_array(x, ((const double[]){0, 0, 0}), 3, 0, 0);
    // the unconstrained solution of two columns is (2, -1); the first column alone gives 1.5
    assert_int_equal(
        nnls_solve(x, (const double[]){1, 1, 1, 0}, (const double[]){1, 2}, 2, 2, 0, &error),
        EHD_OK);
    check_close_array(x, ((const double[]){1.5, 0}), 2, 1e-15, 0);
}

/* Solutions are also optimal if a column equals another column, is a sum of other columns, or is
 * zero. */
static void columns_may_depend_on_each_other(void **state) {
    enum { NUM = 40 };
    double matrix[ROWS * NUM], right[ROWS], x[NUM];
    (void)state;

    for (int trial = 0; trial < 20; trial++) {
        fill(matrix, ROWS * NUM, 0.5);
        fill(right, ROWS, 0.8);
        for (size_t i = 0; i < ROWS; i++) {
            double *row = matrix + i * NUM;
            for (size_t j = 20; j < 30; j++)
                row[j] = row[j - 20];
            for (size_t j = 30; j < 39; j++)
                row[j] = row[j - 30] + row[j - 19];
            row[39] = 0;
        }
        assert_int_equal(nnls_solve(x, matrix, right, ROWS, NUM, 0, &error), EHD_OK);
        assert_in_range(check_optimal(x, matrix, right, ROWS, NUM), 1, 20);
        check_close(x[39], 0, 0, 0);
    }
}

/* With a looser tolerance fewer columns are used. */
static void a_tolerance_ends_it_before(void **state) {
    double matrix[ROWS * 50], right[ROWS], x[50];
    size_t last = 0;
    (void)state;

    fill(matrix, ROWS * 50, 1.5);
    for (size_t i = 0; i < ROWS; i++)
        right[i] = cblas_dasum(50, matrix + i * 50, 1) + next_number();
    for (double tolerance = 1; tolerance > 1e-4; tolerance /= 2) {
        double residual[ROWS];
        size_t num_used = 0;
        assert_int_equal(nnls_solve(x, matrix, right, ROWS, 50, tolerance, &error), EHD_OK);
        for (size_t j = 0; j < 50; j++)
            num_used += x[j] > 0;
        memcpy(residual, right, sizeof residual);
        cblas_dgemv(CblasRowMajor, CblasNoTrans, ROWS, 50, -1, matrix, 50, x, 1, 1, residual, 1);
        const double left = cblas_dnrm2(ROWS, residual, 1) / cblas_dnrm2(ROWS, right, 1);
        if (tolerance > 0.01) assert_true(left <= tolerance);
        if (tolerance == 1) assert_int_equal(num_used, 0);
        assert_true(num_used >= last);
        last = num_used;
    }
    assert_in_range(last, 20, 50);
}

static void what_is_no_number_is_refused(void **state) {
    double matrix[] = {1, 2, 3, 4}, right[] = {1, 1}, x[2];
    (void)state;

    matrix[1] = NAN;
    assert_int_equal(nnls_solve(x, matrix, right, 2, 2, 0, &error), EHD_DATA);
    assert_string_equal(
        error.text, "least squares: found nan as the length of column 1, expected a finite one");
    matrix[1] = 2;
    right[0] = INFINITY;
    assert_int_equal(nnls_solve(x, matrix, right, 2, 2, 0, &error), EHD_DATA);
}

static void refused_memory_is_told(void **state) {
    double matrix[ROWS * 20], right[ROWS], x[20];
    ehd_status status;
    size_t call = 0;
    (void)state;

    fill(matrix, ROWS * 20, 0.5);
    fill(right, ROWS, 0.5);
    do {
        allocation_fail_at(call);
        status = nnls_solve(x, matrix, right, ROWS, 20, 0, &error);
        if (!allocation_failed()) break;
        assert_int_equal(status, EHD_MEMORY);
    } while (call++ < 100);
    assert_int_equal(status, EHD_OK);
    assert_in_range(call, 3, 50);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(solutions_are_optimal),
        cmocka_unit_test(what_is_not_negative_is_found_again),
        cmocka_unit_test(simple_ones_are_known),
        cmocka_unit_test(columns_may_depend_on_each_other),
        cmocka_unit_test(a_tolerance_ends_it_before),
        cmocka_unit_test(what_is_no_number_is_refused),
        cmocka_unit_test(refused_memory_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
