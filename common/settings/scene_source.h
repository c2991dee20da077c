/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Holds a scene while it is read: the values, and the source location of each value. With the
 * locations, a check that involves several keys can name a line. Used for scenes and plans. */
#ifndef EHD_SCENE_SOURCE_H
#define EHD_SCENE_SOURCE_H

#include "common/settings/place.h"
#include "common/settings/scene.h"
#include "common/settings/settings_table.h"
#include "common/settings/yaml_tree.h"

typedef struct scene_source {
    scene values;
    const char *file;   // errors name this file if they do not concern a single key
    const char *beside; // file names in the map are relative to the folder of the file `beside`, or
                        // to the working folder if `beside` is NULL
    place places[MAX_SETTINGS]; // for each row of scene_settings(), the place of its setting; if
                                // the member `file` is NULL, the setting is not given
} scene_source;

/* Initialises a source with scene_defaults and no source locations. `file` and `beside` are kept,
 * not copied. */
void source_init(scene_source *source, const char *file, const char *beside);

/* Assigns a value like setting_assign. File names are relative to the folder of `beside`. */
ehd_status source_assign(
    // output:
    scene_source *source,
    // input:
    const setting *row, const char *text, const char *beside, place where, ehd_error *error);

/* Assigns the values in a YAML map, whose keys are nested or dotted. Returns EHD_DATA if `map` is
 * no map, if a key is unknown or repeated, or if a value is bad. */
ehd_status source_apply_map(scene_source *source, const tree_node *map, ehd_error *error);

/* Assigns the values in a YAML file like source_apply_map. Further errors: EHD_NOINPUT, EHD_IO,
 * EHD_MEMORY. */
ehd_status source_apply_file(scene_source *source, const char *path, ehd_error *error);

/* Sets the keys of "key=value" strings, and unsets the keys of "key=" strings. A later string
 * wins. */
ehd_status source_apply_overrides(scene_source *source, const char *const *overrides,
                                  size_t num_overrides, ehd_error *error);

/* Checks whether an override set or unset the key of a row. */
bool source_is_overridden(const scene_source *source, const setting *row);

/* Calls scene_complete and source_validate, and converts times that were given in seconds. */
ehd_status source_finish(scene_source *source, ehd_error *error);

/* Does the checks of scene_validate. Errors have the source location of a key. */
ehd_status source_validate(const scene_source *source, ehd_error *error);

#endif
