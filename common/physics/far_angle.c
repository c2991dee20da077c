/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/far_angle.h"

#include "common/algebra/qr.h"

#include <math.h>
#include <string.h>

/* Largest angle chi of the collocation, radians. For all ratios the exit lies at chi = 1.71 to 1.89
 * (98 to 108 degrees). If the largest angle is 3, the polynomials are not accurate enough
 * (test_far_angle.c, keeps_the_flow). */
static const double LAST = 1.95;

/* Returns the part of the solution S that has a closed form, 4 cos(phi)/((3 + 2 ratio) q^2). This
 * part alone has no exit. Up to a factor the part is x/H^2, which solves the Reynolds equation also
 * if a constant is added to the gap H. */
static double driven(const far_angle *self, double phi) {
    const double rise = far_angle_rise(self, phi);

    return 4 * cos(phi) / ((3 + 2 * self->ratio) * (rise * rise));
}

double far_angle_rise(const far_angle *self, double phi) {
    const double across = sin(phi);

    return 1 + (self->ratio - 1) * (across * across);
}

/* Two functions of the stretched angle chi (far_angle_stretched), with g = sqrt(ratio): E = cos^2
 * chi + g sin^2 chi and D = g cos^2 chi + sin^2 chi. The factor q of the gap q r^2/2
 * (far_angle_rise) is g E/D, and dchi/dphi is D/sqrt(g). */
typedef struct far_rises {
    double E, D, slope; // dE/dchi = -dD/dchi
} far_rises;

static far_rises rises_at(double ratio, double chi) {
    const double g = sqrt(ratio), across = sin(chi) * sin(chi);

    return (far_rises){1 + (g - 1) * across, g + (1 - g) * across, (g - 1) * sin(2 * chi)};
}

double far_angle_stretched(const far_angle *self, double phi) {
    return self->ratio == 1 ? phi : atan2(sqrt(sqrt(self->ratio)) * sin(phi), cos(phi));
}

double far_angle_direction(const far_angle *self, double chi, double *slope) {
    const double g = sqrt(self->ratio);

    *slope = sqrt(g) / rises_at(self->ratio, chi).D;
    return self->ratio == 1 ? chi : atan2(sin(chi), sqrt(g) * cos(chi));
}

/* Returns the sum over j of term[j] cos(n theta), n = 2 j. cos(n theta) is the Chebyshev polynomial
 * of degree n at place = cos(theta). */
static double even_series(const double *term, double place) {
    const double twice = 2 * (2 * place * place - 1); // Clenshaw's recurrence in cos(2 theta)
    double ahead = 0, here = 0;

    for (int j = FAR_TERMS - 1; j > 0; j--) {
        const double next = term[j] + twice * here - ahead;
        ahead = here;
        here = next;
    }
    return term[0] + twice / 2 * here - ahead;
}

/* Returns the derivative of even_series with respect to `place`, which must not be 1. */
static double even_slope(const double *term, double place) {
    const double theta = acos(place);
    double sum = 0;

    for (int j = 1; j < FAR_TERMS; j++)
        sum += 2 * j * term[j] * sin(2 * j * theta);
    return sum / sin(theta);
}

/* Coefficients of the homogeneous equation h'' + c1 h' - c0 h = 0. h is a function of chi, and is
 * added to `driven` with a factor b so that S has an exit. */
typedef struct far_coefficients {
    double c0, c1;
} far_coefficients;

static far_coefficients coefficients_at(double ratio, double chi) {
    const far_rises at = rises_at(ratio, chi);

    return (far_coefficients){9 * sqrt(ratio) / (at.D * at.D), (3 / at.E + 2 / at.D) * at.slope};
}

/* Returns the derivative, with respect to chi, of the logarithm of the function `driven`, which is
 * proportional to cos(chi) D^(3/2)/E^2. */
static double driven_slope(double ratio, double chi) {
    const far_rises at = rises_at(ratio, chi);

    return -tan(chi) - (1.5 / at.D + 2 / at.E) * at.slope;
}

/* Computes the terms of the even solution h of the homogeneous equation, with h(LAST) = 1. The
 * equation holds at the collocation points: chi/LAST is a zero, between 0 and 1, of the Chebyshev
 * polynomial of the highest order. */
static void solve_growth(double term[FAR_TERMS], double ratio) {
    // the matrix is stored by columns; its last column is the right-hand side
    double matrix[(FAR_TERMS + 1) * FAR_TERMS] = {0}, work[FAR_TERMS];

    for (int i = 0; i < FAR_TERMS - 1; i++) {
        const double theta = M_PI_2 * (i + 0.5) / (FAR_TERMS - 1), t = cos(theta), s = sin(theta);
        const far_coefficients at = coefficients_at(ratio, t * LAST);
        for (int j = 0; j < FAR_TERMS; j++) {
            const double n = 2 * j, value = cos(n * theta), first = n * sin(n * theta) / s;
            const double second = (t * first / s - n * n * value / s) / s;
            matrix[i + FAR_TERMS * j] =
                second / (LAST * LAST) + at.c1 * first / LAST - at.c0 * value;
        }
    }
    for (int j = 0; j < FAR_TERMS; j++)
        matrix[FAR_TERMS - 1 + FAR_TERMS * j] = 1;
    matrix[FAR_TERMS * FAR_TERMS + FAR_TERMS - 1] = 1;
    qr_solve(term, matrix, work, FAR_TERMS, FAR_TERMS);
}

/* Returns chi of the exit, where driven + b h touches zero. At the exit -driven/h has its maximum,
 * which is b. The exit lies between pi/2, where -driven/h is 0, and LAST. `growth` is the
 * derivative of ln h. */
static double find_exit(const double *term, double ratio) {
    double low = M_PI_2, high = LAST;

    for (int i = 0; i < 40; i++) {
        const double chi = (low + high) / 2;
        const double growth = even_slope(term, chi / LAST) / (LAST * even_series(term, chi / LAST));
        *(driven_slope(ratio, chi) > growth ? &low : &high) = chi;
    }
    return low;
}

far_angle far_angle_of(double ratio) {
    far_angle self = {.ratio = ratio};
    double slope;

    solve_growth(self.term, ratio);
    const double exit = find_exit(self.term, ratio);
    self.exit = far_angle_direction(&self, exit, &slope);
    const double factor = -driven(&self, self.exit) / even_series(self.term, exit / LAST);
    for (int j = 0; j < FAR_TERMS; j++)
        self.term[j] *= factor;
    return self;
}

static double round_shape(double exit, double phi) {
    return 0.8 * (cos(phi) - cos(exit) * cosh(3 * phi) / cosh(3 * exit));
}

double far_angle_shape(const far_angle *self, double phi) {
    if (!(phi < self->exit)) return 0;
    if (self->ratio == 1) return round_shape(self->exit, phi);
    return driven(self, phi) + even_series(self->term, far_angle_stretched(self, phi) / LAST);
}
