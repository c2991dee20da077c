/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the POD of one block of snapshots: X = Q R = Q (U S Vᵀ), with modes Q U.
 * Equations: Sirovich 1987. The squared error of the first k modes is the sum of the other squared
 * singular values (Eckart and Young).
 * Called by pod_stream.c and by deimselect/residual_snapshots.c. */
#include "podbuild/pod.h"

#include "common/algebra/lapack.h"
#include "common/program/arena.h"

#include <float.h>
#include <lapacke.h>
#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* LAPACK reads a row-major [num_snapshots, num_nodes] array as a num_nodes x num_snapshots matrix
 * with a snapshot in each column. The modes are the left singular vectors of this matrix, so
 * nothing has to be transposed. */

static ehd_status check_input(size_t num_snapshots, size_t num_nodes, const pod_settings *settings,
                              ehd_error *error) {
    if (num_snapshots == 0 || num_nodes == 0 || num_snapshots > INT_MAX || num_nodes > INT_MAX)
        return ehd_fail(error, EHD_DATA,
                        "snapshots: found %zu states of %zu nodes, expected 1 to %d", num_snapshots,
                        num_nodes, INT_MAX);
    if (settings->num_modes == 0 && !(settings->discarded_energy >= 0.0))
        return ehd_fail(error, EHD_DATA, "discarded energy: found %g, expected >= 0",
                        settings->discarded_energy);
    return EHD_OK;
}

/* Returns the number of singular values above the noise of round-off. */
static size_t numerical_rank(const double *singular_values, size_t num_singular_values) {
    const double noise = (double)num_singular_values * DBL_EPSILON * singular_values[0];
    size_t rank = 0;
    while (rank < num_singular_values && singular_values[rank] > noise)
        rank++;
    return rank;
}

/* Returns the smallest number of modes that omits at most the allowed part of the energy. */
static size_t modes_by_energy(const double *singular_values, size_t rank, double discarded_energy) {
    double total = 0.0, left_out = 0.0;
    size_t num_modes = rank;
    // the sum starts with the weakest mode, so that small energies are not lost by round-off
    for (size_t i = rank; i-- > 0;)
        total += pow(singular_values[i] / singular_values[0], 2);
    for (; num_modes > 1; num_modes--) {
        left_out += pow(singular_values[num_modes - 1] / singular_values[0], 2);
        if (left_out > discarded_energy * total) break;
    }
    return num_modes;
}

/* Source: range of a double. Sums of squares of this value do not overflow for any number of nodes
 * and snapshots. */
static const double LARGEST_VALUE = 1e140;

/* Checks whether all values are finite and at most LARGEST_VALUE in magnitude. The loop has no
 * branch, so that the compiler can vectorise it. */
static bool are_usable(const double *values, size_t count) {
    size_t num_wrong = 0;

    for (size_t k = 0; k < count; k++)
        num_wrong += fabs(values[k]) <= LARGEST_VALUE ? 0 : 1;
    return num_wrong == 0;
}

ehd_status pod_check_snapshots(const double *snapshots, size_t count, size_t num_nodes,
                               size_t first, ehd_error *error) {
    size_t i = 0;

    if (are_usable(snapshots, count * num_nodes)) return EHD_OK;
    while (fabs(snapshots[i]) <= LARGEST_VALUE)
        i++;
    return ehd_fail(error, EHD_DATA,
                    "snapshots: found %g in snapshot %zu at node %zu, expected a finite number, at "
                    "most %g",
                    snapshots[i], first + i / num_nodes, i % num_nodes, LARGEST_VALUE);
}

static ehd_status choose_num_modes(size_t *num_modes, const double *singular_values,
                                   size_t num_singular_values, const pod_settings *settings,
                                   ehd_error *error) {
    const size_t rank = numerical_rank(singular_values, num_singular_values);
    if (rank == 0)
        return ehd_fail(error, EHD_DATA, "snapshots: found only zeros, expected rank > 0");
    if (settings->num_modes > rank && !settings->at_most)
        return ehd_fail(error, EHD_DATA,
                        "number of modes: found %zu, expected at most %zu, the snapshots' rank",
                        settings->num_modes, rank);
    *num_modes = settings->num_modes < rank ? settings->num_modes : rank;
    if (*num_modes == 0)
        *num_modes = modes_by_energy(singular_values, rank, settings->discarded_energy);
    return EHD_OK;
}

void pod_fix_sign(double *mode, size_t num_nodes) {
    size_t largest = 0;
    for (size_t node = 1; node < num_nodes; node++)
        if (fabs(mode[node]) > fabs(mode[largest])) largest = node;
    if (mode[largest] < 0.0)
        for (size_t node = 0; node < num_nodes; node++)
            mode[node] = -mode[node];
}

/* Work arrays of the following functions. All matrices are column-major. */
typedef struct pod_work {
    size_t num_nodes, num_states, num_values; // num_values = min(num_nodes, num_states)
    double *matrix;   // [num_nodes, num_states] the snapshots, later their QR or LQ factors
    double *scales;   // [num_values] factors of the reflectors of Q (LAPACK's tau)
    double *triangle; // [num_values, num_values] R or L
    double *left;     // [num_values, num_values] left singular vectors of `triangle`
    double *right;    // [num_values, num_values]
    arena memory;     // memory of all arrays except the matrix
} pod_work;

static void work_init(pod_work *work, double *matrix, size_t num_nodes, size_t num_states) {
    const size_t num = num_states < num_nodes ? num_states : num_nodes;

    *work = (pod_work){num_nodes, num_states, num, .matrix = matrix};
    work->scales = arena_array(&work->memory, num, sizeof(double));
    work->triangle = arena_table(&work->memory, num, num, sizeof(double));
    work->left = arena_table(&work->memory, num, num, sizeof(double));
    work->right = arena_table(&work->memory, num, num, sizeof(double));
}

/* Factorises the snapshots: Q R if there are more nodes than states, otherwise L Q. The triangular
 * factor, R or L, has the singular values of the snapshots. */
static ehd_status reduce_to_triangle(pod_work *work, ehd_error *error) {
    const int nodes = (int)work->num_nodes, states = (int)work->num_states;
    const int values = (int)work->num_values;
    const bool tall = nodes > states;
    lapack_int info;
    if (tall)
        info = LAPACKE_dgeqrf(LAPACK_COL_MAJOR, nodes, states, work->matrix, nodes, work->scales);
    else
        info = LAPACKE_dgelqf(LAPACK_COL_MAJOR, nodes, states, work->matrix, nodes, work->scales);
    if (info) return lapack_outcome(tall ? "dgeqrf" : "dgelqf", info, error);
    info = LAPACKE_dlacpy(LAPACK_COL_MAJOR, tall ? 'U' : 'L', values, values, work->matrix, nodes,
                          work->triangle, values);
    return lapack_outcome("dlacpy", info, error);
}

/* Computes the first num_modes left singular vectors of the snapshots: Q times the vectors of R, or
 * the vectors of L. */
static ehd_status form_modes(
    // output:
    pod_basis *basis, // in: num_modes, num_nodes; out: modes
    // input:
    const pod_work *work, ehd_error *error) {
    const size_t num_nodes = work->num_nodes, num_values = work->num_values;
    lapack_int info = 0;
    basis->modes = calloc(basis->num_modes * num_nodes, sizeof *basis->modes);
    if (!basis->modes) return ehd_no_memory(error, "POD");
    for (size_t mode = 0; mode < basis->num_modes; mode++)
        memcpy(basis->modes + mode * num_nodes, work->left + mode * num_values,
               num_values * sizeof *basis->modes);
    if (num_nodes > num_values)
        info = LAPACKE_dormqr(LAPACK_COL_MAJOR, 'L', 'N', (int)num_nodes, (int)basis->num_modes,
                              (int)num_values, work->matrix, (int)num_nodes, work->scales,
                              basis->modes, (int)num_nodes);
    for (size_t mode = 0; mode < basis->num_modes; mode++)
        pod_fix_sign(basis->modes + mode * num_nodes, num_nodes);
    return lapack_outcome("dormqr", info, error);
}

static ehd_status decompose(pod_basis *basis, pod_work *work, const pod_settings *settings,
                            ehd_error *error) {
    const int values = (int)work->num_values;
    ehd_status status = reduce_to_triangle(work, error);
    if (status) return status;
    status = lapack_outcome("dgesdd",
                            LAPACKE_dgesdd(LAPACK_COL_MAJOR, 'S', values, values, work->triangle,
                                           values, basis->singular_values, work->left, values,
                                           work->right, values),
                            error);
    if (status) return status;
    status = choose_num_modes(&basis->num_modes, basis->singular_values, work->num_values, settings,
                              error);
    return status ? status : form_modes(basis, work, error);
}

/* Computes the energy of all snapshots and of the omitted modes. Adds the weakest values first, so
 * that small energies are not lost by round-off. */
static void sum_up(pod_basis *basis) {
    for (size_t i = basis->num_singular_values; i-- > 0;) {
        const double square = basis->singular_values[i] * basis->singular_values[i];
        basis->energy += square;
        if (i >= basis->num_modes) basis->tail += square;
    }
}

ehd_status pod_decompose(pod_basis *basis, double *snapshots, size_t num_snapshots,
                         size_t num_nodes, const pod_settings *settings, ehd_error *error) {
    pod_work work;
    *basis = (pod_basis){.num_nodes = num_nodes, .num_snapshots = num_snapshots};
    ehd_status status = check_input(num_snapshots, num_nodes, settings, error);
    if (status) return status;

    work_init(&work, snapshots, num_nodes, num_snapshots);
    basis->num_singular_values = work.num_values;
    basis->singular_values = array_new(work.num_values, 1, sizeof *basis->singular_values);
    if (!basis->singular_values || work.memory.failed) status = ehd_no_memory(error, "POD");
    if (!status) status = decompose(basis, &work, settings, error);
    if (!status) sum_up(basis);
    arena_free(&work.memory);
    if (status) pod_free(basis);
    return status;
}

ehd_status pod_build(pod_basis *basis, const double *snapshots, size_t num_snapshots,
                     size_t num_nodes, const pod_settings *settings, ehd_error *error) {
    *basis = (pod_basis){0};
    ehd_status status = pod_check_snapshots(snapshots, num_snapshots, num_nodes, 0, error);
    if (status) return status;
    double *copy = array_new(num_snapshots, num_nodes, sizeof *copy);

    if (!copy) return ehd_no_memory(error, "POD");
    memcpy(copy, snapshots, num_snapshots * num_nodes * sizeof *copy);
    status = pod_decompose(basis, copy, num_snapshots, num_nodes, settings, error);
    free(copy);
    return status;
}

void pod_free(pod_basis *basis) {
    free(basis->modes);
    free(basis->singular_values);
    *basis = (pod_basis){0};
}

void pod_row(double *row, const pod_basis *basis, size_t i) {
    for (size_t k = 0; k < basis->num_nodes; k++)
        row[k] = basis->singular_values[i] * basis->modes[i * basis->num_nodes + k];
}

double pod_discarded(const pod_basis *basis) {
    const double length = sqrt(basis->tail) + basis->distance;
    // If the distance is zero, the bound is the tail itself. The square of the tail's root would
    // have additional round-off.
    const double omitted = basis->distance > 0 ? length * length : basis->tail;

    return basis->energy > 0 ? omitted / basis->energy : 0;
}

void pod_left_out(double *distance, const pod_basis *basis, const double *coordinates,
                  size_t stride, size_t num_states) {
    for (size_t s = 0; s < num_states; s++) {
        double length = 0, inverse = 0;
        for (size_t m = 0; m < basis->num_modes; m++) {
            const double along = coordinates[s * stride + m];
            const double singular = basis->singular_values[m];
            length = hypot(length, along);
            inverse = hypot(inverse, along / (singular * singular));
        }
        distance[s] = 1 / (inverse * length);
    }
}
