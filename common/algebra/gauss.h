/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Holds the points and weights of Gauss' rule (Gauss-Legendre quadrature) on 0 ... 1.
 * Used by far_field.c and traction.c in common/physics for integrals beyond the grid. */
#ifndef EHD_GAUSS_H
#define EHD_GAUSS_H

/* The integral of a function is approximately the sum of weight[i] times the value of the function
 * at place[i]. With `num` points the sum is exact for polynomials up to the degree 2 num - 1. */
enum { GAUSS_4 = 4, GAUSS_8 = 8 };
extern const double gauss_4_place[GAUSS_4], gauss_4_weight[GAUSS_4];
extern const double gauss_8_place[GAUSS_8], gauss_8_weight[GAUSS_8];

#endif
