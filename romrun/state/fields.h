/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes fields of a reduced state on the whole grid. Only this computation has a cost that grows
 * with the grid. The fields are sums of the modes and of the deflections of the modes (eqs. 24 and
 * 26 of Maier et al. (2015)). The deflections are computed once, for modes that are set to zero
 * behind fixed exits (cut_exits). If the exits of a state lie elsewhere, the deflection by the
 * pressures between these exits and cut_exits is computed with the kernel and added. Called by
 * film_splines.c, and by romrun/online for results with fields. */
#ifndef EHD_FIELDS_H
#define EHD_FIELDS_H

#include "romrun/model/flat.h"
#include "romrun/state/reduced_state.h"

/* Modes on the whole grid. Several threads may use the modes, which never change. */
typedef struct field_modes {
    const double *pressure; // [num_nodes, num_pressure] not cut at an exit; owned by the caller
    size_t *cut_exits;      // [num_lines] medians of the trained exits
    // `deflection`: deflections of the modes cut at cut_exits, [num_pressure] for each node.
    // `column` and `line`: distances in this table to the next column and the next line of the grid
    const double *deflection;
    size_t column, line;
    double *own; // `deflection` if this object owns the table, else NULL
} field_modes;

/* Initialises `self` without deflections, because another table may already hold the deflections.
 * `pressure_basis` must outlive `self`. Errors: EHD_MEMORY. */
ehd_status field_modes_init(
    // output:
    field_modes *self, // free with field_modes_free
    // input:
    const reduced_model *model, const double *pressure_basis, ehd_error *error);
void field_modes_free(field_modes *self);

/* Computes self->deflection, the deflections of the modes at all nodes. `self` owns the memory.
 * Errors: EHD_MEMORY. */
ehd_status field_modes_deflect(field_modes *self, const reduced_model *model, ehd_error *error);

/* Writes the modes to a flat file (romrun/model/flat.h), or reads them from it instead of
 * field_modes_init and field_modes_deflect. `own`: the file contains the deflections, and owns them
 * when they are read. In all cases, free with field_modes_free. */
void field_modes_flat(flat *file, field_modes *self, const reduced_model *model,
                      const double *pressure_basis, bool own);

/* Computes the deflections of the modes cut at cut_exits. Errors: EHD_MEMORY. */
ehd_status field_modes_fill(
    // output:
    double *table, // num_pressure numbers for each node; nodes are `column` numbers apart
    size_t column,
    // input:
    const ehd_grid *grid, // the model's grid, with `margin` nodes before it and `side` lines beside
                          // it
    size_t margin, size_t side, const field_modes *self, const reduced_model *model,
    ehd_error *error);

/* Computes P and H at all nodes, [num_nodes]. H is the sum of approach, gap and the deflection that
 * P causes, even if the basis has separate modes for the deflection (independent basis). The
 * function cannot fail and allocates no memory. */
void reduced_fields(
    // output:
    double *pressure, double *film,
    // input:
    const reduced_state *state, const reduced_model *model, const field_modes *modes);

#endif
