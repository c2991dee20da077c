/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Selects the control rows, which are evaluated after a solution to estimate its error (README.md,
 * Control rows).
 * Called by row_choice.c. */
#ifndef EHD_CONTROL_H
#define EHD_CONTROL_H

#include "deimselect/row_choice.h"

/* Selects the control rows: the rows at which the residual is predicted worst from the selected
 * rows. The residuals of converged reduced solutions are used, scaled to unit norm. The prediction
 * is the combination of residual modes that fits the residual at the selected rows. The control
 * rows are the pivots in a QR factorisation of the prediction errors. Their number is at most the
 * number of converged solutions, and of rows that are not selected. If *num_control is larger and
 * was `given` by the user, returns EHD_DATA. If it is larger and was not given, selects fewer rows.
 * Errors: EHD_DATA, EHD_MEMORY, EHD_INTERNAL (LAPACK). */
ehd_status control_choose(
    // output:
    size_t *control, // [*num_control] indices of inner nodes, like `rows`
    // in and out:
    size_t *num_control,
    // input:
    bool given, const residual_snapshots *snapshots, size_t num_inner, const double *modes,
    size_t num_modes,                    // modes of the residuals, [num_modes, num_inner]
    const size_t *rows, size_t num_rows, // the selected rows, at least num_modes
    ehd_error *error);

#endif
