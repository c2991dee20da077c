/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compares the time of a POD (1500 snapshots of 3001 nodes, 160 modes) with the time of LAPACK's
 * dgesdd alone, on one core.
 *
 *     bench_pod [num_nodes num_states num_modes [repeats]] */
#include "common/program/program.h"
#include "podbuild/pod.h"
#include "tests/bench/measure.h"

#include <cblas.h>
#include <lapacke.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Fills the snapshots with travelling pressure humps over weak noise. The snapshots have full rank,
 * and their singular values decay like those of real snapshots. */
static void fill(double *snapshots, size_t num_states, size_t num_nodes) {
    unsigned long long seed = 1;
    for (size_t state = 0; state < num_states; state++) {
        const double centre = (double)state / (double)num_states;
        const double width = 0.01 + 0.1 * fabs(sin(7.0 * (double)state));
        for (size_t node = 0; node < num_nodes; node++) {
            const double x = (double)node / (double)num_nodes;
            seed = seed * 6364136223846793005ull + 1442695040888963407ull;
            snapshots[state * num_nodes + node] =
                exp(-pow((x - centre) / width, 2)) + 1e-9 * (double)(seed >> 11) * 0x1p-53;
        }
    }
}

static double time_dgesdd(const double *snapshots, int num_states, int num_nodes) {
    const size_t length = (size_t)num_states * (size_t)num_nodes;
    const int num_values = num_states < num_nodes ? num_states : num_nodes;
    double *matrix = malloc(length * sizeof *matrix);
    double *values = malloc((size_t)num_values * sizeof *values);
    double *left = malloc((size_t)num_nodes * (size_t)num_values * sizeof *left);
    double *right = malloc((size_t)num_values * (size_t)num_states * sizeof *right);
    if (!matrix || !values || !left || !right) abort();
    memcpy(matrix, snapshots, length * sizeof *matrix);
    const double start = program_seconds();
    if (LAPACKE_dgesdd(LAPACK_COL_MAJOR, 'S', num_nodes, num_states, matrix, num_nodes, values,
                       left, num_nodes, right, num_values))
        abort();
    const double spent = program_seconds() - start;
    free(matrix);
    free(values);
    free(left);
    free(right);
    return spent;
}

static double time_pod(const double *snapshots, size_t num_states, size_t num_nodes,
                       size_t num_modes) {
    pod_basis basis;
    ehd_error error = {0};
    const double start = program_seconds();
    must(pod_build(&basis, snapshots, num_states, num_nodes,
                   &(pod_settings){.num_modes = num_modes}, &error),
         &error);
    const double spent = program_seconds() - start;
    pod_free(&basis);
    return spent;
}

int main(int argc, char **argv) {
    const size_t num_nodes = argc > 3 ? strtoul(argv[1], NULL, 10) : 3001;
    const size_t num_states = argc > 3 ? strtoul(argv[2], NULL, 10) : 1500;
    const size_t num_modes = argc > 3 ? strtoul(argv[3], NULL, 10) : 160;
    const size_t repeats = argc > 4 ? strtoul(argv[4], NULL, 10) : 3;
    double *snapshots = malloc(num_states * num_nodes * sizeof *snapshots);
    double *ours = malloc(repeats * sizeof *ours), *lapack = malloc(repeats * sizeof *lapack);
    if (!snapshots || !ours || !lapack || repeats == 0) abort();

    openblas_set_num_threads(1);
    fill(snapshots, num_states, num_nodes);
    // measures alternately, so that a busy moment of the machine affects both
    for (size_t i = 0; i < repeats; i++) {
        lapack[i] = time_dgesdd(snapshots, (int)num_states, (int)num_nodes);
        ours[i] = time_pod(snapshots, num_states, num_nodes, num_modes);
    }
    const spread reference = spread_of(lapack, repeats), own = spread_of(ours, repeats);
    const double ratio = own.median / reference.median;
    char text[2][SPREAD_TEXT];
    printf("pod %zux%zu to %zu modes: %s s, dgesdd %s s, ratio %.2f (limit 1.3)\n", num_nodes,
           num_states, num_modes, spread_text(text[0], &own, 1, 2),
           spread_text(text[1], &reference, 1, 2), ratio);
    free(snapshots);
    free(ours);
    free(lapack);
    return ratio <= 1.3 ? 0 : 1;
}
