/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Row selection: which rows of the Reynolds equation the online model evaluates. */
#ifndef EHD_SELECTION_H
#define EHD_SELECTION_H

#include "common/program/status.h"
#include <stdbool.h>
#include <stddef.h>

/* POD bases of the weighted residuals and of the weighted products J dz (Maier et al. 2015,
 * section 3.2). */
typedef struct selection_bases {
    size_t num_nodes;
    size_t num_modes[2];              // of the residual basis, of the Jacobian basis
    const double *modes[2];           // [num_modes, num_nodes] row-major, orthonormal
    const double *singular_values[2]; // [num_modes]
    // what the rows have to determine, whatever the exit
    size_t num_leading;  // leading modes of each basis; 0: all
    size_t num_lines;    // of equal length, which the nodes are on one after the other; 0: one
    size_t num_exits;    // of training, each once, neighbours like one another
    const size_t *exits; // [num_exits, num_lines] nodes of each line before the exit, which takes
                         // the others away
} selection_bases;

/* A method writes num_rows distinct rows in order, so that any prefix is a selection.
 * EHD_DATA when it cannot give as many rows; EHD_MEMORY; EHD_INTERNAL (LAPACK). */
typedef ehd_status selection_function(
    // output:
    size_t *rows, // [num_rows]
    // input:
    const selection_bases *bases, size_t num_rows, ehd_error *error);

typedef struct selection_method {
    const char *name; // "joint"
    selection_function *select;
    size_t rows_per_mode; // at most, of the modes of either basis; 0: any number of rows
    size_t copies;        // of a basis that it takes memory for, beside both
    bool keeps_exits;     // looks at all exits of training at once (stability.h)
    const char *help;
} selection_method;

extern const selection_method selection_methods[]; // ends with a row whose name is NULL

/* The algorithm of Maier et al. 2015, Fig. A1 (file joint.c). */
selection_function selection_joint;
/* Column-pivoted QR of both bases side by side (Drmac and Gugercin 2016) (file pivoted_qr.c). */
selection_function selection_pivoted_qr;

/* Oversampled S-OPT behind a start by pivoted QR (Lauzon et al. 2022) (file s_opt.c). */
selection_function selection_s_opt;

/* The joint greedy, then a row at a time for the worst exit of training (file exits.c). */
selection_function selection_exits;

/* The same bases without the modes behind the leading ones. */
selection_bases selection_leading(const selection_bases *bases);

/* The entry of this name, or NULL. */
const selection_method *selection_find(const char *name);

/* Smallest singular value of modes[:num_columns] sampled at the rows: 1/sigma_min bounds how much
 * gappy least squares amplifies what the basis does not hold. Zero with fewer rows than columns. */
ehd_status selection_sigma_min(
    // output:
    double *sigma_min,
    // input:
    const double *modes, size_t num_columns, size_t num_nodes, // [num_columns, num_nodes]
    const size_t *rows, size_t num_rows, ehd_error *error);

#endif
