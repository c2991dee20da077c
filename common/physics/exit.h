/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The exit boundary, where the pressure ends behind the contact: P >= 0, Lambda >= 0, Lambda P = 0
 * (eqs. 7 and 39 of Maier et al. 2015). What both models ask of it is written here once. */
#ifndef EHD_EXIT_H
#define EHD_EXIT_H

#include "common/physics/reynolds.h"
#include <stdbool.h>

/* Multiplier Lambda of a row at a node without pressure: what is missing in the flow balance there.
 * Negative where the node should have pressure. */
double exit_multiplier(const reynolds_row *row);

/* By how much a node violates P >= 0 and Lambda >= 0, of which the first holds for nodes with
 * pressure; negative where it does not. */
double exit_violation(bool has_pressure, double pressure, double multiplier);

/* The line of a stationary line contact on which the exit is looked for. In its pressurised zone
 * the flux is the same everywhere, and the exit condition P = dP/dx = 0 says that U rho H equals it
 * at the exit. */
typedef struct exit_line {
    const double *pressure; // P at the nodes from first_node on, up to before the exit
    size_t first_node;      // from which on negative pressure is looked for
    size_t min_exit, max_exit;
    size_t
        max_stride; // of the exit downstream, nodes: far from convergence the flux is not yet one
                    // number
    double entrainment;
    double pressure_noise, multiplier_noise;        // negative ones that do not count
    void *state;                                    // for the functions
    double (*film)(void *state, size_t node);       // H
    double (*flux)(void *state, size_t node);       // through the half node before
    double (*multiplier)(void *state, size_t node); // exit_multiplier
} exit_line;

/* The node at which the exit should be: back on negative pressure, on where the multiplier at the
 * exit is negative; as far as the flux says, which an unpressurised film carries at the exit, so
 * that the number of moves does not grow with the number of nodes. */
size_t exit_by_flux(const exit_line *line, size_t exit);

/* The exit within a node, of the accurate rows of a stationary line contact (README.md, The exit
 * within a node): the last cell with pressure, which the exit cuts at x = x_k + offset h behind its
 * node k. Two equations hold there: an unpressurised film carries at the exit what flows through
 * the half node before, which places the exit; and the pressure at k is what falls to zero from
 * there to the exit. The first is eliminated, so that the second stands in the place of the node's
 * Reynolds row. */
typedef struct exit_cell {
    reynolds_row row;    // residual of the second equation, of a Reynolds row's size
    reynolds_row offset; // residual: by how much the offset has to change; derivatives of that
    double row_by_flux, offset_by_flux; // derivatives of both residuals by the flux
    double curvature;     // pressure before the exit over the square of the distance in steps
    double flux_residual; // of the first equation, of a Reynolds row's size
} exit_cell;

/* Whether the exit of a stationary contact on a grid lies within a node: of a line contact with the
 * accurate rows. */
bool exit_is_within_node(const ehd_grid *grid);

/* The cell at the HERE of a stencil, for a flux that comes from elsewhere: derivatives by pressure
 * and film are those at that flux. The films at BACK, HERE, AHEAD and AHEAD2 are interpolated, so
 * that the node must not be the last inner one; there is no pressure from AHEAD on. */
void exit_cell_at(exit_cell *cell, const ehd_grid *grid, double entrainment, double offset,
                  double flux, const reynolds_stencil *stencil, const reynolds_fluid *fluid,
                  const double *pressure, const double *film);

/* Adds what follows from the derivatives of the flux through the half node before, which is that of
 * the cell: reynolds_flux of its stencil. */
void exit_cell_add_flux(exit_cell *cell, const reynolds_row *flux);

/* By how many steps ahead of the HERE of a stencil the exit lies, where a solution has exits at nodes
 * and that is the last one with pressure: where an unpressurised film carries what flows through
 * the half node before, but for what the cell takes in time. That is 0 to 1 but for what is left by
 * an exit at a node, and at most a half beyond. NaN where the film does not rise there. With a
 * reversed stencil entrainment and flux count towards smaller x. */
double exit_place(
    const ehd_grid *grid, double entrainment,
    double flux,                     // through the half node before
    const reynolds_squeeze *squeeze, // with the previous of BACK, HERE, AHEAD; NULL when stationary
    const reynolds_stencil *stencil, const reynolds_fluid *fluid, const double *film);

#endif
