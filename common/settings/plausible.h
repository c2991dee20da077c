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

/* Number of quantities that plausible_judge checks. */
size_t plausible_count(void);

/* Judges one quantity of a contact, with 0 <= index < plausible_count(). Quantities that the scene
 * does not determine are plausible. Unless the result is PLAUSIBLE, writes a line with the value,
 * the limit, and the setting that is probably in another unit. */
plausibility plausible_judge(
    // output:
    char text[PLAUSIBLE_TEXT],
    // input:
    size_t index, const ehd_contact *contact, const contact_settings *given);

#endif
