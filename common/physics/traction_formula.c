/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/traction_formula.h"

#include "common/physics/laws.h"
#include "common/physics/traction.h"

#include <math.h>

const char traction_formula_source[] = "Evans and Johnson, Proc. IMechE C 200, 1986";
const double TRACTION_MIN_EXCESS = 100;

double hertz_mean_pressure(const contact_kind *kind) {
    return kind->load / (kind->dimensions > 1 ? M_PI : 2); // area (point) or length (line) of the
                                                           // dry contact
}

traction_estimate traction_at_mean_pressure(const ehd_contact *contact, double film,
                                            double slide_roll) {
    const double pressure = hertz_mean_pressure(contact->kind);
    ehd_contact sliding = *contact;

    sliding.slide_roll = slide_roll;
    sliding.lubricant.thinning_stress = 0; // no pressure gradient at mean conditions
    if (contact->lubricant.shear != &shear_eyring || !contact_has_traction(&sliding))
        return (traction_estimate){NAN, NAN};
    const double stress = contact_shear_stress(&sliding, pressure, film, 0);
    sliding.lubricant.shear = &shear_newtonian;
    const double viscous = contact_shear_stress(&sliding, pressure, film, 0);
    return (traction_estimate){.coefficient = stress / pressure,
                               .excess = fabs(viscous) * contact->hertz_pressure /
                                         contact->lubricant.shear_constants[0]};
}
