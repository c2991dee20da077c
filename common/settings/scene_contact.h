/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes the contact that a scene describes. */
#ifndef EHD_SCENE_CONTACT_H
#define EHD_SCENE_CONTACT_H

#include "common/physics/grid_choice.h"
#include "common/settings/scene.h"

/* Initialises the contact of a valid scene with contact_init, and its grid. Grid values that the
 * scene does not give are chosen as the contact needs them. EHD_DATA: errors of contact_init, a
 * stationary scene that gives the approach, a given approach that is measured at too short a
 * distance, or a grid with too many nodes. After EHD_DATA the contact's numbers are 0 or NaN as far
 * as they are not known. */
ehd_status scene_contact(
    // output:
    ehd_contact *contact,
    // input:
    const scene *given, ehd_error *error);

/* Do the two steps of scene_contact. Between them a contact whose scene leaves the grid open may
 * take the grid of a model (contact_take_grid). The second step then does not choose a grid, which
 * takes most of the time. */
ehd_status scene_contact_begin(ehd_contact *contact, const scene *given, ehd_error *error);
ehd_status scene_contact_end(ehd_contact *contact, const scene *given, ehd_error *error);

/* Checks that the contact is of the kind of the model in `path`; call it before scene_contact.
 * EHD_DATA: another kind. If it were called later, errors that follow from the other kind, such as
 * too many nodes, would come first. */
ehd_status scene_check_kind(const scene *given, const contact_kind *kind, const char *path,
                            ehd_error *error);

/* Checks that reduced models and their training can represent the scene: both surfaces are smooth.
 * Call it before other work. EHD_DATA. */
ehd_status scene_check_reducible(const scene *given, ehd_error *error);

/* Replaces the grid of scene_contact. Values that the scene does not give come from `needed`.
 * EHD_DATA: too many nodes. */
ehd_status scene_set_grid(ehd_contact *contact, const grid_extent *needed, ehd_error *error);

/* Checks a given approach again, after scene_set_grid. EHD_DATA: it is measured at too short a
 * distance (contact_check_approach). */
ehd_status scene_check_approach(const scene *given, const ehd_contact *contact, ehd_error *error);

#endif
