/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the shape of the dry contact, the ellipse of Hertz, by Carlson's integrals (README.md,
 * Elliptical contacts).
 * Called by contact.c, film_formulas.c, common/output/grid_file.c, common/training and romrun. */
#ifndef EHD_ELLIPSE_H
#define EHD_ELLIPSE_H

#include "common/physics/far_angle.h"

#include <stdbool.h>

/* Shape of the dry contact, with the semi-axes a along the entrainment and b across. All members
 * follow from the ellipticity. For a circle and a line contact all numbers are 1, and the far field
 * is the far field of a circle. */
typedef struct contact_shape {
    double ellipticity; // b/a, as k of Hamrock and Dowson
    double gap_across;  // R_x b^2/(R_y a^2), the factor of Y^2/2 in the gap
    double flow_across; // (a/b)^2, the factor of the flow across
    double cell;        // width in Y over length in X of a grid cell: k^(-1/3)
    double compliance;  // E' a^3/(w R_x), divided by its value for a circle; 2 A/pi in README.md
    far_angle far;      // far field for R_x/R_y
} contact_shape;

/* Shape of a circle and of a line contact. */
extern const contact_shape shape_round;

/* Bounds of the ellipticity of a contact. */
extern const double MIN_ELLIPTICITY, MAX_ELLIPTICITY;

/* Returns the shape for an ellipticity b/a above 0, by Carlson's elliptic integrals. The shape for
 * an ellipticity of 1 is exactly shape_round. */
contact_shape shape_of(double ellipticity);

/* Checks whether two ellipticities agree to 1e-6 of their value. One may come from radii and the
 * other from a printed number. Films then differ by less than 1e-6. */
bool shape_same(const contact_shape *a, const contact_shape *b);

/* ellipse_radius_ratio returns R_y/R_x of the surfaces for an ellipticity b/a. ellipse_ellipticity
 * is the inverse function. Both return exactly 1 for 1. */
double ellipse_radius_ratio(double ellipticity);
double ellipse_ellipticity(double radius_ratio);

/* Returns the gap of the dry contact on Y = 0, |x| >= 1, in the unit of H. */
double ellipse_dry_gap(const contact_shape *shape, double x);

#endif
