/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What can be done with one row of the table of settings. */
#ifndef EHD_SETTINGS_TABLE_H
#define EHD_SETTINGS_TABLE_H

#include "common/program/text.h"
#include "common/settings/place.h"
#include "common/settings/scene.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum { MAX_SETTINGS = 192, MAX_KEY = 128 };

/* The row of a key such as "moes.M", or NULL. */
const setting *setting_find(const char *key);

/* The same, but a bare name also stands for the only key that ends with it: "M" for "moes.M". */
const setting *setting_find_short(const char *name);

size_t setting_index(const setting *row);

/* "grid" or "lubricant.viscosity": keys stand below it. */
bool setting_is_group(const char *key);

/* Refuses a key that is no setting, and names the nearest one or the keys of the group. */
ehd_status setting_unknown(ehd_error *error, place where, const char *key);

/* Whether a word is one of "a|b|c". */
bool setting_has_choice(const char *choices, const char *word);

/* The condition that keeps a key from having a meaning: that of the key which the condition names comes
 * before. NULL: the key is in use. */
const setting_condition *setting_unmet(const setting *row, const scene *of);

/* "law wlf": the key that a condition is about, as it is given. */
void setting_show_condition(char shown[SHOWN_TEXT], const setting_condition *condition,
                            const scene *of);

bool setting_is_given(const setting *row, const scene *of);
void setting_clear(const setting *row, scene *of);

/* Negative, 0 or positive; not given comes first. */
int setting_compare(const setting *row, const scene *left, const scene *right);

/* The value must be given. */
void setting_print(FILE *stream, const setting *row, const scene *of);

/* Sets one value from its text. EHD_DATA with the place, key, found and expected. */
ehd_status setting_assign(
    // output:
    scene *scene,
    // input:
    const setting *row, const char *text, place where, ehd_error *error);

#endif
