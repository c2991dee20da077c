/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The linear systems of Newton by LAPACK on the full matrix: cross-check of the iterative solver
 * and what it is measured against. Put it in full_settings.solve_linear. */
#ifndef EHD_DENSE_H
#define EHD_DENSE_H

#include "fullrun/full_solver.h"

/* The exact Jacobian of a line or of a whole point contact, with the kernel's own values instead of
 * an FFT, in O(n^2) time and memory, then dgesv in O(n^3). The tolerance is not used. EHD_MEMORY,
 * EHD_NOT_CONVERGED where it is singular. */
full_linear_solver dense_solve;

#endif
