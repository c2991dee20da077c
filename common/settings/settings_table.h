/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Operations on rows of the table of settings: finding, assigning, comparing, printing. */
#ifndef EHD_SETTINGS_TABLE_H
#define EHD_SETTINGS_TABLE_H

#include "common/program/text.h"
#include "common/settings/place.h"
#include "common/settings/scene.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum {
    MAX_SETTINGS = 256, // if this is too few, settings_table.c does not compile
    MAX_KEY = 128
};

/* A table of laws, and where a scene stores the chosen law. */
typedef struct law_group {
    const char *key; // "lubricant.viscosity"
    const lubricant_law *const *laws;
    size_t offset; // offset of its law_settings in a scene
} law_group;

enum { LAWS_VISCOSITY, LAWS_DENSITY, LAWS_SHEAR, NUM_LAW_GROUPS };
extern const law_group law_groups[NUM_LAW_GROUPS];

/* Returns the law that a scene names. Returns NULL if the scene names no law or an unknown law. */
const lubricant_law *law_group_choice(const law_group *group, const scene *of);

/* Returns the row of a key such as "moes.M", or NULL. */
const setting *setting_find(const char *key);

/* Returns the row of a key or of its last part, or NULL. The last part is enough if it is unique,
 * or unique among the keys without conditions. "M" means "moes.M". "speed" means "physical.speed",
 * although "surface.speed" exists. */
const setting *setting_find_short(const char *name);

/* Returns the position of a row in the table. */
size_t setting_index(const setting *row);

/* Checks whether there are keys below a key, as below "grid" or "lubricant.viscosity". */
bool setting_is_group(const char *key);

/* Fails with EHD_DATA for a key that is no setting. The error suggests a similar key, or the keys
 * of the group. */
ehd_status setting_unknown(ehd_error *error, place where, const char *key);

/* Checks whether a word is one of "a|b|c". */
bool setting_has_choice(const char *choices, const char *word);

/* Returns the first condition of a key that does not hold. A condition refers to another key; the
 * conditions of that key must hold, too. Returns NULL if all conditions hold, so the key is
 * used. */
const setting_condition *setting_unmet(const setting *row, const scene *of);

/* Writes the last part of a condition's key with the key's current value: "law wlf". */
void setting_show_condition(char shown[SHOWN_TEXT], const setting_condition *condition,
                            const scene *of);

/* Checks whether a scene has a value for a row's key. */
bool setting_is_given(const setting *row, const scene *of);
/* Removes the value of a row's key from a scene. */
void setting_clear(const setting *row, scene *of);

/* Compares two values. Returns a negative number, 0 or a positive number like strcmp. A value that
 * is not given is less than any other. */
int setting_compare(const setting *row, const scene *left, const scene *right);

/* Writes the value of a setting in the form that setting_assign reads; the value must be given.
 * Returns the length of the text, like snprintf. */
size_t setting_show(char *text, size_t size, const setting *row, const scene *of);

/* Returns the value of a setting of type SETTING_REAL. */
double setting_real(const setting *row, const scene *of);

/* Checks whether a setting is a dimensionless time T, which may also be given in seconds. */
bool setting_is_time(const setting *row);

/* Converts all times that were given in seconds to T. `unit_of_time` is a/u in s; NaN: not known.
 * Returns EHD_DATA if it is needed and not known, or if a time T is out of its range. */
ehd_status setting_take_seconds(scene *of, double unit_of_time, ehd_error *error);

/* Returns the quantity (index of vary_names) to whose history a row belongs, or -1 if the row
 * belongs to no history. All histories have the same keys. */
int setting_quantity(const setting *row);

/* Prints `before` and the conditions of a row: "regime transient, closure load". For a row of a
 * history, prints only the condition that all histories have. */
void setting_print_conditions(FILE *stream, const setting *row, const char *before);

/* Prints "key: value"; the value must be given. */
void setting_print(FILE *stream, const setting *row, const scene *of);

/* Assigns one value from its text. Returns EHD_DATA for a bad value; the message has the place, the
 * key, and what was found and expected. */
ehd_status setting_assign(
    // output:
    scene *scene,
    // input:
    const setting *row, const char *text, place where, ehd_error *error);

#endif
