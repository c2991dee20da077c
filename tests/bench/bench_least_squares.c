/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compares the floating-point rate of the least squares of the reduced model with the rate of an
 * OpenBLAS product of the same size, on one core.
 *
 *     bench_least_squares rows columns [repeats] */
#include "common/program/program.h"
#include "romrun/solve/least_squares.h"
#include "tests/bench/measure.h"

#include <cblas.h>
#include <stdio.h>
#include <stdlib.h>

static const double MOST_RATIO = 3;

static void fill_random(double *values, size_t count) {
    unsigned long long seed = 1;

    for (size_t i = 0; i < count; i++) {
        seed = seed * 6364136223846793005ull + 1442695040888963407ull;
        values[i] = (double)(seed >> 11) * 0x1p-52 - 1;
    }
}

int main(int argc, char **argv) {
    if (argc < 3) {
        fprintf(stderr, "usage: bench_least_squares rows columns [repeats]\n");
        return 64;
    }
    size_t num_rows = strtoul(argv[1], NULL, 10), num_columns = strtoul(argv[2], NULL, 10);
    size_t repeats = argc > 3 ? strtoul(argv[3], NULL, 10) : 301;
    int m = (int)num_rows, n = (int)num_columns;
    double *matrix = must_allocate(num_rows * num_columns * sizeof(double));
    double *right = must_allocate(num_rows * sizeof(double));
    double *solution = must_allocate(num_columns * sizeof(double));
    double *product = must_allocate(num_columns * num_columns * sizeof(double));
    double *own = must_allocate(repeats * sizeof(double));
    double *blas = must_allocate(repeats * sizeof(double));
    least_squares *workspace = least_squares_create(num_rows, num_columns);
    char text[2][SPREAD_TEXT];

    if (!workspace) return 71;
    openblas_set_num_threads(1);
    fill_random(matrix, num_rows * num_columns);
    fill_random(right, num_rows);
    // measures alternately, so that a busy moment of the machine affects both
    for (size_t i = 0; i < repeats; i++) {
        double start = program_seconds();
        if (least_squares_solve(solution, workspace, matrix, right, num_rows)) return 1;
        own[i] = program_seconds() - start;
        start = program_seconds();
        cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, n, n, m, 1, matrix, n, matrix, n, 0,
                    product, n);
        blas[i] = program_seconds() - start;
    }
    const spread here = spread_of(own, repeats), there = spread_of(blas, repeats);
    // operations of the symmetric product (half of a full product), the Cholesky factors, and the
    // right-hand side
    const double flops = (double)n * n * m + (double)n * n * n / 3 + 2.0 * n * m + 2.0 * n * n;
    const double rate = flops / here.median, product_rate = 2.0 * n * n * m / there.median;
    printf("least squares %d x %d: %s us, %.1f Gflop/s; dgemm %d x %d x %d: %s us, %.1f Gflop/s; "
           "ratio of the rates %.2f (at most %g)\n",
           m, n, spread_text(text[0], &here, 1e-6, 1), rate * 1e-9, n, n, m,
           spread_text(text[1], &there, 1e-6, 1), product_rate * 1e-9, product_rate / rate,
           MOST_RATIO);
    least_squares_free(workspace);
    free(matrix);
    free(right);
    free(solution);
    free(product);
    free(own);
    free(blas);
    return product_rate <= MOST_RATIO * rate ? 0 : 1;
}
