/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Declares the lubricant laws by name (README.md, Lubricants). A new law is declared here and gets
 * a line in laws.c or shear_laws.c.
 * Included by the sources of laws and tables, and by sources that need a certain law. */
#ifndef EHD_LAWS_H
#define EHD_LAWS_H

#include "common/physics/lubricant.h"

extern const lubricant_law viscosity_barus, viscosity_roelands, viscosity_wlf; // viscosity.c
extern const lubricant_law density_incompressible, density_dowson_higginson;   // density.c
extern const lubricant_law shear_newtonian, shear_eyring, shear_limiting, shear_carreau; // shear.c

#endif
