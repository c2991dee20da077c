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
    size_t num_modes;        // wanted number; 0: by energy
    double discarded_energy; // with num_modes 0: the smallest number of modes for which the sum of
                             // the squared singular values left out is at most this part of all;
                             // never more than the numerical rank, never less than one
    bool at_most;            // num_modes is a limit: fewer where the numerical rank is less
} pod_settings;

/* Truncated POD (Sirovich 1987) by a thin SVD of the snapshots, because their Gram matrix would
 * lose every singular value below 1e-8 of the first. A QR or LQ factorisation comes first, so that
 * the SVD works on the small triangle and only the wanted modes are formed; that is no less
 * accurate than LAPACK's dgesdd alone, and up to twice as fast. Returns EHD_OK; EHD_DATA: no
 * snapshots, a non-finite one, or more modes wanted than the snapshots' numerical rank (singular
 * values above their number * epsilon * the first); EHD_MEMORY; EHD_INTERNAL (LAPACK). On failure
 * the basis is empty. */
ehd_status pod_build(
    // output:
    pod_basis *basis, // free with pod_free
    // input:
    const double *snapshots, // [num_states, num_nodes] row-major
    size_t num_states, size_t num_nodes, const pod_settings *settings, ehd_error *error);

/* How well each snapshot is told by all others: its distance from what these span, relative to its
 * own length. With U S Vᵀ the decomposition of the snapshots as rows, it is 1/|S^-1 Uᵀ e_i|, over
 * |S Uᵀ e_i|: the inverse of their Gram matrix has on its diagonal the inverse squares of these
 * distances. Only of a basis with as many modes as snapshots; with fewer the others tell each one
 * to what was left out. */
void pod_left_out(
    // output:
    double *distance, // [num_states]
    // input:
    const pod_basis *basis,    // its modes may be gone
    const double *coordinates, // of state s in the modes, from s * stride on
    size_t stride, size_t num_states);

/* EHD_DATA: a value that is not finite or above 1e140, where squares may overflow. `first`: the number of
 * the first of these snapshots, for the message. */
ehd_status pod_check_snapshots(const double *snapshots, // [count, num_nodes]
                               size_t count, size_t num_nodes, size_t first, ehd_error *error);

/* How many modes the settings ask for. EHD_DATA: more than the numerical rank, or only zeros. */
ehd_status pod_choose_num_modes(
    // output:
    size_t *num_modes,
    // input:
    const double *singular_values, // [num_singular_values] descending
    size_t num_singular_values, const pod_settings *settings, ehd_error *error);

/* The sign of a singular vector is arbitrary; makes the largest entry positive. */
void pod_fix_sign(double *mode, size_t num_nodes);

void pod_free(pod_basis *basis);

#endif
