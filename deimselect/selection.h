/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Selects the rows of the Reynolds equation that the online model evaluates, with a method from a
 * table (README.md, Methods).
 * Called by row_choice.c, and by exits.c and stability.c for the leading modes. */
#ifndef EHD_SELECTION_H
#define EHD_SELECTION_H

#include "common/program/status.h"
#include <stdbool.h>
#include <stddef.h>

/* POD bases of the weighted residuals and of the weighted products J dz (Maier et al. 2015,
 * section 3.2). */
typedef struct selection_bases {
    size_t num_nodes;
    size_t num_modes[2];              // of the residual basis and of the Jacobian basis
    const double *modes[2];           // [num_modes, num_nodes] row-major, orthonormal
    const double *singular_values[2]; // [num_modes]
    // modes that the rows have to determine at every exit:
    size_t num_leading;  // number of leading modes of each basis; 0: all modes
    size_t num_lines;    // number of grid lines, which have equal lengths; the nodes are numbered
                         // line by line; 0: one line
    size_t num_exits;    // number of different exits of training; successive exits are similar
    const size_t *exits; // [num_exits, num_lines] number of nodes of each line before the exit;
                         // nodes behind the exit have no effect
} selection_bases;

/* Selects num_rows distinct rows. For any k < num_rows, the first k of these rows are a selection
 * of k rows. Errors: EHD_DATA (the method cannot select so many rows), EHD_MEMORY, EHD_INTERNAL
 * (LAPACK). */
typedef ehd_status selection_function(
    // output:
    size_t *rows, // [num_rows]
    // input:
    const selection_bases *bases, size_t num_rows, ehd_error *error);

typedef struct selection_method {
    const char *name; // argument of --method, such as "joint"
    selection_function *select;
    size_t rows_per_mode; // largest number of rows for each mode of a basis; 0: no limit
    size_t copies;        // number of copies of a basis that the method makes
    bool keeps_exits;     // true: the method holds arrays for all exits at once (stability.h)
    const char *help;
} selection_method;

extern const selection_method selection_methods[]; // ends with an entry whose name is NULL

/* Method "joint": the algorithm of Maier et al. 2015, Fig. A1 (joint.c). */
selection_function selection_joint;
/* Method "qr": column-pivoted QR of both bases side by side (Drmac and Gugercin 2016;
 * pivoted_qr.c). */
selection_function selection_pivoted_qr;

/* Method "sopt": oversampled S-OPT, started by pivoted QR (Lauzon et al. 2022; s_opt.c). */
selection_function selection_s_opt;

/* Method "exits": the joint greedy method, then rows for the worst exit of training (exits.c). */
selection_function selection_exits;

/* Returns the bases with the leading modes only. */
selection_bases selection_leading(const selection_bases *bases);

/* Computes the smallest singular value sigma_min of modes[:num_columns] sampled at the rows. Gappy
 * least squares amplifies errors outside of the basis by at most 1/sigma_min. If there are fewer
 * rows than columns, the result is zero. */
ehd_status selection_sigma_min(
    // output:
    double *sigma_min,
    // input:
    const double *modes, size_t num_columns, size_t num_nodes, // [num_columns, num_nodes]
    const size_t *rows, size_t num_rows, ehd_error *error);

#endif
