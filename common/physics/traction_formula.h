/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the published traction curve of a Ree-Eyring fluid, from mean conditions in the contact
 * (README.md, Traction curve).
 * Called by fullrun/formulas.c for --formulas. */
#ifndef EHD_TRACTION_FORMULA_H
#define EHD_TRACTION_FORMULA_H

#include "common/physics/contact.h"

extern const char traction_formula_source[];

typedef struct traction_estimate {
    double coefficient; // friction coefficient, with the sign of the slide-roll ratio
    double excess;      // viscous stress over the Eyring stress, at the mean pressure
} traction_estimate;

/* Returns the friction coefficient, tau0 asinh(eta u_s/(h tau0)) divided by the pressure. The
 * pressure is the mean of Hertz' pressure, and the film has the same thickness everywhere (Evans
 * and Johnson, Proc. IMechE C 200, 1986, Eyring regime, as printed by Arana et al., Proc. IMechE J
 * 233, 2019, eqs. 7 and 13). A slide-roll ratio that differs from the contact's gives another point
 * of the traction curve. The result is NaN for a contact without Eyring's law, or not in SI
 * units. */
traction_estimate traction_at_mean_pressure(const ehd_contact *contact, double film, // H
                                            double slide_roll);

/* Smallest excess (traction_estimate) at which the coefficient is accurate. Above this excess, and
 * up to alpha p_H = 20, the coefficient differs by at most 10 % from the coefficient that follows
 * from the local stress under Hertz' pressure (test_traction_formula.c,
 * stands_for_the_stress_under_hertz). Below this excess the coefficient is too small. */
extern const double TRACTION_MIN_EXCESS;

/* Returns the mean of Hertz' pressure over its maximum. */
double hertz_mean_pressure(const contact_kind *kind);

#endif
