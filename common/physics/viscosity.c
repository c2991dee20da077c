/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes viscosity laws: Barus, Roelands, and modified WLF (eq. 40 of Maier et al. 2015;
 * README.md, Lubricants).
 * Called by lubricant.c through the table viscosity_laws (laws.c). */
#include "common/physics/laws.h"

#include <float.h>
#include <gsl/gsl_integration.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

// ---- shared by laws

#define ALPHA                                                                                      \
    {                                                                                              \
        "alpha", LAW_REQUIRED, NULL, NULL, 1e-10, 1e-6, "1/Pa",                                    \
            "Pressure-viscosity coefficient at zero pressure"                                      \
    }

static ehd_status check_alpha(double alpha, ehd_error *error) {
    if (alpha > 0 && isfinite(alpha)) return EHD_OK;
    return ehd_fail(error, EHD_DATA, "lubricant.viscosity.alpha: found %g, expected > 0 1/Pa",
                    alpha);
}

/* Parameters of Barus and of Roelands, in this order. If a temperature is given, eta0, alpha and
 * the temperature coefficient hold at the reference temperature. Otherwise they hold at the
 * temperature of the lubricant, which the scene does not give. */
enum { OIL_ALPHA, OIL_ETA0, OIL_TEMPERATURE, OIL_REFERENCE, OIL_COEFFICIENT };

#define ETA0(need)                                                                                 \
    {                                                                                              \
        "eta0", need, NULL, NULL, 1e-4, 1e6, "Pa s",                                               \
            "Viscosity at zero pressure, with a temperature that at the reference temperature; "   \
            "roelands needs it, barus with a temperature"                                          \
    }

#define TEMPERATURE(default)                                                                       \
    {                                                                                              \
        "temperature", LAW_OPTIONAL, NULL, default, -100, 400, "degC",                             \
            "Temperature of the lubricant; default 25 with wlf, the others' where eta0 and alpha " \
            "are given for"                                                                        \
    }

#define REFERENCE_TEMPERATURE                                                                      \
    {                                                                                              \
        "reference_temperature", LAW_OPTIONAL, NULL, NULL, -100, 400, "degC",                      \
            "Temperature that eta0, alpha and temperature_coefficient are given for; needed with " \
            "temperature"                                                                          \
    }

#define TEMPERATURE_COEFFICIENT                                                                    \
    {                                                                                              \
        "temperature_coefficient", LAW_OPTIONAL, NULL, NULL, 1e-4, 1, "1/K",                       \
            "Temperature-viscosity coefficient -d ln(eta0)/dT; needed with temperature"            \
    }

static ehd_status lacks_with_temperature(const char *key, ehd_error *error) {
    return ehd_fail(error, EHD_DATA,
                    "lubricant.viscosity.%s: found nothing, expected a value with temperature",
                    key);
}

/* Checks that a temperature is given together with a reference temperature, a temperature
 * coefficient and eta0. A reference temperature may be given only together with a temperature. */
static ehd_status check_temperature(const law_value *values, ehd_error *error) {
    const bool reference = !isnan(values[OIL_REFERENCE].number);

    if (isnan(values[OIL_TEMPERATURE].number))
        return reference ? ehd_fail(error, EHD_DATA,
                                    "lubricant.viscosity.temperature: found nothing, expected a "
                                    "value with reference_temperature")
                         : EHD_OK;
    if (!reference) return lacks_with_temperature("reference_temperature", error);
    if (isnan(values[OIL_COEFFICIENT].number))
        return lacks_with_temperature("temperature_coefficient", error);
    return isnan(values[OIL_ETA0].number) ? lacks_with_temperature("eta0", error) : EHD_OK;
}

static ehd_status check_eta0(const ehd_lubricant *self, ehd_error *error) {
    const double min = 1e-6, max = 1e6; // Bounds of physical.viscosity, Pa s

    if (isnan(self->eta0) || (self->eta0 >= min && self->eta0 <= max)) return EHD_OK;
    return ehd_fail(error, EHD_DATA,
                    "lubricant.viscosity.temperature: found %g degC, where the viscosity is %.3g "
                    "Pa s, expected one where it is from %g to %g Pa s",
                    self->temperature, self->eta0, min, max);
}

// ---- Barus: ln eta = alpha p, ln eta0 = ln eta0_ref - beta (T - T_ref)

enum { BARUS_ALPHA };

static double barus(const ehd_lubricant *self, double pressure, double *derivative) {
    *derivative = self->viscosity_constants[BARUS_ALPHA];
    return self->viscosity_constants[BARUS_ALPHA] * pressure;
}

static ehd_status barus_prepare(ehd_lubricant *self, const law_value *values, ehd_error *error) {
    const double temperature = values[OIL_TEMPERATURE].number;
    ehd_status status = check_alpha(values[OIL_ALPHA].number, error);

    if (!status) status = check_temperature(values, error);
    if (status) return status;
    self->viscosity_constants[BARUS_ALPHA] = values[OIL_ALPHA].number;
    self->eta0 = values[OIL_ETA0].number; // NaN if the scene has none
    self->temperature = temperature;
    self->temperature_coefficient = values[OIL_COEFFICIENT].number;
    if (!isnan(temperature))
        self->eta0 *=
            exp(-values[OIL_COEFFICIENT].number * (temperature - values[OIL_REFERENCE].number));
    return check_eta0(self, error);
}

const lubricant_law viscosity_barus = {.name = "barus",
                                       .parameters = {ALPHA, ETA0(LAW_OPTIONAL), TEMPERATURE(NULL),
                                                      REFERENCE_TEMPERATURE,
                                                      TEMPERATURE_COEFFICIENT},
                                       .prepare = barus_prepare,
                                       .evaluate = barus,
                                       .exponential = true};

// ---- Roelands: ln eta = (ln eta0 + 9.67) [(1 + p/1.96e8)^z - 1]. At a temperature T, ln eta0 +
// 9.67 is multiplied by ((T - 138)/(T_ref - 138))^-S0 (README.md, Temperature).

// Source: Roelands, 1966. ICE_POINT is 0 degrees Celsius.
static const double ROELANDS_PRESSURE = 1.96e8; // Pa
static const double ROELANDS_TEMPERATURE = 138; // K
static const double ICE_POINT = 273.15;         // K
enum { ROELANDS_RATIO, ROELANDS_EXPONENT };     // indices of the constants

static double roelands(const ehd_lubricant *self, double pressure, double *derivative) {
    double z = self->viscosity_constants[ROELANDS_EXPONENT];
    double ratio = self->viscosity_constants[ROELANDS_RATIO];
    double base = 1 + pressure / ROELANDS_PRESSURE;
    double power = pow(base, z);

    *derivative = ratio * z * power / base / ROELANDS_PRESSURE;
    return ratio * (power - 1);
}

/* Changes ln eta0 + 9.67 from its value at the reference temperature to its value at the given
 * temperature. The exponent z of the pressure stays the same. alpha is proportional to (ln eta0 +
 * 9.67) z, so alpha changes by the same factor. */
static void roelands_set_temperature(ehd_lubricant *self, const law_value *values) {
    const double coefficient = values[OIL_COEFFICIENT].number;
    const double ratio = self->viscosity_constants[ROELANDS_RATIO];
    const double above = values[OIL_TEMPERATURE].number + ICE_POINT - ROELANDS_TEMPERATURE;
    const double reference = values[OIL_REFERENCE].number + ICE_POINT - ROELANDS_TEMPERATURE;
    const double s0 = coefficient * reference / ratio;
    const double factor = pow(above / reference, -s0);

    self->viscosity_constants[ROELANDS_RATIO] = factor * ratio;
    self->eta0 *= exp(ratio * (factor - 1));
    self->alpha *= factor;
    self->temperature_coefficient = factor * ratio * s0 / above;
    self->temperature = values[OIL_TEMPERATURE].number;
}

static ehd_status roelands_prepare(ehd_lubricant *self, const law_value *values, ehd_error *error) {
    double alpha = values[OIL_ALPHA].number, eta0 = values[OIL_ETA0].number;
    ehd_status status = check_alpha(alpha, error);

    if (!status) status = check_temperature(values, error);
    if (status) return status;
    // eta0 must exceed Roelands' pole viscosity of 6.31e-5 Pa s, so that ln eta0 + 9.67 is positive
    if (!(eta0 > 6.4e-5 && isfinite(eta0)))
        return ehd_fail(error, EHD_DATA,
                        "lubricant.viscosity.eta0: found %g, expected > 6.4e-5 Pa s", eta0);
    double ratio = log(eta0) + 9.67;
    self->viscosity_constants[ROELANDS_RATIO] = ratio;
    self->viscosity_constants[ROELANDS_EXPONENT] = ROELANDS_PRESSURE * alpha / ratio;
    self->alpha = alpha;
    self->eta0 = eta0;
    self->temperature_coefficient = values[OIL_COEFFICIENT].number;
    if (!isnan(values[OIL_TEMPERATURE].number)) roelands_set_temperature(self, values);
    return check_eta0(self, error);
}

const lubricant_law viscosity_roelands = {
    .name = "roelands",
    .parameters = {ALPHA, ETA0(LAW_REQUIRED), TEMPERATURE(NULL), REFERENCE_TEMPERATURE,
                   TEMPERATURE_COEFFICIENT},
    .prepare = roelands_prepare,
    .evaluate = roelands,
};

// ---- modified WLF, eq. 40 of Maier, Hager, Hetzler, Seemann, Tribology International 2015

/* Indices of the parameters, and of the constants. */
enum {
    WLF_PRESET,
    WLF_TEMPERATURE, // degC, T0 of eq. 40
    WLF_A1,          // degC; from here on in the units of Table 1 of the paper
    WLF_A2,          // 1/GPa
    WLF_B1,          // dimensionless
    WLF_B2,          // 1/MPa
    WLF_C1,          // dimensionless
    WLF_C2,          // degC
    WLF_TG0,         // degC
    WLF_MU_G,        // Pa s
    NUM_WLF,
    WLF_LOG_AT_ZERO = NUM_WLF // ln(eta(0)/mu_g)
};
_Static_assert((int)WLF_LOG_AT_ZERO < (int)MAX_LAW_CONSTANTS, "there is no room for the constants");

static const struct {
    const char *name;
    double constants[NUM_WLF - WLF_A1];
} wlf_presets[] = {
    // Table 1: A1, A2, B1, B2, C1, C2, Tg0, mu_g
    {"no1", {19.17, 4.07, 0.23, 0.0249, 16.04, 18.18, -73.86, 1e12}},
    {"no2", {22.47, 4.22, 0.222, 0.0349, 15.87, 10.22, -113.79, 1e12}},
    {"no3", {69.81, 1.68, 0.213, 0.0118, 11.84, 60.59, -87.46, 1e7}},
};
static const char wlf_choices[] = "no1|no2|no3";
enum { NUM_PRESETS = sizeof wlf_presets / sizeof *wlf_presets };

/* Returns y = (T0 - Tg) D and its derivative with respect to the pressure in Pa. */
static double wlf_shift(const double *constants, double pressure, double *derivative) {
    double giga = pressure * 1e-9, mega = pressure * 1e-6;
    double tg = constants[WLF_TG0] + constants[WLF_A1] * log1p(constants[WLF_A2] * giga);
    double tg_slope = constants[WLF_A1] * constants[WLF_A2] / (1 + constants[WLF_A2] * giga) * 1e-9;
    double d = 1 - constants[WLF_B1] * log1p(constants[WLF_B2] * mega);
    double d_slope = -constants[WLF_B1] * constants[WLF_B2] / (1 + constants[WLF_B2] * mega) * 1e-6;

    *derivative = -tg_slope * d + (constants[WLF_TEMPERATURE] - tg) * d_slope;
    return (constants[WLF_TEMPERATURE] - tg) * d;
}

/* Returns ln eta(p) - ln mu_g = -ln(10) C1 y / (C2 + y). */
static double wlf_log_absolute(const double *constants, double pressure, double *derivative) {
    double y_slope, y = wlf_shift(constants, pressure, &y_slope);
    double c1 = constants[WLF_C1] * M_LN10, c2 = constants[WLF_C2];

    *derivative = -c1 * c2 / ((c2 + y) * (c2 + y)) * y_slope;
    return -c1 * y / (c2 + y);
}

static double wlf(const ehd_lubricant *self, double pressure, double *derivative) {
    const double *constants = self->viscosity_constants;

    return wlf_log_absolute(constants, pressure, derivative) - constants[WLF_LOG_AT_ZERO];
}

/* Checks whether the viscosity is at or beyond its maximum, or its pole, at this pressure. If this
 * is true for one pressure, it is true for all higher pressures. */
static bool wlf_is_beyond(const double *constants, double pressure) {
    double slope;
    const double y = wlf_shift(constants, pressure, &slope);

    return slope >= 0 || constants[WLF_C2] + y <= 0;
}

/* Returns the largest pressure at which the law holds, with a relative accuracy of 1e-9. The
 * viscosity has a maximum where y stops falling, and a pole where C2 + y reaches zero. The limit is
 * the smaller of these two pressures, or 100 GPa if both are larger. */
static double wlf_pressure_limit(const double *constants) {
    // largest limit, Pa; no contact has such pressures (test_lubricant.c,
    // wlf_coefficients_and_limits)
    const double max = 1e11;
    double low = 0, high = max;

    if (!wlf_is_beyond(constants, max)) return max;
    while (high - low > 1e-9 * high) {
        const double middle = (low + high) / 2;
        *(wlf_is_beyond(constants, middle) ? &high : &low) = middle;
    }
    return low;
}

static double wlf_inverse_viscosity(double pressure, void *self) {
    double derivative;
    return exp(-wlf(self, pressure, &derivative));
}

static double gauss_kronrod(ehd_lubricant *self, double left, double right) {
    const gsl_function integrand = {wlf_inverse_viscosity, self};
    double integral, unused[3];

    gsl_integration_qk31(&integrand, left, right, &integral, &unused[0], &unused[1], &unused[2]);
    return integral;
}

/* Integrates eta0/eta from 0 to `end`. The intervals double in length (octaves), because the
 * pressure at which eta0/eta has decayed may be of any size. GSL's adaptive rules would end the
 * process if they did not converge or got no memory. */
static double integrate_inverse_viscosity(ehd_lubricant *self, double end) {
    double sum = 0;

    // eta0/eta is at most 1, so the integral up to `high` is at most `high`
    for (double high = end; high > DBL_EPSILON * sum; high /= 2)
        sum += gauss_kronrod(self, high / 2, high);
    return sum;
}

/* Sets alpha to the reciprocal asymptotic isoviscous pressure coefficient, alpha* = 1/int eta0/eta
 * dp. The integral ends at 3 GPa, or at the limit of the law if that is smaller. */
static ehd_status wlf_reciprocal_coefficient(ehd_lubricant *self, ehd_error *error) {
    const double integral = integrate_inverse_viscosity(self, fmin(3e9, self->pressure_limit));

    if (!(integral > 0))
        return ehd_fail(error, EHD_DATA,
                        "lubricant.viscosity: found constants whose viscosity cannot be "
                        "integrated, expected those of a liquid");
    self->alpha = 1 / integral;
    return EHD_OK;
}

/* Fills in the constants of Table 1, which are given one by one or by a preset. */
static ehd_status wlf_set_constants(double *constants, const law_value *values, ehd_error *error) {
    const char *name = values[WLF_PRESET].word;
    size_t preset = 0;

    for (size_t i = WLF_TEMPERATURE; i < NUM_WLF; i++)
        constants[i] = values[i].number;
    if (!*name) return EHD_OK;
    while (preset < NUM_PRESETS && strcmp(name, wlf_presets[preset].name))
        preset++;
    if (preset == NUM_PRESETS)
        return ehd_fail(error, EHD_DATA, "lubricant.viscosity.preset: found %s, expected %s", name,
                        wlf_choices);
    memcpy(constants + WLF_A1, wlf_presets[preset].constants, sizeof wlf_presets[preset].constants);
    return EHD_OK;
}

static ehd_status wlf_prepare(ehd_lubricant *self, const law_value *values, ehd_error *error) {
    double *constants = self->viscosity_constants, slope;
    ehd_status status = wlf_set_constants(constants, values, error);

    if (status) return status;
    double y = wlf_shift(constants, 0, &slope);
    if (!(constants[WLF_C2] + y > 0 && slope < 0))
        return ehd_fail(error, EHD_DATA,
                        "lubricant.viscosity: found constants whose viscosity does not rise at "
                        "zero pressure at %g degC, expected a liquid above its glass transition",
                        constants[WLF_TEMPERATURE]);
    constants[WLF_LOG_AT_ZERO] = wlf_log_absolute(constants, 0, &slope);
    self->eta0 = constants[WLF_MU_G] * exp(constants[WLF_LOG_AT_ZERO]);
    self->temperature = constants[WLF_TEMPERATURE];
    // dy/dT is 1 at zero pressure
    self->temperature_coefficient = constants[WLF_C1] * M_LN10 * constants[WLF_C2] /
                                    ((constants[WLF_C2] + y) * (constants[WLF_C2] + y));
    self->pressure_limit = wlf_pressure_limit(constants);
    return wlf_reciprocal_coefficient(self, error);
}

#define CONSTANT(key, min, max, unit, help)                                                        \
    { key, LAW_CONSTANT, NULL, NULL, min, max, unit, help }

const lubricant_law viscosity_wlf = {
    .name = "wlf",
    .parameters = {{"preset", LAW_PRESET, wlf_choices, NULL, 0, 0, "1",
                    "Lubricant of Table 1, in place of the eight constants"},
                   TEMPERATURE("25"),
                   CONSTANT("A1", 0, 1e3, "K", "Constant A1 of the modified WLF law"),
                   CONSTANT("A2", 0, 1e3, "1/GPa", "Constant A2 of the modified WLF law"),
                   CONSTANT("B1", 0, 10, "1", "Constant B1 of the modified WLF law"),
                   CONSTANT("B2", 0, 10, "1/MPa", "Constant B2 of the modified WLF law"),
                   CONSTANT("C1", 0.1, 1e3, "1", "Constant C1 of the modified WLF law"),
                   CONSTANT("C2", 0.1, 1e3, "K", "Constant C2 of the modified WLF law"),
                   CONSTANT("Tg0", -273.15, 400, "degC",
                            "Glass transition temperature at zero pressure"),
                   CONSTANT("mu_g", 1, 1e20, "Pa s", "Viscosity at the glass transition")},
    .prepare = wlf_prepare,
    .evaluate = wlf,
};
