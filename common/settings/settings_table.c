/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/settings/settings_table.h"

#include "common/physics/contact.h"
#include "common/settings/unit.h"

#include <ctype.h>
#include <math.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

// ---- the table

#define AT(type, member)       offsetof(type, member), sizeof(((type *)0)->member)
#define CHOICE(member)         SETTING_CHOICE, AT(scene, member)
#define REAL(member)           SETTING_REAL, AT(scene, member)
#define WHOLE(member)          SETTING_WHOLE, AT(scene, member)
#define FLAG(member)           SETTING_FLAG, AT(scene, member)
#define FILE_NAME(member)      SETTING_FILE, AT(scene, member)
#define WORD(member)           SETTING_TEXT, AT(scene, member)
#define HISTORY_CHOICE(member) SETTING_CHOICE, AT(history_settings, member)
#define HISTORY_TEXT(member)   SETTING_TEXT, AT(history_settings, member)
#define HISTORY_FILE(member)   SETTING_FILE, AT(history_settings, member)
#define HISTORY_REAL(member)   SETTING_REAL, AT(history_settings, member)

// clang-format off
#define ALWAYS       {{NULL, NULL}}
#define ON_A_POINT   {{"contact", "point|ellipse"}}
#define ON_AN_ELLIPSE {{"contact", "ellipse"}}
#define IN_TIME      {{"regime", "transient"}}
#define LAW(laws)    {{NULL, laws}} // condition on the law of the key's own history
#define LAST_ROW     {NULL, SETTING_FLAG, 0, 0, NULL, NULL, 0, 0, NULL, NULL, ALWAYS, false}

// columns: key, type, offset, size, default, choices, min, max, unit, help, when, required
static const setting contact_rows[] = {
    {"contact", CHOICE(contact), NULL, "line|point|ellipse", 0, 0, "1",
     "Kind of contact", ALWAYS, true},
    {"regime", CHOICE(regime), NULL, "stationary|transient", 0, 0, "1",
     "Whether the contact varies with time", ALWAYS, true},
    {"closure", CHOICE(closure), "load", "load|approach", 0, 0, "1",
     "What is given: the load, or the rigid approach, and the load is an outcome", ALWAYS, false},
    {"approach", REAL(approach), NULL, NULL, -1e3, 1e3, "1",
     "Rigid approach H0 for the reference; if not given, that of the stationary solution under the "
     "scene's load",
     {{"closure", "approach"}}, false},
    {"approach_length", REAL(approach_length), NULL, NULL, 1e-3, 1e6, "1",
     "How far from a line contact its approach is measured, in reference half widths; default 10 "
     "with closure approach, else 1 as in stationary scenes", IN_TIME, false},
    {"moes.M", REAL(moes.M), NULL, NULL, MIN_MOES_M, MAX_MOES_M, "1",
     "Moes load number, of the sum velocity", ALWAYS, false},
    {"moes.L", REAL(moes.L), NULL, NULL, 0, MAX_MOES_L, "1",
     "Moes lubricant number, of the sum velocity", ALWAYS, false},
    {"physical.load", REAL(physical.load), NULL, NULL, 1e-6, 1e9, "N/m|N",
     "Load, of a line contact per length", ALWAYS, false},
    {"physical.radius", REAL(physical.radius), NULL, NULL, 1e-6, 1e3, "m",
     "Reduced radius of curvature, of an ellipse along the entrainment", ALWAYS, false},
    {"physical.radius_across", REAL(physical.radius_across), NULL, NULL, 1e-6, 1e3, "m",
     "Reduced radius of curvature across the entrainment, which the ellipticity follows from",
     ON_AN_ELLIPSE, false},
    {"physical.speed", REAL(physical.speed), NULL, NULL, 1e-9, 1e4, "m/s",
     "Mean velocity (u1 + u2)/2 of the surfaces", ALWAYS, false},
    {"physical.speed_1", REAL(physical.speed_1), NULL, NULL, -1e4, 1e4, "m/s",
     "Velocity u1 of one surface; with speed_2 in place of physical.speed and slide_roll", ALWAYS, false},
    {"physical.speed_2", REAL(physical.speed_2), NULL, NULL, -1e4, 1e4, "m/s",
     "Velocity u2 of the other surface", ALWAYS, false},
    {"physical.modulus", REAL(physical.modulus), NULL, NULL, 1e3, 1e13, "Pa",
     "Reduced modulus 2/[(1 - nu1^2)/E1 + (1 - nu2^2)/E2]", ALWAYS, false},
    {"physical.viscosity", REAL(physical.viscosity), NULL, NULL, 1e-6, 1e6, "Pa s",
     "Viscosity at zero pressure and the lubricant's temperature; may be left out where the law has its own "
     "(wlf, roelands, and barus with eta0)", ALWAYS, false},
    {"slide_roll", REAL(slide_roll), NULL, NULL, -2, 2, "1",
     "Slide-roll ratio (u1 - u2)/u_m: results then contain the traction; with physical.speed. Surfaces that move in "
     "opposite directions need physical.speed_1 and speed_2", ALWAYS, false},
    {"ellipticity", REAL(ellipticity), NULL, NULL, 0.05, 20, "1",
     "b/a, the half width of the dry contact across the entrainment over that along it; "
     "or physical.radius_across says it", ON_AN_ELLIPSE, false},
    {"hertz_pressure", REAL(hertz_pressure), NULL, NULL, 1e5, 2e10, "Pa",
     "Hertz pressure, where it shall not follow from the other settings", ALWAYS, false},
    LAST_ROW};

static const setting run_rows[] = {
    {"lubricant.thermal_conductivity", REAL(lubricant.thermal_conductivity), NULL, NULL, 1e-3, 1e3, "W/(m K)",
     "Thermal conductivity of the lubricant: results then tell beside the films, which are isothermal, the factor "
     "by which shear heating of the inlet thins them", {{"regime", "stationary"}}, false},
    {"discretization", CHOICE(discretization), "accurate", "accurate|cross-flux|published", 0, 0, "1",
     "How the equations are discretised on the grid: by rows of higher order; by those with what flows across counted "
     "along and the other way round, of stationary point contacts and ellipses; or as published",
     ALWAYS, false},
    {"boundary", CHOICE(boundary), NULL, "open|zero", 0, 0, "1",
     "What lies around the grid: the far field of the contact, or no pressure; default open, "
     "zero with published",
     ON_A_POINT, false},
    {"transport", CHOICE(transport), NULL, "path|upwind", 0, 0, "1",
     "How films that vary in time are carried through the contact: along the path of the fluid, or by "
     "the rows at fixed places; default path, upwind with published", IN_TIME, false},
    {"grid.x_min", REAL(grid.x_min), NULL, NULL, -1e5, -1, "1",
     "First inner node, in contact half widths; below -1; default by M and L, -4 with published", ALWAYS, false},
    {"grid.x_max", REAL(grid.x_max), NULL, NULL, 1, 1e5, "1",
     "Last inner node, in contact half widths; above 1; default by M and L, 2 where films are thin and with "
     "published", ALWAYS, false},
    {"grid.step", REAL(grid.step), NULL, NULL, 1e-6, 1e3, "1",
     "Distance of the nodes, in contact half widths; a whole number of steps fits; default by M and "
     "L, with published 0.005, of a point contact 0.0625; across, of an ellipse over the cube root of b/a", ALWAYS, false},
    {"grid.y_max", REAL(grid.y_max), NULL, NULL, 1, 1e5, "1",
     "Last inner line across the entrainment, in contact half widths, and the first one at -y_max; "
     "above 1, of an ellipse the next one outside; default by M and L, 3 with published", ON_A_POINT, false},
    {"grid.half", FLAG(grid.half), "true", NULL, 0, 0, "1",
     "Solve the symmetric half from y = 0 on; results are of the whole", ON_A_POINT, false},
    {"output.fields", FLAG(output.fields), NULL, NULL, 0, 0, "1",
     "Write pressure and film fields; default true in fullrun, false in romrun", ALWAYS, false},
    {"output.fields_every", WHOLE(output.fields_every), "1", NULL, 1, 1e9, "1",
     "Write fields at every N-th time step", IN_TIME, false},
    {"output.resolution", FLAG(output.resolution), NULL, NULL, 0, 0, "1",
     "Estimate what inlet and step do to the films, which takes a fifth (points) to two fifths (lines) of a cold start more; "
     "romrun: interpolate it between the points of the training; default true", {{"regime", "stationary"}}, false},
    {"transient.end_time", REAL(transient.end_time), NULL, NULL, 1e-9, 1e12, "T",
     "Time T = u_ref t/a_ref at which the run ends", IN_TIME, true},
    {"transient.time.column", WORD(transient.time.column), NULL, NULL, 0, 0, "1",
     "Column or dataset of the times in all tables of histories; default time, T or t", IN_TIME, false},
    {"transient.time.unit", WORD(transient.time.unit), NULL, NULL, 0, 0, "1",
     "Unit of these times, such as ms, or T; default: the unit in the column's header, else T", IN_TIME, false},
    {"transient.tolerance", REAL(transient.tolerance), NULL, NULL, 1e-12, 0.1, "1",
     "Accuracy of the time steps, relative to the central film: with transport path what they do to it "
     "(root mean square over time), default 1.5e-3; with upwind thirty times the local error of a step, "
     "default 1e-4", IN_TIME, false},
    {"transient.smoothing", REAL(transient.smoothing), NULL, NULL, 0, 1, "1",
     "Length below which waves of a film are damped on its path, in contact half widths; default "
     "0.014, less with a tolerance below 1.5e-3, at least 0.85 steps of the grid", {{"transport", "path"}}, false},
    {"transient.fixed_step", REAL(transient.fixed_step), NULL, NULL, 1e-9, 1e12, "T",
     "Length of all time steps, of T; switches error control off", IN_TIME, false},
    {"transient.start_film", REAL(transient.start_film), NULL, NULL, 1e-9, 1, "1",
     "Film H of the start when the speed starts at zero", IN_TIME, false},
    {"transient.start_speed", REAL(transient.start_speed), NULL, NULL, -MAX_FACTOR, MAX_FACTOR, "1",
     "Speed, a factor on the reference value, whose stationary film is the start; default that of the "
     "speed's history at T = 0", IN_TIME, false},
    LAST_ROW};

#define ON_A_SURFACE(kinds) {{"surface.kind", kinds}}

static const setting surface_rows[] = {
    {"surface.kind", CHOICE(surface.kind), NULL, "sine|dent|file", 0, 0, "1",
     "A waviness along x, a dent or a table of heights on one of the surfaces, with which it moves; "
     "fullrun alone", IN_TIME, false},
    {"surface.units", CHOICE(surface.units), "contact", "contact|si", 0, 0, "1",
     "Of its lengths and heights: reference half widths a and film units a^2/R, or metres in a scene "
     "with physical", ON_A_SURFACE("sine|dent|file"), false},
    {"surface.speed", REAL(surface.speed), "1", NULL, -MAX_FACTOR, MAX_FACTOR, "1",
     "Speed of that surface, a factor on the mean of both; 1 in pure rolling; with 0 it rests in the "
     "contact and the start is the stationary film with it",
     ON_A_SURFACE("sine|dent|file"), false},
    {"surface.position", REAL(surface.position), NULL, NULL, -1e9, 1e9, "1",
     "Where it is at T = 0, in front of the grid unless it rests: the end of a waviness, the middle of "
     "a dent, x = 0 of a table; default such that it is about to come in, of one that rests 0",
     ON_A_SURFACE("sine|dent|file"), false},
    {"surface.amplitude", REAL(surface.amplitude), NULL, NULL, -1e3, 1e3, "1",
     "Of the height amplitude sin(2 pi x/wavelength + phase), by which the gap grows, with x from "
     "the waviness's end, over the first wavelength growing in", ON_A_SURFACE("sine"), true},
    {"surface.wavelength", REAL(surface.wavelength), NULL, NULL, 1e-9, 1e3, "1",
     "Of the waviness", ON_A_SURFACE("sine"), true},
    {"surface.phase", REAL(surface.phase), "0", NULL, -1e3, 1e3, "rad",
     "Of the waviness", ON_A_SURFACE("sine"), false},
    {"surface.depth", REAL(surface.depth), NULL, NULL, -1e3, 1e3, "1",
     "Of the dent, by which the gap grows in its middle; below 0 a bump", ON_A_SURFACE("dent"), true},
    {"surface.radius", REAL(surface.radius), NULL, NULL, 1e-9, 1e3, "1",
     "R of the dent depth cos(pi r/(2.4 R)) exp(-2 (r/(1.2 R))^2)", ON_A_SURFACE("dent"), true},
    {"surface.file", FILE_NAME(surface.file), NULL, NULL, 0, 0, "1",
     "CSV or HDF5 file (.h5, .hdf5) with a table of heights over x, its column or dataset x; "
     "zero at its ends", ON_A_SURFACE("file"), true},
    {"surface.column", WORD(surface.column), NULL, NULL, 0, 0, "1",
     "Column or dataset of the heights, by which the gap grows", ON_A_SURFACE("file"), true},
    {"surface.across", WORD(surface.across), NULL, NULL, 0, 0, "1",
     "Column or dataset of y, of a table on a grid, x fastest; without it heights are the same across",
     {{"surface.kind", "file"}, {"contact", "point|ellipse"}}, false},
    LAST_ROW};

/* The keys of one history, below "transient.<quantity>.". */
static const setting history_rows[] = {
    {"law", HISTORY_CHOICE(law), "constant", "constant|sine|ramp|step|table", 0, 0, "1",
     "How it varies: a factor over time; a load only with closure load, an approach only with "
     "closure approach", IN_TIME, false},
    {"amplitude", HISTORY_REAL(amplitude), NULL, NULL, -MAX_FACTOR, MAX_FACTOR, "1",
     "Of the factor mean + amplitude sin(2 pi T/period + phase)", LAW("sine"), true},
    {"mean", HISTORY_REAL(mean), NULL, NULL, -MAX_FACTOR, MAX_FACTOR, "1",
     "Mean of the factor, default 1; a speed with a mean of 0 goes to and fro", LAW("sine"), false},
    {"period", HISTORY_REAL(period), NULL, NULL, 1e-6, 1e12, "T",
     "Time T of one oscillation", LAW("sine"), true},
    {"phase", HISTORY_REAL(phase), "0", NULL, -1e3, 1e3, "rad",
     "Phase at T = 0", LAW("sine"), false},
    {"from", HISTORY_REAL(from), "1", NULL, -MAX_FACTOR, MAX_FACTOR, "1",
     "Factor before a ramp, or up to and at a step", LAW("ramp|step"), false},
    {"to", HISTORY_REAL(to), NULL, NULL, -MAX_FACTOR, MAX_FACTOR, "1",
     "Factor after a ramp or step", LAW("ramp|step"), true},
    {"start", HISTORY_REAL(start), "0", NULL, -1e12, 1e12, "T",
     "Time T at which a ramp starts", LAW("ramp"), false},
    {"duration", HISTORY_REAL(duration), NULL, NULL, 1e-9, 1e12, "T",
     "Time that a ramp takes, of T", LAW("ramp"), true},
    {"at", HISTORY_REAL(at), NULL, NULL, 0, 1e12, "T", "Time T of a step", LAW("step"), true},
    {"file", HISTORY_FILE(file), NULL, NULL, 0, 0, "1",
     "CSV or HDF5 file (.h5, .hdf5) with a table of factors over T", LAW("table"), true},
    {"column", HISTORY_TEXT(column), NULL, NULL, 0, 0, "1",
     "Column or dataset of the factors in the file", LAW("table"), true},
    {"unit", HISTORY_TEXT(unit), NULL, NULL, 0, 0, "1",
     "Unit of this column, such as N/mm, or factor; default: the unit in the column's header, else factor", LAW("table"), false},
    {"interpolation", HISTORY_CHOICE(interpolation), "spline", "spline|linear", 0, 0, "1",
     "How the table is read between its times", LAW("table"), false},
    LAST_ROW};
// clang-format on

const law_group law_groups[NUM_LAW_GROUPS] = {
    [LAWS_VISCOSITY] = {"lubricant.viscosity", viscosity_laws,
                        offsetof(scene, lubricant.viscosity)},
    [LAWS_DENSITY] = {"lubricant.density", density_laws, offsetof(scene, lubricant.density)},
    [LAWS_SHEAR] = {"lubricant.shear", shear_laws, offsetof(scene, lubricant.shear)}};

const lubricant_law *law_group_choice(const law_group *group, const scene *of) {
    const char *name = (const char *)of + group->offset + offsetof(law_settings, law);

    return laws_find(group->laws, name);
}

const char *const vary_names[NUM_VARY] = {"load", "speed", "radius", "modulus", "approach"};

// largest numbers of rows and of texts that make_table makes
#define ROWS_OF(rows) (sizeof(rows) / sizeof *(rows)-1)
enum {
    LAW_ROWS = 1 + MAX_LAW_KEYS,
    MAX_ROWS = ROWS_OF(contact_rows) + NUM_LAW_GROUPS * LAW_ROWS + ROWS_OF(run_rows) +
               ROWS_OF(surface_rows) + NUM_VARY * ROWS_OF(history_rows),
    MAX_TEXTS = 2 * NUM_LAW_GROUPS * LAW_ROWS + NUM_VARY * (1 + ROWS_OF(history_rows)),
    TEXT_ROOM = 512
};
_Static_assert((int)MAX_ROWS <= (int)MAX_SETTINGS, "MAX_SETTINGS is too small");

/* The rows of all settings, and the storage of texts that are made at run time. */
static struct {
    setting rows[MAX_ROWS + 1];
    size_t num_rows;
    char texts[MAX_TEXTS][TEXT_ROOM];
    size_t num_texts;
    const setting *of_condition[MAX_ROWS + 1][MAX_CONDITIONS]; // rows of the conditions' keys
} table;

/* Formats a text and stores it with the table. */
static const char *make_text(const char *format, ...) {
    char *text = table.texts[table.num_texts++];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, TEXT_ROOM, format, arguments);
    va_end(arguments);
    return text;
}

static void add_row(const setting *row) {
    table.rows[table.num_rows++] = *row;
}

static void add_rows(const setting *rows) {
    for (; rows->key; rows++)
        add_row(rows);
}

static void add_laws(const law_group *group, bool required, const char *default_value,
                     const char *help) {
    const lubricant_law *const *laws = group->laws;
    char list[TEXT_ROOM];
    const law_parameter *parameter;
    laws_list(list, sizeof list, laws, NULL);
    const setting law = {.key = make_text("%s.law", group->key),
                         .type = SETTING_CHOICE,
                         .offset = group->offset + offsetof(law_settings, law),
                         .size = LAW_WORD,
                         .default_value = default_value,
                         .choices = make_text("%s", list),
                         .unit = "1",
                         .help = help,
                         .required = required};
    add_row(&law);
    for (size_t slot = 0; (parameter = laws_key(laws, slot)); slot++) {
        laws_list(list, sizeof list, laws, parameter->key);
        const setting row = {.key = make_text("%s.%s", group->key, parameter->key),
                             .type = parameter->choices ? SETTING_CHOICE : SETTING_REAL,
                             .offset = group->offset + offsetof(law_settings, values) +
                                       slot * sizeof(law_value),
                             .size = sizeof(law_value),
                             .default_value = laws_default(laws, parameter->key),
                             .choices = parameter->choices,
                             .min = parameter->min,
                             .max = parameter->max,
                             .unit = parameter->unit,
                             .help = parameter->help,
                             .when = {{law.key, make_text("%s", list)}},
                             .required = laws_require(laws, parameter->key)};
        add_row(&row);
    }
}

static void add_history(int quantity) {
    const char *name = vary_names[quantity], *law = make_text("transient.%s.law", name);
    for (const setting *part = history_rows; part->key; part++) {
        setting row = *part;
        row.key = make_text("transient.%s.%s", name, part->key);
        row.offset += offsetof(scene, transient.vary) + (size_t)quantity * sizeof(history_settings);
        if (!row.when[0].key)
            row.when[0].key = law;
        else if (quantity == VARY_LOAD || quantity == VARY_APPROACH)
            row.when[1] = (setting_condition){"closure", name};
        add_row(&row);
    }
}

/* Returns the row of a key among the rows before `row`, or NULL. The search begins at the first
 * row, because most conditions refer to the first rows. */
static const setting *row_before(const setting *row, const char *key) {
    for (const setting *other = table.rows; other < row; other++)
        if (*other->key == *key && strcmp(other->key, key) == 0) return other;
    return NULL;
}

/* Finds the rows of all conditions once, because each case of a table of cases checks all
 * conditions. */
static void find_conditions(void) {
    for (size_t r = 0; r < table.num_rows; r++) {
        const setting *row = &table.rows[r];
        for (size_t i = 0; i < MAX_CONDITIONS && row->when[i].key; i++)
            table.of_condition[r][i] = row_before(row, row->when[i].key);
    }
}

static void make_table(void) {
    add_rows(contact_rows);
    add_laws(&law_groups[LAWS_VISCOSITY], true, NULL, "How viscosity depends on pressure");
    add_laws(&law_groups[LAWS_DENSITY], false, "incompressible", "How density depends on pressure");
    add_laws(&law_groups[LAWS_SHEAR], false, NULL,
             "How shear stress depends on viscosity times the rate of shear, for the traction; "
             "required if the surfaces slide");
    add_rows(run_rows);
    add_rows(surface_rows);
    for (int i = 0; i < NUM_VARY; i++)
        add_history(i);
    find_conditions();
}

const setting *scene_settings(void) {
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    pthread_once(&once, make_table);
    return table.rows;
}

// ---- finding rows

const setting *setting_find(const char *key) {
    for (const setting *row = scene_settings(); row->key; row++)
        if (*row->key == *key && strcmp(row->key, key) == 0) return row;
    return NULL;
}

static const char *last_part(const char *key) {
    const char *dot = strrchr(key, '.');
    return dot ? dot + 1 : key;
}

const setting *setting_find_short(const char *name) {
    const setting *found = setting_find(name), *used = NULL;
    size_t num_found = 0, num_used = 0; // num_used: number of found keys without conditions
    if (found) return found;
    for (const setting *row = scene_settings(); row->key; row++) {
        if (strcmp(last_part(row->key), name) != 0) continue;
        found = row;
        num_found++;
        if (row->when[0].key) continue;
        used = row;
        num_used++;
    }
    if (num_found == 1) return found;
    return num_used == 1 ? used : NULL;
}

size_t setting_index(const setting *row) {
    return (size_t)(row - scene_settings());
}

static bool stands_below(const char *key, const char *group) {
    const size_t length = strlen(group);
    return strncmp(key, group, length) == 0 && key[length] == '.';
}

bool setting_is_group(const char *key) {
    for (const setting *row = scene_settings(); row->key; row++)
        if (stands_below(row->key, key)) return true;
    return false;
}

static size_t smallest(size_t a, size_t b, size_t c) {
    const size_t ab = a < b ? a : b;
    return ab < c ? ab : c;
}

/* Returns the Levenshtein distance, ignoring case; both texts are shorter than MAX_KEY. */
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

/* Words that a user may write for the last part of a key, each with the last part that is meant. */
static const char *const synonyms[][2] = {{"velocity", "speed"},
                                          {"u", "speed"},
                                          {"v", "speed"},
                                          {"force", "load"},
                                          {"F", "load"},
                                          {"Fn", "load"},
                                          {"w", "load"},
                                          {"R", "radius"},
                                          {"E", "modulus"},
                                          {"young", "modulus"},
                                          {"youngs_modulus", "modulus"},
                                          {"elasticity", "modulus"},
                                          {"eta", "viscosity"},
                                          {"eta0", "viscosity"},
                                          {"mu", "viscosity"},
                                          {"srr", "slide_roll"},
                                          {"SRR", "slide_roll"},
                                          {"slip", "slide_roll"}};

/* Returns the setting that is meant by a key whose last part is a synonym: "physical.speed" for
 * "physical.velocity". Returns NULL if there is no such setting. */
static const setting *same_meaning(const char *key) {
    char meant[MAX_KEY];
    const size_t length = (size_t)(last_part(key) - key);
    for (size_t i = 0; i < sizeof synonyms / sizeof *synonyms; i++) {
        if (strcmp(last_part(key), synonyms[i][0]) != 0) continue;
        snprintf(meant, sizeof meant, "%.*s%s", (int)length, key, synonyms[i][1]);
        return setting_find_short(meant);
    }
    return NULL;
}

/* Finds the setting, or the group of settings, whose name is spelled most like `key`, and copies
 * its name to `meant`. Returns false if no name is similar. */
static bool find_similar(char meant[MAX_KEY], const char *key) {
    size_t nearest = (strlen(key) + 2) / 3 + 1;
    bool found = false;
    for (const setting *row = scene_settings(); row->key; row++) {
        const char *end = row->key;
        do { // for each group above the setting, and for the setting itself
            char part[MAX_KEY];
            end += strcspn(end, ".");
            snprintf(part, sizeof part, "%.*s", (int)(end - row->key), row->key);
            const size_t distance = edit_distance(key, part);
            // a group stands for many settings, so its name must be closer to the key
            const bool near_group = *end != '.' || distance <= 2;
            if (distance < nearest && near_group) {
                nearest = distance;
                found = true;
                memcpy(meant, part, sizeof part);
            }
        } while (*end++);
    }
    return found;
}

/* Finds the setting or group that an unknown key probably stands for, and copies its name to
 * `meant`. Looks for a synonym, then for a similar spelling, then for the same last part. Returns
 * false if it finds no setting or group. */
static bool find_meant(char meant[MAX_KEY], const char *key) {
    const setting *found = same_meaning(key);
    if (strlen(key) >= MAX_KEY) return false;
    if (!found && find_similar(meant, key)) return true;
    for (const setting *row = scene_settings(); row->key && !found; row++)
        if (edit_distance(last_part(key), last_part(row->key)) == 0) found = row;
    if (found) snprintf(meant, MAX_KEY, "%s", found->key);
    return found != NULL;
}

/* Lists the keys and groups right below a group: "moes.M, moes.L". */
static void list_group(char *list, size_t size, const char *group) {
    const size_t depth = strlen(group) + 1;
    const char *before = "";
    size_t used = 0, before_length = 0;
    for (const setting *row = scene_settings(); row->key; row++) {
        if (!stands_below(row->key, group) || used >= size) continue;
        const size_t length = depth + strcspn(row->key + depth, ".");
        if (length == before_length && strncmp(row->key, before, length) == 0) continue;
        used += (size_t)snprintf(list + used, size - used, "%s%.*s", used ? ", " : "", (int)length,
                                 row->key);
        before = row->key;
        before_length = length;
    }
}

ehd_status setting_unknown(ehd_error *error, place where, const char *key) {
    char shown[SHOWN_TEXT], list[700], meant[MAX_KEY];
    text_show(shown, key);
    if (setting_is_group(key)) {
        list_group(list, sizeof list, key);
        return place_fail(error, where, "%s: found a value, expected keys below it: %s", shown,
                          list);
    }
    if (strcmp(key, "groups") == 0 || strcmp(key, "region") == 0)
        return place_fail(error, where, "%s: found a plan, expected a scene", shown);
    if (find_meant(meant, key))
        return place_fail(error, where, "%s: found an unknown key, expected %s (did you mean it?)",
                          shown, meant);
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

// ---- conditions

static char *text_at(const setting *row, scene *of) {
    return (char *)of + row->offset;
}

static const char *const_text_at(const setting *row, const scene *of) {
    return (const char *)of + row->offset;
}

const setting_condition *setting_unmet(const setting *row, const scene *of) {
    for (size_t i = 0; i < MAX_CONDITIONS && row->when[i].key; i++) {
        const setting *other = table.of_condition[setting_index(row)][i];
        const setting_condition *unmet = setting_unmet(other, of);
        if (unmet) return unmet;
        if (!setting_has_choice(row->when[i].values, const_text_at(other, of)))
            return &row->when[i];
    }
    return NULL;
}

void setting_show_condition(char shown[SHOWN_TEXT], const setting_condition *condition,
                            const scene *of) {
    snprintf(shown, SHOWN_TEXT, "%s %s", last_part(condition->key),
             const_text_at(setting_find(condition->key), of));
}

// ---- values

double setting_real(const setting *row, const scene *of) {
    double value;
    memcpy(&value, const_text_at(row, of), sizeof value);
    return value;
}

static int whole_at(const setting *row, const scene *of) {
    int value;
    memcpy(&value, const_text_at(row, of), sizeof value);
    return value;
}

bool setting_is_given(const setting *row, const scene *of) {
    switch (row->type) {
    case SETTING_REAL:
        return !isnan(setting_real(row, of));
    case SETTING_WHOLE:
    case SETTING_FLAG:
        return whole_at(row, of) >= 0;
    default:
        return *const_text_at(row, of) != '\0';
    }
}

bool setting_is_time(const setting *row) {
    return strcmp(row->unit, "T") == 0;
}

/* Notes whether a time was given in seconds. */
static void note_seconds(scene *of, const setting *row, bool seconds) {
    unsigned bit = 1;
    for (const setting *other = scene_settings(); other < row; other++)
        if (setting_is_time(other)) bit <<= 1;
    of->transient.in_seconds =
        seconds ? of->transient.in_seconds | bit : of->transient.in_seconds & ~bit;
}

/* Notes whether the load was given as a force or per length, for check_load. The kind of contact
 * may be given later. */
static void note_load_unit(scene *of, const char *unit) {
    unit_conversion per_length;

    strcpy(of->physical.load_unit, !*unit ? "" : unit_find(&per_length, "N/m", unit) ? "N/m" : "N");
}

/* Notes the unit with which a number was given: "" without a unit. `seconds`: the unit of a time is
 * a multiple of seconds. */
static void note_unit(scene *of, const setting *row, const char *unit, bool seconds) {
    if (setting_is_time(row)) note_seconds(of, row, seconds);
    if (strcmp(row->key, "physical.load") == 0) note_load_unit(of, unit);
}

void setting_clear(const setting *row, scene *of) {
    const double not_given = NAN;
    const int not_whole = -1;
    switch (row->type) {
    case SETTING_REAL:
        memcpy(text_at(row, of), &not_given, sizeof not_given);
        note_unit(of, row, "", false);
        break;
    case SETTING_WHOLE:
    case SETTING_FLAG:
        memcpy(text_at(row, of), &not_whole, sizeof not_whole);
        break;
    default:
        memset(text_at(row, of), 0, row->size);
    }
}

static int compare_reals(double left, double right) {
    return (left > right) - (left < right);
}

int setting_compare(const setting *row, const scene *left, const scene *right) {
    const bool left_given = setting_is_given(row, left);
    if (left_given != setting_is_given(row, right)) return left_given ? 1 : -1;
    if (!left_given) return 0;
    switch (row->type) {
    case SETTING_REAL:
        return compare_reals(setting_real(row, left), setting_real(row, right));
    case SETTING_WHOLE:
    case SETTING_FLAG:
        return whole_at(row, left) - whole_at(row, right);
    default:
        return strcmp(const_text_at(row, left), const_text_at(row, right));
    }
}

/* Prints a YAML scalar, in quotes if YAML could read the text as something else. */
static void print_text(FILE *stream, const char *text) {
    static const char plain[] =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_/.-";
    const bool quoted = *text == '-' || text[strspn(text, plain)];
    if (quoted) fputc('\'', stream);
    for (; *text; text++)
        fputs(*text == '\'' ? "''" : (char[]){*text, '\0'}, stream);
    if (quoted) fputc('\'', stream);
}

size_t setting_show(char *text, size_t size, const setting *row, const scene *of) {
    char number[NUMBER_TEXT];
    const char *shown = number;

    switch (row->type) {
    case SETTING_REAL:
        number_show(number, setting_real(row, of));
        break;
    case SETTING_WHOLE:
        snprintf(number, sizeof number, "%d", whole_at(row, of));
        break;
    case SETTING_FLAG:
        shown = whole_at(row, of) ? "true" : "false";
        break;
    default:
        shown = const_text_at(row, of);
    }
    return (size_t)snprintf(text, size, "%s", shown);
}

void setting_print(FILE *stream, const setting *row, const scene *of) {
    char value[NUMBER_TEXT];
    const bool number =
        row->type == SETTING_REAL || row->type == SETTING_WHOLE || row->type == SETTING_FLAG;

    fprintf(stream, "%s: ", row->key);
    if (number) {
        setting_show(value, sizeof value, row, of);
        fputs(value, stream);
    } else {
        print_text(stream, const_text_at(row, of));
    }
    fputc('\n', stream);
}

enum { ALLOWED_TEXT = 160 };

/* Writes the unit. A load has the unit " N/m" for a line contact and " N" for a point contact, or
 * " N/m (of a point contact N)" if the kind of contact is not known yet. Writes "" for the unit 1.
 * `of` may be NULL. */
static void show_unit(char shown[SHOWN_TEXT], const setting *row, const scene *of) {
    const char *unit = row->unit, *other = strchr(unit, '|');
    *shown = '\0';
    if (strcmp(unit, "1") == 0) return;
    if (!other)
        snprintf(shown, SHOWN_TEXT, " %s", unit);
    else if (of && strcmp(of->contact, "line") == 0)
        snprintf(shown, SHOWN_TEXT, " %.*s", (int)(other - unit), unit);
    else if (of && *of->contact)
        snprintf(shown, SHOWN_TEXT, " %s", other + 1);
    else
        snprintf(shown, SHOWN_TEXT, " %.*s (of a point contact %s)", (int)(other - unit), unit,
                 other + 1);
}

/* Writes the allowed values: "line|point", "true|false", "a number from 1 to 1000 Pa". `of` may be
 * NULL. */
static void show_allowed(char shown[ALLOWED_TEXT], const setting *row, const scene *of) {
    char unit[SHOWN_TEXT];
    switch (row->type) {
    case SETTING_REAL:
    case SETTING_WHOLE:
        show_unit(unit, row, of);
        snprintf(shown, ALLOWED_TEXT, "a %snumber from %g to %g%s",
                 row->type == SETTING_WHOLE ? "whole " : "", row->min, row->max, unit);
        break;
    case SETTING_TEXT:
    case SETTING_FILE:
        snprintf(shown, ALLOWED_TEXT, "%s of at most %zu bytes",
                 row->type == SETTING_FILE ? "the name of a file," : "printable text",
                 row->size - 1);
        break;
    default:
        snprintf(shown, ALLOWED_TEXT, "%s",
                 row->type == SETTING_FLAG ? "true|false" : row->choices);
    }
}

static bool number_begins(const char *text) {
    char *end;
    strtod(text, &end);
    return end != text;
}

/* Returns the unit behind a number, as "kN/m" in "200 kN/m", or "". */
static const char *unit_in(const char *text) {
    char *end;
    strtod(text, &end);
    return end == text ? "" : end + strspn(end, " ");
}

/* Returns the SI unit of a setting in a scene. If the kind of contact is not known yet, a load has
 * the unit "N/m|N". */
static const char *unit_of(char own[SHOWN_TEXT], const setting *row, const scene *of) {
    const char *other = strchr(row->unit, '|');
    if (!other || !*of->contact) return row->unit;
    if (strcmp(of->contact, "line") != 0) return other + 1;
    snprintf(own, SHOWN_TEXT, "%.*s", (int)(other - row->unit), row->unit);
    return own;
}

/* Reads a number with or without a unit. */
static bool read_real(double *value, const char *text, const char *si) {
    const char *unit = unit_in(text);
    char number[2 * NUMBER_TEXT];
    unit_conversion to_si;

    if (!*unit) return number_read(value, text);
    size_t length = (size_t)(unit - text);
    while (length > 0 && text[length - 1] == ' ')
        length--;
    snprintf(number, sizeof number, "%.*s", (int)length, text);
    if (length >= sizeof number || !number_read(value, number) || !unit_find(&to_si, si, unit))
        return false;
    *value = to_si.factor * *value + to_si.offset;
    return true;
}

ehd_status setting_take_seconds(scene *of, double unit_of_time, ehd_error *error) {
    unsigned bits = of->transient.in_seconds;
    of->transient.in_seconds = 0;
    for (const setting *row = scene_settings(); row->key && bits; row++) {
        if (!setting_is_time(row)) continue;
        const bool seconds = bits & 1;
        bits >>= 1;
        if (!seconds) continue;
        if (isnan(unit_of_time))
            return ehd_fail(error, EHD_DATA,
                            "%s: found seconds in a scene without physical, expected T", row->key);
        if (strcmp(row->key, "transient.end_time") == 0) of->transient.end_in_seconds = true;
        const double value = setting_real(row, of) / unit_of_time;
        if (!(value >= row->min && value <= row->max))
            return ehd_fail(error, EHD_DATA,
                            "%s: found T = %g from a time in seconds, expected %g to %g", row->key,
                            value, row->min, row->max);
        memcpy(text_at(row, of), &value, sizeof value);
    }
    return EHD_OK;
}

static bool assign_real(scene *of, const setting *row, const char *text) {
    char si[SHOWN_TEXT];
    double value;
    const bool time = setting_is_time(row);
    const bool seconds = time && !read_real(&value, text, "T");
    if (!read_real(&value, text, seconds ? "s" : unit_of(si, row, of))) return false;
    if (!seconds && !(value >= row->min && value <= row->max)) return false;
    value += 0.0; // -0 becomes 0, so that equal scenes have equal text
    memcpy(text_at(row, of), &value, sizeof value);
    note_unit(of, row, unit_in(text), seconds);
    return true;
}

static bool assign_whole(scene *of, const setting *row, const char *text) {
    size_t count;
    if (parse_count(&count, text, (size_t)row->min, (size_t)row->max, row->key, EHD_DATA, NULL))
        return false;
    const int value = (int)count;
    memcpy(text_at(row, of), &value, sizeof value);
    return true;
}

static bool assign_flag(scene *of, const setting *row, const char *text) {
    const int value = strcmp(text, "true") == 0;
    if (!value && strcmp(text, "false") != 0) return false;
    memcpy(text_at(row, of), &value, sizeof value);
    return true;
}

/* Checks that a text has no control characters; UTF-8 is allowed. */
static bool is_printable(const char *text) {
    for (; *text; text++)
        if ((unsigned char)*text < ' ' || *text == 0x7f) return false;
    return true;
}

static bool assign_text(scene *of, const setting *row, const char *text) {
    const bool valid = row->type == SETTING_CHOICE ? setting_has_choice(row->choices, text)
                                                   : *text && is_printable(text);
    if (!valid || strlen(text) >= row->size) return false;
    setting_clear(row, of);
    memcpy(text_at(row, of), text, strlen(text));
    return true;
}

/* If a text begins with a number, which is out of range or has an unknown unit, writes which units
 * its setting may have. Otherwise writes "". */
static void show_units(char shown[2 * SHOWN_TEXT], const setting *row, const char *text,
                       const scene *of) {
    char si[SHOWN_TEXT], list[SHOWN_TEXT];
    const char *own = unit_of(si, row, of), *unit = unit_in(text);
    unit_conversion known;

    *shown = '\0';
    if (setting_is_time(row)) own = "s";
    if (row->type != SETTING_REAL || strcmp(own, "1") == 0 || strchr(own, '|')) return;
    if (!number_begins(text) || (*unit && unit_find(&known, own, unit))) return;
    unit_list(list, own);
    if (*list)
        snprintf(shown, 2 * SHOWN_TEXT, ", or one in %s%s", setting_is_time(row) ? "s, " : "",
                 list);
}

ehd_status setting_assign(scene *of, const setting *row, const char *text, place where,
                          ehd_error *error) {
    char found[SHOWN_TEXT], allowed[ALLOWED_TEXT], units[2 * SHOWN_TEXT];
    bool valid;
    switch (row->type) {
    case SETTING_REAL:
        valid = assign_real(of, row, text);
        break;
    case SETTING_WHOLE:
        valid = assign_whole(of, row, text);
        break;
    case SETTING_FLAG:
        valid = assign_flag(of, row, text);
        break;
    default:
        valid = assign_text(of, row, text);
    }
    if (valid) return EHD_OK;
    text_show(found, text);
    show_allowed(allowed, row, of);
    show_units(units, row, text, of);
    return place_fail(error, where, "%s: found %s, expected %s%s", row->key, found, allowed, units);
}

// ---- the table as help

/* Prints "barus or wlf" for "barus|wlf". */
static void print_words(FILE *stream, const char *choices) {
    for (; *choices; choices++)
        fputs(*choices == '|' ? " or " : (char[]){*choices, '\0'}, stream);
}

int setting_quantity(const setting *row) {
    char group[MAX_KEY];
    for (int i = 0; i < NUM_VARY; i++) {
        snprintf(group, sizeof group, "transient.%s", vary_names[i]);
        if (stands_below(row->key, group)) return i;
    }
    return -1;
}

void setting_print_conditions(FILE *stream, const setting *row, const char *before) {
    const size_t max_shown = setting_quantity(row) < 0 ? MAX_CONDITIONS : 1;
    for (size_t i = 0; i < max_shown && row->when[i].key; i++) {
        fprintf(stream, "%s%s ", i ? ", " : before, last_part(row->when[i].key));
        print_words(stream, row->when[i].values);
    }
}

/* Checks whether a row is shown. All histories have the same keys, so only the first is shown. */
static bool is_shown(const setting *row) {
    return setting_quantity(row) <= 0;
}

/* Prints "moes.M", or "transient.<load|speed>.law" for all histories. */
static void print_key(FILE *stream, const setting *row) {
    if (setting_quantity(row) < 0) {
        fputs(row->key, stream);
        return;
    }
    for (int i = 0; i < NUM_VARY; i++)
        fprintf(stream, "%s%s", i ? "|" : "transient.<", vary_names[i]);
    fprintf(stream, ">.%s", last_part(row->key));
}

void scene_print_help(FILE *stream) {
    char allowed[ALLOWED_TEXT];
    fprintf(stream,
            "Settings of a scene, in its file or as --set KEY=VALUE; --set KEY= unsets one:\n");
    for (const setting *row = scene_settings(); row->key; row++) {
        if (!is_shown(row)) continue;
        show_allowed(allowed, row, NULL);
        fputs("\n  ", stream);
        print_key(stream, row);
        fprintf(stream, ": %s", allowed);
        if (row->required) fprintf(stream, "; required");
        if (row->default_value) fprintf(stream, "; default %s", row->default_value);
        setting_print_conditions(stream, row, row->required ? " with " : "; only with ");
        fprintf(stream, "\n      %s\n", row->help);
    }
    fprintf(stream, "\nEither moes or physical is required, with all of its keys.\n");
}
