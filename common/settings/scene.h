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
enum { MAX_FACTOR = 1000 };                    // largest |factor| that multiplies a reference value
extern const char *const vary_names[NUM_VARY]; // "load", …: the keys of their histories

/* The history of one quantity: the factor that multiplies its reference value, as a function of T =
 * u_ref t / a_ref. */
typedef struct history_settings {
    char law[16];          // constant, sine, ramp, step, table
    double amplitude;      // dimensionless
    double mean;           // dimensionless; NaN stands for 1
    double period;         // in T
    double phase;          // rad
    double from;           // factor before a ramp or step
    double to;             // factor after a ramp or step
    double start;          // T at which a ramp starts
    double duration;       // of a ramp, in T
    double at;             // T at which a step occurs
    char file[256];        // relative to the working folder
    char column[64];       // column in the file
    char unit[32];         // unit of the column; "": the unit in its header, else factor
    char interpolation[8]; // spline, linear
} history_settings;

/* The operating point in SI units. Load, radius, speed, modulus and viscosity are all given, or
 * none of them is. The speeds of both surfaces may replace the mean speed. An ellipse may have
 * another radius across the entrainment. If the viscosity law has its own viscosity, `viscosity`
 * may be missing. */
typedef struct physical_settings {
    double load;          // N/m of a line contact, N of a point contact
    char load_unit[8];    // unit "N/m" or "N" in which the load was given; "": without a unit
    double radius;        // m
    double radius_across; // m, of an ellipse; NaN: follows from the ellipticity
    double speed;         // m/s, mean of the two surfaces
    double speed_1;       // m/s, of one surface
    double speed_2;       // m/s, of the other surface
    double modulus;       // Pa, E' = 2/[(1-nu1^2)/E1 + (1-nu2^2)/E2]
    double viscosity;     // Pa s at zero pressure
} physical_settings;

/* The grid. Values that are NaN are chosen as the contact needs them (scene_contact.h). */
typedef struct grid_settings {
    double x_min; // all lengths of the grid are in contact half widths
    double x_max;
    double step;
    double y_max; // NaN also for a line contact
    int half;     // 1: only the symmetric half is solved; 0: the whole grid; -1: a line contact
} grid_settings;

typedef struct output_settings {
    int fields;       // whether fields are written: 1, 0, or -1 for the program's default
    int resolution;   // whether errors of the grid are estimated: 1, 0, or -1 for the default
    int fields_every; // fields are written at every N-th time step; only for a transient scene
} output_settings;

/* The column of times in the tables of histories. */
typedef struct table_time_settings {
    char column[64]; // "": time, T or t
    char unit[32];   // "": the unit in the column's header, else T
} table_time_settings;

typedef struct transient_settings {
    // bit i: the i-th setting with the unit T is given in seconds; setting_take_seconds converts it
    unsigned in_seconds;
    bool end_in_seconds; // end_time was given in seconds
    table_time_settings time;
    double end_time; // T at which the run ends
    // dimensionless: tolerance of the error of the central film if `transport` is path, else of the
    // local error of a time step
    double tolerance;
    double smoothing;  // filter length in half widths, for transport along the path
    double fixed_step; // length of fixed time steps in T; NaN: error control chooses the lengths
    double start_film; // central film H at T = 0 if the speed starts at zero
    // factor that multiplies the reference speed; the film at T = 0 is the stationary film at this
    // speed. NaN: factor of the speed's history at T = 0
    double start_speed;
    history_settings vary[NUM_VARY];
} transient_settings;

/* Waviness, dent or heights on one of the surfaces (common/time/surface.h). */
typedef struct surface_settings {
    char kind[16]; // "sine", "dent" or "file"; "": both surfaces are smooth
    char units[8]; // contact, si: units of heights and lengths
    double speed;  // speed of the surface that is not smooth, relative to the mean speed
    double position;
    double amplitude, wavelength, phase;
    double depth, radius;
    char file[256]; // relative to the working folder
    char column[64];
    char across[64]; // column of y; "": the heights depend on x alone
} surface_settings;

/* Values that are not given and have no default are NaN, "" or -1. */
typedef struct scene {
    char contact[16];        // line, point, ellipse
    char regime[16];         // stationary, transient
    char closure[16];        // load, approach
    char discretization[16]; // accurate, cross-flux, published
    char boundary[16];       // open, zero; "" for a line contact
    char transport[16];      // upwind, path
    double approach;         // H0 in the reference frame; NaN: H0 of the stationary solution
    // distance at which the approach is measured, in reference half widths; NaN: 10 with closure
    // approach, else 1
    double approach_length;
    struct {
        double M, L; // dimensionless, both given or neither
    } moes;
    physical_settings physical;
    double slide_roll;     // (u1 - u2)/u_m; NaN: the scene does not give it
    double ellipticity;    // b/a of an ellipse; NaN: follows from physical.radius_across
    double hertz_pressure; // Pa, optional
    lubricant_settings lubricant;
    grid_settings grid;
    output_settings output;
    transient_settings transient; // only for a transient scene
    surface_settings surface;     // only for a transient scene
} scene;

// Largest numbers of nodes in the grid of a point contact and of a line contact. Grids of point
// contacts are also checked against memory. A result has both halves of the grid. Therefore a file
// may have twice as many nodes as a grid of which only one half is solved.
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

/* One key of a scene: a row of the table from which parsing, validation, --help, the schema page
 * and stored settings follow. */
typedef struct setting {
    const char *key; // "lubricant.viscosity.alpha"
    setting_type type;
    size_t offset;             // in scene
    size_t size;               // string size, for SETTING_CHOICE, SETTING_TEXT and SETTING_FILE
    const char *default_value; // default, written as in a scene; NULL: no default
    const char *choices;       // "line" or "barus|roelands|wlf", for SETTING_CHOICE
    double min, max;           // allowed range, both included, for SETTING_REAL and SETTING_WHOLE
    const char *unit;          // "1", "Pa", ...; "N/m|N": N/m for a line contact, else N
    const char *help;          // one sentence
    // If one of these conditions does not hold, the key is refused. A NULL key ends a list of fewer
    // than MAX_CONDITIONS conditions. The conditions refer to keys of rows before this row
    setting_condition when[MAX_CONDITIONS];
    bool required; // whether the key must be given if the conditions hold
} setting;

/* Returns the table of settings, an array that ends with a row whose key is NULL. The keys of the
 * lubricant follow from the tables of laws. */
const setting *scene_settings(void);

/* Makes a scene that has no values except for the defaults of keys without conditions. */
void scene_defaults(scene *scene);

/* Fills in the defaults of all keys that are used with the scene's contact, regime, closure and
 * laws. scene_read, scene_parse and plan_read do this themselves. */
void scene_complete(scene *scene);

/* Returns the mean speed of both surfaces in m/s, or NaN if the scene does not give it. */
double scene_speed(const scene *scene);
/* Returns the slide-roll ratio, (u1 - u2) over the mean speed, or NaN if the scene does not give
 * it. */
double scene_slide_roll(const scene *scene);

/* Checks whether the law of shear stress also thins the flow in the film
 * (lubricant.shear.in_film). */
bool scene_thins_flow(const scene *scene);

/* Reads a YAML file. `overrides` are "key.path=value" strings ("--set"), applied after the file
 * and before validation; "key.path=" unsets the key, as if it had never been given. Relative file
 * names in the YAML file start from the folder of this file. Relative file names in `overrides`
 * start from the working folder. Returns EHD_OK, EHD_NOINPUT or EHD_DATA. For EHD_DATA the message
 * has the file, the line, the key, and what was found and expected. */
ehd_status scene_read(
    // output:
    scene *scene,
    // input:
    const char *path, const char *const *overrides, size_t num_overrides, ehd_error *error);

/* Reads a scene from memory like scene_read. Errors use `name` as the name of the file. Relative
 * file names start from the working folder. */
ehd_status scene_parse(
    // output:
    scene *scene,
    // input:
    const char *text, size_t length, const char *name, const char *const *overrides,
    size_t num_overrides, ehd_error *error);

/* Sets one key from text. The error text begins with `where` ("file:line" or "--set"). */
ehd_status scene_set(scene *scene, const char *key, const char *value, const char *where,
                     ehd_error *error);

/* Checks settings that depend on each other. The error text begins with `where`.
 * - Either moes or physical is given. For an ellipse either ellipticity or radius_across is given.
 * - All required keys are given. No key is given that regime, closure and laws do not use.
 * - The grid's extent is a whole number of grid steps.
 * - The contact lies inside the grid. */
ehd_status scene_validate(const scene *scene, const char *where, ehd_error *error);

/* Returns, as text, all settings that have a value: one line "key: value" each, in table order. The
 * numbers in the text read back as the same numbers. Equal scenes give equal texts, so the text
 * also identifies a scene. Free the text with free(). Returns NULL if there is no memory. */
char *scene_text(const scene *scene);

/* Checks whether `kept`, the text of settings in a file, matches `now`, the text of a scene or a
 * plan. If `kept` has no `discretization`, it is from a version before 0.3.0. Those versions had
 * only the published discretisation, with zero pressure around the grid and transport upwind.
 * `kept` then matches if `now` differs only by the lines that give these three settings. */
bool scene_text_matches(const char *kept, const char *now);

/* Prints the table as text for --help. */
void scene_print_help(FILE *stream);

/* One training point of a plan. */
typedef struct plan_point {
    scene scene;
    size_t group; // number of its group, from 0
} plan_point;

/* Quantities to which the key `where` of a plan may give a lowest and a highest value: alpha p_H
 * and the Moes number M. Only points between these values are solved. */
enum { WHERE_ALPHA_P_H, WHERE_MOES_M, NUM_WHERE };

/* Lowest and highest allowed value of each WHERE_ quantity in a group; -inf and inf: no limit. */
typedef struct plan_where {
    double bounds[NUM_WHERE][2];
} plan_where;

typedef struct plan {
    // [num_points], in the order of the file. In a grid (`combine`) the last key varies fastest. A
    // point is omitted if an earlier point has the same settings and the same bounds
    plan_point *points;
    size_t num_points;
    bool has_region; // points are candidates; the training solves as many as it needs
    // identifies the plan for --resume. The text has the groups with their bounds, scene_text of
    // the first point, and for each further point the settings that differ from the point before
    char *text;
    plan_where *where; // [num_groups]
    size_t num_groups;
} plan;

/* The key of each quantity in `where`. */
extern const char *const plan_where_keys[]; // [NUM_WHERE + 1], NULL at the end
/* Returns bounds that exclude no point. */
plan_where plan_anywhere(void);

/* Reads a plan (schemas/plan.md). Paths in the plan are relative to the plan's folder. Overrides
 * act on every scene. A scene file is read as a plan of one point. The bounds of `where` are on
 * derived quantities, so the caller must apply them. */
ehd_status plan_read(
    // output:
    plan *plan, // free with plan_free
    // input:
    const char *path, const char *const *overrides, size_t num_overrides, ehd_error *error);

/* Reads a plan from the text that files keep as their settings. The plan has the same points,
 * groups and bounds as the original plan. Lines that begin with # and give neither a group nor a
 * point are ignored, because programs add such lines to the text. Errors use `name` as the name of
 * the file. Errors: EHD_DATA, EHD_MEMORY. */
ehd_status plan_parse(
    // output:
    plan *plan, // free with plan_free
    // input:
    const char *text, const char *name, ehd_error *error);

/* Writes `text` of a plan anew after the points have changed. Errors: EHD_MEMORY. */
ehd_status plan_write_text(plan *plan, const char *name, ehd_error *error);

void plan_free(plan *plan);

#endif
