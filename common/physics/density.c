/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the density: incompressible, or by Dowson and Higginson (README.md, Lubricants).
 * Called by lubricant.c through the table density_laws (laws.c). */
#include "common/physics/laws.h"

const lubricant_law density_incompressible = {.name = "incompressible"};

/* Returns (5.9e8 + 1.34 p) / (5.9e8 + p), Dowson and Higginson, Elasto-Hydrodynamic Lubrication,
 * 1966. */
static double dowson_higginson(const ehd_lubricant *self, double pressure, double *derivative) {
    const double c = 5.9e8; // Source: Dowson and Higginson, as above; Pa

    (void)self;
    *derivative = 0.34 * c / ((c + pressure) * (c + pressure));
    return (c + 1.34 * pressure) / (c + pressure);
}

const lubricant_law density_dowson_higginson = {.name = "dowson-higginson",
                                                .evaluate = dowson_higginson};
