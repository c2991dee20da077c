/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes how the pressure far from a contact depends on the direction, by collocation with
 * Chebyshev polynomials (README.md, Far field).
 * Called by ellipse.c for each shape (far_angle_of), and by far_field.c. */
#ifndef EHD_FAR_ANGLE_H
#define EHD_FAR_ANGLE_H

/* Number of Chebyshev terms of the part of S that has no closed form. With 20 terms the error of S,
 * relative to the largest S, is 1e-8 for b/a from 0.05 to 3, 3e-7 at b/a = 5, 1.4e-5 at 10 and 5e-4
 * at 20 (test_far_angle.c, solves_its_equation). */
enum { FAR_TERMS = 20 };

/* Solution S(phi) of (q^3 S')' - 9 q^3 S = -8 cos phi with S'(0) = 0 and S = S' = 0 at the exit.
 * The gap is the parabola q r^2/2 with q = cos^2 phi + ratio sin^2 phi. phi is measured from the
 * side on which the fluid enters. */
typedef struct far_angle {
    double ratio;           // R_x/R_y, 1 for a circle
    double exit;            // phi at the exit
    double term[FAR_TERMS]; // coefficients of even Chebyshev polynomials; not used for a circle
} far_angle;

/* The solution for a circle, which has a closed form. At the exit tan(phi) = -3 tanh(3 phi). Here
 * tanh is taken as 1; it is 1 - 2e-5. */
#define FAR_ANGLE_ROUND                                                                            \
    { .ratio = 1, .exit = M_PI - 1.2490457723982544 }

/* Computes the solution by collocation, for any ratio except 1. FAR_ANGLE_ROUND is the solution
 * for 1. */
far_angle far_angle_of(double ratio);

/* Returns S, which is 0 behind the exit. */
double far_angle_shape(const far_angle *self, double phi);

/* Returns q, the factor of the gap q r^2/2 in the direction phi. */
double far_angle_rise(const far_angle *self, double phi);

/* Returns the angle chi with tan(chi) = ratio^(1/4) tan(phi), in which S is smooth for any ratio.
 * For a circle chi is phi. */
double far_angle_stretched(const far_angle *self, double phi);
/* Returns phi for an angle chi, and in *slope the derivative of phi with respect to chi. */
double far_angle_direction(const far_angle *self, double chi, double *slope);

#endif
