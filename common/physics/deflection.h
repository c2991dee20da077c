/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the elastic deflection of the half space: the convolution of pressure and kernel (eq. 10
 * of Maier et al.; README.md, Deflection), by FFT.
 * Called by fullrun in each iteration of GMRES, and by podbuild, deimselect and romrun for the
 * deflection of modes and states. */
#ifndef EHD_DEFLECTION_H
#define EHD_DEFLECTION_H

#include "common/physics/contact.h"
#include "common/program/status.h"
#include "common/program/team.h"
#include <stddef.h>

typedef struct ehd_deflection ehd_deflection;

/* Creates the deflection operator of a grid. Several threads may call this function at the same
 * time. In deflection_apply each thread needs an object of its own. Returns NULL when out of
 * memory. */
ehd_deflection *deflection_create(const contact_kind *kind, const ehd_grid *grid);
/* Like deflection_create, but the team `threads` shares the transforms of a half grid. The results
 * have the same bits as with one thread. The caller frees the team after the object. NULL: one
 * thread. */
ehd_deflection *deflection_create_shared(const contact_kind *kind, const ehd_grid *grid,
                                         team *threads);
ehd_deflection *deflection_free(ehd_deflection *deflection); // accepts and returns NULL

/* Returns the deflection at the distance (x, y) from a node, caused by unit pressure on the cell of
 * this node (eq. 10 of Maier et al. 2015). In the accurate discretisation the pressure is not
 * constant in the cell but has the curvature of the nodal pressures. To include this curvature,
 * 1/24 of the second differences of the kernel is subtracted from it (README.md, deflection). */
double deflection_influence(const contact_kind *kind, const ehd_grid *grid, double x, double y);

/* Returns the influence coefficients [grid lines, grid width]. Coefficient [l, d] is the deflection
 * at a node due to unit pressure on a cell that is l lines and d nodes away. */
const double *deflection_kernel(const ehd_deflection *deflection);

/* Computes Delta = K P in O(n log n). `delta` and `pressure` may be the same array. */
void deflection_apply(
    // output:
    double *delta, // [num_nodes], boundary nodes included
    // input:
    ehd_deflection *deflection,
    const double *pressure); // [num_nodes]

#endif
