/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/settings/plausible.h"

#include "common/settings/settings_table.h"
#include "common/settings/unit.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// ---- quantities

static double viscosity_of(const ehd_contact *contact) {
    return contact->viscosity;
}

/* Returns the pressure coefficient; NaN in a scene of M and L, whose results are dimensionless. */
static double alpha_of(const ehd_contact *contact) {
    return isnan(contact->load) ? NAN : contact->lubricant.alpha;
}

static double temperature_of(const ehd_contact *contact) {
    return contact->lubricant.temperature;
}

/* Returns a ratio that exceeds 1/3 if the contact is not small compared with the bodies. */
static double width_over_radius(const ehd_contact *contact) {
    const contact_shape *shape = &contact->grid.shape;
    const double along = contact->half_width / contact->radius;

    // across the entrainment: b/R_y, with b = k a and R_y = R k^2/gap_across
    return along * fmax(1, shape->gap_across / shape->ellipticity);
}

static double radius_of(const ehd_contact *contact) {
    return contact->radius;
}

static double speed_of(const ehd_contact *contact) {
    return contact->speed;
}

static double pressure_of(const ehd_contact *contact) {
    return contact->hertz_pressure;
}

static double moes_M_of(const ehd_contact *contact) {
    return contact->moes_M;
}

static double moes_L_of(const ehd_contact *contact) {
    return contact->moes_L;
}

/* Returns the central film in m by a published formula. */
static double film_of(const ehd_contact *contact) {
    return contact_film_scale(contact) *
           contact->kind->central_film(&contact->grid.shape, contact->moes_M, contact->moes_L);
}

/* Returns the film over the half width; of an ellipse over the geometric mean of a and b. */
static double film_over_width(const ehd_contact *contact) {
    return film_of(contact) / (contact->half_width * sqrt(contact->grid.shape.ellipticity));
}

/* Hertz pressure above which a pressure coefficient below its usual range is implausible. At lower
 * pressures this coefficient hardly changes the viscosity, and the lubricant may be water (4.5e-10
 * 1/Pa) (test_plausible.c, water_on_rubber_is_plausible). */
static const double HARD_CONTACT = 2e8;

/* A quantity with its usual range, and the range beyond which a scene is refused. NaN: no limit. */
static const struct quantity {
    const char *name, *unit;
    double scale;                                // of the unit, in SI units
    double (*value)(const ehd_contact *contact); // NaN: not known
    double least, most, lowest, highest;
} quantities[] = {{"viscosity at zero pressure", " Pa s", 1, viscosity_of, 1e-4, 100, 1e-5, 1000},
                  {"pressure coefficient alpha", " 1/Pa", 1, alpha_of, 5e-9, 5e-8, 1e-10, 5e-7},
                  {"temperature", " degC", 1, temperature_of, -60, 200, -100, 400},
                  {"radius", " m", 1, radius_of, 1e-5, 3, 0, INFINITY},
                  {"speed", " m/s", 1, speed_of, 0, 300, 0, INFINITY},
                  {"half width over radius", "", 1, width_over_radius, 0, 1. / 3, 0, 1},
                  {"Hertz pressure", " GPa", 1e9, pressure_of, 0, 5e9, 0, 2e10},
                  {"M", "", 1, moes_M_of, MIN_MOES_M, MAX_MOES_M, MIN_MOES_M, MAX_MOES_M},
                  {"L", "", 1, moes_L_of, 0, MAX_MOES_L, 0, MAX_MOES_L},
                  {"film over half width", "", 1, film_over_width, 0, 0.1, 0, 1},
                  {"film", " nm", 1e-9, film_of, 1e-9, INFINITY, 1e-10, INFINITY}};

enum { NUM_QUANTITIES = sizeof quantities / sizeof *quantities };

/* Returns `limit`, or less: the Hertz pressure may not exceed the limit of the viscosity law. In a
 * scene of M and L this is its only limit, because the results are dimensionless. */
static double most_of(const struct quantity *of, double limit, const ehd_contact *contact) {
    if (of->value != pressure_of) return limit;
    return fmin(isnan(contact->load) ? INFINITY : limit, contact->lubricant.pressure_limit);
}

static plausibility judge(const struct quantity *of, const ehd_contact *contact) {
    const double value = of->value(contact);
    const bool soft = of->value == alpha_of && !isgreater(contact->hertz_pressure, HARD_CONTACT);

    if (isnan(value) || (soft && value < of->least)) return PLAUSIBLE;
    if (value < of->lowest || value > most_of(of, of->highest, contact)) return IMPOSSIBLE;
    if (value < of->least || value > most_of(of, of->most, contact)) return IMPLAUSIBLE;
    return PLAUSIBLE;
}

// ---- the setting that is probably in another unit

/* A setting that may be in another unit, with its usual values. */
typedef struct suspect {
    const char *key;
    size_t member;                  // of contact_settings, unless `law_key` is given
    const char *law_key;            // key of the viscosity law, such as "alpha"
    double usual_line, usual_point; // of a line contact, and of the other kinds, in SI units
} suspect;

#define OF_CONTACT(key) "physical." #key, offsetof(contact_settings, key), NULL
#define OF_LAW(key)     "lubricant.viscosity." #key, 0, #key

static const suspect suspects[] = {{OF_CONTACT(load), 1e5, 1e2},
                                   {OF_CONTACT(radius), 1e-2, 1e-2},
                                   {OF_CONTACT(radius_across), NAN, 1e-2},
                                   {OF_CONTACT(speed), 1, 1},
                                   {OF_CONTACT(modulus), 2e11, 2e11},
                                   {OF_CONTACT(viscosity), 0.05, 0.05},
                                   {OF_LAW(eta0), 0.05, 0.05},
                                   {OF_LAW(alpha), 2e-8, 2e-8}};

enum { NUM_SUSPECTS = sizeof suspects / sizeof *suspects };

// factors by which a value may be wrong; a factor of a million or more only if a unit has it
static const double factors[] = {1e3, 1e-3, 1e6, 1e-6, 1e9, 1e-9};
enum { NUM_FACTORS = sizeof factors / sizeof *factors, NUM_WITHOUT_UNIT = 2 };

/* Returns the value that a suspect names in `given`, or NULL. The viscosity of the law counts, if
 * there is one, in place of physical.viscosity, which only repeats it. */
static double *value_of(contact_settings *given, const suspect *of) {
    const lubricant_law *law = laws_find(viscosity_laws, given->lubricant.viscosity.law);
    law_value *const values = given->lubricant.viscosity.values;
    const bool has_own = law && law_key(law, "eta0");

    if (has_own && !isnan(values[laws_slot(viscosity_laws, "eta0")].number)) given->viscosity = NAN;
    void *member = (char *)given + of->member;
    if (!of->law_key) return member;
    if (!law || !law_key(law, of->law_key)) return NULL;
    return &values[laws_slot(viscosity_laws, of->law_key)].number;
}

/* Counts the quantities that are not plausible. */
static size_t count_implausible(const contact_settings *given) {
    ehd_contact contact;
    size_t count = 0;

    if (contact_init(&contact, given, NULL)) return NUM_QUANTITIES;
    for (size_t i = 0; i < NUM_QUANTITIES; i++)
        count += judge(&quantities[i], &contact) != PLAUSIBLE;
    return count;
}

/* Writes "is KEY = VALUE in UNIT?", or a question about a factor without a unit. */
static void write_question(char *text, size_t size, const char *key, double typed, double factor,
                           const char *unit) {
    if (unit)
        snprintf(text, size, ": is %s = %g in %s?", key, typed, unit);
    else
        snprintf(text, size, ": is %s = %g too %s by a factor of %g?", key, typed,
                 factor > 1 ? "small" : "large", fmax(factor, 1 / factor));
}

/* Writes a question about the setting that is probably in another unit. This is the setting whose
 * change of unit leaves the fewest implausible quantities. Of several such settings it is the one
 * that comes closest to its usual value. Writes "" if no change helps. */
static void ask(char *text, size_t size, const contact_settings *given) {
    const bool line = given->kind->dimensions == 1;
    size_t fewest = count_implausible(given) - 1;
    double nearest = 0; // decades by which the value comes closer to its usual value

    *text = '\0';
    for (size_t i = 0; i < NUM_SUSPECTS * NUM_FACTORS; i++) {
        const suspect *of = &suspects[i / NUM_FACTORS];
        const double factor = factors[i % NUM_FACTORS];
        const double usual = line ? of->usual_line : of->usual_point;
        contact_settings changed = *given;
        double *value = value_of(&changed, of);
        const char *si = setting_find(of->key)->unit;
        if (strchr(si, '|')) si = line ? "N/m" : "N";
        const char *unit = unit_named(si, factor);
        const bool known = unit || i % NUM_FACTORS < NUM_WITHOUT_UNIT;
        if (!value || !(*value > 0) || isnan(usual) || !known) continue;
        const double typed = *value;
        *value *= factor;
        const double nearer = fabs(log10(typed / usual)) - fabs(log10(*value / usual));
        const size_t left = count_implausible(&changed);
        if (left > fewest || (left == fewest && nearer <= nearest) || nearer <= 0) continue;
        fewest = left;
        nearest = nearer;
        const bool mean = value == &changed.speed && given->surface_speeds;
        write_question(text, size, mean ? "the mean of physical.speed_1 and speed_2" : of->key,
                       typed, factor, unit);
    }
}

/* Writes a line about a quantity that is not plausible. */
static void write_line(char text[PLAUSIBLE_TEXT], const struct quantity *of, bool refused,
                       const ehd_contact *contact, const contact_settings *given) {
    const double value = of->value(contact);
    const double most = most_of(of, refused ? of->highest : of->most, contact);
    const bool of_law = most == contact->lubricant.pressure_limit;
    char limit[80], width[48] = "", question[128];

    if (value > most)
        snprintf(limit, sizeof limit, "at most %.3g%s%s%s", most / of->scale, of->unit,
                 of_law ? ", the limit of the law " : "",
                 of_law ? contact->lubricant.viscosity->name : "");
    else
        snprintf(limit, sizeof limit, "at least %.3g%s",
                 (refused ? of->lowest : of->least) / of->scale, of->unit);
    if (!isnan(contact->half_width))
        snprintf(width, sizeof width, "half width %.3g mm, ", contact->half_width * 1e3);
    ask(question, sizeof question, given);
    snprintf(text, PLAUSIBLE_TEXT,
             "%s: found %.3g%s, expected %s (%sp_H %.3g GPa, M = %.3g, L = %.3g)%s", of->name,
             value / of->scale, of->unit, limit, width, contact->hertz_pressure * 1e-9,
             contact->moes_M, contact->moes_L, question);
}

plausibility plausible_judge(char text[PLAUSIBLE_TEXT], const ehd_contact *contact,
                             const contact_settings *given) {
    const struct quantity *first = quantities;
    plausibility worst = PLAUSIBLE;

    for (size_t i = 0; i < NUM_QUANTITIES; i++) {
        const plausibility found = judge(&quantities[i], contact);
        if (found > worst) first = &quantities[i];
        if (found > worst) worst = found;
    }
    if (worst != PLAUSIBLE) write_line(text, first, worst == IMPOSSIBLE, contact, given);
    return worst;
}
