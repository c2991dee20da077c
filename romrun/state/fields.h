/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes fields of a reduced state on the whole grid: the only work whose cost grows with the
 * grid. They are sums of modes and of the modes' deflections (eqs. 24 and 26 of Maier et al.
 * (2015)). These deflections are computed once. A state's own exits change the deflection; this
 * change is computed with the kernel and added. Called by film_splines.c, and by romrun/online for
 * results with fields. */
#ifndef EHD_FIELDS_H
#define EHD_FIELDS_H

#include "romrun/model/flat.h"
#include "romrun/state/reduced_state.h"

/* Modes on the whole grid. Nothing changes them once they are made, so several threads may use
 * them. */
typedef struct field_modes {
    const double *pressure; // [num_nodes, num_pressure] uncut; owned by the caller
    size_t *cut_exits;      // [num_lines], medians of the trained exits
    // deflections of the modes cut at cut_exits, [num_pressure] for each node; then the distances
    // in this table to the next column and to the next line
    const double *deflection;
    size_t column, line;
    double *own; // the deflections, if this object owns them; else NULL
} field_modes;

/* Initialises without deflections, which another table may hold already. `pressure_basis` must
 * outlive it. Errors: EHD_MEMORY. */
ehd_status field_modes_init(
    // output:
    field_modes *self, // free with field_modes_free
    // input:
    const reduced_model *model, const double *pressure_basis, ehd_error *error);
void field_modes_free(field_modes *self);

/* Computes deflections that the object owns. Errors: EHD_MEMORY. */
ehd_status field_modes_deflect(field_modes *self, const reduced_model *model, ehd_error *error);

/* Writes the modes to a flat file (romrun/model/flat.h), or reads them from it instead of
 * field_modes_init and field_modes_deflect. `own`: the file has deflections, and owns them. Free
 * with field_modes_free in either case. */
void field_modes_flat(flat *file, field_modes *self, const reduced_model *model,
                      const double *pressure_basis, bool own);

/* Computes the deflections of the modes cut at cut_exits. Errors: EHD_MEMORY. */
ehd_status field_modes_fill(
    // output:
    double *table, // the first num_pressure numbers of each node are set; nodes are `column`
                   // numbers apart
    size_t column,
    // input:
    const ehd_grid *grid, // the model's grid, with `margin` nodes before it and `side` lines beside
                          // it
    size_t margin, size_t side, const field_modes *self, const reduced_model *model,
    ehd_error *error);

/* Computes P and H at all nodes, [num_nodes]; H follows from P for both kinds of bases. Cannot
 * fail, and allocates nothing. */
void reduced_fields(
    // output:
    double *pressure, double *film,
    // input:
    const reduced_state *state, const reduced_model *model, const field_modes *modes);

#endif
