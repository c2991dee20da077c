/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A scene while it is read: its values and where each came from, so that also the checks across keys
 * can point at a line. Shared by scene and plan. */
#ifndef EHD_SCENE_SOURCE_H
#define EHD_SCENE_SOURCE_H

#include "common/settings/place.h"
#include "common/settings/scene.h"
#include "common/settings/settings_table.h"
#include "common/settings/yaml_tree.h"

typedef struct scene_source {
    scene values;
    const char *file;   // leads errors that are about no single key
    const char *beside; // relative names in the map start from its folder; NULL: working folder
    place places[MAX_SETTINGS]; // by row of scene_settings; file NULL: not given
} scene_source;

/* Defaults, nothing given. `file` and `beside` are kept, not copied. */
void source_init(scene_source *source, const char *file, const char *beside);

/* setting_assign, with relative names of files seen from the folder of `beside`. */
ehd_status source_assign(
    // output:
    scene_source *source,
    // input:
    const setting *row, const char *text, const char *beside, place where, ehd_error *error);

/* Sets what a map (keys nested or dotted) gives. EHD_DATA: no map, unknown, double or bad keys. */
ehd_status source_apply_map(scene_source *source, const tree_node *map, ehd_error *error);

/* Sets "key=value" strings and unsets those without a value; a later one wins. */
ehd_status source_apply_overrides(scene_source *source, const char *const *overrides,
                                  size_t num_overrides, ehd_error *error);
bool source_is_overridden(const scene_source *source, const setting *row);

/* Completes the scene and makes the checks that involve several keys (scene_validate.c). */
ehd_status source_finish(scene_source *source, ehd_error *error);

ehd_status source_validate(const scene_source *source, ehd_error *error);

#endif
