/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where a contact lies among others of its kind and shape: all that a stationary solution depends
 * on. */
#ifndef EHD_CONTACT_PLACE_H
#define EHD_CONTACT_PLACE_H

#include "common/physics/contact.h"

typedef struct contact_place {
    double moes_M, alpha_p_H;
    double thinning;                // traction_thinning_rate
    const ehd_lubricant *lubricant; // NULL: any
} contact_place;

/* Of a contact, which must outlive it. */
contact_place contact_place_of(const ehd_contact *contact);

/* The thinning as a coordinate: its logarithm, and that of 1e-6 below, where the flow is
 * Newtonian: in 18 line contacts (Roelands and Barus, M from 0.5 to 66, L from 4.5 to 21) thinning
 * of 1e-6 changes the central film by at most 1.4e-5 and the minimum film by 6e-5. */
double thinning_coordinate(double thinning);

#endif
