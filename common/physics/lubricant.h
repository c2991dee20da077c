/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes lubricant laws: viscosity and density as functions of pressure, and shear stress as a
 * function of pressure and rate of shear (README.md, Lubricants).
 * Called by contact.c (lubricant_init), by reynolds.c for all nodes, and by traction.c.
 *
 * A law is one lubricant_law and one line in a table of laws.c or shear_laws.c. The lubricant_law
 * also gives the names of its parameters in a scene. Settings, --help and the stored text of a
 * scene follow from the tables. */
#ifndef EHD_LUBRICANT_H
#define EHD_LUBRICANT_H

#include "common/program/status.h"
#include <stdbool.h>
#include <stddef.h>

enum {
    LAW_WORD = 24,           // bytes of a law's name or of a parameter that is a word
    MAX_LAW_PARAMETERS = 16, // largest number of parameters of one law; more do not compile
    MAX_LAW_KEYS = 32,       // number of keys in one table; lubricant_init refuses later keys
    MAX_LAW_CONSTANTS = 16
};

/* Whether a scene must give a parameter. */
typedef enum law_need {
    LAW_OPTIONAL, // not required; the parameter may have a default
    LAW_REQUIRED, // required
    LAW_PRESET,   // a word that names a set of constants; required unless all constants are given
    LAW_CONSTANT  // a constant; required unless the preset is given
} law_need;

/* A parameter of a law: a key below lubricant.viscosity, lubricant.density or lubricant.shear. If
 * several laws of a table have the same key, they must describe the parameter in the same way. Only
 * `need` and the default may differ from law to law. */
typedef struct law_parameter {
    const char *key; // "alpha"
    law_need need;
    const char *choices;       // "no1|no2" for a word; NULL: a number
    const char *default_value; // default, written as in a scene; NULL: there is no default
    double min, max;           // range of a number, inclusive
    const char *unit;          // "1", "Pa", ...
    const char *help;          // description
} law_parameter;

/* The value of a parameter: a number or a word. NaN or "": the scene does not give the
 * parameter. */
typedef union law_value {
    double number;
    char word[LAW_WORD];
} law_value;

/* The name of a law, and the values of its parameters, numbered by laws_slot. */
typedef struct law_settings {
    char law[LAW_WORD];
    law_value values[MAX_LAW_KEYS];
} law_settings;

typedef struct lubricant_settings {
    law_settings viscosity;      // one of viscosity_laws
    law_settings density;        // one of density_laws
    law_settings shear;          // one of shear_laws; "": the first law
    double thermal_conductivity; // W/(m K), for the inlet heating; NaN: the scene does not give it
} lubricant_settings;

typedef struct ehd_lubricant ehd_lubricant;

/* A law of viscosity, density or shear stress. */
typedef struct lubricant_law {
    const char *name;
    law_parameter parameters[MAX_LAW_PARAMETERS]; // a NULL key ends a shorter list
    /* Computes the members of ehd_lubricant that `evaluate` needs: the constants, and for viscosity
     * and shear also the members below the constants. `values` holds the values of `parameters`, in
     * the same order. NULL: no preparation is needed. */
    ehd_status (*prepare)(ehd_lubricant *self, const law_value *values, ehd_error *error);
    /* Returns ln(eta(p)/eta(0)) or rho(p)/rho(0) at a pressure in Pa, and its derivative in 1/Pa.
     * NULL: the density is constant. */
    double (*evaluate)(const ehd_lubricant *self, double pressure, double *derivative);
    /* Returns the shear stress in Pa. `viscous` is the stress without the law, viscosity times rate
     * of shear, in Pa and not negative. `pressure` is in Pa. NULL: the stress is `viscous`, or this
     * is not a law of shear. */
    double (*shear)(const ehd_lubricant *self, double viscous, double pressure);
    bool exponential; // the logarithm of the viscosity is linear in the pressure
} lubricant_law;

extern const lubricant_law *const viscosity_laws[]; // all three tables end with NULL
extern const lubricant_law *const density_laws[];
extern const lubricant_law *const shear_laws[];

struct ehd_lubricant {
    const lubricant_law *viscosity;
    const lubricant_law *density; // NULL: incompressible; the density terms are left out
    const lubricant_law *shear;
    double viscosity_constants[MAX_LAW_CONSTANTS];
    double density_constants[MAX_LAW_CONSTANTS];
    double shear_constants[MAX_LAW_CONSTANTS];
    double thinning_stress; // Pa, Eyring stress if the law also thins the flow in the film, else 0
    double eta0; // Pa s, viscosity at p = 0 and `temperature`; NaN: the law does not give it
    // 1/Pa, the coefficient in the Moes number L (README.md, lubricants); default: the derivative
    // of ln(eta) at zero pressure
    double alpha;
    double pressure_limit; // Pa, largest pressure for which the law holds; default: infinite
    double temperature;    // degC; NaN: not known
    double temperature_coefficient; // 1/K, -d ln(eta0)/dT at the temperature; NaN: not known
    double thermal_conductivity;    // W/(m K); NaN: not known
};

size_t law_num_parameters(const lubricant_law *law);

/* Returns the law's parameter with this key, or NULL. */
const law_parameter *law_key(const lubricant_law *law, const char *key);

/* Returns key number `slot` of a table of laws, or NULL. The keys are in the order of the laws. A
 * key of several laws is numbered once, at the last of these laws. Keys beyond MAX_LAW_KEYS have no
 * number. Stored scenes also use this order, so the order must not change. */
const law_parameter *laws_key(const lubricant_law *const *laws, size_t slot);

/* Returns the index of the number that a key sets, or MAX_LAW_KEYS if the key sets no number. */
size_t laws_slot(const lubricant_law *const *laws, const char *key);

/* Returns the default that all laws with this key share, or NULL. */
const char *laws_default(const lubricant_law *const *laws, const char *key);

/* Checks whether all laws that have this key require a value for it. */
bool laws_require(const lubricant_law *const *laws, const char *key);

/* Returns the law with this name, or NULL. */
const lubricant_law *laws_find(const lubricant_law *const *laws, const char *name);

/* Writes the names of the laws that have a key, as "barus|roelands". If the key is NULL, writes the
 * names of all laws. */
void laws_list(
    // output:
    char *list, // [size] bytes; a longer text is truncated
    size_t size,
    // input:
    const lubricant_law *const *laws, const char *key);

/* Sets up a lubricant. Returns EHD_OK, EHD_MEMORY, EHD_DATA (unknown law or preset, constants out
 * of range), or EHD_INTERNAL (a law's key beyond MAX_LAW_KEYS). */
ehd_status lubricant_init(
    // output:
    ehd_lubricant *lubricant,
    // input:
    const lubricant_settings *settings, ehd_error *error);

/* Returns rho(p)/rho(0) at a pressure in Pa; 1 when incompressible. A negative pressure is taken
 * as zero. */
double lubricant_density(const ehd_lubricant *lubricant, double pressure);

/* Returns the Newtonian shear stress at a dimensionless pressure p / p_H. `isoviscous` is the
 * stress with the viscosity at zero pressure. The result has the unit of `isoviscous`. */
double lubricant_viscous_stress(const ehd_lubricant *lubricant, double hertz_pressure, // Pa
                                double isoviscous, double pressure);

/* Returns the shear stress, divided by the Hertz pressure, at a dimensionless pressure p / p_H
 * (README.md, traction). `isoviscous` is the Newtonian stress for the viscosity at zero pressure,
 * divided by the Hertz pressure, of either sign. */
double lubricant_shear_stress(const ehd_lubricant *lubricant, double hertz_pressure, // Pa
                              double isoviscous, double pressure);

/* Rises of viscosity and density from zero pressure to a given pressure: ln(eta/eta(0)),
 * ln(rho/rho(0)), and ln(eta/eta(0)) at half of the pressure. NaN: the rise is not known. At the
 * Hertz pressure these rises distinguish lubricants with the same alpha p_H. */
enum { RISE_VISCOSITY, RISE_DENSITY, RISE_VISCOSITY_HALF, NUM_RISES };
typedef struct lubricant_rises {
    double of[NUM_RISES];
} lubricant_rises;

lubricant_rises lubricant_rises_at(const ehd_lubricant *lubricant, double pressure); // Pa
/* Returns one of the rises: the one with the index `rise` (RISE_VISCOSITY, …). */
double lubricant_rise_at(const ehd_lubricant *lubricant, int rise, double pressure);
lubricant_rises lubricant_rises_unknown(void);

/* Names of the datasets that hold lubricant_rises: of snapshots, of the states of bases and models,
 * and of the scenes on which a model was calibrated. */
extern const char *const lubricant_rise_names[NUM_RISES];
extern const char *const lubricant_rise_state_names[NUM_RISES];
extern const char *const lubricant_rise_shown_names[NUM_RISES];

/* Evaluates ln(eta/eta(0)) and relative density at num_nodes dimensionless pressures p / p_H, and
 * their derivatives with respect to the dimensionless pressure. Negative pressures are taken as
 * zero, and pressures above the limit of the law as the limit. */
void lubricant_evaluate(
    // output:
    double *log_viscosity, double *log_viscosity_derivative, // [num_nodes]
    double *density, double *density_derivative, // [num_nodes], untouched when incompressible
    // input:
    const ehd_lubricant *lubricant, double hertz_pressure, // Pa
    const double *pressure,                                // [num_nodes], dimensionless
    size_t num_nodes);

#endif
