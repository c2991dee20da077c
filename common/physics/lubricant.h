/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lubricant laws: viscosity and density as functions of pressure. Each law is one row of a table,
 * so that a research variant is one new function and one line. */
#ifndef EHD_LUBRICANT_H
#define EHD_LUBRICANT_H

#include "common/program/status.h"
#include <stdbool.h>
#include <stddef.h>

/* The constants of the modified WLF law (paper eq. 40), in the units of Table 1. */
enum {
    WLF_A1,   // degC
    WLF_A2,   // 1/GPa
    WLF_B1,   // 1
    WLF_B2,   // 1/MPa
    WLF_C1,   // 1
    WLF_C2,   // degC
    WLF_TG0,  // degC
    WLF_MU_G, // Pa s
    NUM_WLF
};

/* What a scene says about its lubricant. NaN or "" stands for "not given". */
typedef struct lubricant_settings {
    char viscosity_law[16];   // barus | roelands | wlf
    char viscosity_preset[8]; // wlf: no1 | no2 | no3 (Table 1), or "" and all of Table 1 given
    double alpha;             // 1/Pa, barus and roelands: pressure-viscosity coefficient at p = 0
    double eta0;              // Pa s, roelands
    double temperature;       // degC, wlf: T0 of eq. (40)
    double wlf[NUM_WLF];      // wlf without preset
    char density_law[24];     // incompressible | dowson-higginson
} lubricant_settings;

typedef struct ehd_lubricant ehd_lubricant;

/* One viscosity law. `log_viscosity` returns ln(eta(p)/eta(0)) and its derivative (1/Pa). */
typedef struct viscosity_law {
    const char *name;
    const char *const *parameters; // keys below lubricant.viscosity that it needs, NULL at the end
    ehd_status (*prepare)(ehd_lubricant *self, const lubricant_settings *settings,
                          ehd_error *error);
    double (*log_viscosity)(const ehd_lubricant *self, double pressure, double *derivative);
} viscosity_law;

/* One density law. Returns rho(p)/rho(0) and its derivative (1/Pa). */
typedef struct density_law {
    const char *name;
    double (*relative_density)(double pressure, double *derivative);
} density_law;

extern const viscosity_law viscosity_laws[]; // ends with a row whose name is NULL
extern const density_law density_laws[];     // ends with a row whose name is NULL

struct ehd_lubricant {
    const viscosity_law *viscosity;
    const density_law *density; // NULL when incompressible: no density term is evaluated
    double constants[NUM_WLF + 4];
    double eta0;           // Pa s, viscosity at zero pressure; NaN where the law has none (barus)
    double alpha;          // 1/Pa, the coefficient behind the Moes number L (model.md, section 1)
    double pressure_limit; // Pa, the law is not to be used above
};

/* Returns EHD_OK, or EHD_DATA (unknown law or preset, constants out of range). */
ehd_status lubricant_init(
    // output:
    ehd_lubricant *lubricant,
    // input:
    const lubricant_settings *settings, ehd_error *error);

/* ln(eta/eta(0)) and relative density at num_nodes dimensionless pressures p / p_H, with their
 * derivatives with respect to the dimensionless pressure. Negative pressures count as zero. */
void lubricant_evaluate(
    // output:
    double *log_viscosity, double *log_viscosity_derivative, // [num_nodes]
    double *density, double *density_derivative, // [num_nodes], untouched when incompressible
    // input:
    const ehd_lubricant *lubricant, double hertz_pressure, // Pa
    const double *pressure,                                // [num_nodes], dimensionless
    size_t num_nodes);

#endif
