/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures each selection method on one core. It selects 160 of 3001 rows, for two random
 * orthonormal bases of 160 modes. If the name of a method is given, only this method runs, and only
 * once, for callgrind. */
#include "common/program/program.h"
#include "deimselect/selection.h"
#include "tests/bench/measure.h"

#include <cblas.h>
#include <lapacke.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NUM_NODES = 3001, NUM_MODES = 160, NUM_ROWS = 160, REPEATS = 9 };

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

static spread time_method(size_t *rows, const selection_method *method,
                          const selection_bases *bases, size_t repeats) {
    double times[REPEATS];
    ehd_error error;

    for (size_t i = 0; i < repeats; i++) {
        const double start = program_seconds();
        must(method->select(rows, bases, NUM_ROWS, &error), &error);
        times[i] = program_seconds() - start;
    }
    return spread_of(times, repeats);
}

/* Returns the time limit of a method in seconds, infinity if it has none. */
static double limit_of(const selection_method *method) {
    return strcmp(method->name, "joint") == 0  ? 0.05
           : strcmp(method->name, "sopt") == 0 ? 0.1
                                               : INFINITY;
}

int main(int argc, char **argv) {
    double *residual_modes = random_basis(1), *jacobian_modes = random_basis(2);
    const selection_bases bases = {.num_nodes = NUM_NODES,
                                   .num_modes = {NUM_MODES, NUM_MODES},
                                   .modes = {residual_modes, jacobian_modes}};
    size_t rows[NUM_ROWS];
    int failed = 0;

    openblas_set_num_threads(1);
    for (const selection_method *method = selection_methods; method->name; method++) {
        if (argc > 1 && strcmp(argv[1], method->name)) continue;
        const spread spent = time_method(rows, method, &bases, argc > 1 ? 1 : REPEATS);
        const double limit = limit_of(method);
        char text[SPREAD_TEXT];
        printf("selection %-6s %d of %d rows: %s s, 1/sigma_min %.3g and %.3g", method->name,
               NUM_ROWS, NUM_NODES, spread_text(text, &spent, 1, 4),
               inverse_sigma_min(residual_modes, rows), inverse_sigma_min(jacobian_modes, rows));
        if (isfinite(limit)) printf(", limit %.2f s", limit);
        putchar('\n');
        failed |= !(spent.median <= limit) && argc == 1;
    }
    free(residual_modes);
    free(jacobian_modes);
    return failed;
}
