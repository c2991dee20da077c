/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts LAPACKE's return values to a status. LAPACK's manual explains these values.
 * Called by podbuild and deimselect after their calls of LAPACKE. */
#ifndef EHD_LAPACK_H
#define EHD_LAPACK_H

#include "common/program/status.h"

/* Converts the `info` that a LAPACKE function returned to EHD_OK, EHD_MEMORY (no memory for its
 * workspace) or EHD_INTERNAL (no convergence, NaN in the input, wrong argument). */
ehd_status lapack_outcome(const char *routine, int info, ehd_error *error);

#endif
