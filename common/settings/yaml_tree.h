/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads a YAML document as a tree of maps, lists and scalars. Only this module uses libyaml.
 *
 * Supports what settings need: one document, unique text keys, no anchors, aliases or tags. */
#ifndef EHD_YAML_TREE_H
#define EHD_YAML_TREE_H

#include "common/program/status.h"
#include "common/settings/place.h"
#include <stddef.h>
#include <stdio.h>

typedef enum tree_kind { TREE_SCALAR, TREE_MAP, TREE_LIST } tree_kind;

typedef struct tree_node {
    tree_kind kind;
    size_t line;             // line number, from 1; for a child of a map, the line of its key
    char *key;               // key in a map, else NULL
    char *value;             // value of a scalar, else NULL
    size_t num_children;     // children of a map or list
    struct tree_node *first; // first child
    struct tree_node *last;  // last child
    struct tree_node *next;  // next sibling
} tree_node;

/* Opens a file to read. Errors: EHD_NOINPUT (missing, a folder, unreadable), EHD_MEMORY. */
ehd_status tree_open(FILE **file, const char *path, ehd_error *error);

/* Reads a whole file of at most 16 MiB into memory, with a zero after it (free with free()).
 * Errors: EHD_NOINPUT (missing, a folder, unreadable), EHD_IO, EHD_DATA (too large), EHD_MEMORY. */
ehd_status tree_read_text(
    // output:
    char **text, size_t *length,
    // input:
    const char *path, ehd_error *error);

/* Parses a text. Returns EHD_DATA if the text is malformed, not UTF-8, empty, or beyond the limits
 * on depth and size; the message is "name:line: found X, expected Y". Other errors: EHD_MEMORY. */
ehd_status tree_parse(
    // output:
    tree_node **root, // free with tree_free
    // input:
    const char *text, size_t length, const char *name, ehd_error *error);

/* Returns the child of a map with this key. Returns NULL if there is no such key, or `map` is no
 * map. */
const tree_node *tree_find(const tree_node *map, const char *key);

/* Returns the node as text for a message: "a map", "a list", "nothing", or the scalar's text, which
 * is stored in `shown` (SHOWN_TEXT bytes). */
const char *tree_show(char *shown, const tree_node *node);

/* Frees a tree, which may be NULL. */
void tree_free(tree_node *root);

#endif
