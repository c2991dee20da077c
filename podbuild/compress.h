/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compression of any number of snapshots while they arrive, in bounded memory. */
#ifndef EHD_COMPRESS_H
#define EHD_COMPRESS_H

#include "common/program/status.h"
#include <stddef.h>

/* A set of snapshots S [num_snapshots, num_nodes] = W diag(sigma) U^T, held as C = diag(sigma) U^T:
 * it has the singular values and the right singular vectors of S, so that its rows serve every
 * later stage (POD, row selection) in place of the snapshots. */
typedef struct compressed_set {
    size_t rank, num_nodes;
    double *rows;            // [rank, num_nodes] row-major, strongest first, orthogonal; the
                             // largest entry of each is positive; NULL with rank 0
    double *singular_values; // [rank] descending, the lengths of the rows; NULL with rank 0
    size_t num_snapshots;
    double energy;           // sum of the squares of all snapshots
    double energy_discarded; // part of it that truncations left out, all of them together
} compressed_set;

typedef struct compressor_settings {
    double discarded_energy; // 0 <= … < 1: part of the energy that may be left out in all; 1e-22
                             // keeps singular values above about 1e-11 of the first, 0 all but
                             // rounding
    size_t block;            // snapshots collected before a compression; 0: 512; fastest near the
                             // rank
    size_t max_rank;         // bound of the rank, whatever that leaves out; 0: none but num_nodes
} compressor_settings;

typedef struct snapshot_compressor snapshot_compressor;

/* Hierarchical approximate POD (Himpe, Leibner and Rave, SIAM J. Sci. Comput. 40(5), A3267, 2018):
 * each full block is replaced by its truncated SVD, and two compressed parts of equally many blocks
 * by that of their rows, like the carry of a binary counter.
 *
 * Energy. A truncation to C leaves out E = S^T S - C^T C, which is positive semidefinite and has
 * the sum of the squared singular values left out as its trace. Such E add up over the tree, so
 * that their sum d bounds both sigma_i(S)^2 - sigma_i(C)^2 >= 0 and the squared distance of all
 * snapshots to the rows of C. The source gives each level but the root an equal share of what may
 * be left out; a stream does not know its number of levels, hence a part of level k = 0, 1, … (a
 * block is 0) with energy e may have lost (k+1)/(k+2) e discarded_energy with all below it, and the
 * result all of it. Singular values below pod_build's numerical rank are noise and go in any case;
 * they are counted.
 *
 * Memory. O(num_nodes (block + rank log2(num_snapshots / block))), rank being that of the parts.
 *
 * The result does not depend on how the snapshots are divided among calls. */
ehd_status compressor_create(
    // output:
    snapshot_compressor **self, // free with compressor_free; NULL on failure
    // input:
    size_t num_nodes, const compressor_settings *settings,
    ehd_error *error); // EHD_DATA: a setting out of range; EHD_MEMORY

snapshot_compressor *compressor_free(snapshot_compressor *self); // accepts and returns NULL

/* EHD_DATA: a snapshot is not finite or above 1e140, where squares overflow; the compressor is as
 * before. EHD_MEMORY, EHD_INTERNAL (LAPACK): the compressor can only be freed. Values whose squares
 * underflow count as zero. */
ehd_status compressor_add(
    // in and out:
    snapshot_compressor *self,
    // input:
    const double *snapshots, size_t count, // [count, num_nodes] row-major
    ehd_error *error);

/* Takes up another set (of another trajectory, say) as if its snapshots had been added. What it has
 * lost is counted, but is not part of this compressor's discarded_energy. Merging in the same order
 * gives the same bits. Errors as compressor_add; EHD_DATA also where the set is not a valid one for
 * this num_nodes. */
ehd_status compressor_merge(
    // in and out:
    snapshot_compressor *self,
    // input:
    const compressed_set *set, ehd_error *error);

/* The set so far; the compressor may go on afterwards. Without snapshots, or with zeros only, its
 * rank is 0. EHD_MEMORY, EHD_INTERNAL (LAPACK): the result is empty. */
ehd_status compressor_finish(
    // output:
    compressed_set *result, // free with compressed_set_free
    // input:
    const snapshot_compressor *self, ehd_error *error);

void compressed_set_free(compressed_set *set);

#endif
