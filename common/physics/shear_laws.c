/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Holds the table of shear stress laws (README.md, Traction), in a file of its own like laws.c. If
 * a scene names no law, the first law applies.
 * Used by lubricant.c and by common/settings. */
#include "common/physics/laws.h"

const lubricant_law *const shear_laws[] = {
    &shear_newtonian, &shear_eyring, &shear_limiting, &shear_carreau, NULL,
};
