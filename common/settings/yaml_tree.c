/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/settings/yaml_tree.h"

#include "common/program/program.h"
#include "common/program/text.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <yaml.h>

enum {
    MAX_BYTES = 1 << 24,
    MAX_NODES = 1 << 20,
    MAX_KEYS = 256, // keys in a map; limits the time of the search for duplicates
    MAX_DEPTH = 16
};

// ---- text

static ehd_status read_stream(char **text, size_t *length, FILE *file, const char *path,
                              ehd_error *error) {
    size_t room = 4096;
    *length = 0;
    do {
        room *= 2;
        char *grown = realloc(*text, room);
        if (!grown) return ehd_no_memory(error, path);
        *text = grown;
        *length += fread(*text + *length, 1, room - 1 - *length, file);
        if (ferror(file))
            return ehd_fail(error, EHD_IO, "%s: found an error while reading (%s)", path,
                            strerror(errno));
    } while (*length == room - 1 && *length <= MAX_BYTES);
    if (*length > MAX_BYTES)
        return place_fail(error, (place){path, 0}, "found more than %d bytes, expected less",
                          MAX_BYTES);
    (*text)[*length] = '\0';
    return EHD_OK;
}

ehd_status tree_open(FILE **file, const char *path, ehd_error *error) {
    *file = program_open(path);
    if (*file) return EHD_OK;
    if (errno == ENOMEM) return ehd_no_memory(error, path);
    if (errno == EISDIR)
        return ehd_fail(error, EHD_NOINPUT, "%s: found a folder, expected a file", path);
    if (errno == ENOTSUP)
        return ehd_fail(error, EHD_NOINPUT, "%s: found no regular file, expected one", path);
    return ehd_fail(error, EHD_NOINPUT, "%s: found nothing (%s), expected a readable file", path,
                    strerror(errno));
}

ehd_status tree_read_text(char **text, size_t *length, const char *path, ehd_error *error) {
    FILE *file = NULL;
    *text = NULL;
    ehd_status status = tree_open(&file, path, error);
    if (status) return status;
    status = read_stream(text, length, file, path, error);
    fclose(file);
    if (status) {
        free(*text);
        *text = NULL;
    }
    return status;
}

// ---- tree

typedef struct reader {
    yaml_parser_t parser;
    const char *name;
    const char *text;
    size_t length;
    size_t num_nodes;
    ehd_error *error;
} reader;

static place place_of(const reader *self, yaml_mark_t mark) {
    return (place){self->name, mark.line + 1};
}

static size_t line_at(const reader *self, size_t offset) {
    size_t line = 1;
    for (size_t i = 0; i < offset && i < self->length; i++)
        line += self->text[i] == '\n';
    return line;
}

/* Checks whether a line is indented with a tab, which YAML forbids. */
static bool indented_with_tab(const reader *self, size_t line) {
    size_t i = 0;
    for (; i < self->length && line > 1; i++)
        line -= self->text[i] == '\n';
    while (i < self->length && self->text[i] == ' ')
        i++;
    return i < self->length && self->text[i] == '\t';
}

static ehd_status fail_malformed(const reader *self) {
    const yaml_parser_t *parser = &self->parser;
    const place where = place_of(self, parser->problem_mark);
    if (parser->error == YAML_MEMORY_ERROR) return ehd_no_memory(self->error, self->name);
    if (parser->error == YAML_READER_ERROR)
        return place_fail(self->error, (place){self->name, line_at(self, parser->problem_offset)},
                          "found bytes that are no text (%s), expected UTF-8", parser->problem);
    if (indented_with_tab(self, where.line))
        return place_fail(self->error, where, "found a tab, expected spaces as indentation");
    return place_fail(self->error, where, "found malformed YAML (%s), expected \"key: value\"",
                      parser->problem);
}

static ehd_status next_event(reader *self, yaml_event_t *event) {
    return yaml_parser_parse(&self->parser, event) ? EHD_OK : fail_malformed(self);
}

static ehd_status add_node(reader *self, tree_node **added, tree_node *parent, yaml_mark_t mark) {
    if (self->num_nodes++ >= MAX_NODES)
        return place_fail(self->error, place_of(self, mark),
                          "found more than %d values, expected less", MAX_NODES);
    tree_node *node = calloc(1, sizeof *node);
    if (!node) return ehd_no_memory(self->error, self->name);
    node->line = mark.line + 1;
    if (parent) {
        *(parent->last ? &parent->last->next : &parent->first) = node;
        parent->last = node;
        parent->num_children++;
    }
    *added = node;
    return EHD_OK;
}

/* Refuses aliases, anchors and tags. */
static ehd_status check_plain(const reader *self, const yaml_event_t *event) {
    const yaml_char_t *anchor = NULL, *tag = NULL;
    const place where = place_of(self, event->start_mark);
    switch (event->type) {
    case YAML_ALIAS_EVENT:
        return place_fail(self->error, where, "found an alias (*), expected plain values");
    case YAML_SCALAR_EVENT:
        anchor = event->data.scalar.anchor;
        tag = event->data.scalar.tag;
        break;
    case YAML_MAPPING_START_EVENT:
        anchor = event->data.mapping_start.anchor;
        tag = event->data.mapping_start.tag;
        break;
    case YAML_SEQUENCE_START_EVENT:
        anchor = event->data.sequence_start.anchor;
        tag = event->data.sequence_start.tag;
        break;
    default:
        break;
    }
    if (anchor) return place_fail(self->error, where, "found an anchor (&), expected plain values");
    if (tag) return place_fail(self->error, where, "found a tag (!), expected plain values");
    return EHD_OK;
}

static ehd_status copy_scalar(const reader *self, const yaml_event_t *event, char **copy) {
    const size_t length = event->data.scalar.length;
    const char *text = (const char *)event->data.scalar.value;
    if (strlen(text) != length)
        return place_fail(self->error, place_of(self, event->start_mark),
                          "found a zero byte, expected text");
    *copy = malloc(length + 1);
    if (!*copy) return ehd_no_memory(self->error, self->name);
    memcpy(*copy, text, length + 1);
    return EHD_OK;
}

static ehd_status set_key(const reader *self, const yaml_event_t *event, const tree_node *map,
                          tree_node *node) {
    const place where = place_of(self, event->start_mark);
    char shown[SHOWN_TEXT];
    ehd_status status = check_plain(self, event);
    if (status) return status;
    if (event->type != YAML_SCALAR_EVENT)
        return place_fail(self->error, where, "found a map or list as key, expected a name");
    if (map->num_children > MAX_KEYS)
        return place_fail(self->error, where, "found more than %d keys, expected less", MAX_KEYS);
    status = copy_scalar(self, event, &node->key);
    if (status) return status;
    const tree_node *earlier = tree_find(map, node->key);
    if (earlier == node) return EHD_OK;
    text_show(shown, node->key);
    return place_fail(self->error, where, "%s: found again, expected only once (first in line %zu)",
                      shown, earlier->line);
}

static ehd_status read_children(reader *self, tree_node *parent, size_t depth);

/* Reads the node whose first event is `event`. */
static ehd_status fill_node(reader *self, tree_node *node, const yaml_event_t *event,
                            size_t depth) {
    ehd_status status = check_plain(self, event);
    if (status) return status;
    if (event->type == YAML_SCALAR_EVENT) return copy_scalar(self, event, &node->value);
    node->kind = event->type == YAML_MAPPING_START_EVENT ? TREE_MAP : TREE_LIST;
    if (depth >= MAX_DEPTH)
        return place_fail(self->error, place_of(self, event->start_mark),
                          "found more than %d maps and lists inside of each other, expected less",
                          MAX_DEPTH);
    return read_children(self, node, depth + 1);
}

/* Reads one child of a map or list. In a map `event` is the key of the child. In a list `event` is
 * the start of the child. */
static ehd_status read_child(reader *self, tree_node *parent, yaml_event_t *event, size_t depth) {
    tree_node *child = NULL;
    ehd_status status = add_node(self, &child, parent, event->start_mark);
    if (!status && parent->kind == TREE_MAP) {
        status = set_key(self, event, parent, child);
        if (status) return status;
        yaml_event_delete(event);
        status = next_event(self, event);
    }
    return status ? status : fill_node(self, child, event, depth);
}

static ehd_status read_children(reader *self, tree_node *parent, size_t depth) {
    ehd_status status = EHD_OK;
    bool ended = false;
    while (!status && !ended) {
        yaml_event_t event;
        status = next_event(self, &event);
        if (status) break;
        ended = event.type == YAML_MAPPING_END_EVENT || event.type == YAML_SEQUENCE_END_EVENT;
        if (!ended) status = read_child(self, parent, &event, depth);
        yaml_event_delete(&event);
    }
    return status;
}

/* Skips the next event, which must be of this type. */
static ehd_status skip_event(reader *self, yaml_event_type_t type, const char *otherwise) {
    yaml_event_t event;
    ehd_status status = next_event(self, &event);
    if (status) return status;
    if (event.type != type)
        status = place_fail(self->error, place_of(self, event.start_mark), "%s", otherwise);
    yaml_event_delete(&event);
    return status;
}

static ehd_status read_root(reader *self, tree_node **root) {
    yaml_event_t event;
    ehd_status status = next_event(self, &event);
    if (status) return status;
    status = add_node(self, root, NULL, event.start_mark);
    if (!status) status = fill_node(self, *root, &event, 0);
    yaml_event_delete(&event);
    return status;
}

static ehd_status read_document(reader *self, tree_node **root) {
    ehd_status status = skip_event(self, YAML_STREAM_START_EVENT, "found no text");
    if (!status)
        status = skip_event(self, YAML_DOCUMENT_START_EVENT, "found no settings, expected some");
    if (!status) status = read_root(self, root);
    if (!status) status = skip_event(self, YAML_DOCUMENT_END_EVENT, "found no end");
    if (!status)
        status =
            skip_event(self, YAML_STREAM_END_EVENT, "found a second YAML document, expected one");
    return status;
}

ehd_status tree_parse(tree_node **root, const char *text, size_t length, const char *name,
                      ehd_error *error) {
    reader self = {.name = name, .text = text, .length = length, .error = error};
    const size_t skipped = length >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
    *root = NULL;
    if (!yaml_parser_initialize(&self.parser)) return ehd_no_memory(error, name);
    // The encoding is given, so that a byte order mark cannot select UTF-16. The parser then reads
    // the byte order mark of UTF-8 as text, so the mark is skipped here.
    yaml_parser_set_input_string(&self.parser, (const unsigned char *)text + skipped,
                                 length - skipped);
    yaml_parser_set_encoding(&self.parser, YAML_UTF8_ENCODING);
    const ehd_status status = read_document(&self, root);
    yaml_parser_delete(&self.parser);
    if (status) {
        tree_free(*root);
        *root = NULL;
    }
    return status;
}

const tree_node *tree_find(const tree_node *map, const char *key) {
    if (map->kind != TREE_MAP) return NULL;
    for (const tree_node *child = map->first; child; child = child->next)
        if (child->key && strcmp(child->key, key) == 0) return child;
    return NULL;
}

const char *tree_show(char *shown, const tree_node *node) {
    if (node->kind == TREE_MAP) return "a map";
    if (node->kind == TREE_LIST) return "a list";
    text_show(shown, node->value);
    return shown;
}

void tree_free(tree_node *root) {
    while (root) {
        tree_node *next = root->next;
        tree_free(root->first);
        free(root->key);
        free(root->value);
        free(root);
        root = next;
    }
}
