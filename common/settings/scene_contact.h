/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The contact that a scene describes. */
#ifndef EHD_SCENE_CONTACT_H
#define EHD_SCENE_CONTACT_H

#include "common/physics/grid_choice.h"
#include "common/settings/scene.h"

/* Initialises the contact of a valid scene with contact_init, and its grid. Where the scene does
 * not give the grid, it is chosen as the contact needs it. EHD_DATA: errors of contact_init, a
 * stationary scene that gives the approach, a given approach that is measured from too near, or a
 * grid with too many nodes. After EHD_DATA the contact's numbers are 0 or NaN as far as they are
 * not known. */
ehd_status scene_contact(
    // output:
    ehd_contact *contact,
    // input:
    const scene *given, ehd_error *error);

/* The two steps of scene_contact. Between them a contact whose scene leaves the grid open may take
 * the grid of a model (contact_take_grid). The second step then does not choose a grid, which
 * takes most of the time. */
ehd_status scene_contact_begin(ehd_contact *contact, const scene *given, ehd_error *error);
ehd_status scene_contact_end(ehd_contact *contact, const scene *given, ehd_error *error);

/* Checks that the contact is of the kind of the model in `path`; call it before scene_contact.
 * EHD_DATA: another kind. Otherwise an error that follows from another kind, such as a grid of too
 * many nodes, would come first. */
ehd_status scene_check_kind(const scene *given, const contact_kind *kind, const char *path,
                            ehd_error *error);

/* Checks that reduced models and their training can represent the scene: both surfaces are smooth.
 * Call it before other work. EHD_DATA. */
ehd_status scene_check_reducible(const scene *given, ehd_error *error);

/* Replaces the grid of scene_contact. `needed` is used where the scene does not give the grid.
 * EHD_DATA: too many nodes. */
ehd_status scene_set_grid(ehd_contact *contact, const grid_extent *needed, ehd_error *error);

/* Checks a given approach again, after scene_set_grid. EHD_DATA: it is measured from too near
 * (contact_check_approach). */
ehd_status scene_check_approach(const scene *given, const ehd_contact *contact, ehd_error *error);

#endif
