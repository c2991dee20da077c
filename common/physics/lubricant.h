/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lubricant laws: viscosity and density as functions of pressure, shear stress as one of the rate of
 * shear too.
 *
 * A law is one lubricant_law, which also says what its parameters are called in a scene, and one
 * line in a table of laws.c: settings, --help and the stored text of a scene follow from the
 * tables. */
#ifndef EHD_LUBRICANT_H
#define EHD_LUBRICANT_H

#include "common/program/status.h"
#include <stdbool.h>
#include <stddef.h>

enum {
    LAW_WORD = 24,           // bytes of a law's name or of a parameter that is a word
    MAX_LAW_PARAMETERS = 16, // of one law; the compiler tells of more
    MAX_LAW_KEYS = 32,       // of all laws of a table; a law with one more is refused
    MAX_LAW_CONSTANTS = 16
};

/* Whether a scene must give a parameter. */
typedef enum law_need {
    LAW_OPTIONAL, // no; it may have a default
    LAW_REQUIRED, // yes
    LAW_PRESET,   // yes, or else all of the law's constants: a word that names a set of them
    LAW_CONSTANT  // yes, or else the preset
} law_need;

/* A parameter of a law: a key below lubricant.viscosity, lubricant.density or lubricant.shear.
 * Where several laws of a table have the same key, all of them describe it in the same way; only
 * whether a scene must give it and its default are each law's own. */
typedef struct law_parameter {
    const char *key; // "alpha"
    law_need need;
    const char *choices;       // "no1|no2" of a word; NULL: a number
    const char *default_value; // as it would stand in a scene; NULL: none
    double min, max;           // of a number, both allowed
    const char *unit;          // "1", "Pa", ...
    const char *help;          // what it is
} law_parameter;

/* The value of a parameter: NaN or "" when not given. */
typedef union law_value {
    double number;
    char word[LAW_WORD];
} law_value;

/* The choice of a law and its parameters' values, at the places that laws_slot tells. */
typedef struct law_settings {
    char law[LAW_WORD];
    law_value values[MAX_LAW_KEYS];
} law_settings;

typedef struct lubricant_settings {
    law_settings viscosity;      // one of viscosity_laws
    law_settings density;        // one of density_laws
    law_settings shear;          // one of shear_laws; "": the first one
    double thermal_conductivity; // W/(m K), of what the inlet's heating does; NaN: not given
} lubricant_settings;

typedef struct ehd_lubricant ehd_lubricant;

/* A law of viscosity, density or shear stress. */
typedef struct lubricant_law {
    const char *name;
    law_parameter parameters[MAX_LAW_PARAMETERS]; // where fewer, then one whose key is NULL
    /* Computes from the values of these parameters, in their order, what `evaluate` needs:
     * constants and, of a viscosity, what ehd_lubricant has below them. NULL: there is nothing to
     * do. */
    ehd_status (*prepare)(ehd_lubricant *self, const law_value *values, ehd_error *error);
    /* ln(eta(p)/eta(0)) or rho(p)/rho(0) at a pressure in Pa, and its derivative in 1/Pa. NULL: the
     * density is constant. */
    double (*evaluate)(const ehd_lubricant *self, double pressure, double *derivative);
    /* Shear stress in Pa at what it would be without the law, viscosity times rate of shear, not
     * negative, and a pressure, both in Pa. NULL: just that, or not a law of shear. */
    double (*shear)(const ehd_lubricant *self, double viscous, double pressure);
    bool exponential; // a viscosity whose logarithm is linear in the pressure
} lubricant_law;

extern const lubricant_law *const viscosity_laws[]; // all end with NULL
extern const lubricant_law *const density_laws[];
extern const lubricant_law *const shear_laws[];

struct ehd_lubricant {
    const lubricant_law *viscosity;
    const lubricant_law *density; // NULL when incompressible: no density term is evaluated
    const lubricant_law *shear;
    double viscosity_constants[MAX_LAW_CONSTANTS];
    double density_constants[MAX_LAW_CONSTANTS];
    double shear_constants[MAX_LAW_CONSTANTS];
    double thinning_stress; // Pa, Eyring's, where the law thins the flow too; 0: it does not
    double eta0; // Pa s, viscosity at zero pressure and the temperature; NaN where the law has none
    double alpha; // 1/Pa, the coefficient behind the Moes number L (README.md, lubricants); by
                  // default the derivative of ln(eta) at zero pressure
    double pressure_limit; // Pa, the law is not to be used above; by default infinite
    double temperature;    // degC; NaN where the law is not at a temperature
    // 1/K, -d ln(eta0)/dT at the temperature; NaN where it is not known
    double temperature_coefficient;
    double thermal_conductivity; // W/(m K); NaN where it is not known
};

size_t law_num_parameters(const lubricant_law *law);

/* The law's parameter of this key, or NULL. */
const law_parameter *law_key(const lubricant_law *law, const char *key);

/* The keys of a table of laws, each once, in the order of the laws and where the last law that has
 * it stands: number `slot`, or NULL. Those beyond MAX_LAW_KEYS have no number. It is the order of
 * stored scenes too, which must not change. */
const law_parameter *laws_key(const lubricant_law *const *laws, size_t slot);

/* The number of a key; MAX_LAW_KEYS where it has none. */
size_t laws_slot(const lubricant_law *const *laws, const char *key);

/* The default that all laws with this key share, or NULL. */
const char *laws_default(const lubricant_law *const *laws, const char *key);

/* Whether all laws with this key need it. */
bool laws_require(const lubricant_law *const *laws, const char *key);

/* NULL where there is no such law. */
const lubricant_law *laws_find(const lubricant_law *const *laws, const char *name);

/* "barus|roelands": the laws that have a key, or all when it is NULL. */
void laws_list(
    // output:
    char *list, // [size] bytes, cut there
    size_t size,
    // input:
    const lubricant_law *const *laws, const char *key);

/* Returns EHD_OK, EHD_MEMORY, EHD_DATA (unknown law or preset, constants out of range), or
 * EHD_INTERNAL (a law's key beyond MAX_LAW_KEYS). */
ehd_status lubricant_init(
    // output:
    ehd_lubricant *lubricant,
    // input:
    const lubricant_settings *settings, ehd_error *error);

/* rho(p)/rho(0) at a pressure in Pa; 1 when incompressible. A negative pressure counts as zero. */
double lubricant_density(const ehd_lubricant *lubricant, double pressure);

/* Newtonian shear stress at a dimensionless pressure p / p_H, where a fluid of the viscosity at zero
 * pressure has `isoviscous`, in the same unit. */
double lubricant_viscous_stress(const ehd_lubricant *lubricant, double hertz_pressure, // Pa
                                double isoviscous, double pressure);

/* Shear stress over the Hertz pressure at a dimensionless pressure p / p_H, where a fluid of the
 * viscosity at zero pressure would have `isoviscous` of it, of either sign (README.md,
 * traction). */
double lubricant_shear_stress(const ehd_lubricant *lubricant, double hertz_pressure, // Pa
                              double isoviscous, double pressure);

/* How far viscosity and density rise to a pressure, ln(eta/eta(0)) and ln(rho/rho(0)), and the viscosity
 * to half of it. NaN where that is not known. At the Hertz pressure they distinguish lubricants of the
 * same alpha p_H. */
enum { RISE_VISCOSITY, RISE_DENSITY, RISE_VISCOSITY_HALF, NUM_RISES };
typedef struct lubricant_rises {
    double of[NUM_RISES];
} lubricant_rises;

lubricant_rises lubricant_rises_at(const ehd_lubricant *lubricant, double pressure); // Pa
/* One of these alone. */
double lubricant_rise_at(const ehd_lubricant *lubricant, int rise, double pressure);
lubricant_rises lubricant_rises_unknown(void);

/* The names of their datasets: of snapshots, of the states of bases and models, and of a model's
 * calibration. */
extern const char *const lubricant_rise_names[NUM_RISES];
extern const char *const lubricant_rise_state_names[NUM_RISES];
extern const char *const lubricant_rise_shown_names[NUM_RISES];

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
