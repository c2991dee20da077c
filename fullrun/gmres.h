/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Allocates the memory of GMRES, which solves the linear systems of Newton (README.md, Linear
 * systems). The solver itself, full_solve_gmres, is declared in full_solver.h.
 * Called by full_solver.c, which calls full_solve_gmres in each Newton iteration. */
#ifndef EHD_GMRES_H
#define EHD_GMRES_H

#include "fullrun/full_solver.h"

typedef struct gmres_workspace gmres_workspace;

/* Allocates memory that suffices for any exit on the grid. Returns NULL if there is no memory. */
gmres_workspace *gmres_workspace_create(const ehd_grid *grid, const full_settings *settings);
/* Returns the bytes of the workspace per node of a point contact, without the factors. */
double gmres_workspace_bytes(const ehd_grid *grid);
gmres_workspace *gmres_workspace_free(gmres_workspace *workspace); // accepts and returns NULL

#endif
