/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compresses any number of snapshots in bounded memory while they arrive. */
#ifndef EHD_COMPRESS_H
#define EHD_COMPRESS_H

#include "common/program/status.h"
#include <stddef.h>

/* Compressed form of the snapshots S = W diag(sigma) U^T, [num_snapshots, num_nodes]. It holds C =
 * diag(sigma) U^T, which has the singular values and the right singular vectors of S. Later stages
 * (POD, row selection) therefore use the rows of C in place of the snapshots. */
typedef struct compressed_set {
    size_t rank, num_nodes;
    double *rows;            // [rank, num_nodes] row-major, strongest first, orthogonal; the
                             // largest entry of each row is positive; NULL if rank is 0
    double *singular_values; // [rank] descending, the norms of the rows; NULL if rank is 0
    size_t num_snapshots;
    double energy;           // sum of the squares of all snapshots
    double energy_discarded; // part of energy that all truncations omitted
} compressed_set;

typedef struct compressor_settings {
    double discarded_energy; // 0 <= … < 1: part of the energy that all truncations together may
                             // omit; 1e-22 keeps singular values above about 1e-11 of the first, 0
                             // omits only round-off
    size_t block;            // snapshots collected before a compression; 0: 512; fastest if near
                             // the rank
    size_t max_rank;         // upper limit of the rank, whatever energy that omits; 0: no limit
} compressor_settings;

typedef struct snapshot_compressor snapshot_compressor;

/* Creates a compressor for hierarchical approximate POD (Himpe, Leibner and Rave, SIAM J. Sci.
 * Comput. 40(5), A3267, 2018). A truncated SVD replaces each full block. A truncated SVD of their
 * rows joins two compressed parts of equally many blocks, like the carry of a binary counter.
 *
 * Energy: a truncation to C omits E = S^T S - C^T C. This matrix is positive semidefinite, and its
 * trace is the sum of the omitted squared singular values. The matrices E add up over the tree. The
 * trace d of their sum therefore bounds sigma_i(S)^2 - sigma_i(C)^2 >= 0 and the sum of the squared
 * distances of all snapshots from the rows of C.
 *
 * The source gives each level but the root an equal share of the allowed energy. The number of
 * levels of a stream is not known in advance. A part of level k = 0, 1, … (0: a block) with energy
 * e may therefore have omitted (k+1)/(k+2) e discarded_energy, with all parts below it. The result
 * may omit all of discarded_energy. Singular values below the numerical rank of pod_build are
 * always omitted as noise, and they count as omitted energy.
 *
 * Memory: O(num_nodes (block + rank log2(num_snapshots / block))), where rank is that of the parts.
 *
 * The result does not depend on how the snapshots are divided among calls. */
ehd_status compressor_create(
    // output:
    snapshot_compressor **self, // free with compressor_free; NULL on failure
    // input:
    size_t num_nodes, const compressor_settings *settings,
    ehd_error *error); // EHD_DATA: a setting out of range; EHD_MEMORY

snapshot_compressor *compressor_free(snapshot_compressor *self); // accepts and returns NULL

/* Adds snapshots. Values whose squares underflow count as zero. Errors: EHD_DATA (a value that is
 * not finite or above 1e140, where squares overflow; the compressor is unchanged); EHD_MEMORY,
 * EHD_INTERNAL (LAPACK; after these the compressor can only be freed). */
ehd_status compressor_add(
    // in and out:
    snapshot_compressor *self,
    // input:
    const double *snapshots, size_t count, // [count, num_nodes] row-major
    ehd_error *error);

/* Adds another set, for example of another trajectory, as if its snapshots were added. The energy
 * that the set has omitted counts in the result, but not against the discarded_energy of this
 * compressor. Merging in the same order gives the same bits. Errors as compressor_add; EHD_DATA
 * also if the set has another num_nodes or invalid energies. */
ehd_status compressor_merge(
    // in and out:
    snapshot_compressor *self,
    // input:
    const compressed_set *set, ehd_error *error);

/* Returns the compressed set of all snapshots so far in *result. More snapshots may be added
 * afterwards. The rank is 0 without snapshots, or if all of them are zero. Errors: EHD_MEMORY,
 * EHD_INTERNAL (LAPACK); *result is then empty. */
ehd_status compressor_finish(
    // output:
    compressed_set *result, // free with compressed_set_free
    // input:
    const snapshot_compressor *self, ehd_error *error);

void compressed_set_free(compressed_set *set);

#endif
