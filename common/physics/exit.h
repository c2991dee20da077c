/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the exit boundary, where the pressure ends downstream of the centre: P >= 0, Lambda >=
 * 0, Lambda P = 0 (eqs. 7 and 39 of Maier et al. 2015). The full and the reduced model share these
 * functions.
 * Called by fullrun/full_solver.c and romrun/solve/exit_search.c to move the exit. */
#ifndef EHD_EXIT_H
#define EHD_EXIT_H

#include "common/physics/reynolds.h"
#include <stdbool.h>

/* Returns the multiplier Lambda of a row at a node without pressure: the flow that is missing in
 * the balance of its cell. The multiplier is negative if the node should have pressure. */
double exit_multiplier(const reynolds_row *row);

/* Returns by how much a node violates its condition: P >= 0 for a node with pressure, Lambda >= 0
 * for a node without pressure. The result is negative if the condition holds. */
double exit_violation(bool has_pressure, double pressure, double multiplier);

/* The exit within the cell of a node, in the accurate discretisation of a stationary line contact
 * (README.md, The exit within a node). The exit lies downstream of node k, the last node with
 * pressure, at x = x_k + offset h. It satisfies two equations. First, the film at the exit has no
 * pressure and carries the flux through the half node before k. This equation gives the offset.
 * Second, the pressure falls from its value at k to zero at the exit. The first equation is
 * eliminated, and the second equation replaces the Reynolds row of node k. */
typedef struct exit_cell {
    reynolds_row row;    // second equation, scaled as a Reynolds row
    reynolds_row offset; // first equation; its residual is the necessary change of the offset
    double row_by_flux, offset_by_flux; // derivatives of both residuals with respect to the flux
    double curvature;     // pressure upstream of the exit, divided by the square of the distance to
                          // the exit in grid steps
    double flux_residual; // residual of the first equation, scaled as a Reynolds row
} exit_cell;

/* Checks whether the exit of a stationary contact on this grid may lie between nodes. This is so in
 * line contacts with the accurate discretisation. */
bool exit_is_within_node(const ehd_grid *grid);

/* Evaluates the exit cell at HERE of a stencil for a given flux. Derivatives with respect to
 * pressure and film are taken at constant flux. The film is interpolated from BACK, HERE, AHEAD and
 * AHEAD2, so HERE must not be the last inner node. AHEAD and AHEAD2 must have no pressure. */
void exit_cell_at(exit_cell *cell, const ehd_grid *grid, double entrainment, double offset,
                  double flux, const reynolds_stencil *stencil, const reynolds_fluid *fluid,
                  const double *pressure, const double *film);

/* Adds the derivatives of the flux through the half node before HERE to the derivatives of both
 * equations. `flux` is the result of reynolds_flux for the stencil of the cell. */
void exit_cell_add_flux(exit_cell *cell, const reynolds_row *flux);

/* Returns the distance from HERE downstream to the exit, in grid steps, for a solution whose exits
 * are nodes. HERE of the stencil is the last node with pressure. The film at the exit has no
 * pressure. It carries the flux through the half node before HERE, minus the rate at which the cell
 * stores fluid. The result lies between 0 and 1, but the error of an exit at a node may move it out
 * of this range by at most 0.5. The result is NaN if the film does not rise at the exit. With a
 * reversed stencil, entrainment and flux are positive towards smaller x. */
double exit_place(
    const ehd_grid *grid, double entrainment,
    double flux,                     // through the half node before HERE
    const reynolds_squeeze *squeeze, // `previous` at BACK, HERE and AHEAD; NULL when stationary
    const reynolds_stencil *stencil, const reynolds_fluid *fluid, const double *film);

#endif
