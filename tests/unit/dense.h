/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solves the linear systems of Newton's method by LAPACK with a full matrix, as a reference for the
 * iterative solver. To use it, set full_settings.solve_linear to dense_solve. */
#ifndef EHD_DENSE_H
#define EHD_DENSE_H

#include "fullrun/full_solver.h"

/* Solves with the exact Jacobian of a line contact, or of a point contact on a whole grid. The
 * deflection uses the values of the kernel instead of an FFT, and takes O(n^2) time and memory.
 * dgesv takes O(n^3) time. The argument `tolerance` is not used. Returns EHD_MEMORY, or
 * EHD_NOT_CONVERGED if the matrix is singular. */
full_linear_solver dense_solve;

#endif
