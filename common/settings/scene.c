/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/settings/scene.h"

#include "common/program/text.h"
#include "common/settings/scene_contact.h"
#include "common/settings/scene_source.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char override_name[] = "--set";

// ---- defaults

static void fill_default(scene *of, const setting *row) {
    // setting_assign cannot fail here: a unit test checks the defaults of the table
    if (row->default_value && !setting_is_given(row, of) && !setting_unmet(row, of))
        setting_assign(of, row, row->default_value, (place){0}, NULL);
}

void scene_defaults(scene *of) {
    memset(of, 0, sizeof *of);
    for (const setting *row = scene_settings(); row->key; row++) {
        setting_clear(row, of);
        if (!row->when[0].key) fill_default(of, row);
    }
}

/* Fills in the defaults that the chosen law has for its own parameters. */
static void fill_law(scene *of, const law_group *group) {
    const lubricant_law *law = law_group_choice(group, of);
    char key[MAX_KEY];

    for (size_t i = 0; law && i < law_num_parameters(law); i++) {
        if (!law->parameters[i].default_value) continue;
        snprintf(key, sizeof key, "%s.%s", group->key, law->parameters[i].key);
        const setting *row = setting_find(key);
        if (row && !setting_is_given(row, of))
            setting_assign(of, row, law->parameters[i].default_value, (place){0}, NULL);
    }
}

static void fill_real(double *value, double default_value) {
    if (isnan(*value)) *value = default_value;
}

static bool has_lines(const scene *of) {
    return *of->contact && strcmp(of->contact, "line") != 0;
}

/* Fills in the grid of the published method. It is the same for all M and L. */
static void fill_published_grid(scene *of) {
    const bool point = has_lines(of);

    fill_real(&of->grid.x_min, -4);
    fill_real(&of->grid.x_max, 2);
    fill_real(&of->grid.step, point ? 0.0625 : 0.005);
    if (point) fill_real(&of->grid.y_max, 3);
}

static void fill_boundary(scene *of) {
    const bool published = strcmp(of->discretization, "published") == 0;

    if (!*of->boundary)
        snprintf(of->boundary, sizeof of->boundary, "%s", published ? "zero" : "open");
}

/* Fills in `transport`, and the tolerance of the time steps, which depends on `transport`. */
static void fill_transient(scene *of) {
    const bool published = strcmp(of->discretization, "published") == 0;

    if (!*of->transport)
        snprintf(of->transport, sizeof of->transport, "%s", published ? "upwind" : "path");
    fill_real(&of->transient.tolerance, strcmp(of->transport, "path") == 0 ? 1.5e-3 : 1e-4);
}

double scene_speed(const scene *of) {
    return isnan(of->physical.speed) ? (of->physical.speed_1 + of->physical.speed_2) / 2
                                     : of->physical.speed;
}

double scene_slide_roll(const scene *of) {
    return isnan(of->slide_roll) ? (of->physical.speed_1 - of->physical.speed_2) / scene_speed(of)
                                 : of->slide_roll;
}

bool scene_thins_flow(const scene *of) {
    const size_t slot = laws_slot(shear_laws, "in_film");

    return strcmp(of->lubricant.shear.values[slot].word, "true") == 0;
}

void scene_complete(scene *of) {
    for (const setting *row = scene_settings(); row->key; row++)
        fill_default(of, row);
    for (int i = 0; i < NUM_LAW_GROUPS; i++)
        fill_law(of, &law_groups[i]);
    if (strcmp(of->discretization, "published") == 0) fill_published_grid(of);
    if (has_lines(of)) fill_boundary(of);
    if (strcmp(of->regime, "transient") == 0) fill_transient(of);
}

// ---- setting values

ehd_status scene_set(scene *of, const char *key, const char *value, const char *where,
                     ehd_error *error) {
    const place here = {where, 0};
    const setting *row = setting_find(key);
    return row ? setting_assign(of, row, value, here, error) : setting_unknown(error, here, key);
}

void source_init(scene_source *source, const char *file, const char *beside) {
    memset(source, 0, sizeof *source);
    scene_defaults(&source->values);
    source->file = file;
    source->beside = beside;
}

ehd_status source_assign(scene_source *source, const setting *row, const char *text,
                         const char *beside, place where, ehd_error *error) {
    char *path = NULL;
    if (row->type == SETTING_FILE && *text && beside) {
        path = path_beside(beside, text);
        if (!path) return ehd_no_memory(error, source->file);
    }
    const ehd_status status =
        setting_assign(&source->values, row, path ? path : text, where, error);
    free(path);
    return status;
}

static ehd_status apply_value(scene_source *source, const setting *row, const tree_node *node,
                              place where, ehd_error *error) {
    char shown[SHOWN_TEXT];
    place *known = &source->places[setting_index(row)];
    if (node->kind != TREE_SCALAR)
        return place_fail(error, where, "%s: found %s, expected a single value", row->key,
                          tree_show(shown, node));
    // The YAML parser refuses a key that comes twice, but not a nested key that is also given as a
    // dotted key.
    if (known->file)
        return place_fail(error, where, "%s: found again, expected only once (first in line %zu)",
                          row->key, known->line);
    *known = where;
    return source_assign(source, row, node->value, source->beside, where, error);
}

static ehd_status apply_below(scene_source *source, const tree_node *map, const char *prefix,
                              ehd_error *error) {
    ehd_status status = EHD_OK;
    for (const tree_node *node = map->first; node && !status; node = node->next) {
        char key[MAX_KEY];
        const place where = {source->file, node->line};
        const int length =
            snprintf(key, sizeof key, "%s%s%s", prefix, *prefix ? "." : "", node->key);
        const setting *row = length < MAX_KEY ? setting_find(key) : NULL;
        if (row)
            status = apply_value(source, row, node, where, error);
        else if (node->kind == TREE_MAP && length < MAX_KEY && setting_is_group(key))
            status = apply_below(source, node, key, error);
        else
            status = setting_unknown(error, where, key);
    }
    return status;
}

ehd_status source_apply_map(scene_source *source, const tree_node *map, ehd_error *error) {
    char shown[SHOWN_TEXT];
    if (map->kind != TREE_MAP)
        return place_fail(error, (place){source->file, map->line},
                          "found %s, expected settings as \"key: value\"", tree_show(shown, map));
    return apply_below(source, map, "", error);
}

ehd_status source_apply_file(scene_source *source, const char *path, ehd_error *error) {
    char *text;
    size_t length;
    tree_node *root = NULL;
    ehd_status status = tree_read_text(&text, &length, path, error);
    if (!status) status = tree_parse(&root, text, length, path, error);
    if (!status) status = source_apply_map(source, root, error);
    tree_free(root);
    free(text);
    return status;
}

static ehd_status apply_override(scene_source *source, const char *text, ehd_error *error) {
    const place where = {override_name, 0};
    char key[MAX_KEY], shown[SHOWN_TEXT];
    const char *equals = strchr(text, '=');
    text_show(shown, text);
    if (!equals) return place_fail(error, where, "found %s, expected KEY=VALUE", shown);
    snprintf(key, sizeof key, "%.*s", (int)(equals - text), text);
    const setting *row = setting_find(key);
    if (!row) return setting_unknown(error, where, key);
    source->places[setting_index(row)] = where;
    if (equals[1]) return setting_assign(&source->values, row, equals + 1, where, error);
    setting_clear(row, &source->values);
    return EHD_OK;
}

ehd_status source_apply_overrides(scene_source *source, const char *const *overrides,
                                  size_t num_overrides, ehd_error *error) {
    ehd_status status = EHD_OK;
    for (size_t i = 0; i < num_overrides && !status; i++)
        status = apply_override(source, overrides[i], error);
    return status;
}

bool source_is_overridden(const scene_source *source, const setting *row) {
    return source->places[setting_index(row)].file == override_name;
}

/* Converts the times that were given in seconds. */
static ehd_status take_seconds(scene_source *source, ehd_error *error) {
    ehd_contact contact;
    ehd_error cause = {""};
    ehd_status status = scene_contact_derive(&contact, &source->values, &cause);

    if (!status)
        status = setting_take_seconds(&source->values, contact_time_scale(&contact), &cause);
    return status ? place_fail(error, (place){source->file, 0}, "%s", cause.text) : EHD_OK;
}

ehd_status source_finish(scene_source *source, ehd_error *error) {
    scene_complete(&source->values);
    const ehd_status status = source_validate(source, error);
    return status || !source->values.transient.in_seconds ? status : take_seconds(source, error);
}

// ---- reading and writing

static ehd_status parse(scene *of, const char *text, size_t length, const char *name,
                        const char *beside, const char *const *overrides, size_t num_overrides,
                        ehd_error *error) {
    scene_source source;
    tree_node *root;
    source_init(&source, name, beside);
    ehd_status status = tree_parse(&root, text, length, name, error);
    if (!status) status = source_apply_map(&source, root, error);
    if (!status) status = source_apply_overrides(&source, overrides, num_overrides, error);
    if (!status) status = source_finish(&source, error);
    tree_free(root);
    *of = source.values;
    return status;
}

ehd_status scene_parse(scene *of, const char *text, size_t length, const char *name,
                       const char *const *overrides, size_t num_overrides, ehd_error *error) {
    return parse(of, text, length, name, NULL, overrides, num_overrides, error);
}

ehd_status scene_read(scene *of, const char *path, const char *const *overrides,
                      size_t num_overrides, ehd_error *error) {
    char *text;
    size_t length;
    ehd_status status = tree_read_text(&text, &length, path, error);
    if (status) return status;
    status = parse(of, text, length, path, path, overrides, num_overrides, error);
    free(text);
    return status;
}

char *scene_text(const scene *of) {
    char *text = NULL;
    size_t length = 0;
    FILE *stream = open_memstream(&text, &length);
    if (!stream) return NULL;
    for (const setting *row = scene_settings(); row->key; row++)
        if (setting_is_given(row, of)) setting_print(stream, row, of);
    if (fclose(stream)) {
        free(text);
        text = NULL;
    }
    return text;
}

bool scene_text_matches(const char *kept, const char *now) {
    static const char key[] = "discretization:";
    static const char *const later[] = {"discretization: published\n", "boundary: zero\n",
                                        "transport: upwind\n"};
    size_t length = 0;

    for (const char *line = kept; *line; line += length + (line[length] == '\n')) {
        length = strcspn(line, "\n");
        if (strncmp(line, key, strlen(key)) == 0) return strcmp(kept, now) == 0;
    }
    for (; *now; now += length, kept += length) {
        for (size_t i = 0; i < sizeof later / sizeof *later; i++)
            if (strncmp(now, later[i], strlen(later[i])) == 0) now += strlen(later[i]);
        length = strcspn(now, "\n");
        length += now[length] == '\n';
        if (strncmp(kept, now, length) != 0) return false;
    }
    return !*kept;
}
