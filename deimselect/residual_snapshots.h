/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The iterations that rows are selected from: in memory, or read from their file one after the other. */
#ifndef EHD_RESIDUAL_SNAPSHOTS_H
#define EHD_RESIDUAL_SNAPSHOTS_H

#include "common/artefact/artefact.h"
#include "podbuild/stream_pod.h"
#include <stdint.h>

/* The two sets of snapshots. */
typedef enum residual_kind {
    RESIDUALS, // D f
    PRODUCTS   // D J dz
} residual_kind;

extern const char *const residual_names[]; // "residuals", "Jacobian products"

/* A file of residuals while it is read once or twice. */
typedef struct residual_reader {
    artefact *file;
    const program *caller;  // shows how far a reading is; NULL: nobody
    size_t block, max_rank; // room that the PODs have (stream_pod.h)
} residual_reader;

/* Iterations of the training repeated with the projected system. */
typedef struct residual_snapshots {
    size_t count;
    double *residuals; // [count, num_inner] D f; NULL: they are read
    double *steps;     // [count, num_inner] D J dz
    int64_t *state; // [count] stationary training state that each belongs to, ascending, -1: none
    const residual_reader *reader; // of what is not in memory
} residual_snapshots;

/* Snapshots that `reader` reads. EHD_MEMORY. */
ehd_status residual_snapshots_init(residual_snapshots *snapshots, size_t count,
                                   const residual_reader *reader,
                                   ehd_error *error); // free with residual_snapshots_free

/* More iterations of a state to those in memory, of which there are none in a zero object. EHD_MEMORY. */
ehd_status residual_snapshots_append(
    // in and out:
    residual_snapshots *snapshots,
    // input:
    const double *residuals, const double *steps, // [count, num_inner]
    size_t count, int64_t state, size_t num_inner, ehd_error *error);

/* Memory for those that were to be read, which are in memory from now on. EHD_MEMORY. */
ehd_status residual_snapshots_hold(residual_snapshots *snapshots, size_t num_inner,
                                   ehd_error *error);
void residual_snapshots_free(residual_snapshots *snapshots);

/* Solutions whose residual has converged: the last iteration of each stationary state. */
size_t residual_snapshots_converged(const residual_snapshots *snapshots);

/* POD of a set, of at most so many modes. What is read is streamed: singular values above 1e-11 of the
 * first are found as long as there is room for their directions; where there is not the weakest give way,
 * as far as 1e-8 of the first. Errors as pod_build and stream_pod_add; EHD_INTERRUPTED. */
ehd_status residual_snapshots_pod(
    // output:
    pod_basis *pod, // free with pod_free
    // input:
    const residual_snapshots *snapshots, residual_kind kind, size_t num_inner, size_t num_modes,
    ehd_error *error);

/* The converged residuals, each of unit norm, or of those that are read fewer rows with the same Gram
 * matrix of their columns, but for 1e-12 of its trace, and 1e-8 where there is no room for more: all that
 * pivots of it depend on. Errors as above. */
ehd_status residual_snapshots_unit(
    // output:
    double **rows, // [*num_rows, num_inner]; free()
    size_t *num_rows,
    // input:
    const residual_snapshots *snapshots, size_t num_inner, ehd_error *error);

#endif
