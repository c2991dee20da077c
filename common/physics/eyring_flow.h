/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the flow of a Ree-Eyring fluid between sliding surfaces (README.md, Thinned flow).
 * Called by reynolds.c for the mobility, and by traction.c for the shear stress.
 *
 * Two numbers determine the flow. The rate N = eta |u1 - u2|/(tau0 h) is the Newtonian stress due
 * to sliding, divided by Eyring's stress. The gradient Sigma = h |dp/dx|/(2 tau0) is the change of
 * the stress from the middle of the film to a surface, divided by Eyring's stress. */
#ifndef EHD_EYRING_FLOW_H
#define EHD_EYRING_FLOW_H

#include <math.h>
#include <stdbool.h>

/* Factors of the flow that depend on the gradient alone. */
typedef struct eyring_gradient {
    double square;  // Sigma^2
    double at_rest; // A = 3 (Sigma cosh Sigma - sinh Sigma)/Sigma^3, the factor without sliding
    double sliding; // C = 3 (Sigma coth Sigma - 1)/Sigma^2, the factor of fast sliding divided by N
} eyring_gradient;

/* The factor on the mobility of the pressure flow, and the derivatives of its logarithm with
 * respect to ln N and ln Sigma. */
typedef struct eyring_factor {
    double value, by_log_rate, by_log_gradient;
} eyring_factor;

/* Source: the range of a double, in which exp(Sigma) overflows from Sigma = 709 on. The constant is
 * the largest Sigma for which the factor is evaluated. Above it the factor is constant. Only
 * iterates far from a solution have such gradients. */
#define EYRING_LARGEST_GRADIENT 600.

/* Returns the factors for Sigma >= 0, without cancellation or overflow. */
static inline eyring_gradient eyring_gradient_of(double sigma) {
    const double s = sigma * sigma;

    if (sigma < 1) {
        // A = 3 sum 2k s^(k-1)/(2k + 1)!, sinh Sigma/Sigma = sum s^k/(2k + 1)!
        double term = 1, at_rest = 0, sinh_over = 1;
        for (int k = 1; k <= 9; k++) {
            const double factor = 1. / (2 * k * (2 * k + 1));
            at_rest += 6 * k * factor * term;
            term *= s * factor;
            sinh_over += term;
        }
        return (eyring_gradient){s, at_rest, at_rest / sinh_over};
    }
    const double capped = fmin(sigma, EYRING_LARGEST_GRADIENT), decay = exp(-2 * capped);
    const double rise = capped - 1 + (capped + 1) * decay; // 2 exp(-Sigma) (Sigma cosh - sinh)

    return (eyring_gradient){capped * capped, 1.5 * exp(capped) * rise / (capped * capped * capped),
                             3 * rise / (capped * capped * (1 - decay))};
}

/* Returns the derivative of ln A with respect to ln Sigma. */
static inline double eyring_at_rest_slope(const eyring_gradient *of) {
    return of->square < EYRING_LARGEST_GRADIENT * EYRING_LARGEST_GRADIENT ? 3 / of->sliding - 3 : 0;
}

/* Returns the derivative of ln(C/A) with respect to ln Sigma, which is -C Sigma^2/3. */
static inline double eyring_sliding_slope(const eyring_gradient *of) {
    return of->square < EYRING_LARGEST_GRADIENT * EYRING_LARGEST_GRADIENT
               ? -of->sliding * of->square / 3
               : 0;
}

/* Returns the factor of a flow along the sliding. The factor is exact without a gradient across the
 * sliding:
 *
 *     A sqrt(1 + (N Sigma/sinh Sigma)^2) = sqrt(A^2 + (N C)^2)
 *
 * (T. F. Conry, S. Wang, C. Cusano, ASME J. Tribology 109, 1987). */
static inline eyring_factor eyring_along(const eyring_gradient *of, double rate) {
    const double slid = rate * (of->sliding / of->at_rest); // sinh of eyring_stress
    const double root = slid < 1e8 ? sqrt(1 + slid * slid) : slid;
    const double by_rate = slid / root * (slid / root);

    return (eyring_factor){slid < 1e8 ? of->at_rest * root : rate * of->sliding, by_rate,
                           eyring_at_rest_slope(of) + by_rate * eyring_sliding_slope(of)};
}

/* Returns the factor of a flow across the sliding, without a gradient along the sliding: A r/asinh
 * r with r = N sqrt(Sigma/sinh Sigma). The factor is exact without sliding, and without a gradient.
 * At rates up to 1e4 its error is at most 1.3 % for Sigma = 1, and 6.8 % for Sigma = 2
 * (tests/unit/test_eyring_flow.c). */
static inline eyring_factor eyring_across(const eyring_gradient *of, double rate) {
    const double slid = rate * sqrt(of->sliding / of->at_rest);
    const double root = slid < 1e8 ? sqrt(1 + slid * slid) : slid;
    double factor, by_rate;

    if (slid < 1e-4) {
        factor = 1 + slid * slid / 6;
        by_rate = slid * slid / 3;
    } else {
        // asinh(slid), accurate to round-off, from `root`
        const double stress =
            slid < 0.5 ? log1p(slid + slid * slid / (1 + root)) : log(slid + root);
        factor = slid / stress;
        by_rate = 1 - slid / (root * stress);
    }
    return (eyring_factor){of->at_rest * factor, by_rate,
                           eyring_at_rest_slope(of) + by_rate / 2 * eyring_sliding_slope(of)};
}

/* Coefficients of the error bounds of the factors, for gradients Sigma_x along the sliding and
 * Sigma_y across it. The bounds hold for gradients up to 3 and for any rate of sliding. The error
 * of the factor along is below DOUBT_ALONG Sigma_y^2. The error of the factor across is below
 * DOUBT_ACROSS Sigma_x^2 + DOUBT_ACROSS_OWN Sigma_y^2. Errors found by numerical quadrature stay
 * below both bounds (test_eyring_flow.c, doubt_is_a_bound). */
#define EYRING_DOUBT_ALONG      0.1
#define EYRING_DOUBT_ACROSS     0.25
#define EYRING_DOUBT_ACROSS_OWN 0.025

/* Returns the shear stress due to sliding in the middle of the film, divided by Eyring's stress.
 * The result is not negative. */
static inline double eyring_stress(const eyring_gradient *of, double rate) {
    return asinh(rate * (of->sliding / of->at_rest));
}

#endif
