/* SPDX-License-Identifier: GPL-3.0-or-later */
/* POD of snapshots that arrive one after the other: hierarchical approximate POD (Himpe, Leibner
 * and Rave, SIAM J. Sci. Comput. 40(5), A3267, 2018) on a tree that is a chain of blocks.
 * Called by bases.c, by snapgen for trajectories, and by deimselect for residuals. */
#ifndef EHD_POD_STREAM_H
#define EHD_POD_STREAM_H

#include "common/program/status.h"
#include "podbuild/pod.h"
#include <stdbool.h>
#include <stddef.h>

typedef struct pod_stream_settings {
    // Parts of the energy of all snapshots so far, 0 <= … < 1. local_energy: squared distance of
    // the snapshots from the directions kept. dropped_energy: energy of directions that are dropped
    // for lack of room.
    double local_energy, dropped_energy;
    size_t block;    // number of snapshots that are added together
    size_t max_rank; // largest number of directions; 0: no limit
} pod_stream_settings;

typedef struct pod_stream pod_stream;

/* Creates a stream. Snapshots that fit in one block have the POD of pod_build, to the last bit.
 * Otherwise orthonormal directions Q, in rows, and a triangle R represent all snapshots so far:
 * their Gram matrix is Qᵀ Rᵀ R Q. For each block B of snapshots
 *
 *     A = B Qᵀ,   B' = B - A Q,   Q := [Q; V],   R := triangle of [R 0; A B' Vᵀ]
 *
 * V is the POD of B', up to the allowed distance. Nearly all of the work are two products, each as
 * large as the Gram matrix of Q and all snapshots.
 *
 * Error bound, with |.| the root of the sum of the squares of all entries. S are the snapshots, X
 * their projections on the directions, d = |S - X|² <= local_energy |S|², t <= dropped_energy |S|²
 * the energy of directions that were dropped. P are the modes kept at the end, and sigma' the
 * singular values behind them.
 *
 *     |S - S Pᵀ P| <= sqrt(sum sigma'² + t) + sqrt(d),   |sigma(X) - sigma(S)| <= sqrt(d)
 *
 * When directions are dropped, the SVD omits a positive semidefinite part of XᵀX, and the traces of
 * these parts add up. The triangle inequality adds S - X. If compressed
 * snapshots are streamed in place of others, their squared distance p adds sqrt(p) to the bound
 * (pod_stream_inherit).
 *
 * The result depends only on the snapshots, their order and the settings. */
ehd_status pod_stream_create(
    // output:
    pod_stream **self, // free with pod_stream_free; NULL on failure
    // input:
    size_t num_nodes, const pod_stream_settings *settings,
    ehd_error *error); // EHD_DATA: a setting out of range; EHD_MEMORY

pod_stream *pod_stream_free(pod_stream *self); // accepts and returns NULL

/* Adds snapshots. How they are divided among calls does not matter. Errors: EHD_DATA (a value that
 * is not finite or above 1e140; the stream is unchanged); EHD_MEMORY (also if there are more
 * directions than room), EHD_INTERNAL (LAPACK; after these the stream can only be freed). */
ehd_status pod_stream_add(
    // in and out:
    pod_stream *self,
    // input:
    const double *snapshots, size_t count, // [count, num_nodes] row-major
    ehd_error *error);

/* Adds the rows of a POD in place of its snapshots. Errors as pod_stream_add. */
ehd_status pod_stream_merge(pod_stream *self, const pod_basis *part, ehd_error *error);

/* Counts p, the squared distance of snapshots from the rows that were added in their place. Parts
 * hold different snapshots, so their p add up. */
void pod_stream_inherit(pod_stream *self, double squared_distance);

/* Returns the sum of the squares of all snapshots so far. */
double pod_stream_energy(const pod_stream *self);

/* Computes the modes. settings->discarded_energy bounds the omitted energy with d and t included,
 * but not p. The stream can only be freed afterwards. Errors as pod_build. */
ehd_status pod_stream_finish(
    // output:
    pod_basis *basis, // free with pod_free
    // in and out:
    pod_stream *self,
    // input:
    const pod_settings *settings, ehd_error *error);

// ---- memory

/* Returns the largest memory of a stream of num_snapshots snapshots, with its modes, bytes. */
double pod_stream_bytes(size_t num_nodes, size_t num_snapshots,
                        const pod_stream_settings *settings);

/* Returns the memory of all work with streams, bytes, for a given block size and largest number of
 * directions. */
typedef double pod_work_bytes(const void *work, size_t block, size_t max_rank);

/* Divides a memory limit between a block of snapshots and `least` to `most` directions. Returns
 * false if the limit, in bytes, is too small for `least` directions; then *block is 1 and *max_rank
 * is `least`. */
bool pod_stream_room(
    // output:
    size_t *block, size_t *max_rank,
    // input:
    size_t num_snapshots, size_t least, size_t most, double limit, pod_work_bytes *bytes,
    const void *work);

#endif
