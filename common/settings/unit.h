/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts values from usual engineering units to SI units: "N/mm" to N/m, "GPa" to Pa.
 * Called for the values of settings (settings_table.c), for columns of tables (history.c,
 * surface.c), and to name the unit of a wrong value (plausible.c). */
#ifndef EHD_UNIT_H
#define EHD_UNIT_H

#include "common/program/text.h"
#include <stdbool.h>

/* value in SI units = factor * value + offset */
typedef struct unit_conversion {
    double factor, offset;
} unit_conversion;

/* Finds a unit of the same kind as the SI unit `si`, such as "kN/m" for "N/m". Spaces, dots, stars
 * and carets in `name` do not matter: "mPa.s" and "mPa s" are the same. Returns false if there is
 * no such unit. `si` may have two units, "N/m|N"; the conversion is then found in either of them.
 * */
bool unit_find(
    // output:
    unit_conversion *found,
    // input:
    const char *si, const char *name);

/* Lists the units of the same kind as `si`: "N/mm, kN/m". `si` is one unit. */
void unit_list(char list[SHOWN_TEXT], const char *si);

/* Returns the name of the first unit with this factor, or NULL. `si` is one unit. */
const char *unit_named(const char *si, double factor);

#endif
