/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/settings/settings_table.h"

#include "common/program/text.h"
#include <ctype.h>
#include <math.h>
#include <string.h>

// ---- the table

#define CHOICE(member) SETTING_CHOICE, offsetof(scene, member), sizeof(((scene *)0)->member)
#define REAL(member)   SETTING_REAL, offsetof(scene, member), sizeof(double)
#define FLAG(member)   SETTING_FLAG, offsetof(scene, member), sizeof(int)

// columns: key, type, offset, size, default, choices, least, most, unit, help, laws, required
// clang-format off
const setting scene_settings[] = {
    {"contact", CHOICE(contact), NULL, "line", 0, 0, "1",
     "Kind of contact", NULL, true},
    {"regime", CHOICE(regime), NULL, "stationary", 0, 0, "1",
     "Whether the contact varies with time", NULL, true},
    {"closure", CHOICE(closure), "load", "load", 0, 0, "1",
     "What closes the system of equations: the load is given", NULL, false},
    {"moes.M", REAL(moes_M), NULL, NULL, 0.1, 1e5, "1",
     "Moes load number, of the sum velocity", NULL, false},
    {"moes.L", REAL(moes_L), NULL, NULL, 0, 100, "1",
     "Moes lubricant number, of the sum velocity", NULL, false},
    {"physical.load", REAL(load), NULL, NULL, 1, 1e9, "N/m",
     "Load per length", NULL, false},
    {"physical.radius", REAL(radius), NULL, NULL, 1e-6, 1e3, "m",
     "Reduced radius of curvature", NULL, false},
    {"physical.speed", REAL(speed), NULL, NULL, 1e-9, 1e4, "m/s",
     "Mean velocity (u1 + u2)/2 of the surfaces", NULL, false},
    {"physical.modulus", REAL(modulus), NULL, NULL, 1e3, 1e13, "Pa",
     "Reduced modulus 2/[(1 - nu1^2)/E1 + (1 - nu2^2)/E2]", NULL, false},
    {"physical.viscosity", REAL(viscosity), NULL, NULL, 1e-6, 1e6, "Pa s",
     "Viscosity at zero pressure", NULL, false},
    {"hertz_pressure", REAL(hertz_pressure), NULL, NULL, 1e5, 2e10, "Pa",
     "Hertz pressure, where it shall not follow from the other settings", NULL, false},
    {"lubricant.viscosity.law", CHOICE(lubricant.viscosity_law), NULL, "barus|roelands|wlf", 0, 0,
     "1", "How viscosity depends on pressure", NULL, true},
    {"lubricant.viscosity.preset", CHOICE(lubricant.viscosity_preset), NULL, "no1|no2|no3", 0, 0,
     "1", "Lubricant of Table 1, in place of the eight constants", "wlf", false},
    {"lubricant.viscosity.temperature", REAL(lubricant.temperature), "25", NULL, -100, 400, "degC",
     "Temperature of the lubricant", "wlf", false},
    {"lubricant.viscosity.alpha", REAL(lubricant.alpha), NULL, NULL, 1e-10, 1e-6, "1/Pa",
     "Pressure-viscosity coefficient at zero pressure", "barus|roelands", false},
    {"lubricant.viscosity.eta0", REAL(lubricant.eta0), NULL, NULL, 1e-4, 1e6, "Pa s",
     "Viscosity at zero pressure", "roelands", false},
    {"lubricant.viscosity.A1", REAL(lubricant.wlf[WLF_A1]), NULL, NULL, 0, 1e3, "degC",
     "Constant A1 of the modified WLF law", "wlf", false},
    {"lubricant.viscosity.A2", REAL(lubricant.wlf[WLF_A2]), NULL, NULL, 0, 1e3, "1/GPa",
     "Constant A2 of the modified WLF law", "wlf", false},
    {"lubricant.viscosity.B1", REAL(lubricant.wlf[WLF_B1]), NULL, NULL, 0, 10, "1",
     "Constant B1 of the modified WLF law", "wlf", false},
    {"lubricant.viscosity.B2", REAL(lubricant.wlf[WLF_B2]), NULL, NULL, 0, 10, "1/MPa",
     "Constant B2 of the modified WLF law", "wlf", false},
    {"lubricant.viscosity.C1", REAL(lubricant.wlf[WLF_C1]), NULL, NULL, 0.1, 1e3, "1",
     "Constant C1 of the modified WLF law", "wlf", false},
    {"lubricant.viscosity.C2", REAL(lubricant.wlf[WLF_C2]), NULL, NULL, 0.1, 1e3, "degC",
     "Constant C2 of the modified WLF law", "wlf", false},
    {"lubricant.viscosity.Tg0", REAL(lubricant.wlf[WLF_TG0]), NULL, NULL, -273.15, 400, "degC",
     "Glass transition temperature at zero pressure", "wlf", false},
    {"lubricant.viscosity.mu_g", REAL(lubricant.wlf[WLF_MU_G]), NULL, NULL, 1, 1e20, "Pa s",
     "Viscosity at the glass transition", "wlf", false},
    {"lubricant.density.law", CHOICE(lubricant.density_law), "incompressible",
     "incompressible|dowson-higginson", 0, 0, "1", "How density depends on pressure", NULL, false},
    {"grid.x_min", REAL(x_min), "-4", NULL, -1e3, -1, "1",
     "First inner node, in contact half widths; below -1", NULL, false},
    {"grid.x_max", REAL(x_max), "2", NULL, 1, 1e3, "1",
     "Last inner node, in contact half widths; above 1", NULL, false},
    {"grid.step", REAL(step), "0.005", NULL, 1e-6, 0.125, "1",
     "Distance of the nodes, in contact half widths; a whole number of steps fits", NULL, false},
    {"output.fields", FLAG(output_fields), NULL, NULL, 0, 0, "1",
     "Write pressure and film fields; default true in fullrun, false in romrun", NULL, false},
    {NULL, SETTING_FLAG, 0, 0, NULL, NULL, 0, 0, NULL, NULL, NULL, false}};
// clang-format on

_Static_assert(sizeof scene_settings / sizeof *scene_settings <= MAX_SETTINGS + 1,
               "MAX_SETTINGS is too small");

// ---- finding rows

const setting *setting_find(const char *key) {
    for (const setting *row = scene_settings; row->key; row++)
        if (strcmp(row->key, key) == 0) return row;
    return NULL;
}

static const char *last_part(const char *key) {
    const char *dot = strrchr(key, '.');
    return dot ? dot + 1 : key;
}

const setting *setting_find_short(const char *name) {
    const setting *found = setting_find(name);
    size_t num_found = found ? 1 : 0;
    if (found) return found;
    for (const setting *row = scene_settings; row->key; row++) {
        if (strcmp(last_part(row->key), name) != 0) continue;
        found = row;
        num_found++;
    }
    return num_found == 1 ? found : NULL;
}

size_t setting_index(const setting *row) {
    return (size_t)(row - scene_settings);
}

static bool stands_below(const char *key, const char *group) {
    const size_t length = strlen(group);
    return strncmp(key, group, length) == 0 && key[length] == '.';
}

bool setting_is_group(const char *key) {
    for (const setting *row = scene_settings; row->key; row++)
        if (stands_below(row->key, key)) return true;
    return false;
}

static size_t smallest(size_t a, size_t b, size_t c) {
    const size_t ab = a < b ? a : b;
    return ab < c ? ab : c;
}

/* Levenshtein's distance, capitals and small letters being equal; both texts below MAX_KEY. */
static size_t edit_distance(const char *left, const char *right) {
    size_t row[MAX_KEY];
    const size_t width = strlen(right);
    for (size_t j = 0; j <= width; j++)
        row[j] = j;
    for (size_t i = 1; left[i - 1]; i++) {
        size_t diagonal = row[0];
        row[0] = i;
        for (size_t j = 1; j <= width; j++) {
            const size_t above = row[j];
            const bool same =
                tolower((unsigned char)left[i - 1]) == tolower((unsigned char)right[j - 1]);
            row[j] = smallest(above + 1, row[j - 1] + 1, diagonal + !same);
            diagonal = above;
        }
    }
    return row[width];
}

/* The key that a slip of the pen would explain: a similar one, or else one with the same last part. */
static const setting *nearest(const char *key) {
    const setting *found = NULL;
    size_t least = (strlen(key) + 2) / 3 + 1;
    if (strlen(key) >= MAX_KEY) return NULL;
    for (const setting *row = scene_settings; row->key; row++) {
        const size_t distance = edit_distance(key, row->key);
        if (distance >= least) continue;
        least = distance;
        found = row;
    }
    for (const setting *row = scene_settings; row->key && !found; row++)
        if (edit_distance(last_part(key), last_part(row->key)) == 0) found = row;
    return found;
}

/* "moes.M, moes.L" */
static void list_group(char *list, size_t size, const char *group) {
    size_t used = 0;
    for (const setting *row = scene_settings; row->key; row++)
        if (stands_below(row->key, group) && used < size)
            used += (size_t)snprintf(list + used, size - used, "%s%s", used ? ", " : "", row->key);
}

ehd_status setting_unknown(ehd_error *error, place where, const char *key) {
    char shown[SHOWN_TEXT], list[700];
    text_show(shown, key);
    if (setting_is_group(key)) {
        list_group(list, sizeof list, key);
        return place_fail(error, where, "%s: found a value, expected keys below it: %s", shown,
                          list);
    }
    const setting *row = nearest(key);
    if (row)
        return place_fail(error, where, "%s: found an unknown key, expected %s (did you mean it?)",
                          shown, row->key);
    return place_fail(error, where, "%s: found an unknown key, expected one of those --help shows",
                      shown);
}

bool setting_has_choice(const char *choices, const char *word) {
    const size_t length = strlen(word);
    if (strchr(word, '|')) return false;
    for (; choices; choices = strchr(choices, '|')) {
        choices += *choices == '|';
        if (strncmp(choices, word, length) == 0 && (choices[length] == '|' || !choices[length]))
            return length > 0;
    }
    return false;
}

// ---- values

static char *text_at(const setting *row, scene *of) {
    return (char *)of + row->offset;
}

static const char *const_text_at(const setting *row, const scene *of) {
    return (const char *)of + row->offset;
}

static double real_at(const setting *row, const scene *of) {
    double value;
    memcpy(&value, const_text_at(row, of), sizeof value);
    return value;
}

static int flag_at(const setting *row, const scene *of) {
    int value;
    memcpy(&value, const_text_at(row, of), sizeof value);
    return value;
}

bool setting_is_given(const setting *row, const scene *of) {
    switch (row->type) {
    case SETTING_REAL:
        return !isnan(real_at(row, of));
    case SETTING_FLAG:
        return flag_at(row, of) >= 0;
    default:
        return *const_text_at(row, of) != '\0';
    }
}

void setting_clear(const setting *row, scene *of) {
    const double not_given = NAN;
    const int own_default = -1;
    switch (row->type) {
    case SETTING_REAL:
        memcpy(text_at(row, of), &not_given, sizeof not_given);
        break;
    case SETTING_FLAG:
        memcpy(text_at(row, of), &own_default, sizeof own_default);
        break;
    default:
        memset(text_at(row, of), 0, row->size);
    }
}

int setting_compare(const setting *row, const scene *left, const scene *right) {
    const bool left_given = setting_is_given(row, left);
    if (left_given != setting_is_given(row, right)) return left_given ? 1 : -1;
    if (!left_given) return 0;
    if (row->type == SETTING_CHOICE)
        return strcmp(const_text_at(row, left), const_text_at(row, right));
    if (row->type == SETTING_FLAG) return flag_at(row, left) - flag_at(row, right);
    const double a = real_at(row, left), b = real_at(row, right);
    return (a > b) - (a < b);
}

void setting_print(FILE *stream, const setting *row, const scene *of) {
    char number[NUMBER_TEXT];
    switch (row->type) {
    case SETTING_REAL:
        number_show(number, real_at(row, of));
        fprintf(stream, "%s: %s\n", row->key, number);
        break;
    case SETTING_FLAG:
        fprintf(stream, "%s: %s\n", row->key, flag_at(row, of) ? "true" : "false");
        break;
    default:
        fprintf(stream, "%s: %s\n", row->key, const_text_at(row, of));
    }
}

/* "line", "barus|roelands|wlf", "true|false", "a number from 1 to 1000 Pa". */
static void show_allowed(char *shown, size_t size, const setting *row) {
    const bool plain = strcmp(row->unit, "1") == 0;
    if (row->type == SETTING_REAL)
        snprintf(shown, size, "a number from %g to %g%s%s", row->least, row->most, plain ? "" : " ",
                 plain ? "" : row->unit);
    else
        snprintf(shown, size, "%s", row->type == SETTING_FLAG ? "true|false" : row->choices);
}

static bool assign_real(scene *of, const setting *row, const char *text) {
    double value;
    if (!number_read(&value, text) || !(value >= row->least && value <= row->most)) return false;
    value += 0.0; // -0 becomes 0, so that equal scenes have equal text
    memcpy(text_at(row, of), &value, sizeof value);
    return true;
}

static bool assign_flag(scene *of, const setting *row, const char *text) {
    const int value = strcmp(text, "true") == 0;
    if (!value && strcmp(text, "false") != 0) return false;
    memcpy(text_at(row, of), &value, sizeof value);
    return true;
}

static bool assign_choice(scene *of, const setting *row, const char *text) {
    if (!setting_has_choice(row->choices, text) || strlen(text) >= row->size) return false;
    setting_clear(row, of);
    memcpy(text_at(row, of), text, strlen(text));
    return true;
}

ehd_status setting_assign(scene *of, const setting *row, const char *text, place where,
                          ehd_error *error) {
    char found[SHOWN_TEXT], allowed[128];
    bool valid;
    switch (row->type) {
    case SETTING_REAL:
        valid = assign_real(of, row, text);
        break;
    case SETTING_FLAG:
        valid = assign_flag(of, row, text);
        break;
    default:
        valid = assign_choice(of, row, text);
    }
    if (valid) return EHD_OK;
    text_show(found, text);
    show_allowed(allowed, sizeof allowed, row);
    return place_fail(error, where, "%s: found %s, expected %s", row->key, found, allowed);
}

// ---- the table for people

void scene_print_help(FILE *stream) {
    char allowed[128];
    fprintf(stream, "Settings of a scene, in its file or as --set KEY=VALUE:\n");
    for (const setting *row = scene_settings; row->key; row++) {
        show_allowed(allowed, sizeof allowed, row);
        fprintf(stream, "\n  %s: %s", row->key, allowed);
        if (row->required) fprintf(stream, "; required");
        if (row->fallback) fprintf(stream, "; default %s", row->fallback);
        if (row->laws) fprintf(stream, "; law %s", row->laws);
        fprintf(stream, "\n      %s\n", row->help);
    }
    fprintf(stream, "\nEither moes or physical is required, with all of its keys.\n");
}

/* "barus, wlf" from "barus|wlf", because a bar would end the cell of a Markdown table. */
static void print_words(FILE *stream, const char *choices) {
    for (; *choices; choices++)
        fputs(*choices == '|' ? ", " : (char[]){*choices, '\0'}, stream);
}

static void print_allowed(FILE *stream, const setting *row) {
    if (row->type == SETTING_REAL)
        fprintf(stream, "%g to %g", row->least, row->most);
    else
        print_words(stream, row->type == SETTING_FLAG ? "true|false" : row->choices);
}

void scene_print_markdown(FILE *stream) {
    fprintf(stream, "| Key | Allowed | Unit | Default | Viscosity law | Meaning |\n"
                    "|---|---|---|---|---|---|\n");
    for (const setting *row = scene_settings; row->key; row++) {
        fprintf(stream, "| `%s` | ", row->key);
        print_allowed(stream, row);
        fprintf(stream, " | %s | %s | ", row->type == SETTING_REAL ? row->unit : "",
                row->required   ? "*required*"
                : row->fallback ? row->fallback
                                : "");
        print_words(stream, row->laws ? row->laws : "");
        fprintf(stream, " | %s |\n", row->help);
    }
}
