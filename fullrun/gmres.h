/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Memory of the full solver's linear systems. */
#ifndef EHD_GMRES_H
#define EHD_GMRES_H

#include "fullrun/full_solver.h"

typedef struct gmres_workspace gmres_workspace;

/* Allocates memory that suffices for any exit on the grid. Returns NULL if there is no memory. */
gmres_workspace *gmres_workspace_create(const ehd_grid *grid, const full_settings *settings);
/* Returns the bytes of the workspace per node of a point contact, without factors. */
double gmres_workspace_bytes(const ehd_grid *grid);
gmres_workspace *gmres_workspace_free(gmres_workspace *workspace); // accepts and returns NULL

#endif
