/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/settings/part_list.h"

#include "common/program/text.h"
#include "common/settings/place.h"
#include "common/settings/yaml_tree.h"

#include <stdlib.h>
#include <string.h>

static bool ends_with(const char *text, const char *end) {
    const size_t length = strlen(text), other = strlen(end);

    return length >= other && strcmp(text + length - other, end) == 0;
}

bool part_list_is(const char *path) {
    return ends_with(path, ".yml") || ends_with(path, ".yaml");
}

void part_list_free(part_list *self) {
    for (size_t i = 0; i < self->num; i++)
        free(self->paths[i]);
    *self = (part_list){0};
}

static ehd_status add(part_list *self, char *path, const char *file, ehd_error *error) {
    if (!path) return ehd_no_memory(error, file);
    self->paths[self->num++] = path;
    return EHD_OK;
}

static ehd_status add_model(part_list *self, const tree_node *node, const char *path,
                            ehd_error *error) {
    char shown[SHOWN_TEXT];
    const place where = {path, node->line};

    if (node->kind != TREE_SCALAR || !*node->value || part_list_is(node->value))
        return place_fail(error, where, "models: found %s, expected the name of a model.h5",
                          node->kind == TREE_SCALAR && *node->value ? "the name of a list of models"
                                                                    : tree_show(shown, node));
    return add(self, path_beside(path, node->value), path, error);
}

static ehd_status read_tree(part_list *self, const tree_node *root, const char *path,
                            ehd_error *error) {
    const tree_node *models = tree_find(root, "models");
    char shown[SHOWN_TEXT];
    ehd_status status = EHD_OK;

    for (const tree_node *node = root->first; root->kind == TREE_MAP && node; node = node->next) {
        text_show(shown, node->key);
        if (node == models) continue;
        if (strcmp(node->key, "groups") == 0 || strcmp(node->key, "contact") == 0)
            return place_fail(error, (place){path, node->line},
                              "%s: found a %s, expected a list of models", shown,
                              strcmp(node->key, "groups") == 0 ? "plan" : "scene");
        return place_fail(error, (place){path, node->line},
                          "%s: found an unknown key, expected models", shown);
    }
    if (!models)
        return place_fail(error, (place){path, 0}, "models: found %s, expected a map with it",
                          root->kind == TREE_MAP ? "nothing" : tree_show(shown, root));
    if (models->kind != TREE_LIST || models->num_children == 0 || models->num_children > MAX_PARTS)
        return place_fail(error, (place){path, models->line},
                          "models: found %s, expected a list of one to %d model.h5",
                          models->kind != TREE_LIST   ? tree_show(shown, models)
                          : models->num_children == 0 ? "an empty list"
                                                      : "a longer list",
                          MAX_PARTS);
    for (const tree_node *node = models->first; node && !status; node = node->next)
        status = add_model(self, node, path, error);
    return status;
}

ehd_status part_list_read(part_list *self, const char *path, ehd_error *error) {
    char *text = NULL;
    size_t length = 0;
    tree_node *root = NULL;

    *self = (part_list){0};
    if (!part_list_is(path)) return add(self, strdup(path), path, error);
    ehd_status status = tree_read_text(&text, &length, path, error);
    if (!status) status = tree_parse(&root, text, length, path, error);
    if (!status) status = read_tree(self, root, path, error);
    tree_free(root);
    free(text);
    return status;
}
