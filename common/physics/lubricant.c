/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/lubricant.h"

#include <gsl/gsl_integration.h>
#include <math.h>
#include <string.h>

// slots of lubricant.constants used by the laws other than wlf
enum { CONSTANT_ALPHA = 0, CONSTANT_EXPONENT, CONSTANT_LOG_RATIO };
// slot behind the wlf constants
enum { WLF_T0 = NUM_WLF };

static const double NO_LIMIT = INFINITY;

// ---- Barus: ln eta = alpha p

static double barus_log_viscosity(const ehd_lubricant *self, double pressure, double *derivative) {
    *derivative = self->constants[CONSTANT_ALPHA];
    return self->constants[CONSTANT_ALPHA] * pressure;
}

static ehd_status barus_prepare(ehd_lubricant *self, const lubricant_settings *settings,
                                ehd_error *error) {
    if (!(settings->alpha > 0 && isfinite(settings->alpha)))
        return ehd_fail(error, EHD_DATA, "lubricant.viscosity.alpha: found %g, expected > 0 1/Pa",
                        settings->alpha);
    self->constants[CONSTANT_ALPHA] = settings->alpha;
    self->alpha = settings->alpha;
    return EHD_OK;
}

// ---- Roelands: ln eta = (ln eta0 + 9.67) [(1 + p/1.96e8)^z - 1]

static const double ROELANDS_PRESSURE = 1.96e8; // Pa

static double roelands_log_viscosity(const ehd_lubricant *self, double pressure,
                                     double *derivative) {
    double z = self->constants[CONSTANT_EXPONENT];
    double ratio = self->constants[CONSTANT_LOG_RATIO];
    double base = 1 + pressure / ROELANDS_PRESSURE;
    double power = pow(base, z);

    *derivative = ratio * z * power / base / ROELANDS_PRESSURE;
    return ratio * (power - 1);
}

static ehd_status roelands_prepare(ehd_lubricant *self, const lubricant_settings *settings,
                                   ehd_error *error) {
    if (!(settings->alpha > 0 && isfinite(settings->alpha)))
        return ehd_fail(error, EHD_DATA, "lubricant.viscosity.alpha: found %g, expected > 0 1/Pa",
                        settings->alpha);
    // eta0 above the Roelands pole viscosity 6.31e-5 Pa s, else ln eta0 + 9.67 is not positive
    if (!(settings->eta0 > 6.4e-5 && isfinite(settings->eta0)))
        return ehd_fail(error, EHD_DATA,
                        "lubricant.viscosity.eta0: found %g, expected > 6.4e-5 Pa s",
                        settings->eta0);
    double ratio = log(settings->eta0) + 9.67;
    self->constants[CONSTANT_LOG_RATIO] = ratio;
    self->constants[CONSTANT_EXPONENT] = ROELANDS_PRESSURE * settings->alpha / ratio;
    self->alpha = settings->alpha;
    self->eta0 = settings->eta0;
    return EHD_OK;
}

// ---- modified WLF, paper eq. (40)

static const double wlf_presets[][NUM_WLF] = {
    // Table 1: A1, A2, B1, B2, C1, C2, Tg0, mu_g
    {19.17, 4.07, 0.23, 0.0249, 16.04, 18.18, -73.86, 1e12},
    {22.47, 4.22, 0.222, 0.0349, 15.87, 10.22, -113.79, 1e12},
    {69.81, 1.68, 0.213, 0.0118, 11.84, 60.59, -87.46, 1e7},
};
static const char *const wlf_preset_names[] = {"no1", "no2", "no3"};

/* y = (T0 - Tg) D, its derivative in 1/Pa. */
static double wlf_shift(const double *constants, double pressure, double *derivative) {
    double giga = pressure * 1e-9, mega = pressure * 1e-6;
    double tg = constants[WLF_TG0] + constants[WLF_A1] * log1p(constants[WLF_A2] * giga);
    double tg_slope = constants[WLF_A1] * constants[WLF_A2] / (1 + constants[WLF_A2] * giga) * 1e-9;
    double d = 1 - constants[WLF_B1] * log1p(constants[WLF_B2] * mega);
    double d_slope = -constants[WLF_B1] * constants[WLF_B2] / (1 + constants[WLF_B2] * mega) * 1e-6;

    *derivative = -tg_slope * d + (constants[WLF_T0] - tg) * d_slope;
    return (constants[WLF_T0] - tg) * d;
}

/* ln eta(p) - ln mu_g = -ln(10) C1 y / (C2 + y). */
static double wlf_log_absolute(const double *constants, double pressure, double *derivative) {
    double y_slope, y = wlf_shift(constants, pressure, &y_slope);
    double c1 = constants[WLF_C1] * M_LN10, c2 = constants[WLF_C2];

    *derivative = -c1 * c2 / ((c2 + y) * (c2 + y)) * y_slope;
    return -c1 * y / (c2 + y);
}

static double wlf_log_viscosity(const ehd_lubricant *self, double pressure, double *derivative) {
    return wlf_log_absolute(self->constants, pressure, derivative) -
           self->constants[NUM_WLF + 1]; // its value at zero pressure
}

/* The law turns over where y stops falling, or has a pole where C2 + y reaches zero: the smaller of
 * both pressures, to 1e-9, or 100 GPa when neither lies below that. */
static double wlf_pressure_limit(const double *constants) {
    const double step = 1e6, most = 1e11;
    double slope, low = 0;

    for (double p = 0; p <= most; p += step) {
        double y = wlf_shift(constants, p, &slope);
        if (slope >= 0 || constants[WLF_C2] + y <= 0) break;
        low = p;
    }
    double high = low + step;
    while (high - low > 1e-9 * high) {
        double middle = (low + high) / 2;
        double y = wlf_shift(constants, middle, &slope);
        if (slope >= 0 || constants[WLF_C2] + y <= 0)
            high = middle;
        else
            low = middle;
    }
    return low;
}

static double wlf_inverse_viscosity(double pressure, void *self) {
    double derivative;
    return exp(-wlf_log_viscosity(self, pressure, &derivative));
}

/* Reciprocal asymptotic isoviscous pressure coefficient, alpha* = 1/int eta0/eta dp, to 3 GPa. */
static ehd_status wlf_reciprocal_coefficient(ehd_lubricant *self, ehd_error *error) {
    const size_t num_intervals = 200;
    gsl_integration_workspace *workspace = gsl_integration_workspace_alloc(num_intervals);
    gsl_function integrand = {wlf_inverse_viscosity, self};
    double integral = 0, estimate;

    if (!workspace)
        return ehd_fail(error, EHD_MEMORY, "lubricant: found no memory for the integral of alpha*");
    int failed =
        gsl_integration_qag(&integrand, 0, fmin(3e9, self->pressure_limit), 0, 1e-10, num_intervals,
                            GSL_INTEG_GAUSS31, workspace, &integral, &estimate);
    gsl_integration_workspace_free(workspace);
    if (failed || !(integral > 0))
        return ehd_fail(error, EHD_DATA,
                        "lubricant.viscosity: found constants whose viscosity cannot be "
                        "integrated, expected those of a liquid");
    self->alpha = 1 / integral;
    return EHD_OK;
}

static ehd_status wlf_prepare(ehd_lubricant *self, const lubricant_settings *settings,
                              ehd_error *error) {
    const double *constants = settings->wlf;

    if (settings->viscosity_preset[0]) {
        size_t preset = 0;
        while (preset < 3 && strcmp(settings->viscosity_preset, wlf_preset_names[preset]))
            preset++;
        if (preset == 3)
            return ehd_fail(error, EHD_DATA,
                            "lubricant.viscosity.preset: found %s, expected no1|no2|no3",
                            settings->viscosity_preset);
        constants = wlf_presets[preset];
    }
    memcpy(self->constants, constants, sizeof(double) * NUM_WLF);
    self->constants[WLF_T0] = isnan(settings->temperature) ? 25 : settings->temperature;

    double slope;
    double y = wlf_shift(self->constants, 0, &slope);
    if (!(constants[WLF_C2] + y > 0 && slope < 0))
        return ehd_fail(error, EHD_DATA,
                        "lubricant.viscosity: found constants whose viscosity does not rise at "
                        "zero pressure at %g degC, expected a liquid above its glass transition",
                        self->constants[WLF_T0]);
    self->constants[NUM_WLF + 1] = wlf_log_absolute(self->constants, 0, &slope);
    self->eta0 = constants[WLF_MU_G] * exp(self->constants[NUM_WLF + 1]);
    self->pressure_limit = wlf_pressure_limit(self->constants);
    return wlf_reciprocal_coefficient(self, error);
}

// ---- density

/* Dowson and Higginson: (5.9e8 + 1.34 p) / (5.9e8 + p). */
static double dowson_higginson(double pressure, double *derivative) {
    const double c = 5.9e8;

    *derivative = 0.34 * c / ((c + pressure) * (c + pressure));
    return (c + 1.34 * pressure) / (c + pressure);
}

// ---- tables

static const char *const barus_parameters[] = {"alpha", NULL};
static const char *const roelands_parameters[] = {"eta0", "alpha", NULL};
static const char *const wlf_parameters[] = {"A1", "A2",  "B1",   "B2", "C1",
                                             "C2", "Tg0", "mu_g", NULL};

const viscosity_law viscosity_laws[] = {
    {"barus", barus_parameters, barus_prepare, barus_log_viscosity},
    {"roelands", roelands_parameters, roelands_prepare, roelands_log_viscosity},
    {"wlf", wlf_parameters, wlf_prepare, wlf_log_viscosity},
    {NULL, NULL, NULL, NULL},
};

const density_law density_laws[] = {
    {"incompressible", NULL},
    {"dowson-higginson", dowson_higginson},
    {NULL, NULL},
};

ehd_status lubricant_init(ehd_lubricant *lubricant, const lubricant_settings *settings,
                          ehd_error *error) {
    const viscosity_law *viscosity = viscosity_laws;
    const density_law *density = density_laws;

    while (viscosity->name && strcmp(viscosity->name, settings->viscosity_law))
        viscosity++;
    if (!viscosity->name)
        return ehd_fail(error, EHD_DATA,
                        "lubricant.viscosity.law: found %s, expected barus|roelands|wlf",
                        settings->viscosity_law);
    while (density->name && strcmp(density->name, settings->density_law))
        density++;
    if (!density->name)
        return ehd_fail(error, EHD_DATA,
                        "lubricant.density.law: found %s, expected "
                        "incompressible|dowson-higginson",
                        settings->density_law);
    memset(lubricant, 0, sizeof *lubricant);
    lubricant->viscosity = viscosity;
    lubricant->density = density->relative_density ? density : NULL;
    lubricant->eta0 = NAN;
    lubricant->pressure_limit = NO_LIMIT;
    return viscosity->prepare(lubricant, settings, error);
}

void lubricant_evaluate(double *log_viscosity, double *log_viscosity_derivative, double *density,
                        double *density_derivative, const ehd_lubricant *lubricant,
                        double hertz_pressure, const double *pressure, size_t num_nodes) {
    double limit = lubricant->pressure_limit;

    for (size_t i = 0; i < num_nodes; i++) {
        // Newton iterates go slightly negative, and a spike may pass the law's limit on the way
        double p = fmin(fmax(pressure[i], 0) * hertz_pressure, limit), slope;
        log_viscosity[i] = lubricant->viscosity->log_viscosity(lubricant, p, &slope);
        log_viscosity_derivative[i] = slope * hertz_pressure;
        if (lubricant->density) {
            density[i] = lubricant->density->relative_density(p, &slope);
            density_derivative[i] = slope * hertz_pressure;
        }
    }
}
