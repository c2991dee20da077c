/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The shape of the dry contact, the ellipse of Hertz (README.md, Elliptical contacts). */
#ifndef EHD_ELLIPSE_H
#define EHD_ELLIPSE_H

#include "common/physics/far_angle.h"

#include <stdbool.h>

/* Semi-axes a along the entrainment, b across. All of it follows from the first member, and is 1 of
 * a circle and of a line contact, whose far field is that of a circle. */
typedef struct contact_shape {
    double ellipticity; // b/a, as k of Hamrock and Dowson
    double gap_across;  // R_x b^2/(R_y a^2): of Y^2/2 in the gap
    double flow_across; // (a/b)^2
    double compliance;  // E' a^3/(w R_x) over that of the circle, 2 A/pi of README.md
    far_angle far;      // of R_x/R_y
} contact_shape;

/* Of a circle, and of a line contact. */
extern const contact_shape shape_round;

/* Ellipticities that shapes are made of. */
extern const double MIN_ELLIPTICITY, MAX_ELLIPTICITY;

/* The shape of an ellipticity b/a above 0, by Carlson's elliptic integrals; exactly shape_round of
 * 1. */
contact_shape shape_of(double ellipticity);

/* Whether two shapes are the same, to 1e-6 of the ellipticity: one may come from radii and the other
 * from a number that was read from print. Films differ by less than that. */
bool shape_same(const contact_shape *a, const contact_shape *b);

/* R_y/R_x of the surfaces that make an ellipse of b/a, and back, exactly 1 of 1. */
double ellipse_radius_ratio(double ellipticity);
double ellipse_ellipticity(double radius_ratio);

/* Gap of the dry contact on Y = 0, |x| >= 1, in film units. */
double ellipse_dry_gap(const contact_shape *shape, double x);

#endif
