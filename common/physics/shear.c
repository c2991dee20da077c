/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes laws of shear stress: Newton, Ree and Eyring, limiting stress, Carreau (README.md,
 * Traction).
 * Called by lubricant.c through the table shear_laws (shear_laws.c). */
#include "common/physics/laws.h"

#include <math.h>
#include <string.h>

static ehd_status keep_one(ehd_lubricant *self, const law_value *values, ehd_error *error) {
    (void)error;
    self->shear_constants[0] = values[0].number;
    return EHD_OK;
}

const lubricant_law shear_newtonian = {.name = "newtonian"};

// ---- Ree-Eyring: rate = tau0/eta sinh(tau/tau0)

static double eyring(const ehd_lubricant *self, double viscous, double pressure) {
    const double tau0 = self->shear_constants[0];

    (void)pressure;
    return tau0 * asinh(viscous / tau0);
}

static ehd_status eyring_prepare(ehd_lubricant *self, const law_value *values, ehd_error *error) {
    if (strcmp(values[1].word, "true") == 0) self->thinning_stress = values[0].number;
    return keep_one(self, values, error);
}

const lubricant_law shear_eyring = {
    .name = "eyring",
    .parameters = {{"tau0", LAW_REQUIRED, NULL, NULL, 1e3, 1e12, "Pa", "Eyring stress"},
                   {"in_film", LAW_OPTIONAL, "false|true", "false", 0, 0, "1",
                    "Whether the law counts in the film's flow too, not in the traction alone"}},
    .prepare = eyring_prepare,
    .shear = eyring};

// ---- a limiting stress: rate = -tau_L/eta ln(1 - tau/tau_L), tau_L = limit p
// S. Bair, W. O. Winer, ASME J. Lubrication Technology 101 (1979) 251-257

static double limiting(const ehd_lubricant *self, double viscous, double pressure) {
    const double limit = self->shear_constants[0] * pressure;

    return limit > 0 ? -limit * expm1(-viscous / limit) : 0;
}

const lubricant_law shear_limiting = {
    .name = "limiting",
    .parameters = {{"limit", LAW_REQUIRED, NULL, NULL, 1e-4, 1, "1",
                    "Limiting shear stress over the pressure"}},
    .prepare = keep_one,
    .shear = limiting};

// ---- Carreau: tau = eta rate (1 + (eta rate/G)^2)^((n - 1)/2)
// S. Bair, High-Pressure Rheology for Quantitative Elastohydrodynamics, Elsevier 2007

static double carreau(const ehd_lubricant *self, double viscous, double pressure) {
    const double ratio = viscous / self->shear_constants[0], n = self->shear_constants[1];

    (void)pressure;
    // hypot: the square of the ratio may overflow
    return viscous * pow(hypot(1, ratio), n - 1);
}

static ehd_status carreau_prepare(ehd_lubricant *self, const law_value *values, ehd_error *error) {
    self->shear_constants[1] = values[1].number;
    return keep_one(self, values, error);
}

const lubricant_law shear_carreau = {
    .name = "carreau",
    .parameters = {{"G", LAW_REQUIRED, NULL, NULL, 1e2, 1e12, "Pa",
                    "Shear stress at which the viscosity begins to fall"},
                   {"n", LAW_REQUIRED, NULL, NULL, 0.01, 1, "1",
                    "Exponent of the stress over the rate of shear, far above"}},
    .prepare = carreau_prepare,
    .shear = carreau};
