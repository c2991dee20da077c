/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which rows are evaluated after a solution, to tell how far it may be off. */
#ifndef EHD_CONTROL_H
#define EHD_CONTROL_H

#include "deimselect/row_choice.h"

/* Rows at which the residuals of converged reduced solutions are least predicted by the selected
 * rows: pivots of what is left of them, each of unit norm, after interpolation by residual modes
 * fitted at the selected rows. No more rows than converged solutions: fewer are chosen, or EHD_DATA
 * where the number was `given`. EHD_MEMORY, EHD_INTERNAL (LAPACK). */
ehd_status control_choose(
    // output:
    size_t *control, // [*num_control], counted as `rows`
    // in and out:
    size_t *num_control,
    // input:
    bool given, const residual_snapshots *snapshots, size_t num_inner, const double *modes,
    size_t num_modes,                    // [num_modes, num_inner] of the residuals
    const size_t *rows, size_t num_rows, // selected, at least num_modes
    ehd_error *error);

#endif
