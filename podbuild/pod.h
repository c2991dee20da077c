/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Proper orthogonal decomposition of a set of snapshots. */
#ifndef EHD_POD_H
#define EHD_POD_H

#include "common/program/status.h"
#include <stdbool.h>
#include <stddef.h>

typedef struct pod_basis {
    size_t num_modes;
    size_t num_nodes;
    size_t num_singular_values;
    double *modes;           // [num_modes, num_nodes] row-major, orthonormal, strongest first; the
                             // largest entry of each mode is positive
    double *singular_values; // [num_singular_values], all of them, descending
} pod_basis;

typedef struct pod_settings {
    size_t num_modes;        // number of modes; 0: by discarded_energy
    double discarded_energy; // used if num_modes is 0: the number of modes is the smallest for
                             // which the omitted squared singular values sum up to at most this
                             // part of all; at most the numerical rank, at least one
    bool at_most;            // num_modes is an upper limit: take fewer modes if the numerical rank
                             // is less
} pod_settings;

/* Computes a truncated POD (Sirovich 1987) by a thin SVD of the snapshots. Their Gram matrix would
 * lose all singular values below 1e-8 of the first. A QR or LQ factorisation comes first, so that
 * the SVD works on a small triangle and only the wanted modes are formed. This is as accurate as
 * LAPACK's dgesdd alone and up to twice as fast.
 *
 * Errors: EHD_DATA (no snapshots, a value that is not finite, or more modes wanted than the
 * numerical rank, the number of singular values above their number * epsilon * the first);
 * EHD_MEMORY; EHD_INTERNAL (LAPACK). On failure the basis is empty. */
ehd_status pod_build(
    // output:
    pod_basis *basis, // free with pod_free
    // input:
    const double *snapshots, // [num_states, num_nodes] row-major
    size_t num_states, size_t num_nodes, const pod_settings *settings, ehd_error *error);

/* Computes the distance of each snapshot from the span of all others, relative to its own norm. Let
 * U S Vᵀ be the SVD of the matrix with a snapshot in each row. The distance is then 1/|S^-1 Uᵀ
 * e_i|, because the diagonal of the inverse Gram matrix holds the inverse squares of the distances,
 * and the norm is |S Uᵀ e_i|. Valid only for a basis with as many modes as snapshots. With fewer
 * modes the others represent each snapshot up to the truncation error. */
void pod_left_out(
    // output:
    double *distance, // [num_states]
    // input:
    const pod_basis *basis,    // basis->modes is not used and may be NULL
    const double *coordinates, // coordinates of state s in the modes begin at s * stride
    size_t stride, size_t num_states);

/* Checks snapshots. EHD_DATA: a value that is not finite or above 1e140, where squares may
 * overflow. `first`: number of the first of these snapshots, for the error message. */
ehd_status pod_check_snapshots(const double *snapshots, // [count, num_nodes]
                               size_t count, size_t num_nodes, size_t first, ehd_error *error);

/* Returns the number of modes that the settings select in *num_modes. EHD_DATA: more modes wanted
 * than the numerical rank, or all singular values are zero. */
ehd_status pod_choose_num_modes(
    // output:
    size_t *num_modes,
    // input:
    const double *singular_values, // [num_singular_values] descending
    size_t num_singular_values, const pod_settings *settings, ehd_error *error);

/* Multiplies a mode by 1 or -1, so that its entry of largest magnitude is positive. */
void pod_fix_sign(double *mode, size_t num_nodes);

void pod_free(pod_basis *basis);

#endif
