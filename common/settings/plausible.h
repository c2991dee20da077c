/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks whether the quantities that follow from a scene, such as Hertz pressure and film, lie in
 * the range of lubricated contacts. If not, a value of the scene is probably in another unit.
 * Called by scene_contact.c and contact_load, which refuse or warn, and by describe.c. */
#ifndef EHD_PLAUSIBLE_H
#define EHD_PLAUSIBLE_H

#include "common/physics/contact.h"

enum { PLAUSIBLE_TEXT = 512 };

typedef enum plausibility {
    PLAUSIBLE,
    IMPLAUSIBLE, // outside of the usual range: a warning
    IMPOSSIBLE   // so far outside that the scene is refused
} plausibility;

/* Judges the quantities of a contact. Returns the worst verdict. Unless it is PLAUSIBLE, writes a
 * line about the first quantity with this verdict: its value, the limit, and the setting that is
 * probably in another unit. Quantities that the scene does not determine are plausible. */
plausibility plausible_judge(
    // output:
    char text[PLAUSIBLE_TEXT],
    // input:
    const ehd_contact *contact, const contact_settings *given);

#endif
