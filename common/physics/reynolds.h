/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the discrete Reynolds operator, for any list of rows.
 *
 * A row is the residual of d/dx(eps dP/dx) + d/dy(eps dP/dy) = U d(rho H)/dx + d(rho H)/dT at a
 * node (eq. 7 of Maier et al. 2015 without the multiplier of cavitation) and its derivatives with
 * respect to pressure and film at the nodes of its stencil. Each solver chooses the rows, and
 * relates P and H to its own unknowns.
 * Called by fullrun/full_solver.c and romrun/solve/row_system.c in each iteration, by
 * romrun/solve/exit_search.c, and by romrun/trust. */
#ifndef EHD_REYNOLDS_H
#define EHD_REYNOLDS_H

#include "common/physics/contact.h"
#include <stddef.h>

/* Nodes of a row's stencil. BACK lies upstream of HERE, and AHEAD downstream. Only point contacts
 * and ellipses have nodes across the entrainment. The published discretisation does not use BACK3,
 * AHEAD2, LEFT2 and RIGHT2. Only the discretisation with cross fluxes uses the last four nodes,
 * which lie to the left and right of BACK and AHEAD. */
enum {
    NODE_BACK3,
    NODE_BACK2,
    NODE_BACK,
    NODE_HERE,
    NODE_AHEAD,
    NODE_AHEAD2,
    NUM_LINE_STENCIL,
    NODE_LEFT2 = NUM_LINE_STENCIL,
    NODE_LEFT,
    NODE_RIGHT,
    NODE_RIGHT2,
    NUM_CROSS_STENCIL,
    NODE_BACK_LEFT = NUM_CROSS_STENCIL,
    NODE_BACK_RIGHT,
    NODE_AHEAD_LEFT,
    NODE_AHEAD_RIGHT,
    NUM_STENCIL
};
#define NO_NODE ((size_t)-1) // beyond the boundary nodes, or not used by the discretisation

typedef struct reynolds_stencil {
    size_t node[NUM_STENCIL]; // indices into the arrays given to reynolds_rows, or NO_NODE
} reynolds_stencil;

typedef struct reynolds_row {
    double residual;
    double by_pressure[NUM_STENCIL];
    double by_film[NUM_STENCIL];
} reynolds_row;

/* Fluid properties at a list of nodes. Arrays [num_nodes]. */
typedef struct reynolds_fluid {
    double *mobility;       // rho/(eta lambda), so that eps = mobility H^3
    double *mobility_slope; // derivative with respect to the dimensionless pressure
    double *log_mobility;   // ln mobility up to a constant; NULL in the published discretisation
    double *density;        // NULL when incompressible
    double *density_slope;
    // contact whose viscosity law is also evaluated half way between two nodes; NULL: the mean of
    // both nodes is enough
    const ehd_contact *between;
    const ehd_contact *thinned; // contact with a thinned flow (README.md); NULL: not thinned
    // rate N of the Eyring fluid (eyring_flow.h) at H = 1 and rho / mobility = 1
    double thinning;
    // gradient Sigma along the entrainment, at H = 1 and a pressure difference of 1 between two
    // neighbouring nodes
    double gradient_thinning;
    double gradient_across; // gradient across over gradient along, at equal pressure differences
} reynolds_fluid;

enum { NUM_FLUID_ARRAYS = 5 };

/* Returns a fluid whose arrays lie in `memory` [NUM_FLUID_ARRAYS, num_nodes]. The caller owns the
 * memory and the contact, to which the fluid points. */
reynolds_fluid reynolds_fluid_in(double *memory, size_t num_nodes, const ehd_contact *contact);

/* Returns the nodes of a fluid from `first_node` on. The result shares the arrays of `fluid`. */
reynolds_fluid reynolds_fluid_from(const reynolds_fluid *fluid, size_t first_node);

/* The BDF time derivative of rho H at the nodes of the rows: rate * rho H + previous. */
typedef struct reynolds_squeeze {
    double rate; // unit: 1 / dimensionless time
    // [num_rows] weighted sum of rho H at previous time levels, in the current scales of the
    // contact
    const double *previous;
} reynolds_squeeze;

/* Returns the number of entries, from the first on, that a stencil of this discretisation can use.
 * All later entries are NO_NODE. */
static inline int reynolds_stencil_size(const ehd_grid *grid) {
    return grid->discretization == DISCRETIZATION_CROSS_FLUX ? NUM_STENCIL : NUM_CROSS_STENCIL;
}

/* Return how many nodes a stencil extends upstream, and how many it extends downstream and
 * across. */
size_t reynolds_reach_back(const ehd_grid *grid);
size_t reynolds_reach_ahead(const ehd_grid *grid);

/* Returns the stencil of an inner node for entrainment towards larger x. On the mirror line of a
 * half grid the nodes to the left and right are the same. */
reynolds_stencil reynolds_stencil_at(const ehd_grid *grid, size_t node);

/* Returns the mirror image of reynolds_stencil_at, for entrainment towards smaller x. */
reynolds_stencil reynolds_stencil_reversed(const ehd_grid *grid, size_t node);

/* Evaluates the fluid properties at the given pressures. */
void reynolds_fluid_evaluate(
    // output:
    reynolds_fluid *fluid,
    // input:
    const ehd_contact *contact, const double *pressure, // [num_nodes]
    size_t num_nodes);

/* Computes residuals and derivatives of the rows whose stencils are given, in the discretisation of
 * the grid (README.md, Reynolds equation). */
void reynolds_rows(
    // output:
    reynolds_row *rows, // [num_rows]
    // input:
    const ehd_grid *grid, double entrainment, // U of the Reynolds equation, 1 when steady
    const reynolds_squeeze *squeeze,          // NULL when steady
    const reynolds_stencil *stencils,         // [num_rows]
    size_t num_rows,
    const reynolds_fluid *fluid, // arrays [num_nodes]
    const double *pressure,      // [num_nodes]
    const double *film);         // [num_nodes]

/* Returns the largest error bound of the thinned rows of a point contact or ellipse upstream of the
 * centre, where the film forms. The bound is relative to the larger of the entrained flow and the
 * pressure flow. The thinning of the flow along the entrainment neglects the pressure gradient
 * across, and the thinning of the flow across neglects the gradient along (README.md, thinned
 * flow). Returns 0 if the rows are exact, as in line contacts. */
double reynolds_flow_doubt(const ehd_contact *contact,
                           const reynolds_stencil *stencils, // [num_rows]
                           const size_t *node,               // [num_rows] of the grid
                           size_t num_rows, const double *pressure,
                           const double *film); // [num_nodes]

/* Reason that is reported if the error bound, relative to the flow, exceeds default_accuracy
 * (romrun/solve/README.md, Thinned flow). */
extern const char flow_doubt_reason[];

/* Returns the flux U rho H - eps dP/dx along the entrainment through the half node between BACK and
 * HERE of a stencil. The member `residual` holds the flux, the other members its derivatives. */
reynolds_row reynolds_flux(const ehd_grid *grid, double entrainment,
                           const reynolds_stencil *stencil, const reynolds_fluid *fluid,
                           const double *pressure, const double *film);

/* Change of the reduced pressure, int mobility dP, from one node to the next, in the accurate
 * discretisation. If the viscosity is exponential in the pressure, this change is exactly the
 * logarithmic mean of the mobilities times the pressure difference (D. L. Scharfetter, H. K.
 * Gummel, IEEE Trans. Electron Devices 16, 1969). Otherwise the mobility half way between the nodes
 * is used too, and the change is of fourth order in the pressure difference. */
typedef struct reynolds_link {
    double value, by_before, by_after; // derivatives with respect to the pressures at both nodes
    // derivatives for a thinned flow, otherwise 0: with respect to the film at the half node, and
    // to the logarithm of the gradient between the nodes. In a finished link, by_before and
    // by_after already include the effect of the gradient
    double by_film, by_gradient;
} reynolds_link;

/* Returns the link from HERE to AHEAD of a stencil. A thinned flow is evaluated with the film at
 * HERE. */
reynolds_link reynolds_link_ahead(const reynolds_stencil *stencil, const reynolds_fluid *fluid,
                                  const double *pressure, const double *film);

#endif
