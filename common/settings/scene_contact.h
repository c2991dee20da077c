/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes the contact that a scene describes. */
#ifndef EHD_SCENE_CONTACT_H
#define EHD_SCENE_CONTACT_H

#include "common/physics/grid_choice.h"
#include "common/settings/plausible.h"
#include "common/settings/scene.h"

/* Initialises the contact of a valid scene with contact_init, and the contact's grid. Grid values
 * that the scene does not give are chosen as the contact needs them. Returns EHD_DATA for
 * - errors of contact_init,
 * - an impossible quantity, such as a half width above the radius (plausible.h),
 * - a stationary scene that gives the approach,
 * - a given approach that is measured at too short a distance (contact_check_approach),
 * - a grid with too many nodes.
 * After EHD_DATA the unknown numbers of the contact are 0 or NaN. */
ehd_status scene_contact(
    // output:
    ehd_contact *contact,
    // input:
    const scene *given, ehd_error *error);

/* Together, these two functions do the work of scene_contact. If the scene does not give the grid,
 * the contact may take the grid of a model between the two calls (contact_take_grid).
 * scene_contact_end then does not choose a grid, which saves most of the time. */
ehd_status scene_contact_begin(ehd_contact *contact, const scene *given, ehd_error *error);
ehd_status scene_contact_end(ehd_contact *contact, const scene *given, ehd_error *error);

/* Does the first part of scene_contact_begin: contact_init, without the check of quantities. */
ehd_status scene_contact_derive(ehd_contact *contact, const scene *given, ehd_error *error);

/* Judges the quantities of the contact of a scene (plausible_judge). */
plausibility scene_judge(char text[PLAUSIBLE_TEXT], const ehd_contact *contact, const scene *given);

/* Checks that the scene has the kind of contact of the model in `path`. Returns EHD_DATA for
 * another kind. Call this function before scene_contact. Otherwise the user would first see errors
 * that follow from the other kind, such as too many nodes. */
ehd_status scene_check_kind(const scene *given, const contact_kind *kind, const char *path,
                            ehd_error *error);

/* Checks that a reduced model and its training can represent the scene: both surfaces must be
 * smooth. Returns EHD_DATA if a surface is not. Call this function before other work. */
ehd_status scene_check_reducible(const scene *given, ehd_error *error);

/* Replaces the grid that scene_contact made. Values that the scene does not give come from
 * `needed`. Returns EHD_DATA if the grid has too many nodes. */
ehd_status scene_set_grid(ehd_contact *contact, const grid_extent *needed, ehd_error *error);

/* Checks a given approach again, after scene_set_grid. Returns EHD_DATA if the approach is measured
 * at too short a distance (contact_check_approach). */
ehd_status scene_check_approach(const scene *given, const ehd_contact *contact, ehd_error *error);

#endif
