/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What LAPACKE's return values mean. */
#ifndef EHD_LAPACK_H
#define EHD_LAPACK_H

#include "common/program/status.h"

/* `info` as a LAPACKE function returned it: EHD_OK, EHD_MEMORY (its workspace) or EHD_INTERNAL (no
 * convergence, NaN in the input, wrong argument). */
ehd_status lapack_outcome(const char *routine, int info, ehd_error *error);

#endif
