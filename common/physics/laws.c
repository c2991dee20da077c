/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tables of lubricant laws. The tables have a file of their own, so that a program that links
 * the library can replace them by longer tables. */
#include "common/physics/laws.h"

const lubricant_law *const viscosity_laws[] = {
    &viscosity_barus,
    &viscosity_roelands,
    &viscosity_wlf,
    NULL,
};

const lubricant_law *const density_laws[] = {
    &density_incompressible,
    &density_dowson_higginson,
    NULL,
};
