/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the POD of snapshots that arrive one after the other, by the hierarchical approximate
 * POD (Himpe, Leibner and Rave, SIAM J. Sci. Comput. 40(5), A3267, 2018). The tree of this method
 * is here a chain: blocks of snapshots are added one after the other.
 * Called by bases.c, by snapgen for trajectories, and by deimselect for residuals. */
#ifndef EHD_POD_STREAM_H
#define EHD_POD_STREAM_H

#include "common/program/status.h"
#include "podbuild/pod.h"
#include <stdbool.h>
#include <stddef.h>

typedef struct pod_stream_settings {
    // Energies that may be omitted, relative to the energy of all snapshots so far, 0 <= … < 1.
    // local_energy: squared distance of the snapshots from the span of the directions
    // (pod_stream_create). dropped_energy: energy of directions that are dropped because max_rank
    // is reached.
    double local_energy, dropped_energy;
    size_t block;    // number of snapshots that are processed together
    size_t max_rank; // largest number of directions; 0: no limit
} pod_stream_settings;

typedef struct pod_stream pod_stream;

/* Creates a stream. If all snapshots fit in one block, the result is bit-identical to that of
 * pod_build. Otherwise the rows of Q are orthonormal directions, and R is upper triangular. The
 * Gram matrix of all snapshots so far is Qᵀ Rᵀ R Q. Each block B of snapshots changes Q and R:
 *
 *     A = B Qᵀ,   B' = B - A Q,   Q := [Q; V],   R := triangle of [R 0; A B' Vᵀ]
 *
 * "triangle" is the triangular factor of a QR factorisation. V are the POD modes of B'; they
 * represent B' up to the allowed distance. Two matrix products, B Qᵀ and A Q, take nearly all of
 * the time.
 *
 * Error bound. |.| is the root of the sum of the squares of all entries, S are the snapshots, and X
 * their projections on the directions. d = |S - X|² is the squared distance, with d <= local_energy
 * |S|². t is the energy of dropped directions, with t <= dropped_energy |S|². P are the modes kept
 * at the end, and sigma' the singular values of the modes that are not kept.
 *
 *     |S - S Pᵀ P| <= sqrt(sum sigma'² + t) + sqrt(d),   |sigma(X) - sigma(S)| <= sqrt(d)
 *
 * Proof: when directions are dropped, the SVD omits a positive semidefinite part of XᵀX, and the
 * traces of these parts add up. By the triangle inequality, the bound also includes |S - X|. If
 * compressed snapshots are streamed in place of the original ones, p is the squared distance
 * between the two sets. The bound then increases by sqrt(p) (pod_stream_inherit).
 *
 * The result depends only on the snapshots, their order and the settings. */
ehd_status pod_stream_create(
    // output:
    pod_stream **self, // free with pod_stream_free; NULL on failure
    // input:
    size_t num_nodes, const pod_stream_settings *settings,
    ehd_error *error); // EHD_DATA: a setting out of range; EHD_MEMORY

pod_stream *pod_stream_free(pod_stream *self); // accepts and returns NULL

/* Adds snapshots. The result does not depend on how many snapshots each call adds. Errors:
 * EHD_DATA: a value is not finite or is above 1e140; the stream is unchanged. EHD_MEMORY (also if
 * the snapshots need more than max_rank directions) or EHD_INTERNAL (LAPACK): afterwards the stream
 * can only be freed. */
ehd_status pod_stream_add(
    // in and out:
    pod_stream *self,
    // input:
    const double *snapshots, size_t count, // [count, num_nodes] row-major
    ehd_error *error);

/* Adds the rows of a POD in place of the snapshots of this POD. Errors as pod_stream_add. */
ehd_status pod_stream_merge(pod_stream *self, const pod_basis *part, ehd_error *error);

/* Increases p (pod_stream_create) by the squared distance between original snapshots and the
 * compressed snapshots that were added in their place. Different compressed sets come from
 * different snapshots, so their squared distances add up. */
void pod_stream_inherit(pod_stream *self, double squared_distance);

/* Returns the sum of the squares of all snapshots so far. */
double pod_stream_energy(const pod_stream *self);

/* Computes the modes. settings->discarded_energy limits the omitted energy including d and t, but
 * without p. Afterwards the stream can only be freed. Errors as pod_build. */
ehd_status pod_stream_finish(
    // output:
    pod_basis *basis, // free with pod_free
    // in and out:
    pod_stream *self,
    // input:
    const pod_settings *settings, ehd_error *error);

// ---- memory

/* Returns the largest memory of a stream of num_snapshots snapshots and its modes, bytes. */
double pod_stream_bytes(size_t num_nodes, size_t num_snapshots,
                        const pod_stream_settings *settings);

/* Returns the memory of a whole computation with streams, bytes, for a block size and a largest
 * number of directions. `work`: data of this computation. */
typedef double pod_work_bytes(const void *work, size_t block, size_t max_rank);

/* Divides a memory limit, bytes, between a block of snapshots and `least` to `most` directions.
 * Returns false if the limit is too small for `least` directions. Then *block is 1 and *max_rank
 * is `least`. */
bool pod_stream_room(
    // output:
    size_t *block, size_t *max_rank,
    // input:
    size_t num_snapshots, size_t least, size_t most, double limit, pod_work_bytes *bytes,
    const void *work);

#endif
