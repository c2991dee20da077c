/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Selects the control rows, which are evaluated after a solution to estimate its error (README.md,
 * Control rows).
 * Called by row_choice.c. */
#ifndef EHD_CONTROL_H
#define EHD_CONTROL_H

#include "deimselect/row_choice.h"

/* Selects the control rows: the rows at which the residual is predicted worst from the selected
 * rows. The residuals are those of converged reduced solutions, with unit norm. The prediction fits
 * residual modes at the selected rows. The control rows are the pivots in a QR factorisation of the
 * prediction errors. There are at most as many control rows as converged solutions. If more are
 * wanted, fewer are selected, or EHD_DATA is returned if the number was `given`. Errors: EHD_DATA,
 * EHD_MEMORY, EHD_INTERNAL (LAPACK). */
ehd_status control_choose(
    // output:
    size_t *control, // [*num_control] indices of inner nodes, like `rows`
    // in and out:
    size_t *num_control,
    // input:
    bool given, const residual_snapshots *snapshots, size_t num_inner, const double *modes,
    size_t num_modes,                    // modes of the residuals, [num_modes, num_inner]
    const size_t *rows, size_t num_rows, // selected, at least num_modes
    ehd_error *error);

#endif
