/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the POD of snapshots that arrive one by one, in a fixed amount of memory. */
#ifndef EHD_STREAM_POD_H
#define EHD_STREAM_POD_H

#include "common/program/status.h"
#include "podbuild/pod.h"
#include <stdbool.h>
#include <stddef.h>

typedef struct stream_settings {
    // Parts of the energy of all snapshots so far, 0 <= … < 1. local_energy: squared distance of
    // the snapshots from the directions kept. root_energy: energy of directions that are dropped
    // for lack of room.
    double local_energy, root_energy;
    size_t block;    // number of snapshots that are added together
    size_t max_rank; // largest number of directions
} stream_settings;

typedef struct stream_pod stream_pod;

/* Creates a stream for hierarchical approximate POD (Himpe, Leibner and Rave, SIAM J. Sci. Comput.
 * 40(5), A3267, 2018) on a tree that is a chain. Orthonormal directions Q, in rows, and a triangle
 * R represent all snapshots so far: their Gram matrix is Qᵀ Rᵀ R Q. For each block B of snapshots
 *
 *     A = B Qᵀ,   B' = B - A Q,   Q := [Q; V],   R := triangle of [R 0; A B' Vᵀ]
 *
 * V is the POD of those rows of B' that are longer than the allowed distance. It comes from their
 * Gram matrix, five decades at a time. Nearly all of the work are two products, each as large as
 * the Gram matrix of Q and all snapshots. A tree of SVDs (compress.h) takes ten of them.
 *
 * Error bound, with |.| the root of the sum of the squares of all entries. S are the snapshots, X
 * their projections on the directions, d = |S - X|² <= local_energy |S|², t <= root_energy |S|² the
 * energy of directions that were dropped. P are the modes kept at the end, and sigma' the singular
 * values behind them.
 *
 *     |S - S Pᵀ P| <= sqrt(sum sigma'² + t) + sqrt(d),   |sigma(X) - sigma(S)| <= sqrt(d)
 *
 * When directions are dropped, the SVD omits a positive semidefinite part of XᵀX, and the traces of
 * these parts add up. The triangle inequality adds S - X. If the first root gets the share w of the
 * whole error, its energy is w² of the whole, and (1 - w)² remains for d.
 *
 * The result depends only on the snapshots, their order and the settings. */
ehd_status stream_pod_create(
    // output:
    stream_pod **self, // free with stream_pod_free; NULL on failure
    // input:
    size_t num_nodes, const stream_settings *settings,
    ehd_error *error); // EHD_DATA: a setting out of range; EHD_MEMORY

stream_pod *stream_pod_free(stream_pod *self); // accepts and returns NULL

/* Returns the largest memory of a stream, bytes. */
double stream_pod_bytes(size_t num_nodes, const stream_settings *settings);

/* Returns the memory of all work with streams, bytes, for a given block size and largest number of
 * directions. */
typedef double stream_work_bytes(const void *work, size_t block, size_t max_rank);

/* Divides a memory limit between a block of snapshots and `least` to `most` directions. Returns
 * false if the limit, in bytes, is too small for `least` directions; then *block is 1 and *max_rank
 * is `least`. */
bool stream_pod_room(
    // output:
    size_t *block, size_t *max_rank,
    // input:
    size_t num_snapshots, size_t least, size_t most, double limit, stream_work_bytes *bytes,
    const void *work);

/* Adds a snapshot. Errors: EHD_DATA (a value that is not finite or above 1e140; the stream is
 * unchanged); EHD_MEMORY (also if there are more directions than room), EHD_INTERNAL (LAPACK; after
 * these the stream can only be freed). */
ehd_status stream_pod_add(
    // in and out:
    stream_pod *self,
    // input:
    const double *snapshot, // [num_nodes]
    ehd_error *error);

/* Terms of the error bound, see stream_pod_create. */
typedef struct stream_error {
    double energy;    // |S|²
    double distance;  // d
    double truncated; // t
} stream_error;

/* Computes the modes. settings->discarded_energy is the part of the energy that the first root of
 * the error bound may have, t included. The arrays of the stream move to *basis; the stream can
 * only be freed afterwards. Errors as pod_build. */
ehd_status stream_pod_finish(
    // output:
    pod_basis *basis, // free with pod_free
    stream_error *bound,
    // in and out:
    stream_pod *self,
    // input:
    const pod_settings *settings, ehd_error *error);

#endif
