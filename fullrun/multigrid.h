/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solves a sparse linear system on the nodes of a large point contact approximately. One cycle of
 * multigrid with relaxation by lines replaces the factors of the matrix (fullrun/README.md, Large
 * point contacts).
 * Called by gmres.c as the preconditioner. */
#ifndef EHD_MULTIGRID_H
#define EHD_MULTIGRID_H

#include "common/physics/contact.h"
#include "common/program/team.h"
#include <stdbool.h>
#include <stddef.h>

/* Size of a row of the matrix. The row of the node in line l and column c has entries [CYCLE_LINES,
 * CYCLE_COLUMNS] for lines l - 1 to l + 1 and columns c - 2 to c + 1. */
enum { CYCLE_BACK = 2, CYCLE_COLUMNS = CYCLE_BACK + 2, CYCLE_LINES = 3 };
enum { CYCLE_ENTRIES = CYCLE_LINES * CYCLE_COLUMNS };

typedef struct multigrid multigrid;

/* Creates a cycle for the inner nodes of a grid. Returns NULL if there is no memory. `threads`
 * share the work on the lines; if `threads` is NULL, one thread does all work. The caller frees the
 * threads after the cycle. */
multigrid *multigrid_create(const ehd_grid *grid, team *threads);
multigrid *multigrid_free(multigrid *self); // accepts and returns NULL

/* Returns the bytes of a cycle per inner node of a grid. */
double multigrid_bytes(const ehd_grid *grid);

/* Prepares the cycle for a matrix, whose rows and unknowns the caller has set before. Returns false
 * if the matrix of a line or of the coarsest grid is singular. */
bool multigrid_prepare(multigrid *self);

/* Return two arrays for the caller to fill: the rows, [num_inner, CYCLE_ENTRIES], and marks for the
 * nodes that are unknowns, [num_inner]. Entries in rows and columns of other nodes are ignored. */
double *multigrid_rows(multigrid *self);
bool *multigrid_unknowns(multigrid *self);

/* Runs one cycle with zero as the initial solution. The solution is a linear function of the right
 * side. */
void multigrid_cycle(multigrid *self);

/* Return the right side, which the caller fills, and the solution, [num_inner] each. Both are zero
 * at nodes that are no unknowns. */
double *multigrid_right(multigrid *self);
const double *multigrid_solution(const multigrid *self);

#endif
