/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the effect of shear heating in the inlet on the film, by a published factor on the
 * isothermal film. Results contain the factor; the films stay isothermal (README.md, Inlet
 * heating).
 * Called by common/output for results and tables of cases, and by romrun/library/solve.c. */
#ifndef EHD_INLET_HEATING_H
#define EHD_INLET_HEATING_H

#include "common/physics/contact.h"

typedef struct inlet_heating {
    double loading; // dimensionless thermal loading eta0 beta u^2/k; NaN: the conductivity is not
                    // known
    double factor;  // dimensionless factor on the films; NaN: the factor is not known, or the
                    // contact lies outside of the formula's range of use
} inlet_heating;

/* Returns loading and factor of a contact in SI units whose lubricant has a conductivity. Without
 * a slide-roll ratio the contact is taken as in pure rolling. */
inlet_heating inlet_heating_of(const ehd_contact *contact);

/* Returns the factor of Zhu and Cheng, as printed by Zhou and Hoeprich, J. Tribology 113, 1991, eq.
 * 21, and Arana et al., Proc. IMechE J 233, 2019, eq. 24; used by Gupta et al., J. Tribology 114,
 * 1992. The range of use is a slide-roll ratio of at most 2 (one surface at rest) and a load term,
 * 13.2 (p_H/E') loading^0.42, of at most a quarter. Outside of this range the result is NaN. */
double inlet_heating_factor(double loading,     // dimensionless, eta0 beta u^2/k, u the mean speed
                            double ratio,       // p_H/E'
                            double slide_roll); // (u1 - u2)/u, of either sign

#endif
