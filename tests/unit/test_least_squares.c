/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/solve/least_squares.h"
#include "tests/unit/allocation.h"
#include "tests/unit/check.h"
#include "tests/unit/random.h"

#include <cblas.h>
#include <lapacke.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { ROWS = 40, COLUMNS = 12 };

static double random_number(void) {
    static uint64_t seed = 42;
    return random_next(&seed) - 0.5;
}

/* Fills a random matrix [num_rows, COLUMNS] with singular values from 1 down to 1/condition. */
static void random_matrix(double *matrix, size_t num_rows, double condition) {
    double left[ROWS * COLUMNS], right[COLUMNS * COLUMNS], scales[COLUMNS];

    for (size_t i = 0; i < num_rows * COLUMNS; i++)
        left[i] = random_number();
    for (size_t i = 0; i < COLUMNS * COLUMNS; i++)
        right[i] = random_number();
    double *const both[] = {left, right};
    const int rows[] = {(int)num_rows, COLUMNS};
    for (int i = 0; i < 2; i++) {
        assert_int_equal(
            LAPACKE_dgeqrf(LAPACK_ROW_MAJOR, rows[i], COLUMNS, both[i], COLUMNS, scales), 0);
        assert_int_equal(
            LAPACKE_dorgqr(LAPACK_ROW_MAJOR, rows[i], COLUMNS, COLUMNS, both[i], COLUMNS, scales),
            0);
    }
    for (size_t r = 0; r < num_rows; r++)
        for (size_t j = 0; j < COLUMNS; j++)
            left[r * COLUMNS + j] *= pow(condition, -(double)j / (COLUMNS - 1));
    cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasTrans, (int)num_rows, COLUMNS, COLUMNS, 1, left,
                COLUMNS, right, COLUMNS, 0, matrix, COLUMNS);
}

static void random_vector(double *vector, size_t length) {
    for (size_t i = 0; i < length; i++)
        vector[i] = random_number();
}

static double norm(const double *vector, size_t length) {
    return cblas_dnrm2((int)length, vector, 1);
}

/* Returns |matrix x + right|. */
static double residual(const double *matrix, const double *x, const double *right,
                       size_t num_rows) {
    double left[ROWS];

    memcpy(left, right, num_rows * sizeof(double));
    cblas_dgemv(CblasRowMajor, CblasNoTrans, (int)num_rows, COLUMNS, 1, matrix, COLUMNS, x, 1, 1,
                left, 1);
    return norm(left, num_rows);
}

/* Computes argmin |matrix x + right| by LAPACK. */
static void reference(double *x, const double *matrix, const double *right, size_t num_rows) {
    double copy[ROWS * COLUMNS], b[ROWS];

    memcpy(copy, matrix, num_rows * COLUMNS * sizeof(double));
    for (size_t r = 0; r < num_rows; r++)
        b[r] = -right[r];
    assert_int_equal(
        LAPACKE_dgels(LAPACK_ROW_MAJOR, 'N', (int)num_rows, COLUMNS, 1, copy, COLUMNS, b, 1), 0);
    memcpy(x, b, COLUMNS * sizeof(double));
}

static void solve(double *x, const double *matrix, const double *right, size_t num_rows) {
    least_squares *workspace = least_squares_create(ROWS, COLUMNS);

    assert_non_null(workspace);
    assert_int_equal(least_squares_solve(x, workspace, matrix, right, num_rows), EHD_OK);
    least_squares_free(workspace);
}

/* Compares solutions with LAPACK. The allowed error follows from perturbation theory. It is
 * proportional to the condition number, and to its square if the residual is not small. */
static void equals_lapack(void **state) {
    (void)state;
    double matrix[ROWS * COLUMNS], right[ROWS], x[COLUMNS], expected[COLUMNS];

    for (double condition = 1; condition < 2e8; condition *= 10)
        for (size_t num_rows = COLUMNS; num_rows <= ROWS; num_rows += 7) {
            random_matrix(matrix, num_rows, condition);
            random_vector(right, num_rows);
            solve(x, matrix, right, num_rows);
            reference(expected, matrix, right, num_rows);
            double limit = fmin(1e-13 * condition * condition, 0.5) * norm(expected, COLUMNS);
            check_close_array(x, expected, COLUMNS, 0, limit);
            double least = residual(matrix, expected, right, num_rows);
            check_close(residual(matrix, x, right, num_rows), least, 1e-2, 1e-2);
        }
}

/* The error of the normal equations is proportional to the square of the condition number. The
 * error is 1e-5 at a condition number of 1e6. Up to this number the normal equations are used,
 * since their factors are cheap and can be reused (least_squares_again). At 1e8 the normal
 * equations would fail; QR has an error of 1e-9. */
static void qr_takes_over_where_normal_equations_fail(void **state) {
    (void)state;
    double matrix[ROWS * COLUMNS], right[ROWS], x[COLUMNS], expected[COLUMNS];
    least_squares *workspace = least_squares_create(ROWS, COLUMNS);

    assert_non_null(workspace);
    for (double condition = 1e2; condition < 2e8; condition *= 10)
        for (int i = 0; i < 5; i++) {
            random_matrix(matrix, ROWS, condition);
            random_vector(expected, COLUMNS);
            cblas_dgemv(CblasRowMajor, CblasNoTrans, ROWS, COLUMNS, -1, matrix, COLUMNS, expected,
                        1, 0, right, 1);
            assert_int_equal(least_squares_solve(x, workspace, matrix, right, ROWS), EHD_OK);
            double error = 0;
            for (size_t j = 0; j < COLUMNS; j++)
                error = fmax(error, fabs(x[j] - expected[j]));
            bool again = least_squares_again(x, workspace, matrix, right, ROWS) == EHD_OK;
            if (condition < 2e6) assert_true(again && error < 1e-15 * condition * condition);
            if (condition > 5e7) assert_true(!again && error < 1e-8);
        }
    least_squares_free(workspace);
}

/* Columns of very different norms do not make the problem ill-conditioned. */
static void scales_columns(void **state) {
    (void)state;
    double matrix[ROWS * COLUMNS], right[ROWS], x[COLUMNS], expected[COLUMNS];

    random_matrix(matrix, ROWS, 10);
    random_vector(right, ROWS);
    reference(expected, matrix, right, ROWS);
    for (size_t j = 0; j < COLUMNS; j++)
        for (size_t r = 0; r < ROWS; r++)
            matrix[r * COLUMNS + j] *= pow(10, 2 * (double)j - 10);
    solve(x, matrix, right, ROWS);
    for (size_t j = 0; j < COLUMNS; j++)
        check_close(x[j] * pow(10, 2 * (double)j - 10), expected[j], 1e-10, 1e-12);
}

/* The unknowns of zero columns are zero. The other unknowns minimise the residual as if there were
 * no zero columns, at any condition number. */
static void zero_columns_get_zero(void **state) {
    (void)state;
    double matrix[ROWS * COLUMNS], right[ROWS], x[COLUMNS];

    for (double condition = 1; condition < 2e8; condition *= 1e4) {
        random_matrix(matrix, ROWS, condition);
        random_vector(right, ROWS);
        for (size_t r = 0; r < ROWS; r++)
            matrix[r * COLUMNS + 3] = matrix[r * COLUMNS + 11] = 0;
        for (size_t r = 0; r < ROWS && condition > 1; r++) // some columns are nearly equal
            matrix[r * COLUMNS + 7] = matrix[r * COLUMNS + 2] * (1 + 1e-9 * (double)r);
        solve(x, matrix, right, ROWS);
        check_close(x[3], 0, 0, 0);
        check_close(x[11], 0, 0, 0);
        // the solution for the other columns is the best one: the gradient vanishes
        double left[ROWS], gradient[COLUMNS];
        memcpy(left, right, sizeof left);
        cblas_dgemv(CblasRowMajor, CblasNoTrans, ROWS, COLUMNS, 1, matrix, COLUMNS, x, 1, 1, left,
                    1);
        cblas_dgemv(CblasRowMajor, CblasTrans, ROWS, COLUMNS, 1, matrix, COLUMNS, left, 1, 0,
                    gradient, 1);
        check_close_array(gradient, (double[COLUMNS]){0}, COLUMNS, 0, 1e-7);
        assert_true(norm(left, ROWS) < norm(right, ROWS));
    }
}

/* If columns are equal up to round-off, any minimiser of the residual is accepted. */
static void near_rank_deficiency_is_harmless(void **state) {
    (void)state;
    double matrix[ROWS * COLUMNS], right[ROWS], x[COLUMNS], known[COLUMNS];

    for (double apart = 1e-6; apart > 1e-18; apart *= 1e-2) {
        random_matrix(matrix, ROWS, 5);
        random_vector(known, COLUMNS);
        for (size_t r = 0; r < ROWS; r++)
            matrix[r * COLUMNS + 7] = matrix[r * COLUMNS + 2] + apart * random_number();
        memset(right, 0, sizeof right);
        cblas_dgemv(CblasRowMajor, CblasNoTrans, ROWS, COLUMNS, -1, matrix, COLUMNS, known, 1, 0,
                    right, 1);
        solve(x, matrix, right, ROWS);
        assert_true(residual(matrix, x, right, ROWS) < 1e-7 * norm(right, ROWS));
    }
}

/* Iterations with the factors of a similar matrix converge to the solution of the given matrix. */
static void factors_of_a_neighbour_converge_to_the_solution(void **state) {
    (void)state;
    double matrix[ROWS * COLUMNS], right[ROWS], left[ROWS], expected[COLUMNS], step[COLUMNS];
    double x[COLUMNS] = {0};
    least_squares *workspace = least_squares_create(ROWS, COLUMNS);

    assert_non_null(workspace);
    random_matrix(matrix, ROWS, 10);
    random_vector(right, ROWS);
    assert_int_equal(least_squares_factorise(workspace, matrix, ROWS), EHD_OK);
    for (size_t i = 0; i < ROWS * COLUMNS; i++)
        matrix[i] *= 1 + 0.02 * random_number();
    reference(expected, matrix, right, ROWS);
    for (int iteration = 0; iteration < 30; iteration++) {
        memcpy(left, right, sizeof left);
        cblas_dgemv(CblasRowMajor, CblasNoTrans, ROWS, COLUMNS, 1, matrix, COLUMNS, x, 1, 1, left,
                    1);
        assert_int_equal(least_squares_again(step, workspace, matrix, left, ROWS), EHD_OK);
        for (size_t j = 0; j < COLUMNS; j++)
            x[j] += step[j];
    }
    check_close_array(x, expected, COLUMNS, 1e-9, 1e-11);
    least_squares_free(workspace);
}

/* Problems with fewer rows than columns are refused, because the solution would depend on the start
 * of Newton's iteration. Columns of zeros do not count. */
static void fewer_rows_than_columns_are_refused(void **state) {
    (void)state;
    double matrix[ROWS * COLUMNS], right[ROWS], x[COLUMNS];
    least_squares *workspace = least_squares_create(ROWS, COLUMNS);

    assert_non_null(workspace);
    random_matrix(matrix, ROWS, 5);
    random_vector(right, ROWS);
    for (size_t num_rows = 1; num_rows < COLUMNS; num_rows++) {
        assert_int_equal(least_squares_solve(x, workspace, matrix, right, num_rows),
                         EHD_NOT_CONVERGED);
        assert_int_equal(least_squares_factorise(workspace, matrix, num_rows), EHD_NOT_CONVERGED);
    }
    for (size_t r = 0; r < ROWS; r++)
        matrix[r * COLUMNS + 4] = 0;
    assert_int_equal(least_squares_solve(x, workspace, matrix, right, COLUMNS - 2),
                     EHD_NOT_CONVERGED);
    assert_int_equal(least_squares_solve(x, workspace, matrix, right, COLUMNS - 1), EHD_OK);
    assert_true(residual(matrix, x, right, COLUMNS - 1) < 1e-10);
    least_squares_free(workspace);
}

static void not_finite_is_said(void **state) {
    (void)state;
    const double bad[] = {NAN, INFINITY, -INFINITY};
    double matrix[ROWS * COLUMNS], right[ROWS], x[COLUMNS];
    least_squares *workspace = least_squares_create(ROWS, COLUMNS);

    for (size_t i = 0; i < 3; i++) {
        random_matrix(matrix, ROWS, 5);
        random_vector(right, ROWS);
        matrix[17] = bad[i];
        assert_int_equal(least_squares_solve(x, workspace, matrix, right, ROWS), EHD_NOT_CONVERGED);
        // the first column has a value that is not finite, and must not count as a column of zeros
        random_matrix(matrix, ROWS, 5);
        matrix[COLUMNS] = bad[i];
        assert_int_equal(least_squares_solve(x, workspace, matrix, right, ROWS), EHD_NOT_CONVERGED);
    }
    least_squares_free(workspace);
}

/* LAPACK must not be called for a matrix without finite numbers. It would print a message about
 * missing columns to standard output, amid the output of the program. */
static void no_columns_are_left_in_silence(void **state) {
    (void)state;
    const double all[] = {NAN, INFINITY};
    double matrix[ROWS * COLUMNS], right[ROWS], x[COLUMNS];
    least_squares *workspace = least_squares_create(ROWS, COLUMNS);
    FILE *said = tmpfile();
    const int before = dup(STDOUT_FILENO);

    assert_non_null(said);
    random_vector(right, ROWS);
    fflush(stdout);
    assert_true(dup2(fileno(said), STDOUT_FILENO) >= 0);
    for (size_t i = 0; i < 2; i++) {
        for (size_t k = 0; k < ROWS * COLUMNS; k++)
            matrix[k] = all[i];
        const ehd_status status = least_squares_solve(x, workspace, matrix, right, ROWS);
        if (status != EHD_NOT_CONVERGED) printf("found status %d\n", (int)status);
    }
    fflush(stdout);
    assert_true(dup2(before, STDOUT_FILENO) >= 0);
    close(before);
    assert_int_equal(fseek(said, 0, SEEK_END), 0);
    assert_int_equal(ftell(said), 0);
    fclose(said);
    least_squares_free(workspace);
}

/* Checks that J (J^T J)^-1 c is the shortest x with J^T x = c. */
static void check_dual(least_squares *workspace, const double *matrix, const double *functional,
                       const double *shown, size_t num_columns) {
    double copy[ROWS * COLUMNS], shortest[ROWS] = {0}, dual[COLUMNS];

    memcpy(copy, matrix, ROWS * num_columns * sizeof(double));
    memcpy(shortest, functional, num_columns * sizeof(double));
    assert_int_equal(LAPACKE_dgels(LAPACK_ROW_MAJOR, 'T', ROWS, (int)num_columns, 1, copy,
                                   (int)num_columns, shortest, 1),
                     0);
    least_squares_dual(dual, workspace, functional);
    // several right-hand sides at once
    double many[3 * COLUMNS];
    for (int k = 0; k < 3; k++)
        for (size_t j = 0; j < COLUMNS; j++)
            many[(size_t)k * COLUMNS + j] = (k - 1) * functional[j];
    least_squares_duals(many, workspace, 3);
    for (int k = 0; k < 3; k++)
        for (size_t j = 0; j < COLUMNS; j++)
            check_close(many[(size_t)k * COLUMNS + j], (k - 1) * dual[j], 1e-12, 0);
    for (size_t r = 0; r < ROWS; r++)
        check_close(cblas_ddot((int)num_columns, shown + r * COLUMNS, 1, dual, 1), shortest[r],
                    1e-4, 1e-4 * norm(shortest, ROWS));
}

static void dual_is_the_shortest_cause(void **state) {
    (void)state;
    least_squares *workspace = least_squares_create(ROWS, COLUMNS);
    double matrix[ROWS * COLUMNS], narrow[ROWS * COLUMNS], right[ROWS], functional[COLUMNS];
    double x[COLUMNS];

    assert_non_null(workspace);
    // solved by the normal equations and, at the largest condition number, by QR
    const double conditions[] = {1, 1e3, 1e9};
    for (int i = 0; i < 3; i++) {
        random_matrix(matrix, ROWS, conditions[i]);
        random_vector(right, ROWS);
        random_vector(functional, COLUMNS);
        assert_int_equal(least_squares_solve(x, workspace, matrix, right, ROWS), EHD_OK);
        check_dual(workspace, matrix, functional, matrix, COLUMNS);
        // a column of zeros is ignored
        for (size_t r = 0; r < ROWS; r++)
            matrix[r * COLUMNS + COLUMNS - 1] = 0;
        assert_int_equal(least_squares_solve(x, workspace, matrix, right, ROWS), EHD_OK);
        for (size_t r = 0; r < ROWS; r++)
            memcpy(narrow + r * (COLUMNS - 1), matrix + r * COLUMNS,
                   (COLUMNS - 1) * sizeof(double));
        check_dual(workspace, narrow, functional, matrix, COLUMNS - 1);
    }
    least_squares_free(workspace);
}

static void survives_failing_allocations(void **state) {
    (void)state;
    least_squares *workspace;
    size_t call = 0;

    for (;; call++) {
        allocation_fail_at(call);
        workspace = least_squares_create(ROWS, COLUMNS);
        if (!allocation_failed()) break;
        assert_null(workspace);
    }
    assert_true(call > 1);
    assert_null(least_squares_free(workspace));
    assert_null(least_squares_free(NULL));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equals_lapack),
        cmocka_unit_test(qr_takes_over_where_normal_equations_fail),
        cmocka_unit_test(scales_columns),
        cmocka_unit_test(zero_columns_get_zero),
        cmocka_unit_test(near_rank_deficiency_is_harmless),
        cmocka_unit_test(factors_of_a_neighbour_converge_to_the_solution),
        cmocka_unit_test(fewer_rows_than_columns_are_refused),
        cmocka_unit_test(dual_is_the_shortest_cause),
        cmocka_unit_test(not_finite_is_said),
        cmocka_unit_test(no_columns_are_left_in_silence),
        cmocka_unit_test(survives_failing_allocations),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
