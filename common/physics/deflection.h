/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Elastic deflection of the half space: the convolution of pressure and kernel, by FFT. */
#ifndef EHD_DEFLECTION_H
#define EHD_DEFLECTION_H

#include "common/physics/contact.h"
#include "common/program/status.h"
#include "common/program/team.h"
#include <stddef.h>

typedef struct ehd_deflection ehd_deflection;

/* May be called from several threads; each thread applies an object of its own. Returns NULL when
 * out of memory. */
ehd_deflection *deflection_create(const contact_kind *kind, const ehd_grid *grid);
/* The same, of a half grid with lines and columns that those threads transform, which its caller frees after
 * it; the bits are those of one thread. NULL: none. */
ehd_deflection *deflection_create_shared(const contact_kind *kind, const ehd_grid *grid,
                                         team *threads);
ehd_deflection *deflection_free(ehd_deflection *deflection); // accepts and returns NULL

/* Deflection at a distance (along, across) from a node of unit pressure: that of its cell (eq. 10
 * of Maier et al. 2015). In the accurate discretisation the pressure is not constant in the cell
 * but has the nodes' curvature, whose integral over the cell, step^2/24 of the second differences,
 * is carried by the neighbouring nodes (README.md, deflection). */
double deflection_influence(const contact_kind *kind, const ehd_grid *grid, double x, double y);

/* Influence coefficients: deflection at a node by unit pressure in a cell that is l lines and d
 * nodes away; [grid lines, grid width]. */
const double *deflection_kernel(const ehd_deflection *deflection);

/* Delta = K P, O(n log n). `delta` and `pressure` may be the same array. */
void deflection_apply(
    // output:
    double *delta, // [num_nodes], boundary nodes included
    // input:
    ehd_deflection *deflection,
    const double *pressure); // [num_nodes]

#endif
