/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A scene: the settings of one contact problem, as a YAML file gives them. */
#ifndef EHD_SCENE_H
#define EHD_SCENE_H

#include "common/physics/lubricant.h"
#include "common/program/status.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* Every double is NaN and every string "" until it is given or a default fills it. */
typedef struct scene {
    char contact[16];      // line
    char regime[16];       // stationary
    char closure[16];      // load
    double moes_M;         // 1, given with moes_L, or not at all
    double moes_L;         // 1
    double load;           // N/m for a line contact; the five of `physical`, or none
    double radius;         // m
    double speed;          // m/s, mean of the two surfaces
    double modulus;        // Pa, E' = 2/[(1-nu1^2)/E1 + (1-nu2^2)/E2]
    double viscosity;      // Pa s at zero pressure
    double hertz_pressure; // Pa, optional
    lubricant_settings lubricant;
    double x_min; // contact half widths
    double x_max;
    double step;
    int output_fields; // 1, 0, or -1: the program's own default
} scene;

typedef enum setting_type { SETTING_CHOICE, SETTING_REAL, SETTING_FLAG } setting_type;

/* One row a key; it feeds parsing, validation, --help, the schema page and provenance. */
typedef struct setting {
    const char *key; // "lubricant.viscosity.alpha"
    setting_type type;
    size_t offset;        // in scene
    size_t size;          // of the string, for SETTING_CHOICE
    const char *fallback; // default as it would stand in the file; NULL: none
    const char *choices;  // "line" or "barus|roelands|wlf", for SETTING_CHOICE
    double least, most;   // allowed range, both included, for SETTING_REAL
    const char *unit;     // "1", "Pa", ...
    const char *help;     // one sentence
    const char *laws;     // viscosity laws that use it, "barus|roelands"; NULL: whatever the law
    bool required;
} setting;

extern const setting scene_settings[]; // ends with a row whose key is NULL

/* Everything not given, then defaults filled in where the table has them and no viscosity law has a
 * say. */
void scene_defaults(scene *scene);

/* Fills in the defaults that belong to the scene's viscosity law, where not given. scene_read,
 * scene_parse and plan_read have done so. */
void scene_complete(scene *scene);

/* Reads a YAML file. `overrides` are "key.path=value" strings ("--set"), applied after the file
 * and before validation. Returns EHD_OK, EHD_NOINPUT, or EHD_DATA with file, line, key, found and
 * expected in *error. */
ehd_status scene_read(
    // output:
    scene *scene,
    // input:
    const char *path, const char *const *overrides, size_t num_overrides, ehd_error *error);

/* The same from memory, as a multibody code may want; `name` stands for the file
 * in errors. */
ehd_status scene_parse(
    // output:
    scene *scene,
    // input:
    const char *text, size_t length, const char *name, const char *const *overrides,
    size_t num_overrides, ehd_error *error);

/* Sets one key from text; `where` ("file:line" or "--set") leads the error text. */
ehd_status scene_set(scene *scene, const char *key, const char *value, const char *where,
                     ehd_error *error);

/* The checks that involve several keys: moes or physical; what the law needs and nothing else; the
 * grid's extent a whole number of steps; the contact inside the grid. */
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

/* Reads a plan (design.md, "Settings"). Paths in it are relative to the plan's folder. Overrides
 * act on every scene. A plain scene file is also accepted as a plan of one point.
 * `where` bounds need derived quantities, which the caller applies (snapgen). */
ehd_status plan_read(
    // output:
    plan *plan, // free with plan_free
    // input:
    const char *path, const char *const *overrides, size_t num_overrides, ehd_error *error);

void plan_free(plan *plan);

#endif
