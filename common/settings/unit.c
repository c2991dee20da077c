/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/settings/unit.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A unit, without the characters that simple_name drops. */
static const struct unit {
    const char *si, *name;
    unit_conversion to_si;
} units[] = {
    {"N/m", "N/mm", {1e3, 0}},       {"N/m", "kN/m", {1e3, 0}},    {"N/m", "N/cm", {1e2, 0}},
    {"N/m", "kN/mm", {1e6, 0}},      {"N/m", "MN/m", {1e6, 0}},    {"N", "kN", {1e3, 0}},
    {"N", "mN", {1e-3, 0}},          {"N", "MN", {1e6, 0}},        {"m", "mm", {1e-3, 0}},
    {"m", "um", {1e-6, 0}},          {"m", "nm", {1e-9, 0}},       {"m", "cm", {1e-2, 0}},
    {"m/s", "mm/s", {1e-3, 0}},      {"m/s", "um/s", {1e-6, 0}},   {"m/s", "cm/s", {1e-2, 0}},
    {"m/s", "km/h", {1 / 3.6, 0}},   {"Pa", "MPa", {1e6, 0}},      {"Pa", "GPa", {1e9, 0}},
    {"Pa", "kPa", {1e3, 0}},         {"Pa", "bar", {1e5, 0}},      {"Pa", "N/mm2", {1e6, 0}},
    {"Pa", "N/m2", {1, 0}},          {"Pa s", "mPas", {1e-3, 0}},  {"Pa s", "cP", {1e-3, 0}},
    {"Pa s", "Ns/m2", {1, 0}},       {"1/Pa", "1/GPa", {1e-9, 0}}, {"1/Pa", "1/MPa", {1e-6, 0}},
    {"1/Pa", "mm2/N", {1e-6, 0}},    {"1/Pa", "m2/N", {1, 0}},     {"1/Pa", "GPa-1", {1e-9, 0}},
    {"1/Pa", "Pa-1", {1, 0}},        {"1/Pa", "/GPa", {1e-9, 0}},  {"1/Pa", "/Pa", {1, 0}},
    {"degC", "C", {1, 0}},           {"degC", "K", {1, -273.15}},  {"W/(m K)", "W/mK", {1, 0}},
    {"rad", "deg", {M_PI / 180, 0}}, {"1", "%", {0.01, 0}},        {"s", "ms", {1e-3, 0}},
    {"s", "us", {1e-6, 0}},          {"s", "min", {60, 0}}};

enum { NUM_UNITS = sizeof units / sizeof *units, MAX_UNIT = 32 };

/* Writes a name without spaces, dots, stars and carets, and with ASCII letters for the signs micro,
 * degree and raised numbers. Returns false if the name is too long. */
static bool simple_name(char simple[MAX_UNIT], const char *name) {
    static const char *const signs[][2] = {{"µ", "u"},   {"μ", "u"}, {"°", "deg"}, {"²", "2"},
                                           {"⁻¹", "-1"}, {"·", ""},  {" ", ""},    {".", ""},
                                           {"*", ""},    {"^", ""}};
    size_t length = 0;

    while (*name) {
        char one[2] = {*name, '\0'};
        const char *text = one;
        size_t bytes = 1;
        for (size_t i = 0; i < sizeof signs / sizeof *signs; i++)
            if (strncmp(name, signs[i][0], strlen(signs[i][0])) == 0) {
                text = signs[i][1];
                bytes = strlen(signs[i][0]);
                break;
            }
        if (length + strlen(text) >= MAX_UNIT) return false;
        strcpy(simple + length, text);
        length += strlen(text);
        name += bytes;
    }
    simple[length] = '\0';
    return length > 0;
}

/* Finds a unit of the kind `si`, of which only the first `length` bytes count. */
static bool find_of(unit_conversion *found, const char *si, size_t length, const char *simple) {
    char own[MAX_UNIT], first[MAX_UNIT];

    snprintf(first, sizeof first, "%.*s", (int)length, si);
    if (strcmp(first, "1") != 0 && simple_name(own, first) && strcmp(own, simple) == 0) {
        *found = (unit_conversion){1, 0};
        return true;
    }
    for (size_t i = 0; i < NUM_UNITS; i++)
        if (strcmp(units[i].si, first) == 0 && strcmp(units[i].name, simple) == 0) {
            *found = units[i].to_si;
            return true;
        }
    return false;
}

bool unit_find(unit_conversion *found, const char *si, const char *name) {
    const size_t length = strcspn(si, "|");
    char simple[MAX_UNIT];

    if (!simple_name(simple, name)) return false;
    return find_of(found, si, length, simple) ||
           (si[length] && unit_find(found, si + length + 1, name));
}

void unit_list(char list[SHOWN_TEXT], const char *si) {
    size_t used = 0;

    *list = '\0';
    for (size_t i = 0; i < NUM_UNITS && used < SHOWN_TEXT; i++)
        if (strcmp(units[i].si, si) == 0)
            used += (size_t)snprintf(list + used, SHOWN_TEXT - used, "%s%s", used ? ", " : "",
                                     units[i].name);
}

const char *unit_named(const char *si, double factor) {
    for (size_t i = 0; i < NUM_UNITS; i++)
        if (strcmp(units[i].si, si) == 0 && units[i].to_si.offset == 0 &&
            fabs(units[i].to_si.factor / factor - 1) < 1e-9)
            return units[i].name;
    return NULL;
}
