/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The shape of the dry contact, the ellipse of Hertz (README.md, Elliptical contacts). */
#ifndef EHD_ELLIPSE_H
#define EHD_ELLIPSE_H

/* Semi-axes a along the entrainment, b across. All of it follows from the first member, and is 1 of
 * a circle and of a line contact. */
typedef struct contact_shape {
    double ellipticity; // b/a, as k of Hamrock and Dowson
    double gap_across;  // R_x b^2/(R_y a^2): of Y^2/2 in the gap
    double flow_across; // (a/b)^2
    double compliance;  // w R_x/(E' a^3) over that of the circle, 2 A/pi of README.md
} contact_shape;

/* Of a circle, and of a line contact. */
extern const contact_shape shape_round;

#endif
