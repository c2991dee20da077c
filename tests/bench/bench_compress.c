/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures two computations on one core: the compression, in blocks, of 10000 snapshots of 1201
 * nodes and rank about 250, and the POD of all snapshots in one piece.
 *
 *     bench_compress [num_nodes num_snapshots [block]] */
#include "common/program/program.h"
#include "podbuild/pod_stream.h"

#include <cblas.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Fills the snapshots with a hump that travels back and forth over twenty periods. The width of the
 * hump differs in each period. */
static void fill(double *snapshots, size_t num_snapshots, size_t num_nodes) {
    for (size_t s = 0; s < num_snapshots; s++) {
        const double time = 20.0 * (double)s / (double)num_snapshots;
        const double centre = 0.5 + 0.4 * sin(2.0 * M_PI * time);
        const double width = 0.0105 + 0.0005 * floor(time);
        for (size_t k = 0; k < num_nodes; k++)
            snapshots[s * num_nodes + k] =
                exp(-pow(((double)k / (double)num_nodes - centre) / width, 2));
    }
}

static double time_compression(pod_basis *set, const double *snapshots, size_t num_snapshots,
                               size_t num_nodes, size_t block) {
    const pod_stream_settings settings = {.local_energy = 0.25e-22, .block = block};
    pod_stream *stream = NULL;
    ehd_error error = {0};
    const double start = program_seconds();
    if (pod_stream_create(&stream, num_nodes, &settings, &error) ||
        pod_stream_add(stream, snapshots, num_snapshots, &error) ||
        pod_stream_finish(set, stream, &(pod_settings){.discarded_energy = 1e-22}, &error)) {
        fprintf(stderr, "bench_compress: %s\n", error.text);
        exit(1);
    }
    pod_stream_free(stream);
    return program_seconds() - start;
}

static double time_one_piece(pod_basis *basis, const double *snapshots, size_t num_snapshots,
                             size_t num_nodes) {
    ehd_error error = {0};
    const double start = program_seconds();
    if (pod_build(basis, snapshots, num_snapshots, num_nodes,
                  &(pod_settings){.discarded_energy = 1e-22}, &error)) {
        fprintf(stderr, "bench_compress: %s\n", error.text);
        exit(1);
    }
    return program_seconds() - start;
}

/* Returns the largest difference between corresponding singular values, relative to the first
 * value. */
static double deviation(const pod_basis *set, const pod_basis *basis) {
    double largest = 0;
    for (size_t i = 0; i < set->num_modes; i++)
        largest = fmax(largest, fabs(set->singular_values[i] - basis->singular_values[i]));
    return largest / basis->singular_values[0];
}

int main(int argc, char **argv) {
    const size_t num_nodes = argc > 2 ? strtoul(argv[1], NULL, 10) : 1201;
    const size_t num_snapshots = argc > 2 ? strtoul(argv[2], NULL, 10) : 10000;
    const size_t block = argc > 3 ? strtoul(argv[3], NULL, 10) : 512;
    double *snapshots = malloc(num_snapshots * num_nodes * sizeof *snapshots);
    pod_basis set, basis;
    if (!snapshots) abort();

    openblas_set_num_threads(1);
    fill(snapshots, num_snapshots, num_nodes);
    const double spent = time_compression(&set, snapshots, num_snapshots, num_nodes, block);
    const double one_piece = time_one_piece(&basis, snapshots, num_snapshots, num_nodes);
    printf(
        "compression %zux%zu to rank %zu: %.2f s (limit 20), in one piece %.2f s to %zu; singular "
        "values differ by %.1e of the first; discarded %.1e\n",
        num_snapshots, num_nodes, set.num_modes, spent, one_piece, basis.num_modes,
        deviation(&set, &basis), pod_discarded(&set));
    pod_free(&set);
    pod_free(&basis);
    free(snapshots);
    return spent <= 20 ? 0 : 1;
}
