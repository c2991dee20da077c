/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/far_angle.h"

#include "common/algebra/qr.h"

#include <math.h>
#include <string.h>

/* The exit lies at chi = 98 to 108 degrees for all ratios; collocation goes on to here. */
static const double LAST = 1.95;

/* S without an exit, x/H^2 but for a factor: of 4 cos(phi)/((3 + 2 ratio) q^2) the equation holds,
 * whatever constant is added to the gap. */
static double driven(const far_angle *self, double phi) {
    const double rise = far_angle_rise(self, phi);

    return 4 * cos(phi) / ((3 + 2 * self->ratio) * (rise * rise));
}

double far_angle_rise(const far_angle *self, double phi) {
    const double across = sin(phi);

    return 1 + (self->ratio - 1) * (across * across);
}

/* With stretch^2 = g, E = cos^2 + g sin^2 and D = g cos^2 + sin^2 of chi, q is g E/D, and dchi/dphi
 * D/sqrt(g). */
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

/* Sum of terms with cos(n theta), n = 0, 2, 4 ...: the Chebyshev polynomials at cos(theta). */
static double even_series(const double *term, double place) {
    const double twice = 2 * (2 * place * place - 1); // Clenshaw, in cos(2 theta)
    double ahead = 0, here = 0;

    for (int j = FAR_TERMS - 1; j > 0; j--) {
        const double next = term[j] + twice * here - ahead;
        ahead = here;
        here = next;
    }
    return term[0] + twice / 2 * here - ahead;
}

/* In chi the equation without its right side is h'' + c1 h' - c0 h = 0. */
typedef struct far_coefficients {
    double c0, c1;
} far_coefficients;

static far_coefficients coefficients_at(double ratio, double chi) {
    const far_rises at = rises_at(ratio, chi);

    return (far_coefficients){9 * sqrt(ratio) / (at.D * at.D), (3 / at.E + 2 / at.D) * at.slope};
}

/* Of `driven` the logarithmic derivative by chi: it goes with cos(chi) D^(3/2)/E^2. */
static double driven_slope(double ratio, double chi) {
    const far_rises at = rises_at(ratio, chi);

    return -tan(chi) - (1.5 / at.D + 2 / at.E) * at.slope;
}

/* The even solution h, 1 at LAST: one equation at each zero of the next even polynomial in 0 ... 1
 * but the last, which stands for h(LAST) = 1. */
static void solve_growth(double term[FAR_TERMS], double ratio) {
    double matrix[(FAR_TERMS + 1) * FAR_TERMS] = {0},
                                    work[FAR_TERMS]; // by columns, the last the right side

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

/* chi where driven + b h touches zero: -driven/h, which b has to be, is largest. Between the middle,
 * where it is 0, and LAST; of the logarithm of h the derivative by differences. */
static double find_exit(const double *term, double ratio) {
    const double d = 1e-4;
    double low = M_PI_2, high = LAST - d;

    for (int i = 0; i < 40; i++) {
        const double chi = (low + high) / 2;
        const double growth =
            log(even_series(term, (chi + d) / LAST) / even_series(term, (chi - d) / LAST)) /
            (2 * d);
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
