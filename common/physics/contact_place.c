/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/contact_place.h"

#include "common/physics/traction.h"

#include <math.h>

contact_place contact_place_of(const ehd_contact *contact) {
    return (contact_place){.moes_M = contact->moes_M,
                           .alpha_p_H = contact->alpha_p_H,
                           .thinning = traction_thinning_rate(contact),
                           .lubricant = &contact->lubricant};
}

double thinning_coordinate(double thinning) {
    const double least = 1e-6;

    return thinning > least ? log(thinning) : log(least);
}
