/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Selects 160 of 3001 rows with two random orthonormal bases of 160 modes, each method, on one core. */
#include "deimselect/selection.h"

#include <cblas.h>
#include <lapacke.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { NUM_NODES = 3001, NUM_MODES = 160, NUM_ROWS = 160, REPEATS = 9 };

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int compare(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double *random_basis(unsigned long long seed) {
    double *modes = malloc(sizeof(double[NUM_MODES][NUM_NODES]));
    double scales[NUM_MODES];
    if (!modes) abort();
    for (size_t i = 0; i < (size_t)NUM_MODES * NUM_NODES; i++) {
        seed = seed * 6364136223846793005ull + 1442695040888963407ull;
        modes[i] = (double)(seed >> 11) * 0x1p-52 - 1.0;
    }
    if (LAPACKE_dgeqrf(LAPACK_COL_MAJOR, NUM_NODES, NUM_MODES, modes, NUM_NODES, scales) ||
        LAPACKE_dorgqr(LAPACK_COL_MAJOR, NUM_NODES, NUM_MODES, NUM_MODES, modes, NUM_NODES, scales))
        abort();
    return modes;
}

static double inverse_sigma_min(const double *modes, const size_t *rows) {
    double sigma_min;
    if (selection_sigma_min(&sigma_min, modes, NUM_MODES, NUM_NODES, rows, NUM_ROWS, NULL)) abort();
    return 1.0 / sigma_min;
}

static double time_method(size_t *rows, const selection_method *method,
                          const selection_bases *bases) {
    double times[REPEATS];
    ehd_error error = {0};
    for (size_t i = 0; i < REPEATS; i++) {
        const double start = seconds();
        if (method->select(rows, bases, NUM_ROWS, &error)) {
            fprintf(stderr, "bench_selection: %s\n", error.text);
            exit(1);
        }
        times[i] = seconds() - start;
    }
    qsort(times, REPEATS, sizeof *times, compare);
    return times[REPEATS / 2];
}

int main(void) {
    double *residual_modes = random_basis(1), *jacobian_modes = random_basis(2);
    const selection_bases bases = {.num_nodes = NUM_NODES,
                                   .num_modes = {NUM_MODES, NUM_MODES},
                                   .modes = {residual_modes, jacobian_modes}};
    size_t rows[NUM_ROWS];
    double joint_seconds = 0.0;

    openblas_set_num_threads(1);
    for (const selection_method *method = selection_methods; method->name; method++) {
        const double spent = time_method(rows, method, &bases);
        if (strcmp(method->name, "joint") == 0) joint_seconds = spent;
        printf("selection %-6s %d of %d rows: %.4f s, 1/sigma_min %.3g and %.3g\n", method->name,
               NUM_ROWS, NUM_NODES, spent, inverse_sigma_min(residual_modes, rows),
               inverse_sigma_min(jacobian_modes, rows));
    }
    printf("selection joint: limit 0.05 s\n");
    free(residual_modes);
    free(jacobian_modes);
    return joint_seconds <= 0.05 ? 0 : 1;
}
