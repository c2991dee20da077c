/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the proper orthogonal decomposition (POD) of one block of snapshots. The modes are the
 * left singular vectors of the matrix with a snapshot in each column (Sirovich, Quart. Appl. Math.
 * 45, 1987).
 * Called by pod_stream.c for each block, and by deimselect for residuals. */
#ifndef EHD_POD_H
#define EHD_POD_H

#include "common/program/status.h"
#include <stdbool.h>
#include <stddef.h>

/* A truncated POD. Row i of the POD is mode i times its singular value. The matrix R of these rows
 * can replace the matrix S of the snapshots: Rᵀ R equals Sᵀ S, except for the omitted modes. */
typedef struct pod_basis {
    size_t num_modes;
    size_t num_nodes;
    size_t num_singular_values;
    double *modes;           // [num_modes, num_nodes] row-major, orthonormal, strongest first; the
                             // entry of largest magnitude of each mode is positive
    double *singular_values; // [num_singular_values] descending, including the omitted modes
    size_t num_snapshots;
    double energy; // sum of the squares of all snapshots
    double tail;   // energy of the omitted modes and of directions that a stream dropped
    // Upper bound of the distance (root of the sum of squares) between the given snapshots and
    // their approximations, which a stream decomposes (pod_stream.h). 0 for one block of snapshots.
    double distance;
} pod_basis;

typedef struct pod_settings {
    size_t num_modes;        // number of modes; 0: discarded_energy determines the number
    double discarded_energy; // used if num_modes is 0: fraction of the sum of all squared singular
                             // values that may be omitted. The smallest number of modes that meets
                             // this limit is taken: at least one, at most the numerical rank
    bool at_most;            // true: num_modes is an upper limit, and fewer modes are taken if the
                             // numerical rank is less
} pod_settings;

/* Computes a truncated POD by a thin SVD of the snapshots. A POD by their Gram matrix would lose
 * all singular values below 1e-8 of the first. A QR or LQ factorisation comes first. The SVD then
 * works on a small triangular matrix, and only the wanted modes are formed. This method is as
 * accurate as LAPACK's dgesdd alone and up to twice as fast.
 *
 * Errors: EHD_DATA (as pod_check_snapshots, no snapshots, only zeros, or more modes wanted than the
 * numerical rank); EHD_MEMORY; EHD_INTERNAL (LAPACK). The numerical rank is the number of singular
 * values above n * epsilon * the first, where n is the number of all singular values. On failure
 * the basis is empty. */
ehd_status pod_build(
    // output:
    pod_basis *basis, // free with pod_free
    // input:
    const double *snapshots, // [num_snapshots, num_nodes] row-major
    size_t num_snapshots, size_t num_nodes, const pod_settings *settings, ehd_error *error);

/* Like pod_build, but overwrites the snapshots instead of copying them. It does not check them. */
ehd_status pod_decompose(pod_basis *basis, double *snapshots, size_t num_snapshots,
                         size_t num_nodes, const pod_settings *settings, ehd_error *error);

void pod_free(pod_basis *basis);

/* Computes row i, [num_nodes]: the singular value times the mode. */
void pod_row(double *row, const pod_basis *basis, size_t i);

/* Returns an upper bound of the energy that the modes omit, relative to the energy of all
 * snapshots: (sqrt(tail) + distance)² / energy. */
double pod_discarded(const pod_basis *basis);

/* Computes the distance of each snapshot from the span of all other snapshots, relative to the norm
 * of the snapshot. X = U S Vᵀ is the SVD of the matrix with a snapshot in each row. The inverse of
 * the Gram matrix X Xᵀ is U S^-2 Uᵀ. Its diagonal holds the inverse squares of the distances, so
 * the distance of snapshot i is 1/|S^-1 Uᵀ e_i|. The norm of snapshot i is |S Uᵀ e_i|. The basis
 * must have as many modes as snapshots, because with fewer modes X Xᵀ has no inverse. */
void pod_left_out(
    // output:
    double *distance, // [num_states]
    // input:
    const pod_basis *basis,    // basis->modes is not used and may be NULL
    const double *coordinates, // coordinates of state s in the modes begin at s * stride
    size_t stride, size_t num_states);

/* Checks snapshots. EHD_DATA: a value that is not finite or above 1e140, where squares may
 * overflow. `first`: number that the error message gives to the first snapshot. */
ehd_status pod_check_snapshots(const double *snapshots, // [count, num_nodes]
                               size_t count, size_t num_nodes, size_t first, ehd_error *error);

/* Multiplies a mode by 1 or -1, so that its entry of largest magnitude is positive. */
void pod_fix_sign(double *mode, size_t num_nodes);

#endif
