/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/ellipse.h"

#include <gsl/gsl_mode.h>
#include <gsl/gsl_sf_ellint.h>
#include <math.h>

const contact_shape shape_round = {1, 1, 1, 1, 1, FAR_ANGLE_ROUND};
const double MIN_ELLIPTICITY = 0.05, MAX_ELLIPTICITY = 20;

/* Return A and B (README.md, Elliptical contacts), the integrals from 0 to infinity of
 * 1/[(1+t)^(3/2) (k^2+t)^(1/2) t^(1/2)] and 1/[(1+t)^(1/2) (k^2+t)^(3/2) t^(1/2)]. */
static double integral_along(double k) {
    return 2. / 3 * gsl_sf_ellint_RD(0, k * k, 1, GSL_PREC_DOUBLE);
}

static double integral_across(double k) {
    return 2. / 3 * gsl_sf_ellint_RD(0, 1, k * k, GSL_PREC_DOUBLE);
}

contact_shape shape_of(double ellipticity) {
    const double k = ellipticity;

    if (k == 1) return shape_round; // exact to the last bit
    return (contact_shape){.ellipticity = k,
                           .gap_across = k * k / ellipse_radius_ratio(k),
                           .flow_across = 1 / (k * k),
                           .cell = 1 / cbrt(k),
                           .compliance = M_2_PI * integral_along(k),
                           .far = far_angle_of(1 / ellipse_radius_ratio(k))};
}

bool shape_same(const contact_shape *a, const contact_shape *b) {
    return fabs(a->ellipticity - b->ellipticity) <= 1e-6 * b->ellipticity;
}

double ellipse_radius_ratio(double ellipticity) {
    return integral_along(ellipticity) / integral_across(ellipticity);
}

/* Inverts ellipse_radius_ratio by a fixed-point iteration in logarithms. The derivative d
 * ln(R_y/R_x)/d ln(b/a) is 1.5 at b/a = 1, and below 2 everywhere. Each iteration adds 0.6 times
 * the remaining difference of ln(R_y/R_x), and reduces the error by at least a factor of 5. */
double ellipse_ellipticity(double radius_ratio) {
    const double goal = log(radius_ratio);
    double logarithm = 0.6 * goal;

    for (int i = 0; i < 60 && radius_ratio != 1; i++)
        logarithm += 0.6 * (goal - log(ellipse_radius_ratio(exp(logarithm))));
    return radius_ratio == 1 ? 1 : exp(logarithm);
}

/* Adds the deflection outside of the ellipse to x^2/2 and subtracts the deflection at the centre.
 * The integral for the deflection outside of the ellipse begins at x^2 - 1. */
double ellipse_dry_gap(const contact_shape *shape, double x) {
    const double k2 = shape->ellipticity * shape->ellipticity, x2 = x * x, t = fmax(x2 - 1, 0);
    const double along = M_PI_2 * shape->compliance;

    return x2 / 2 + (gsl_sf_ellint_RF(t, k2 + t, 1 + t, GSL_PREC_DOUBLE) -
                     x2 / 3 * gsl_sf_ellint_RD(t, k2 + t, 1 + t, GSL_PREC_DOUBLE) -
                     gsl_sf_ellint_RF(0, k2, 1, GSL_PREC_DOUBLE)) /
                        along;
}
