/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The contact that a scene describes. */
#ifndef EHD_SCENE_CONTACT_H
#define EHD_SCENE_CONTACT_H

#include "common/physics/grid_choice.h"
#include "common/settings/scene.h"

/* contact_init with the settings of a valid scene, and its grid: where the scene does not say, as
 * the contact needs it. EHD_DATA as there, and where a stationary scene gives the approach, a given
 * approach is measured from too near, or the grid has too many nodes; the contact's numbers are then
 * 0 or NaN as far as they are not known. */
ehd_status scene_contact(
    // output:
    ehd_contact *contact,
    // input:
    const scene *given, ehd_error *error);

/* The same in two steps. Between them a contact whose scene leaves the grid open may take one of a model
 * (contact_take_grid). The choice of a grid, which takes most of the time, is then left out. */
ehd_status scene_contact_begin(ehd_contact *contact, const scene *given, ehd_error *error);
ehd_status scene_contact_end(ehd_contact *contact, const scene *given, ehd_error *error);

/* Before it, where the contact has to be of the kind of the model in `path`: EHD_DATA. Else what
 * follows from another kind, such as a grid of too many nodes, would be told first. */
ehd_status scene_check_kind(const scene *given, const contact_kind *kind, const char *path,
                            ehd_error *error);

/* EHD_DATA: a scene that reduced models and their training do not serve, which have smooth surfaces.
 * Before other work. */
ehd_status scene_check_reducible(const scene *given, ehd_error *error);

/* Puts another grid in place of the one of scene_contact: `needed` where the scene does not say.
 * EHD_DATA: too many nodes. */
ehd_status scene_set_grid(ehd_contact *contact, const grid_extent *needed, ehd_error *error);

/* Again after another grid: EHD_DATA where the scene gives the approach and it is measured from too
 * near (contact_check_approach). */
ehd_status scene_check_approach(const scene *given, const ehd_contact *contact, ehd_error *error);

#endif
