/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Approximate inverse of a sparse matrix on the nodes of a large point contact by a cycle of multigrid
 * with relaxation by lines (fullrun/README.md, Large point contacts): instead of its factors. */
#ifndef EHD_MULTIGRID_H
#define EHD_MULTIGRID_H

#include "common/physics/contact.h"
#include "common/program/team.h"
#include <stdbool.h>
#include <stddef.h>

/* Entries of a row: of the nodes from two columns back to one ahead, on its own line and those beside
 * it; [CYCLE_LINES, CYCLE_COLUMNS]. */
enum { CYCLE_BACK = 2, CYCLE_COLUMNS = CYCLE_BACK + 2, CYCLE_LINES = 3 };
enum { CYCLE_ENTRIES = CYCLE_LINES * CYCLE_COLUMNS };

typedef struct multigrid multigrid;

/* For the inner nodes of a grid; NULL: no memory. The threads share the lines, and their caller frees
 * them afterwards; NULL: none. */
multigrid *multigrid_create(const ehd_grid *grid, team *threads);
multigrid *multigrid_free(multigrid *self); // accepts and returns NULL

/* Bytes that it takes for an inner node of a grid. */
double multigrid_bytes(const ehd_grid *grid);

/* Takes a matrix, of which the caller fills the rows before; false: a line's or the coarsest matrix
 * is singular. */
bool multigrid_prepare(multigrid *self);

/* The rows to fill, [num_inner, CYCLE_ENTRIES], and which nodes are unknowns, [num_inner]; entries of
 * other rows and columns do not count. */
double *multigrid_rows(multigrid *self);
bool *multigrid_unknowns(multigrid *self);

/* One cycle from zero, a linear function of the right side. */
void multigrid_cycle(multigrid *self);

/* Right side and solution of a cycle, [num_inner]; zero where there is no unknown. */
double *multigrid_right(multigrid *self);
const double *multigrid_solution(const multigrid *self);

#endif
