/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/output/describe.h"

#include "common/physics/inlet_heating.h"
#include "common/settings/scene_contact.h"

#include <math.h>
#include <stdio.h>

/* Prints a line, unless the value is not known. */
static void print_known(const char *name, double value, const char *unit) {
    if (isfinite(value)) printf("%-24s%.6g%s\n", name, value, unit);
}

static void print_quantities(const ehd_contact *contact) {
    const contact_shape *shape = &contact->grid.shape;
    const double film = contact->kind->central_film(shape, contact->moes_M, contact->moes_L);
    const inlet_heating heating = inlet_heating_of(contact);

    printf("%-24s%s\n", "contact", contact->kind->name);
    if (contact->kind == &contact_ellipse) print_known("ellipticity b/a", shape->ellipticity, "");
    print_known("M", contact->moes_M, "");
    print_known("L", contact->moes_L, "");
    print_known("Hertz pressure", contact->hertz_pressure * 1e-9, " GPa");
    print_known("alpha p_H", contact->alpha_p_H, "");
    print_known("lambda", contact->lambda, "");
    print_known("half width a", contact->half_width * 1e3, " mm");
    if (contact->kind == &contact_ellipse)
        print_known("half width b", contact_half_width_across(contact) * 1e3, " mm");
    print_known("viscosity", contact->viscosity, " Pa s");
    print_known("slide-roll ratio", contact->slide_roll, "");
    print_known("central film, formula", film, "");
    print_known("  in SI units", film * contact_film_scale(contact) * 1e6, " um");
    print_known("unit of film a^2/R", contact_film_scale(contact) * 1e6, " um");
    print_known("unit of time a/u", contact_time_scale(contact) * 1e3, " ms");
    print_known("thermal loading", heating.loading, "");
    print_known("inlet heating factor", heating.factor, "");
}

ehd_status scene_describe(const program *caller, ehd_error *error) {
    const char *path = caller->describe;
    ehd_contact contact;
    ehd_error cause = {""};
    scene given;
    ehd_status status = scene_read(&given, path, caller->overrides, caller->num_overrides, error);

    if (status) return status;
    status = scene_contact_derive(&contact, &given, &cause);
    if (status) return ehd_fail(error, status, "%s: %s", path, cause.text);
    contact.slide_roll = scene_slide_roll(&given);
    print_quantities(&contact);
    char text[PLAUSIBLE_TEXT];
    const plausibility found = scene_judge(text, &contact, &given);
    if (found == IMPLAUSIBLE) program_warn(caller, "%s: %s", path, text);
    if (found == IMPOSSIBLE) status = ehd_fail(error, EHD_DATA, "%s: %s", path, text);
    return status;
}
