/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the place of a contact: the coordinates that distinguish contacts of one kind and shape
 * (README.md, Moes numbers). A stationary solution depends on these coordinates alone.
 * Called by romrun, by common/training and by snapgen. */
#ifndef EHD_CONTACT_PLACE_H
#define EHD_CONTACT_PLACE_H

#include "common/physics/contact.h"
#include "common/physics/traction.h"

typedef struct contact_place {
    double moes_M, alpha_p_H;
    flow_thinning thinning;
    const ehd_lubricant *lubricant; // NULL: the place is valid for any lubricant
} contact_place;

/* Returns the place of a contact. The result points to the lubricant of the contact, so the contact
 * must outlive the result. */
contact_place contact_place_of(const ehd_contact *contact);

/* Returns the place of a contact, with NULL as the lubricant: only M, alpha p_H and the thinning
 * count. */
contact_place contact_place_of_any(const ehd_contact *contact);

/* Returns the coordinate for the thinning by sliding: the logarithm of the larger of `sliding` and
 * 1e-6. A flow with weaker thinning counts as Newtonian. In 18 line contacts (Roelands and Barus, M
 * from 0.5 to 66, L from 4.5 to 21) a thinning of 1e-6 changes the central film by at most 1.4e-5
 * and the minimum film by 6e-5. */
double thinning_coordinate(double sliding);

/* Returns the coordinate for the thinning by the pressure gradient: the logarithm of the larger of
 * `gradient` and 1e-2. In 5 line contacts without sliding a thinning of 1e-2 changes the central
 * and the minimum film by 1.1e-5 at M = 0.3, by 4e-6 at M = 1, and by less from M = 13 on. */
double gradient_coordinate(double gradient);

#endif
