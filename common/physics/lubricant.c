/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/lubricant.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- tables of laws

size_t law_num_parameters(const lubricant_law *law) {
    size_t count = 0;

    while (count < MAX_LAW_PARAMETERS && law->parameters[count].key)
        count++;
    return count;
}

const law_parameter *law_key(const lubricant_law *law, const char *key) {
    for (size_t i = 0; i < law_num_parameters(law); i++)
        if (strcmp(law->parameters[i].key, key) == 0) return &law->parameters[i];
    return NULL;
}

static bool is_last_with(const lubricant_law *const *law, const char *key) {
    for (law++; *law; law++)
        if (law_key(*law, key)) return false;
    return true;
}

const law_parameter *laws_key(const lubricant_law *const *laws, size_t slot) {
    if (slot >= MAX_LAW_KEYS) return NULL;
    for (const lubricant_law *const *law = laws; *law; law++)
        for (size_t i = 0; i < law_num_parameters(*law); i++) {
            const law_parameter *parameter = &(*law)->parameters[i];
            if (is_last_with(law, parameter->key) && slot-- == 0) return parameter;
        }
    return NULL;
}

size_t laws_slot(const lubricant_law *const *laws, const char *key) {
    size_t slot = 0;

    for (const lubricant_law *const *law = laws; *law; law++)
        for (size_t i = 0; i < law_num_parameters(*law); i++) {
            if (!is_last_with(law, (*law)->parameters[i].key)) continue;
            if (slot == MAX_LAW_KEYS) return MAX_LAW_KEYS;
            if (strcmp((*law)->parameters[i].key, key) == 0) return slot;
            slot++;
        }
    return MAX_LAW_KEYS;
}

const char *laws_default(const lubricant_law *const *laws, const char *key) {
    const char *shared = NULL;

    for (const lubricant_law *const *law = laws; *law; law++) {
        const law_parameter *parameter = law_key(*law, key);
        if (!parameter) continue;
        if (!parameter->default_value) return NULL;
        if (shared && strcmp(shared, parameter->default_value) != 0) return NULL;
        shared = parameter->default_value;
    }
    return shared;
}

bool laws_require(const lubricant_law *const *laws, const char *key) {
    for (; *laws; laws++) {
        const law_parameter *parameter = law_key(*laws, key);
        if (parameter && parameter->need != LAW_REQUIRED) return false;
    }
    return true;
}

const lubricant_law *laws_find(const lubricant_law *const *laws, const char *name) {
    while (*laws && strcmp((*laws)->name, name))
        laws++;
    return *laws;
}

void laws_list(char *list, size_t size, const lubricant_law *const *laws, const char *key) {
    size_t used = 0;

    *list = '\0';
    for (; *laws && used < size; laws++)
        if (!key || law_key(*laws, key))
            used +=
                (size_t)snprintf(list + used, size - used, "%s%s", used ? "|" : "", (*laws)->name);
}

// ---- one lubricant

/* Collects the values of a law's parameters in the order of the law, defaults included. */
static ehd_status collect_values(law_value *values, const lubricant_law *law,
                                 const lubricant_law *const *laws, const law_settings *settings,
                                 const char *group, ehd_error *error) {
    for (size_t i = 0; i < law_num_parameters(law); i++, values++) {
        const law_parameter *parameter = &law->parameters[i];
        const char *default_value = parameter->default_value;
        const size_t slot = laws_slot(laws, parameter->key);

        if (slot == MAX_LAW_KEYS)
            return ehd_fail(error, EHD_INTERNAL,
                            "%s.%s: found more keys of laws before it, expected at most %d", group,
                            parameter->key, MAX_LAW_KEYS - 1);
        *values = settings->values[slot];
        if (!default_value) continue;
        if (parameter->choices && !*values->word)
            snprintf(values->word, sizeof values->word, "%s", default_value);
        if (!parameter->choices && isnan(values->number))
            values->number = strtod(default_value, NULL);
    }
    return EHD_OK;
}

/* Finds the law that the settings name, and prepares it. `group` is the key of the settings, for
 * error messages. */
static ehd_status prepare_law(const lubricant_law **law, ehd_lubricant *lubricant,
                              const lubricant_law *const *laws, const law_settings *settings,
                              const char *group, ehd_error *error) {
    law_value values[MAX_LAW_PARAMETERS];
    char list[512];

    *law = laws_find(laws, settings->law);
    if (!*law) {
        laws_list(list, sizeof list, laws, NULL);
        return ehd_fail(error, EHD_DATA, "%s.law: found %s, expected %s", group, settings->law,
                        list);
    }
    if (!(*law)->prepare) return EHD_OK;
    ehd_status status = collect_values(values, *law, laws, settings, group, error);
    return status ? status : (*law)->prepare(lubricant, values, error);
}

ehd_status lubricant_init(ehd_lubricant *lubricant, const lubricant_settings *settings,
                          ehd_error *error) {
    *lubricant = (ehd_lubricant){.eta0 = NAN,
                                 .alpha = NAN,
                                 .pressure_limit = INFINITY,
                                 .temperature = NAN,
                                 .temperature_coefficient = NAN,
                                 .thermal_conductivity = settings->thermal_conductivity};
    ehd_status status = prepare_law(&lubricant->viscosity, lubricant, viscosity_laws,
                                    &settings->viscosity, "lubricant.viscosity", error);
    if (!status)
        status = prepare_law(&lubricant->density, lubricant, density_laws, &settings->density,
                             "lubricant.density", error);
    lubricant->shear = shear_laws[0];
    if (!status && *settings->shear.law)
        status = prepare_law(&lubricant->shear, lubricant, shear_laws, &settings->shear,
                             "lubricant.shear", error);
    if (status) return status;

    if (!lubricant->density->evaluate) lubricant->density = NULL;
    if (isnan(lubricant->alpha)) lubricant->viscosity->evaluate(lubricant, 0, &lubricant->alpha);
    return EHD_OK;
}

double lubricant_density(const ehd_lubricant *lubricant, double pressure) {
    double derivative;

    if (!lubricant->density) return 1;
    return lubricant->density->evaluate(lubricant, fmax(pressure, 0), &derivative);
}

/* Returns the pressure in Pa, limited to the range of the laws. */
static double pressure_of_laws(const ehd_lubricant *lubricant, double hertz_pressure,
                               double pressure) {
    return fmin(fmax(pressure, 0) * hertz_pressure, lubricant->pressure_limit);
}

double lubricant_viscous_stress(const ehd_lubricant *lubricant, double hertz_pressure,
                                double isoviscous, double pressure) {
    const double p = pressure_of_laws(lubricant, hertz_pressure, pressure);
    double slope;

    return isoviscous * exp(lubricant->viscosity->evaluate(lubricant, p, &slope));
}

double lubricant_shear_stress(const ehd_lubricant *lubricant, double hertz_pressure,
                              double isoviscous, double pressure) {
    const double p = pressure_of_laws(lubricant, hertz_pressure, pressure);
    const double viscous =
        lubricant_viscous_stress(lubricant, hertz_pressure, fabs(isoviscous), pressure);

    if (!lubricant->shear->shear) return copysign(viscous, isoviscous);
    return copysign(lubricant->shear->shear(lubricant, viscous * hertz_pressure, p) /
                        hertz_pressure,
                    isoviscous);
}

const char *const lubricant_rise_names[NUM_RISES] = {[RISE_VISCOSITY] = "viscosity_rise",
                                                     [RISE_DENSITY] = "density_rise",
                                                     [RISE_VISCOSITY_HALF] = "viscosity_rise_half"};
const char *const lubricant_rise_state_names[NUM_RISES] = {
    [RISE_VISCOSITY] = "state_viscosity_rise",
    [RISE_DENSITY] = "state_density_rise",
    [RISE_VISCOSITY_HALF] = "state_viscosity_rise_half"};
const char *const lubricant_rise_shown_names[NUM_RISES] = {
    [RISE_VISCOSITY] = "shown_viscosity_rise",
    [RISE_DENSITY] = "shown_density_rise",
    [RISE_VISCOSITY_HALF] = "shown_viscosity_rise_half"};

double lubricant_rise_at(const ehd_lubricant *lubricant, int rise, double pressure) {
    const double of = (rise == RISE_VISCOSITY_HALF ? 0.5 : 1) * fmax(pressure, 0);
    double slope;

    if (!(pressure <= lubricant->pressure_limit)) return NAN;
    if (rise == RISE_DENSITY) return log(lubricant_density(lubricant, pressure));
    return lubricant->viscosity->evaluate(lubricant, of, &slope);
}

lubricant_rises lubricant_rises_at(const ehd_lubricant *lubricant, double pressure) {
    lubricant_rises found;

    for (int r = 0; r < NUM_RISES; r++)
        found.of[r] = lubricant_rise_at(lubricant, r, pressure);
    return found;
}

lubricant_rises lubricant_rises_unknown(void) {
    lubricant_rises none;

    for (int r = 0; r < NUM_RISES; r++)
        none.of[r] = NAN;
    return none;
}

void lubricant_evaluate(double *log_viscosity, double *log_viscosity_derivative, double *density,
                        double *density_derivative, const ehd_lubricant *lubricant,
                        double hertz_pressure, const double *pressure, size_t num_nodes) {
    double limit = lubricant->pressure_limit;

    for (size_t i = 0; i < num_nodes; i++) {
        // pressures of iterates become slightly negative. During the iteration the pressure of a
        // spike may exceed the limit of the law
        double p = fmin(fmax(pressure[i], 0) * hertz_pressure, limit), slope;
        log_viscosity[i] = lubricant->viscosity->evaluate(lubricant, p, &slope);
        log_viscosity_derivative[i] = slope * hertz_pressure;
        if (lubricant->density) {
            density[i] = lubricant->density->evaluate(lubricant, p, &slope);
            density_derivative[i] = slope * hertz_pressure;
        }
    }
}
