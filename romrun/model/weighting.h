/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Weights of the selected rows in the online least squares, besides D. They belong to a list of
 * rows as a whole, so that a part of it has weights of its own. */
#ifndef EHD_WEIGHTING_H
#define EHD_WEIGHTING_H

#include "common/program/status.h"
#include <stddef.h>

/* Writes one positive factor a row. `sampled`: the leading modes of the weighted Jacobian products,
 * as many as unknowns, at the rows; over all nodes they are orthonormal. EHD_MEMORY. */
typedef ehd_status weighting_function(
    // output:
    double *factors, // [num_rows]
    // input:
    const double *sampled, size_t num_rows, size_t num_modes, // [num_rows, num_modes]
    ehd_error *error);

typedef struct weighting {
    const char *name; // "quadrature"
    weighting_function *weigh;
    const char *help;
} weighting;

extern const weighting weightings[]; // ends with a row whose name is NULL

/* The entry of this name, or NULL. */
const weighting *weighting_find(const char *name);

/* One for every row, as published. */
weighting_function weighting_plain;

/* Quadrature weights with which the selected rows approximate the normal matrix of all rows: sum_k
 * q_k q_k^T = 1 over the rows q_k of an orthonormal basis of D J. Finds w >= min_weight such that
 * sum_r w_r q_r q_r^T over the selected rows is nearest to it (Frobenius), as in empirical
 * quadrature (Farhat et al. 2014; Hernandez et al. 2017). The factor is sqrt(w_r). */
weighting_function weighting_quadrature;

#endif
