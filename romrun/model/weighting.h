/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes weights of the selected rows in the online least squares, in addition to D
 * (deimselect/README.md, Weights of the rows). The weights hold only for a list of rows as a whole,
 * so a part of the list needs other weights. Called by deimselect/row_choice.c, and by model_read.c
 * for a part of a model. */
#ifndef EHD_WEIGHTING_H
#define EHD_WEIGHTING_H

#include "common/program/status.h"
#include <stddef.h>

/* Computes one positive factor for each selected row. `sampled` holds the POD modes of the products
 * D J dz (deimselect/README.md) at these rows. There are as many modes as unknowns; over the rows
 * of all nodes they are orthonormal. Errors: EHD_MEMORY. */
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

extern const weighting weightings[]; // ends with an entry whose name is NULL

/* Sets all factors to 1, as published. */
weighting_function weighting_plain;

/* Computes quadrature weights with which the selected rows approximate the normal matrix of all
 * rows. Let q_k be the rows of an orthonormal basis of D J, so that sum_k q_k q_k^T = 1. The
 * weights are the w >= min_weight for which sum_r w_r q_r q_r^T over the selected rows is nearest
 * to 1 (Frobenius norm), as in empirical quadrature (Farhat et al. 2014; Hernandez et al. 2017).
 * The factor is sqrt(w_r). */
weighting_function weighting_quadrature;

#endif
