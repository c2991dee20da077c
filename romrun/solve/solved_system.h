/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gives access to the least-squares problem of the last iteration of a solution (Maier et al.
 * (2015), eq. 28). From this problem romrun/trust/functionals.c estimates errors. Implemented by
 * reduced_solver.c. */
#ifndef EHD_SOLVED_SYSTEM_H
#define EHD_SOLVED_SYSTEM_H

#include "romrun/solve/exit_search.h"
#include "romrun/solve/least_squares.h"
#include "romrun/solve/reduced_solver.h"
#include "romrun/state/node_state.h"

/* The least-squares problem of the last iteration. Its rows are, in this order, the selected
 * Reynolds rows before the exit, the linear equations (projected elasticity and closure) and, if
 * the exit lies between two nodes, the row of the cell with the exit. */
typedef struct solved_system {
    node_state *nodes; // nodes at the solution
    exit_search *exits;
    size_t num_rows;
    size_t num_reynolds;
    const size_t *row;    // [num_reynolds] indices in the model
    const double *matrix; // [num_rows, num_unknowns] D J; with kept factors, of an earlier state
    least_squares *factors;
    const double *right, *step; // [num_rows] D f before the last step; [num_unknowns] the last step
    // estimated change that one more iteration would cause, divided by the change that the last
    // iteration caused
    double remaining;
    const double *offset; // [num_unknowns] gradient of the exit's offset within its cell;
                          // NULL: exits are nodes
    size_t matrix_number; // serial number of the kept matrix; 0: this solution made the matrix
    size_t solution_number;
} solved_system;

/* Returns the system of the last solution. The system is valid until the next solution. */
solved_system reduced_solved_system(reduced_solver *solver);

#endif
