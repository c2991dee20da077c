/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Elastic deflection of the half space: a Toeplitz convolution, by FFT. */
#ifndef EHD_DEFLECTION_H
#define EHD_DEFLECTION_H

#include "common/physics/contact.h"
#include "common/program/status.h"
#include <stddef.h>

typedef struct ehd_deflection ehd_deflection;

/* Plans are made here and are not thread-safe; applying is, with one object a thread. Returns NULL
 * when out of memory. */
ehd_deflection *deflection_create(const contact_kind *kind, const ehd_grid *grid);
ehd_deflection *deflection_free(ehd_deflection *deflection); // accepts and returns NULL

/* Influence of a cell on a node some lines and nodes away; [grid lines, grid width] values. */
const double *deflection_kernel(const ehd_deflection *deflection);

/* Delta = K P, eq. (10) discretised with piecewise-constant pressure, O(n log n).
 * `delta` and `pressure` may be the same array. */
void deflection_apply(
    // output:
    double *delta, // [num_nodes], boundary nodes included
    // input:
    ehd_deflection *deflection,
    const double *pressure); // [num_nodes]

#endif
