/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solves the linear systems of Newton by LAPACK on the full matrix, as a reference for the
 * iterative solver and its speed. Put it in full_settings.solve_linear. */
#ifndef EHD_DENSE_H
#define EHD_DENSE_H

#include "fullrun/full_solver.h"

/* Solves with the exact Jacobian of a line contact, or of a point contact on a whole grid. The
 * deflection uses the values of the kernel instead of an FFT, in O(n^2) time and memory; dgesv
 * takes O(n^3). The tolerance is not used. Returns EHD_MEMORY, or EHD_NOT_CONVERGED if the matrix
 * is singular. */
full_linear_solver dense_solve;

#endif
