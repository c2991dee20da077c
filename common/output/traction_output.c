/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/output/traction_output.h"

#include "common/output/grid_file.h"
#include "common/program/arena.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MEMBER(name, member) COLUMN(contact_traction, name, member)

const column traction_columns[] = {{MEMBER("friction_coefficient", coefficient)},
                                   {MEMBER("friction_force", friction)},
                                   {MEMBER("rolling_resistance", rolling_resistance)},
                                   {MEMBER("rolling_moment", rolling_moment)},
                                   {MEMBER("power_loss", power)},
                                   {MEMBER("mean_shear_stress", mean_stress)},
                                   {MEMBER("largest_shear_stress", largest_stress)},
                                   {0}};

ehd_status traction_put_units(artefact *file, const ehd_contact *contact, ehd_error *error) {
    const bool point = contact->kind->dimensions > 1;
    const named_number numbers[] = {
        {point ? "point_moment" : "line_moment", contact->load * contact->half_width},
        {point ? "point_power" : "line_power", contact->load * contact->speed},
        {"slide_roll", contact->slide_roll},
        {0}};

    return numbers_put(file, 0, numbers, error);
}

ehd_status traction_put(artefact *file, const contact_traction *traction, ehd_error *error) {
    return columns_put(file, traction_columns, 0, traction, sizeof *traction, 1, error);
}

ehd_status traction_put_stresses(artefact *file, size_t index, const ehd_contact *contact,
                                 const double *pressure, const double *film, double rigid_approach,
                                 ehd_error *error) {
    const ehd_grid *grid = &contact->grid;
    double *on_1 = array_new(grid->num_nodes, 2, sizeof *on_1);

    if (!on_1) return ehd_no_memory(error, artefact_path(file));
    double *on_2 = on_1 + grid->num_nodes;
    contact_surface_stresses(on_1, on_2, contact, pressure, film, rigid_approach);
    ehd_status status = grid_put_field(file, "shear_stress_1", index, on_1, grid, true, error);
    if (!status) status = grid_put_field(file, "shear_stress_2", index, on_2, grid, true, error);
    free(on_1);
    return status;
}

/* Returns how many digits to print of a number with the relative error `error`. The last two of
 * these digits are uncertain. */
static int digits_of(double error, int most) {
    return error > 0 ? (int)fmin(fmax(ceil(-log10(error)) + 1, 1), most) : most;
}

void traction_print(const contact_traction *traction, const ehd_contact *contact,
                    const film_effects *effects) {
    const double off = film_effects_of_rolling(effects);
    const double rolled = 2 * traction->rolling_resistance * contact->far_speed / traction->power;
    const double load = contact->load, stress = contact->hertz_pressure * 1e-6;
    const struct {
        const char *text, *units[2]; // units of a line contact, and of the other kinds
        double value, scale, error;
    } lines[] = {
        {"friction coefficient", {"", ""}, traction->coefficient, 1, 0},
        {"friction force", {"N/m", "N"}, traction->friction, load, 0},
        {"rolling resistance", {"N/m", "N"}, traction->rolling_resistance, load, off},
        {"rolling moment", {"N", "N m"}, traction->rolling_moment, load * contact->half_width, off},
        {"power loss", {"W/m", "W"}, traction->power, load * contact->speed, off * fabs(rolled)},
        {"mean shear stress", {"MPa", "MPa"}, traction->mean_stress, stress, 0},
        {"largest shear stress", {"MPa", "MPa"}, traction->largest_stress, stress, 0}};

    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        const char *unit = lines[i].units[contact->kind->dimensions > 1];
        const double value = lines[i].value;
        printf("%-24s%-*.*g", lines[i].text, *unit ? 14 : 0, digits_of(lines[i].error, 8), value);
        if (*unit) printf("%.*g %s", digits_of(lines[i].error, 6), value * lines[i].scale, unit);
        putchar('\n');
    }
}

void traction_warn(const program *caller, double friction) {
    if (isgreater(fabs(friction), usual_friction))
        program_warn(caller,
                     "%s: friction coefficient: found %.3g, expected at most %g (check "
                     "lubricant.shear.law)",
                     caller->arguments[0], friction, usual_friction);
}
