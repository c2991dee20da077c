/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/inlet_heating.h"

#include <math.h>

/* Largest load term, 13.2 (p_H/E') loading^0.42, with which the formula is used. The sources of the
 * formula give no range. The factor was compared in pure rolling, for p_H/E' from 0.001 to 0.01,
 * with the factor of Murch and Wilson (1975), which does not depend on the load. With load terms up
 * to 0.25 the factor is 0.78 to 1.07 times their factor (test_inlet_heating.c,
 * others_found_about_the_same). With a load term of 0.5 it is half of their factor. */
static const double MAX_LOAD_TERM = 0.25;

/* Bounds of |S|. At 2, simple sliding, one surface is at rest. Above 2 the surfaces move in
 * opposite directions. */
static const double MAX_SLIDE_ROLL = 2;

double inlet_heating_factor(double loading, double ratio, double slide_roll) {
    const double sliding = fabs(slide_roll);
    const double load_term = 13.2 * ratio * pow(loading, 0.42);

    if (!(islessequal(load_term, MAX_LOAD_TERM) && islessequal(sliding, MAX_SLIDE_ROLL)))
        return NAN;
    return (1 - load_term) / (1 + 0.213 * (1 + 2.23 * pow(sliding, 0.83)) * pow(loading, 0.64));
}

inlet_heating inlet_heating_of(const ehd_contact *contact) {
    const double slide_roll = isnan(contact->slide_roll) ? 0 : contact->slide_roll;
    const ehd_lubricant *lubricant = &contact->lubricant;
    const double loading = contact->viscosity * lubricant->temperature_coefficient *
                           contact->speed * contact->speed / lubricant->thermal_conductivity;

    return (inlet_heating){.loading = loading,
                           .factor = inlet_heating_factor(
                               loading, contact->hertz_pressure / contact->modulus, slide_roll)};
}
