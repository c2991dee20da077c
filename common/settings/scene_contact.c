/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/settings/scene_contact.h"

#include <math.h>
#include <string.h>

ehd_status scene_set_grid(ehd_contact *contact, const grid_extent *needed, ehd_error *error) {
    const size_t most = contact->kind->dimensions > 1 ? MAX_NODES : MAX_LINE_NODES;

    contact->grid = grid_choose(&contact->grid_given, needed, &contact->grid);
    if (contact->grid.num_inner <= most) return EHD_OK;
    return ehd_fail(
        error, EHD_DATA,
        "grid: found %zu nodes from %g by %g for M = %g and L = %g, expected at most %zu, "
        "as by another grid.step",
        contact->grid.num_inner, contact->grid.x_min, contact->grid.step, contact->moes_M,
        contact->moes_L, most);
}

static const contact_kind *kind_of(const scene *given) {
    return *given->contact ? contact_kind_find(given->contact) : &contact_line;
}

ehd_status scene_check_kind(const scene *given, const contact_kind *kind, const char *path,
                            ehd_error *error) {
    const contact_kind *found = kind_of(given);

    return found == kind ? EHD_OK
                         : ehd_fail(error, EHD_DATA, "contact: found %s, expected %s as in %s",
                                    found->name, kind->name, path);
}

ehd_status scene_check_reducible(const scene *given, ehd_error *error) {
    if (*given->surface.kind)
        return ehd_fail(error, EHD_DATA,
                        "surface.kind: found %s, expected none with a reduced model, which is of "
                        "smooth surfaces; fullrun solves it",
                        given->surface.kind);
    return EHD_OK;
}

ehd_status scene_check_approach(const scene *given, const ehd_contact *contact, ehd_error *error) {
    return strcmp(given->closure, "approach") == 0 ? contact_check_approach(contact, error)
                                                   : EHD_OK;
}

/* Returns the index of a name that the scene's reader has accepted; 0 for "". */
static unsigned named(const char *const *names, const char *name) {
    unsigned index;

    name_find(&index, names, name);
    return index;
}

/* Sets how films are carried through the contact. */
static void set_transport(ehd_contact *contact, const scene *given) {
    contact->transport = named(transport_names, given->transport); // "" if stationary
    contact->smoothing = given->transient.smoothing;
    contact->time_tolerance = isnan(given->transient.fixed_step) ? given->transient.tolerance : NAN;
}

ehd_status scene_contact(ehd_contact *contact, const scene *given, ehd_error *error) {
    const ehd_status status = scene_contact_begin(contact, given, error);

    return status ? status : scene_contact_end(contact, given, error);
}

/* Returns the settings of the contact that a scene describes. */
static contact_settings settings_of(const scene *given) {
    return (contact_settings){
        .kind = kind_of(given),
        .lubricant = given->lubricant,
        .moes_M = given->moes.M,
        .moes_L = given->moes.L,
        .load = given->physical.load,
        .radius = given->physical.radius,
        .radius_across = given->physical.radius_across,
        .ellipticity = given->ellipticity,
        .speed = scene_speed(given),
        .surface_speeds = isnan(given->physical.speed),
        .modulus = given->physical.modulus,
        .viscosity = given->physical.viscosity,
        .hertz_pressure = given->hertz_pressure,
        .approach_given = strcmp(given->closure, "approach") == 0,
        .approach_length = given->approach_length,
    };
}

static ehd_status derive(ehd_contact *contact, const contact_settings *settings, const scene *given,
                         ehd_error *error) {
    *contact = (ehd_contact){0};
    if (settings->approach_given && strcmp(given->regime, "stationary") == 0)
        return ehd_fail(error, EHD_DATA,
                        "closure: found approach in a stationary scene, expected load; a transient "
                        "scene finds the load of an approach");
    return contact_init(contact, settings, error);
}

ehd_status scene_contact_derive(ehd_contact *contact, const scene *given, ehd_error *error) {
    const contact_settings settings = settings_of(given);

    return derive(contact, &settings, given, error);
}

plausibility scene_judge(char text[PLAUSIBLE_TEXT], const ehd_contact *contact,
                         const scene *given) {
    const contact_settings settings = settings_of(given);

    return plausible_judge(text, contact, &settings);
}

ehd_status scene_contact_begin(ehd_contact *contact, const scene *given, ehd_error *error) {
    const contact_settings settings = settings_of(given);
    char text[PLAUSIBLE_TEXT];
    ehd_status status = derive(contact, &settings, given, error);

    if (!status && plausible_judge(text, contact, &settings) == IMPOSSIBLE)
        status = ehd_fail(error, EHD_DATA, "%s", text);
    if (status) return status;
    contact->slide_roll = scene_slide_roll(given);
    contact->grid.half = given->grid.half != 0 && contact->kind->dimensions > 1;
    contact->grid.discretization = named(discretization_names, given->discretization);
    contact->grid.boundary = named(boundary_names, given->boundary); // "" for a line contact
    contact->grid_given =
        (grid_extent){given->grid.x_min, given->grid.x_max, given->grid.step, given->grid.y_max};
    if (contact_has_chosen_grid(contact)) return EHD_OK;
    return scene_set_grid(contact, &contact->grid_given, error);
}

ehd_status scene_contact_end(ehd_contact *contact, const scene *given, ehd_error *error) {
    ehd_status status = EHD_OK;

    if (contact->grid.num_inner == 0) {
        const grid_extent needed = grid_extent_needed(contact);
        status = scene_set_grid(contact, &needed, error);
    }
    set_transport(contact, given);
    return status ? status : scene_check_approach(given, contact, error);
}
