/* SPDX-License-Identifier: GPL-3.0-or-later */
/* POD of any number of snapshots that come one after the other, in memory that is given beforehand. */
#ifndef EHD_STREAM_POD_H
#define EHD_STREAM_POD_H

#include "common/program/status.h"
#include "podbuild/pod.h"
#include <stdbool.h>
#include <stddef.h>

typedef struct stream_settings {
    // parts of the energy of all snapshots so far, 0 <= … < 1: that their distance from the directions
    // kept may have, and that may be left out where directions have to give way
    double local_energy, root_energy;
    size_t block;    // snapshots that are taken up together
    size_t max_rank; // directions that there is room for
} stream_settings;

typedef struct stream_pod stream_pod;

/* Hierarchical approximate POD (Himpe, Leibner and Rave, SIAM J. Sci. Comput. 40(5), A3267, 2018) of
 * a tree that is a chain: each block is joined to what those before it have left. Orthonormal
 * directions Q and a triangle R stand for all snapshots so far, in that Qᵀ Rᵀ R Q is their Gram matrix.
 * Of a block B
 *
 *     A = B Qᵀ,   B' = B - A Q,   Q := [Q; V],   R := triangle of [R 0; A B' Vᵀ]
 *
 * where V is the POD of those rows of B' that are longer than may be left out, by their Gram matrix,
 * five decades at a time. Two products of the size of a Gram matrix of Q and all snapshots are nearly
 * all of the work, while a tree of SVDs (compress.h) takes ten of them.
 *
 * Error. With X the snapshots S as they are in Q and d = |S - X|² at most local_energy |S|² (squares of
 * all entries); t the energy of directions that gave way, at most root_energy |S|²; and sigma' behind
 * the modes P that are kept in the end,
 *
 *     |S - S Pᵀ P| <= sqrt(sum sigma'² + t) + sqrt(d),   |sigma(X) - sigma(S)| <= sqrt(d):
 *
 * where directions give way, the SVD leaves out a positive semidefinite part of XᵀX, and the traces of
 * these add up; S - X is added by the triangle inequality. A share w of the whole error for the
 * first root, hence w² of its energy, leaves (1 - w)² for d.
 *
 * The result does not depend on anything but the snapshots, their order and the settings. */
ehd_status stream_pod_create(
    // output:
    stream_pod **self, // free with stream_pod_free; NULL on failure
    // input:
    size_t num_nodes, const stream_settings *settings,
    ehd_error *error); // EHD_DATA: a setting out of range; EHD_MEMORY

stream_pod *stream_pod_free(stream_pod *self); // accepts and returns NULL

/* Bytes that a stream takes at most, of `max_modes` of its directions in the end. */
double stream_pod_bytes(size_t num_nodes, const stream_settings *settings);

/* Bytes that some work with streams takes in all, of blocks of so many and room for so many directions. */
typedef double stream_work_bytes(const void *work, size_t block, size_t max_rank);

/* How a limit is shared out between blocks of snapshots and `least` to `most` directions. False: it has no
 * room for the least, of which block and directions are then. */
bool stream_pod_room(
    // output:
    size_t *block, size_t *max_rank,
    // input:
    size_t num_snapshots, size_t least, size_t most, double limit, stream_work_bytes *bytes,
    const void *work);

/* EHD_DATA: a snapshot that is not finite or above 1e140. After the others the stream can only be freed:
 * EHD_MEMORY, also where directions are more than there is room for; EHD_INTERNAL (LAPACK). */
ehd_status stream_pod_add(
    // in and out:
    stream_pod *self,
    // input:
    const double *snapshot, // [num_nodes]
    ehd_error *error);

/* What the error's bound is made of. */
typedef struct stream_error {
    double energy;    // |S|²
    double distance;  // d
    double truncated; // t
} stream_error;

/* The modes: of `settings` the energy left out is that of the first root above, so that it counts t.
 * The stream has given its memory away and can only be freed. Errors as pod_build. */
ehd_status stream_pod_finish(
    // output:
    pod_basis *basis, // free with pod_free
    stream_error *bound,
    // in and out:
    stream_pod *self,
    // input:
    const pod_settings *settings, ehd_error *error);

#endif
