/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The contact that a scene describes. */
#ifndef EHD_SCENE_CONTACT_H
#define EHD_SCENE_CONTACT_H

#include "common/physics/contact.h"
#include "common/settings/scene.h"

/* contact_init with the settings of a valid scene. EHD_DATA as there, and where a stationary scene
 * gives the approach; the contact's numbers are then 0 or NaN as far as they are not known. */
ehd_status scene_contact(
    // output:
    ehd_contact *contact,
    // input:
    const scene *given, ehd_error *error);

#endif
