/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A scene: the settings of one contact problem, as a YAML file gives them. */
#ifndef EHD_SCENE_H
#define EHD_SCENE_H

#include "common/physics/lubricant.h"
#include "common/program/status.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* What may vary in time. */
enum { VARY_LOAD, VARY_SPEED, VARY_RADIUS, VARY_MODULUS, VARY_APPROACH, NUM_VARY };
enum { MAX_FACTOR = 1000 };                    // on a reference value, of either sign
extern const char *const vary_names[NUM_VARY]; // "load", …: the keys of their histories

/* How one of them varies: a factor on its reference value over the time T = u_ref t / a_ref. */
typedef struct history_settings {
    char law[16];          // constant, sine, ramp, step, table
    double amplitude;      // 1
    double period;         // of T
    double phase;          // rad
    double from;           // factor
    double to;             // factor
    double start;          // T
    double duration;       // of T
    double at;             // T
    char file[256];        // seen from the working folder
    char column[64];       // of the file
    char interpolation[8]; // spline, linear
} history_settings;

/* Every double is NaN, every string "" and every int -1 until it is given or a default fills it. */
typedef struct scene {
    char contact[16];       // line, point
    char regime[16];        // stationary, transient
    char closure[16];       // load, approach
    double approach;        // H0 in the reference frame; NaN: that of the stationary solution
    double approach_length; // a_ref; NaN: by the closure
    double moes_M;          // 1, given with moes_L, or not at all
    double moes_L;          // 1
    double load;    // N/m of a line contact, N of a point contact; the five of `physical`, or none
    double radius;  // m
    double speed;   // m/s, mean of the two surfaces
    double modulus; // Pa, E' = 2/[(1-nu1^2)/E1 + (1-nu2^2)/E2]
    double viscosity;      // Pa s at zero pressure
    double hertz_pressure; // Pa, optional
    lubricant_settings lubricant;
    double x_min; // contact half widths
    double x_max;
    double step;
    double y_max;          // NaN: a line contact
    int half;              // 1, 0: whether the symmetric half is solved; -1: a line contact
    int output_fields;     // 1, 0, or -1: the program's own default
    int output_resolution; // the same
    int fields_every;      // fields at every N-th step; this and all below only when transient
    double end_time;       // T
    double tolerance;      // 1, on the local error
    double fixed_step;     // of T; NaN: steps by the local error
    double start_film;     // H of the start from rest; NaN: not given
    history_settings vary[NUM_VARY];
} scene;

typedef enum setting_type {
    SETTING_CHOICE,
    SETTING_TEXT,
    SETTING_FILE, // text; a relative name is resolved when it is read
    SETTING_REAL,
    SETTING_WHOLE, // number
    SETTING_FLAG
} setting_type;

/* Another key, and the values of it that a key belongs to. */
typedef struct setting_condition {
    const char *key;    // "lubricant.viscosity.law"
    const char *values; // "barus|roelands"
} setting_condition;

enum { MAX_CONDITIONS = 2 };

/* One row a key; it feeds parsing, validation, --help, the schema page and provenance. */
typedef struct setting {
    const char *key; // "lubricant.viscosity.alpha"
    setting_type type;
    size_t offset;        // in scene
    size_t size;          // of the string, for SETTING_CHOICE, SETTING_TEXT and SETTING_FILE
    const char *fallback; // default as it would stand in the file; NULL: none
    const char *choices;  // "line" or "barus|roelands|wlf", for SETTING_CHOICE
    double min, max;      // allowed range, both included, for SETTING_REAL and SETTING_WHOLE
    const char *unit; // "1", "Pa", ...; "N/m|N": by the kind of contact, in the order of its key
    const char *help; // one sentence
    setting_condition when[MAX_CONDITIONS]; // all must hold, or the key is refused; key NULL: none.
                                            // Rows that conditions name stand before.
    bool required;                          // where its conditions hold
} setting;

/* The table: an array that ends with a row whose key is NULL. The keys of the lubricant follow from
 * the tables of laws. */
const setting *scene_settings(void);

/* Everything not given, except for the defaults of keys that are used in every scene. */
void scene_defaults(scene *scene);

/* Fills in the defaults that belong to the scene's regime, closure and laws, where not given.
 * scene_read, scene_parse and plan_read have done so. */
void scene_complete(scene *scene);

/* The grid's step: as given, or the default of the kind of contact. */
double scene_step(const scene *of);

/* Reads a YAML file. `overrides` are "key.path=value" strings ("--set"), applied after the file
 * and before validation; "key.path=" unsets the key, as if nothing had given it. Relative names of files start from the folder of the file that has them, or in
 * `overrides` from the working folder. Returns EHD_OK, EHD_NOINPUT, or EHD_DATA with file, line, key,
 * found and expected in *error. */
ehd_status scene_read(
    // output:
    scene *scene,
    // input:
    const char *path, const char *const *overrides, size_t num_overrides, ehd_error *error);

/* The same from memory, as a multibody code may want; `name` stands for the file in errors, and
 * relative names start from the working folder. */
ehd_status scene_parse(
    // output:
    scene *scene,
    // input:
    const char *text, size_t length, const char *name, const char *const *overrides,
    size_t num_overrides, ehd_error *error);

/* Sets one key from text; `where` ("file:line" or "--set") leads the error text. */
ehd_status scene_set(scene *scene, const char *key, const char *value, const char *where,
                     ehd_error *error);

/* The checks that involve several keys: moes or physical; what regime, closure and laws need and
 * nothing else; the grid's extent a whole number of steps; the contact inside the grid. */
ehd_status scene_validate(const scene *scene, const char *where, ehd_error *error);

/* All settings that have a value, "key: value" a line, in table order. Numbers round-trip.
 * Equal scenes give equal text, so it also identifies a scene. Free with free(). */
char *scene_text(const scene *scene);

/* The table as help text (--help of the programs) and as Markdown rows (schemas/scene.md). */
void scene_print_help(FILE *stream);
void scene_print_markdown(FILE *stream);

/* One training point of a plan. */
typedef struct plan_point {
    scene scene;
    size_t group; // number of its group, from 0
} plan_point;

typedef struct plan {
    plan_point *points; // [num_points], in the order of the file, grids with the last key fastest;
                        // of equal points (with equal bounds) only the first
    size_t num_points;
    char *text; // groups with bounds, the first point's scene_text, and for each further point the
        // settings in which it differs from the one before; identifies the plan for --resume
    double (*where_bounds)[2]; // [num_groups] bounds on alpha_p_H, -inf..inf where not given
    size_t num_groups;
} plan;

/* Reads a plan (schemas/plan.md). Paths in it are relative to the plan's folder. Overrides
 * act on every scene. A plain scene file is also accepted as a plan of one point.
 * `where` bounds need derived quantities, which the caller applies (snapgen). */
ehd_status plan_read(
    // output:
    plan *plan, // free with plan_free
    // input:
    const char *path, const char *const *overrides, size_t num_overrides, ehd_error *error);

void plan_free(plan *plan);

#endif
