/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/contact_place.h"

#include <math.h>

contact_place contact_place_of(const ehd_contact *contact) {
    return (contact_place){.moes_M = contact->moes_M,
                           .alpha_p_H = contact->alpha_p_H,
                           .thinning = traction_thinning(contact),
                           .lubricant = &contact->lubricant};
}

contact_place contact_place_of_any(const ehd_contact *contact) {
    contact_place place = contact_place_of(contact);

    place.lubricant = NULL;
    return place;
}

double thinning_coordinate(double sliding) {
    // smallest thinning by sliding that is distinguished from no thinning. A thinning of 1e-6
    // changes films by at most 6e-5 (contact_place.h; test_contact_place.c,
    // thinning_that_no_film_shows_is_none)
    const double least = 1e-6;

    return sliding > least ? log(sliding) : log(least);
}

double gradient_coordinate(double gradient) {
    // smallest thinning by the gradient that is distinguished from no thinning. A thinning of 1e-2
    // changes films by at most 1.1e-5 (contact_place.h; test_contact_place.c,
    // thinning_that_no_film_shows_is_none)
    const double least = 1e-2;

    return gradient > least ? log(gradient) : log(least);
}
