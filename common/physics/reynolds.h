/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The Reynolds operator, written once, for any list of rows.
 *
 * A row is the residual f of d/dx(eps dP/dx) + d/dy(eps dP/dy) = U d(rho H)/dx + d(rho H)/dT at a node (eq. 7 without
 * multiplier) and its derivatives with respect to pressure and film at the stencil's nodes. Who asks for which rows,
 * and how P and H depend on the unknowns, is the solvers' business. */
#ifndef EHD_REYNOLDS_H
#define EHD_REYNOLDS_H

#include "common/physics/contact.h"
#include <stddef.h>

/* Nodes of a row's stencil, named by the entrainment's direction. A line contact has no sides. */
enum {
    NODE_BACK2,
    NODE_BACK,
    NODE_HERE,
    NODE_AHEAD,
    NUM_LINE_STENCIL,
    NODE_LEFT = NUM_LINE_STENCIL,
    NODE_RIGHT,
    NUM_STENCIL
};
#define NO_NODE ((size_t)-1) // as BACK2 of the first inner node: first-order entrainment there

typedef struct reynolds_stencil {
    size_t node[NUM_STENCIL]; // into the arrays of nodes given to reynolds_rows
} reynolds_stencil;

typedef struct reynolds_row {
    double residual;
    double by_pressure[NUM_STENCIL];
    double by_film[NUM_STENCIL];
} reynolds_row;

/* Fluid at a list of nodes. Arrays [num_nodes]; owned by the caller. */
typedef struct reynolds_fluid {
    double *mobility;       // rho/(eta lambda), so that eps = mobility H^3
    double *mobility_slope; // with respect to the dimensionless pressure
    double *density;        // NULL when incompressible
    double *density_slope;
} reynolds_fluid;

/* The time derivative at the rows' nodes: rate * rho H + earlier. */
typedef struct reynolds_squeeze {
    double rate; // 1 / dimensionless time
    const double
        *earlier; // [num_rows] weighted sum of rho H of earlier states, in the current frame
} reynolds_squeeze;

/* Stencil of inner node `node` of a grid, entrainment towards larger x. On the mirror line of a half grid both
 * sides are the same node. */
reynolds_stencil reynolds_stencil_at(const ehd_grid *grid, size_t node);

/* Fluid properties at the given pressures. */
void reynolds_fluid_evaluate(
    // output:
    reynolds_fluid *fluid,
    // input:
    const ehd_contact *contact, const double *pressure, // [num_nodes]
    size_t num_nodes);

/* Residual and derivatives of the rows whose stencils are given (model.md, section 2: central
 * pressure flow with the mean of the nodal eps at half nodes, second-order backward entrainment). */
void reynolds_rows(
    // output:
    reynolds_row *rows, // [num_rows]
    // input:
    double step, double entrainment,  // grid step; U of eq. (7), 1 when steady
    const reynolds_squeeze *squeeze,  // NULL when steady
    const reynolds_stencil *stencils, // [num_rows]
    size_t num_rows,
    const reynolds_fluid *fluid, // arrays [num_nodes]
    const double *pressure,      // [num_nodes]
    const double *film);         // [num_nodes]

#endif
