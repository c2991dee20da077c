/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The discrete Reynolds operator, for any list of rows.
 *
 * A row is the residual of d/dx(eps dP/dx) + d/dy(eps dP/dy) = U d(rho H)/dx + d(rho H)/dT at a
 * node (eq. 7 of Maier et al. 2015 without the multiplier of cavitation) and its derivatives with
 * respect to pressure and film at the nodes of its stencil. The solvers choose the rows and know
 * how P and H depend on their unknowns. */
#ifndef EHD_REYNOLDS_H
#define EHD_REYNOLDS_H

#include "common/physics/contact.h"
#include <stddef.h>

/* Nodes of a row's stencil, named along the direction of entrainment. Those across it are of a point
 * contact. The published discretisation has none of BACK3, AHEAD2, LEFT2 and RIGHT2; the last four,
 * beside the nodes before and behind, are of the discretisation with cross fluxes alone. */
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
#define NO_NODE ((size_t)-1) // beyond the boundary nodes, or not in the discretisation

typedef struct reynolds_stencil {
    size_t node[NUM_STENCIL]; // into the arrays of nodes given to reynolds_rows, or NO_NODE
} reynolds_stencil;

typedef struct reynolds_row {
    double residual;
    double by_pressure[NUM_STENCIL];
    double by_film[NUM_STENCIL];
} reynolds_row;

/* Fluid at a list of nodes. Arrays [num_nodes]. */
typedef struct reynolds_fluid {
    double *mobility;       // rho/(eta lambda), so that eps = mobility H^3
    double *mobility_slope; // with respect to the dimensionless pressure
    double *log_mobility;   // ln mobility, but for a constant; NULL when not needed, as published
    double *density;        // NULL when incompressible
    double *density_slope;
    const ehd_contact *between; // whose mobility is evaluated between two nodes too; NULL where the
                                // mean of theirs is enough
    const ehd_contact *thinned; // whose flow an Eyring fluid thins; NULL: not
    double thinning;            // of that, its rate at film 1 and rho over mobility 1
    double
        gradient_thinning;  // and its gradient at film 1 and a change of pressure by 1 along a step
    double gradient_across; // of that across, over that along
} reynolds_fluid;

enum { NUM_FLUID_ARRAYS = 5 };

/* The fluid's arrays in `memory` [NUM_FLUID_ARRAYS, num_nodes], which the caller owns, as it does
 * the contact. */
reynolds_fluid reynolds_fluid_in(double *memory, size_t num_nodes, const ehd_contact *contact);

/* The same fluid from one of its nodes on. */
reynolds_fluid reynolds_fluid_from(const reynolds_fluid *fluid, size_t first_node);

/* The BDF time derivative of rho H at the nodes of the rows: rate * rho H + previous. */
typedef struct reynolds_squeeze {
    double rate; // 1 / dimensionless time
    // [num_rows] weighted sum of rho H at previous time levels, in the current frame
    const double *previous;
} reynolds_squeeze;

/* So many of a stencil's nodes, the first ones, may be there. */
static inline int reynolds_stencil_size(const ehd_grid *grid) {
    return grid->discretization == DISCRETIZATION_CROSS_FLUX ? NUM_STENCIL : NUM_CROSS_STENCIL;
}

/* By how many nodes a stencil reaches back along the entrainment, and ahead and across it. */
size_t reynolds_reach_back(const ehd_grid *grid);
size_t reynolds_reach_ahead(const ehd_grid *grid);

/* Stencil of an inner node of a grid and its discretisation, entrainment towards larger x. On the
 * mirror line of a half grid the nodes to the left and right are the same. */
reynolds_stencil reynolds_stencil_at(const ehd_grid *grid, size_t node);

/* The same for entrainment towards smaller x: its mirror image. */
reynolds_stencil reynolds_stencil_reversed(const ehd_grid *grid, size_t node);

/* Fluid properties at the given pressures. */
void reynolds_fluid_evaluate(
    // output:
    reynolds_fluid *fluid,
    // input:
    const ehd_contact *contact, const double *pressure, // [num_nodes]
    size_t num_nodes);

/* Residual and derivatives of the rows whose stencils are given, by the grid's discretisation
 * (README.md, Reynolds equation). */
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

/* Returns a bound of the error of thinned rows of a point contact or ellipse, the largest before the
 * centre, where the film is made. It is relative to the entrained flow or, where that is more, to the
 * pressure flow. Rows along the entrainment do not count the gradient across, and rows across do not
 * count the gradient along (README.md, thinned flow). 0 where rows are exact, as those of lines. */
double reynolds_flow_doubt(const ehd_contact *contact,
                           const reynolds_stencil *stencils, // [num_rows]
                           const size_t *node,               // [num_rows] of the grid
                           size_t num_rows, const double *pressure,
                           const double *film); // [num_nodes]

/* Beyond this doubt results are not to be trusted, for this reason. */
extern const double flow_doubt_most;
extern const char flow_doubt_reason[];

/* Flux U rho H - eps dP/dx along the entrainment through the half node between the BACK and the
 * HERE of a stencil, as residual, and its derivatives. */
reynolds_row reynolds_flux(const ehd_grid *grid, double entrainment,
                           const reynolds_stencil *stencil, const reynolds_fluid *fluid,
                           const double *pressure, const double *film);

/* Change of the reduced pressure, int mobility dP, from one node to the next. Where the viscosity
 * is exponential in the pressure: the logarithmic mean of the mobilities times the difference of
 * the pressures, then exact (D. L. Scharfetter, H. K. Gummel, IEEE Trans. Electron Devices 16,
 * 1969). Else with the mobility half way between as well, of fourth order in the difference. Of the
 * accurate discretisation. */
typedef struct reynolds_link {
    double value, by_before, by_after; // derivatives by the pressures
    // of a thinned flow, else 0: by the film at the half node, and what the parts of a link have by
    // the logarithm of the gradient
    double by_film, by_gradient;
} reynolds_link;

/* From the HERE to the AHEAD of a stencil, where flow is thinned with the film at HERE. */
reynolds_link reynolds_link_ahead(const reynolds_stencil *stencil, const reynolds_fluid *fluid,
                                  const double *pressure, const double *film);

#endif
