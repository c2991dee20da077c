/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How the pressure far from a contact depends on the direction (README.md, far field). */
#ifndef EHD_FAR_ANGLE_H
#define EHD_FAR_ANGLE_H

/* Terms of the part that is known by its equation alone: with 20 S is within 1e-8 of
 * its largest for b/a of 0.05 to 3, 3e-7 at 5, 1.4e-5 at 10 and 5e-4 at 20. */
enum { FAR_TERMS = 20 };

/* S(phi) of a parabolic gap q r^2/2, q = cos^2 phi + ratio sin^2 phi, phi from the side on which the
 * fluid comes in: (q^3 S')' - 9 q^3 S = -8 cos phi, S'(0) = 0, S = S' = 0 at the exit. */
typedef struct far_angle {
    double ratio;           // R_x/R_y, 1 of a circle
    double exit;            // phi
    double term[FAR_TERMS]; // Chebyshev polynomials of even order; not used of a circle
} far_angle;

/* Of a circle, in closed form. */
#define FAR_ANGLE_ROUND                                                                            \
    { .ratio = 1, .exit = M_PI - 1.2490457723982544 } // tan(phi) = -3 tanh(3 phi), tanh: 1 - 2e-5

/* By collocation; any ratio but 1, which has FAR_ANGLE_ROUND. */
far_angle far_angle_of(double ratio);

/* S, 0 behind the exit. */
double far_angle_shape(const far_angle *self, double phi);

/* q */
double far_angle_rise(const far_angle *self, double phi);

/* The angle chi, tan(chi) = ratio^(1/4) tan(phi), in which S is smooth, whatever the ratio; of a
 * circle phi. And back, with the derivative of phi by chi. */
double far_angle_stretched(const far_angle *self, double phi);
double far_angle_direction(const far_angle *self, double chi, double *slope);

#endif
