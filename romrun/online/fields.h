/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fields of a reduced state on the whole grid: the only work whose cost grows with the grid. They are
 * sums of modes and of their deflections, which are made once; what a state's own exits change of
 * these is added by the kernel. */
#ifndef EHD_FIELDS_H
#define EHD_FIELDS_H

#include "romrun/online/reduced_solver.h"

/* Read-only once made; several threads may use one. */
typedef struct field_modes {
    const double *pressure; // [num_nodes, num_pressure], the caller's, not cut
    size_t *cut_exits;      // [num_lines], medians of the trained exits
    // deflections of the modes cut at cut_exits, [num_pressure] of a node, and how far it is from
    // those to the next column and line
    const double *deflection;
    size_t column, line;
    double *own; // where they are nobody else's
} field_modes;

/* Without deflections, which another table may hold already. `pressure_basis` must outlive it.
 * EHD_MEMORY. */
ehd_status field_modes_init(
    // output:
    field_modes *self, // free with field_modes_free
    // input:
    const reduced_model *model, const double *pressure_basis, ehd_error *error);
void field_modes_free(field_modes *self);

/* Makes deflections of its own. EHD_MEMORY. */
ehd_status field_modes_deflect(field_modes *self, const reduced_model *model, ehd_error *error);

/* Deflections of the modes cut at cut_exits. EHD_MEMORY. */
ehd_status field_modes_fill(
    // output:
    double *table, // the first num_pressure numbers of each node, `column` apart
    size_t column,
    // input:
    const ehd_grid *grid, // the model's, with `margin` nodes before it and `side` lines beside it
    size_t margin, size_t side, const field_modes *self, const reduced_model *model,
    ehd_error *error);

/* P and H at all nodes, [num_nodes]; H follows from P for either basis. Cannot fail, and allocates
 * nothing. */
void reduced_fields(
    // output:
    double *pressure, double *film,
    // input:
    const reduced_state *state, const reduced_model *model, const field_modes *modes);

#endif
