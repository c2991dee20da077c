/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A scene: the settings of one contact problem, as a YAML file gives them. */
#ifndef EHD_SCENE_H
#define EHD_SCENE_H

#include "common/physics/lubricant.h"
#include "common/program/status.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* The quantities that may vary in time. */
enum { VARY_LOAD, VARY_SPEED, VARY_RADIUS, VARY_MODULUS, VARY_APPROACH, NUM_VARY };
enum { MAX_FACTOR = 1000 };                    // largest magnitude of a factor
extern const char *const vary_names[NUM_VARY]; // "load", …: the keys of their histories

/* The history of one quantity: a factor on its reference value as a function of T = u_ref t /
 * a_ref. */
typedef struct history_settings {
    char law[16];          // constant, sine, ramp, step, table
    double amplitude;      // dimensionless
    double mean;           // dimensionless; NaN: 1
    double period;         // in T
    double phase;          // rad
    double from;           // factor
    double to;             // factor
    double start;          // T
    double duration;       // in T
    double at;             // T
    char file[256];        // relative to the working folder
    char column[64];       // in the file
    char interpolation[8]; // spline, linear
} history_settings;

/* The operating point in SI units. Load, radius, speed, modulus and viscosity are all given, or
 * none of them is. The speeds of both surfaces may replace the mean speed, and an ellipse may have
 * another radius across. The viscosity may be left to a law that has its own. */
typedef struct physical_settings {
    double load;          // N/m of a line contact, N of a point contact
    double radius;        // m
    double radius_across; // m, of an ellipse; NaN: follows from the ellipticity
    double speed;         // m/s, mean of the two surfaces
    double speed_1;       // m/s, of one surface
    double speed_2;       // m/s, of the other surface
    double modulus;       // Pa, E' = 2/[(1-nu1^2)/E1 + (1-nu2^2)/E2]
    double viscosity;     // Pa s at zero pressure
} physical_settings;

/* The grid. NaN: chosen as the contact needs it (scene_contact.h). */
typedef struct grid_settings {
    double x_min; // contact half widths
    double x_max;
    double step;
    double y_max; // NaN also for a line contact
    int half;     // 1, 0: whether the symmetric half is solved; -1: a line contact
} grid_settings;

typedef struct output_settings {
    int fields;       // 1, 0, or -1: the program's own default
    int resolution;   // 1, 0, or -1: the program's own default
    int fields_every; // fields at every N-th step, only when transient
} output_settings;

typedef struct transient_settings {
    double end_time; // T
    // dimensionless, for the local error of a step or, with transport along the path, for the
    // error of the central film
    double tolerance;
    double smoothing;   // half widths, for transport along the path
    double fixed_step;  // length of fixed steps in T; NaN: step size control by the local error
    double start_film;  // H at the start from rest
    double start_speed; // factor; NaN: the speed's history at T = 0
    history_settings vary[NUM_VARY];
} transient_settings;

/* Waviness, dent or heights on one of the surfaces (common/time/surface.h). */
typedef struct surface_settings {
    char kind[16]; // sine, dent, file; "": both surfaces are smooth
    char units[8]; // contact, si: units of heights and lengths
    double speed;  // speed of that surface, relative to the mean speed
    double position;
    double amplitude, wavelength, phase;
    double depth, radius;
    char file[256]; // relative to the working folder
    char column[64];
    char across[64]; // column of y; "": the table is of x alone
} surface_settings;

/* Values that are not given and have no default are NaN, "" or -1. */
typedef struct scene {
    char contact[16];        // line, point, ellipse
    char regime[16];         // stationary, transient
    char closure[16];        // load, approach
    char discretization[16]; // accurate, published
    char boundary[16];       // open, zero; "" of a line contact
    char transport[16];      // upwind, path
    double approach;         // H0 in the reference frame; NaN: H0 of the stationary solution
    double approach_length;  // a_ref; NaN: 10 with closure approach, else 1
    struct {
        double M, L; // dimensionless, both given or neither
    } moes;
    physical_settings physical;
    double slide_roll;     // (u1 - u2)/u_m; NaN: not given
    double ellipticity;    // b/a of an ellipse; NaN: follows from physical.radius_across
    double hertz_pressure; // Pa, optional
    lubricant_settings lubricant;
    grid_settings grid;
    output_settings output;
    transient_settings transient; // only when transient
    surface_settings surface;     // only when transient
} scene;

// Largest numbers of nodes in the grid of a point contact and of a line contact. Grids of point
// contacts are also checked against memory. A result has both halves of a grid, so files may have twice as many
// nodes.
enum { MAX_NODES = 50000000, MAX_LINE_NODES = 2000000 };

typedef enum setting_type {
    SETTING_CHOICE,
    SETTING_TEXT,
    SETTING_FILE, // text; a relative name is made relative to the working folder
    SETTING_REAL,
    SETTING_WHOLE, // whole number
    SETTING_FLAG
} setting_type;

/* Condition for the use of a key: the values that another key must have. */
typedef struct setting_condition {
    const char *key;    // "lubricant.viscosity.law"
    const char *values; // "barus|roelands"
} setting_condition;

enum { MAX_CONDITIONS = 2 };

/* One key of a scene. Parsing, validation, --help, the schema page and stored settings follow from
 * it. */
typedef struct setting {
    const char *key; // "lubricant.viscosity.alpha"
    setting_type type;
    size_t offset;             // in scene
    size_t size;               // size of the string, for SETTING_CHOICE, SETTING_TEXT and
                               // SETTING_FILE
    const char *default_value; // default, written as in a scene; NULL: none
    const char *choices;       // "line" or "barus|roelands|wlf", for SETTING_CHOICE
    double min, max;           // allowed range, both included, for SETTING_REAL and SETTING_WHOLE
    const char *unit;          // "1", "Pa", ...; "N/m|N": of a line contact, and of others
    const char *help;          // one sentence
    // If one of these conditions does not hold, the key is refused. The conditions end with a NULL
    // key, and refer to keys of rows before this row
    setting_condition when[MAX_CONDITIONS];
    bool required; // if the conditions hold
} setting;

/* Returns the table of settings, an array that ends with a row whose key is NULL. The keys of the
 * lubricant follow from the tables of laws. */
const setting *scene_settings(void);

/* Makes a scene with nothing given, except for the defaults of keys without conditions. */
void scene_defaults(scene *scene);

/* Fills in the defaults of all keys that are used with the scene's contact, regime, closure and
 * laws. scene_read, scene_parse and plan_read do this themselves. */
void scene_complete(scene *scene);

/* Returns the mean speed of both surfaces in m/s; NaN: not given. */
double scene_speed(const scene *scene);
/* Returns the slide-roll ratio, (u1 - u2) over the mean speed; NaN: not given. */
double scene_slide_roll(const scene *scene);

/* Checks whether the law of shear stress also thins the flow in the film
 * (lubricant.shear.in_film). */
bool scene_thins_flow(const scene *scene);

/* Reads a YAML file. `overrides` are "key.path=value" strings ("--set"), applied after the file
 * and before validation; "key.path=" unsets the key, as if nothing had given it. Relative names
 * of files start from the folder of the file that has them, or in `overrides` from the working
 * folder. Returns EHD_OK, EHD_NOINPUT, or EHD_DATA with file, line, key, found and expected in
 * *error. */
ehd_status scene_read(
    // output:
    scene *scene,
    // input:
    const char *path, const char *const *overrides, size_t num_overrides, ehd_error *error);

/* Reads a scene from memory like scene_read. `name` stands for the file in errors, and relative
 * names start from the working folder. */
ehd_status scene_parse(
    // output:
    scene *scene,
    // input:
    const char *text, size_t length, const char *name, const char *const *overrides,
    size_t num_overrides, ehd_error *error);

/* Sets one key from text; `where` ("file:line" or "--set") leads the error text. */
ehd_status scene_set(scene *scene, const char *key, const char *value, const char *where,
                     ehd_error *error);

/* Checks settings that depend on each other. `where` leads the error text.
 * - Either moes or physical is given, and of an ellipse either ellipticity or radius_across.
 * - Required keys are given, and no keys that regime, closure or laws do not use.
 * - The grid's extent is a whole number of steps.
 * - The contact lies inside the grid. */
ehd_status scene_validate(const scene *scene, const char *where, ehd_error *error);

/* Returns all settings that have a value, one line "key: value" each, in table order. Numbers
 * round-trip. Equal scenes give equal texts, so the text also identifies a scene. Free with free().
 * NULL: no memory. */
char *scene_text(const scene *scene);

/* Checks whether the text of settings that a file keeps matches the text `now`, of a scene or a
 * plan. A text without a discretization is from a version before 0.3.0, which had only the
 * published discretisation, with zero pressure around the grid. Such a text matches if those
 * settings are the only difference. */
bool scene_text_matches(const char *kept, const char *now);

/* Prints the table as text for --help. */
void scene_print_help(FILE *stream);
/* Prints the table as a Markdown table for schemas/scene.md. */
void scene_print_markdown(FILE *stream);

/* One training point of a plan. */
typedef struct plan_point {
    scene scene;
    size_t group; // number of its group, from 0
} plan_point;

/* Quantities that `where` of a plan may bound. */
enum { WHERE_ALPHA_P_H, WHERE_MOES_M, NUM_WHERE };

/* Bounds of a group; -inf..inf: no bound. */
typedef struct plan_where {
    double bounds[NUM_WHERE][2];
} plan_where;

typedef struct plan {
    // [num_points], in the order of the file; in a grid the last key varies fastest. Points that
    // equal an earlier one, bounds included, are omitted
    plan_point *points;
    size_t num_points;
    bool has_region; // points are candidates; training solves those that it needs
    // identifies the plan for --resume: the groups with their bounds, scene_text of the first
    // point, and of each further point what differs from the point before
    char *text;
    plan_where *where; // [num_groups]
    size_t num_groups;
} plan;

/* The key of each quantity in `where`. */
extern const char *const plan_where_keys[]; // [NUM_WHERE + 1], NULL at the end
/* Returns bounds that exclude nothing. */
plan_where plan_anywhere(void);

/* Reads a plan (schemas/plan.md). Paths in it are relative to the plan's folder. Overrides act on
 * every scene. A scene file is a plan of one point. The caller applies the bounds of `where`,
 * which are on derived quantities. */
ehd_status plan_read(
    // output:
    plan *plan, // free with plan_free
    // input:
    const char *path, const char *const *overrides, size_t num_overrides, ehd_error *error);

/* Reads a plan from the text that files keep as their settings: the same points, groups and bounds.
 * Lines that others added to the text, which begin with #, are ignored. `name` stands for the file
 * in errors. EHD_DATA, EHD_MEMORY. */
ehd_status plan_parse(
    // output:
    plan *plan, // free with plan_free
    // input:
    const char *text, const char *name, ehd_error *error);

/* Writes the text of the points anew, after they have changed. EHD_MEMORY. */
ehd_status plan_write_text(plan *plan, const char *name, ehd_error *error);

void plan_free(plan *plan);

#endif
