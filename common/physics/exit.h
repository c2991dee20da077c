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

#endif
