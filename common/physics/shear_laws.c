/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of the laws of shear stress, in a file of its own as those of laws.c; the first one is that
 * of a scene which names none. */
#include "common/physics/laws.h"

const lubricant_law *const shear_laws[] = {
    &shear_newtonian, &shear_eyring, &shear_limiting, &shear_carreau, NULL,
};
