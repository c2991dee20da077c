/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Holds the snapshots for row selection and computes their POD (README.md, What is selected from).
 * Each iteration of the training with the reduced basis gives one snapshot of each kind. The
 * snapshots are in memory, or are streamed from a file. Called by main.c, row_choice.c, row_plan.c
 * and control.c, and by snapgen. */
#ifndef EHD_RESIDUAL_SNAPSHOTS_H
#define EHD_RESIDUAL_SNAPSHOTS_H

#include "common/artefact/artefact.h"
#include "podbuild/pod_stream.h"
#include <stdint.h>

typedef enum residual_kind {
    RESIDUALS, // D f
    PRODUCTS   // D J dz
} residual_kind;

extern const char *const residual_names[]; // "residuals", "Jacobian products"

/* File of residuals that is streamed. */
typedef struct residual_reader {
    artefact *file;
    const program *caller;  // program that prints progress messages; NULL: no messages are printed
    size_t block, max_rank; // settings of the streams that compute the PODs (pod_stream.h)
} residual_reader;

/* Snapshots of the iterations of the training with the reduced basis and all rows. */
typedef struct residual_snapshots {
    size_t count;
    double *residuals; // [count, num_inner] D f; NULL: streamed by reader
    double *steps;     // [count, num_inner] D J dz; NULL: streamed by reader
    int64_t *state;    // [count] index of the stationary training state to which the iteration
                       // belongs, ascending; -1: the iteration belongs to no stationary state
    const residual_reader *reader; // NULL if all is in memory
} residual_snapshots;

/* Initialises snapshots that `reader` streams. Errors: EHD_MEMORY. */
ehd_status residual_snapshots_init(residual_snapshots *snapshots, size_t count,
                                   const residual_reader *reader,
                                   ehd_error *error); // free with residual_snapshots_free

/* Appends iterations of a state to snapshots in memory. In an object without snapshots all members
 * are zero. Errors: EHD_MEMORY. */
ehd_status residual_snapshots_append(
    // in and out:
    residual_snapshots *snapshots,
    // input:
    const double *residuals, const double *steps, // [count, num_inner]
    size_t count, int64_t state, size_t num_inner, ehd_error *error);

/* Allocates memory for the snapshots, which the caller has to fill. From this call on the snapshots
 * are in memory and are not streamed. Errors: EHD_MEMORY. */
ehd_status residual_snapshots_hold(residual_snapshots *snapshots, size_t num_inner,
                                   ehd_error *error);
void residual_snapshots_free(residual_snapshots *snapshots);

/* Returns the number of converged residuals, which are the residuals in the last iteration of each
 * stationary state. */
size_t residual_snapshots_converged(const residual_snapshots *snapshots);

/* Computes the POD of all snapshots of one kind, with at most num_modes modes. If the snapshots are
 * streamed, the POD keeps singular values above 1e-11 of the first one. If the memory does not
 * suffice for all directions, the stream drops directions with singular values below 1e-8 of the
 * first one. Errors as pod_build and pod_stream_add; EHD_INTERRUPTED. */
ehd_status residual_snapshots_pod(
    // output:
    pod_basis *pod, // free with pod_free
    // input:
    const residual_snapshots *snapshots, residual_kind kind, size_t num_inner, size_t num_modes,
    ehd_error *error);

/* Returns the converged residuals, each scaled to unit norm. If the residuals are streamed, returns
 * a matrix with fewer rows. Its columns have the same Gram matrix as the columns of the residuals,
 * up to 1e-12 of the trace, or up to 1e-8 if memory is short. The pivots of control_choose depend
 * only on this Gram matrix. Errors as residual_snapshots_pod. */
ehd_status residual_snapshots_unit(
    // output:
    double **rows, // [*num_rows, num_inner]; free()
    size_t *num_rows,
    // input:
    const residual_snapshots *snapshots, size_t num_inner, ehd_error *error);

#endif
