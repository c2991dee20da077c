/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "podbuild/pod.h"

#include "common/algebra/lapack.h"

#include <float.h>
#include <lapacke.h>
#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* LAPACK reads a row-major [num_states, num_nodes] array as a num_nodes x num_states matrix with a
 * snapshot in each column. The modes are its left singular vectors, and nothing is transposed. */

static ehd_status check_input(const double *snapshots, size_t num_states, size_t num_nodes,
                              const pod_settings *settings, ehd_error *error) {
    if (num_states == 0 || num_nodes == 0 || num_states > INT_MAX || num_nodes > INT_MAX)
        return ehd_fail(error, EHD_DATA,
                        "snapshots: found %zu states of %zu nodes, expected 1 to %d", num_states,
                        num_nodes, INT_MAX);
    if (settings->num_modes == 0 && !(settings->discarded_energy >= 0.0))
        return ehd_fail(error, EHD_DATA, "discarded energy: found %g, expected >= 0",
                        settings->discarded_energy);
    for (size_t i = 0; i < num_states * num_nodes; i++)
        if (!isfinite(snapshots[i]))
            return ehd_fail(
                error, EHD_DATA,
                "snapshots: found %g in state %zu at node %zu, expected a finite number",
                snapshots[i], i / num_nodes, i % num_nodes);
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
    // sum up from the weakest on, so that small energies are not lost by round-off
    for (size_t i = rank; i-- > 0;)
        total += pow(singular_values[i] / singular_values[0], 2);
    for (; num_modes > 1; num_modes--) {
        left_out += pow(singular_values[num_modes - 1] / singular_values[0], 2);
        if (left_out > discarded_energy * total) break;
    }
    return num_modes;
}

/* Sums of squares of this value do not overflow for any number of nodes and snapshots. */
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

ehd_status pod_choose_num_modes(size_t *num_modes, const double *singular_values,
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
    size_t num_nodes, num_states, num_values; // num_values: the smaller of the other two
    double *matrix;   // [num_nodes, num_states] the snapshots, later their QR or LQ factors
    double *scales;   // [num_values] of the factors' reflectors
    double *triangle; // [num_values, num_values] R or L
    double *left;     // [num_values, num_values] left singular vectors of the triangle
    double *right;    // [num_values, num_values]
} pod_work;

static void work_free(pod_work *work) {
    free(work->matrix);
    free(work->scales);
    free(work->triangle);
    free(work->left);
    free(work->right);
}

static ehd_status work_allocate(pod_work *work, size_t num_nodes, size_t num_states,
                                ehd_error *error) {
    const size_t num_values = num_states < num_nodes ? num_states : num_nodes;
    *work = (pod_work){num_nodes, num_states, num_values, NULL, NULL, NULL, NULL, NULL};
    work->matrix = malloc(num_nodes * num_states * sizeof *work->matrix);
    work->scales = malloc(num_values * sizeof *work->scales);
    work->triangle = calloc(num_values * num_values, sizeof *work->triangle);
    work->left = malloc(num_values * num_values * sizeof *work->left);
    work->right = malloc(num_values * num_values * sizeof *work->right);
    if (work->matrix && work->scales && work->triangle && work->left && work->right) return EHD_OK;
    return ehd_fail(error, EHD_MEMORY, "POD of %zu snapshots: found no memory, expected %.0f MB",
                    num_states,
                    8e-6 * (double)(num_nodes * num_states + 3 * num_values * num_values));
}

/* Factorises the snapshots: Q R if there are more nodes than states, otherwise L Q. The triangle, R
 * or L, has the singular values of the snapshots. */
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
    status = pod_choose_num_modes(&basis->num_modes, basis->singular_values, work->num_values,
                                  settings, error);
    if (status) return status;
    return form_modes(basis, work, error);
}

ehd_status pod_build(pod_basis *basis, const double *snapshots, size_t num_states, size_t num_nodes,
                     const pod_settings *settings, ehd_error *error) {
    pod_work work = {0};
    ehd_status status;
    *basis = (pod_basis){0};

    status = check_input(snapshots, num_states, num_nodes, settings, error);
    if (status) return status;

    status = work_allocate(&work, num_nodes, num_states, error);
    if (status) goto done;
    basis->num_nodes = num_nodes;
    basis->num_singular_values = work.num_values;
    basis->singular_values = malloc(work.num_values * sizeof *basis->singular_values);
    if (!basis->singular_values) {
        status = ehd_no_memory(error, "POD");
        goto done;
    }
    memcpy(work.matrix, snapshots, num_nodes * num_states * sizeof *work.matrix);
    status = decompose(basis, &work, settings, error);
done:
    work_free(&work);
    if (status) pod_free(basis);
    return status;
}

void pod_free(pod_basis *basis) {
    free(basis->modes);
    free(basis->singular_values);
    *basis = (pod_basis){0};
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
