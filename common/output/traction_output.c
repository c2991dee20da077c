/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/output/traction_output.h"

#include "common/output/grid_file.h"
#include "common/program/arena.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ENTRY(field, member, text)                                                                 \
    { #field, offsetof(contact_traction, member), text }

const traction_entry traction_entries[NUM_TRACTION] = {
    ENTRY(friction_coefficient, coefficient, "friction coefficient"),
    ENTRY(friction_force, friction, "friction force"),
    ENTRY(rolling_resistance, rolling_resistance, "rolling resistance"),
    ENTRY(rolling_moment, rolling_moment, "rolling moment"),
    ENTRY(power_loss, power, "power loss"),
    ENTRY(mean_shear_stress, mean_stress, "mean shear stress"),
    ENTRY(largest_shear_stress, largest_stress, "largest shear stress")};

static double value_of(const contact_traction *traction, size_t entry) {
    double value;

    memcpy(&value, (const char *)traction + traction_entries[entry].offset, sizeof value);
    return value;
}

ehd_status traction_put_units(artefact *file, const ehd_contact *contact, ehd_error *error) {
    const bool point = contact->kind->dimensions > 1;
    ehd_status status = artefact_put_real(file, point ? "point_moment" : "line_moment",
                                          contact->load * contact->half_width, error);

    if (!status)
        status = artefact_put_real(file, point ? "point_power" : "line_power",
                                   contact->load * contact->speed, error);
    if (!status) status = artefact_put_real(file, "slide_roll", contact->slide_roll, error);
    return status;
}

ehd_status traction_put(artefact *file, const contact_traction *traction, ehd_error *error) {
    ehd_status status = EHD_OK;

    for (size_t i = 0; i < NUM_TRACTION && !status; i++) {
        const double value = value_of(traction, i);
        status = artefact_put(file, traction_entries[i].field, &value, error);
    }
    return status;
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

/* Bounds of the friction coefficient: the largest value that the law `limiting` accepts. If the
 * friction exceeds this value and the viscosity rises with pressure, a line warns that the law of
 * shear stress does not hold. */
static const double MUCH_FRICTION = 1;

void traction_print(const contact_traction *traction, const ehd_contact *contact,
                    const film_effects *effects) {
    const double off = film_effects_of_rolling(effects);
    const double rolled = 2 * traction->rolling_resistance * contact->far_speed / traction->power;
    const double errors[NUM_TRACTION] = {0, 0, off, off, off * fabs(rolled), 0, 0};
    const double load = contact->load, stress = contact->hertz_pressure * 1e-6;
    const double scales[NUM_TRACTION] = {
        1, load, load, load * contact->half_width, load * contact->speed, stress, stress};
    static const char *const units[2][NUM_TRACTION] = {{"", "N/m", "N/m", "N", "W/m", "MPa", "MPa"},
                                                       {"", "N", "N", "N m", "W", "MPa", "MPa"}};

    for (size_t i = 0; i < NUM_TRACTION; i++) {
        const char *unit = units[contact->kind->dimensions > 1][i];
        const double value = value_of(traction, i);
        printf("%-24s%-*.*g", traction_entries[i].text, *unit ? 14 : 0, digits_of(errors[i], 8),
               value);
        if (*unit) printf("%.*g %s", digits_of(errors[i], 6), value * scales[i], unit);
        putchar('\n');
    }
    if (fabs(traction->coefficient) > MUCH_FRICTION && contact->alpha_p_H > 1)
        printf("  of friction           more than lubricants carry, whose shear stress is below "
               "the pressure: see lubricant.shear.law\n");
}
