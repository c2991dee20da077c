/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/settings/csv.h"

#include "common/program/text.h"
#include "common/settings/yaml_tree.h"
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- text

static size_t count_lines(const char *text) {
    size_t lines = 1;
    for (; *text; text++)
        lines += *text == '\n';
    return lines;
}

ehd_status csv_open(csv_file *self, const char *path, ehd_error *error) {
    static const char byte_order_mark[] = "\xef\xbb\xbf";
    size_t length = 0;
    *self = (csv_file){.path = strdup(path)};
    if (!self->path) return place_no_memory(error, path);
    self->where.file = self->path;
    const ehd_status status = tree_read_text(&self->text, &length, path, error);
    if (status) return status;
    if (strlen(self->text) != length)
        return place_fail(error, (place){path, count_lines(self->text)},
                          "found a zero byte, expected text");
    self->rest = self->text + (strncmp(self->text, byte_order_mark, 3) == 0 ? 3 : 0);
    return EHD_OK;
}

void csv_close(csv_file *self) {
    free(self->path);
    free(self->text);
    *self = (csv_file){0};
}

size_t csv_count_lines(const csv_file *self) {
    return count_lines(self->rest);
}

char *csv_next_line(csv_file *self) {
    while (*self->rest) {
        char *start = self->rest, *end = start + strcspn(start, "\n");
        self->rest = *end ? end + 1 : end;
        *end = '\0';
        self->where.line++;
        const char first = start[strspn(start, " \t\r")];
        if (first && first != '#') return start;
    }
    return NULL;
}

char *csv_next_field(char **rest) {
    char *field = *rest;
    if (!field) return NULL;
    char *end = field + strcspn(field, ",");
    *rest = *end ? end + 1 : NULL;
    *end = '\0';
    field += strspn(field, " \t");
    for (end = field + strlen(field); end > field && strchr(" \t\r", end[-1]);)
        *--end = '\0';
    return field;
}

ehd_status csv_check_width(const csv_file *self, size_t found, size_t expected, ehd_error *error) {
    if (found == expected) return EHD_OK;
    return place_fail(error, self->where, "found %zu column%s, expected %zu as in the header",
                      found, found == 1 ? "" : "s", expected);
}

// ---- numbers

enum { NO_COLUMN = -1 };

void table_show_names(char shown[SHOWN_TEXT], const char *const *names) {
    char all[2 * SHOWN_TEXT] = "";
    for (size_t i = 0; names[i]; i++)
        snprintf(all + strlen(all), sizeof all - strlen(all), "%s%s", i > 0 ? "|" : "", names[i]);
    text_show(shown, all);
}

/* Place of a name in the list, its length when it is not there. */
static int rank_of(const char *name, const char *const *names) {
    int rank = 0;
    while (names[rank] && strcmp(name, names[rank]) != 0)
        rank++;
    return rank;
}

/* Place in the header of the first of the names that it has, NO_COLUMN when it has none. */
static int find_column(const char *const *names, char *const *fields, size_t width) {
    int found = NO_COLUMN, best = rank_of("", names); // no name is empty
    for (size_t i = 0; i < width; i++) {
        const int rank = rank_of(fields[i], names);
        if (rank >= best) continue;
        best = rank;
        found = (int)i;
    }
    return found;
}

/* Places of the wanted columns in the header, NO_COLUMN where one is missing, and its width. */
static ehd_status find_columns(int *places, size_t *width, csv_file *self,
                               const table_column *columns, size_t num_columns, ehd_error *error) {
    char shown[SHOWN_TEXT];
    char *line = csv_next_line(self);
    *width = 0;
    if (!line)
        return place_fail(error, (place){self->path, 0}, "found an empty file, expected a header");
    char **fields = malloc((strlen(line) + 1) * sizeof *fields);
    if (!fields) return place_no_memory(error, self->path);
    for (char *field; (field = csv_next_field(&line));)
        fields[(*width)++] = field;
    for (size_t c = 0; c < num_columns; c++)
        places[c] = columns[c].names ? find_column(columns[c].names, fields, *width) : 0;
    free(fields);
    for (size_t c = 0; c < num_columns; c++) {
        if (places[c] != NO_COLUMN || columns[c].optional) continue;
        table_show_names(shown, columns[c].names);
        return place_fail(error, self->where, "found no column %s in the header, expected one",
                          shown);
    }
    return EHD_OK;
}

static ehd_status read_number(double *value, const csv_file *self, const char *field,
                              ehd_error *error) {
    char shown[SHOWN_TEXT];
    if (number_read(value, field)) return EHD_OK;
    text_show(shown, field);
    return place_fail(error, self->where, "found %s, expected a number", shown);
}

static ehd_status read_line(table_column *columns, size_t num_columns, size_t row,
                            const csv_file *self, char *line, const int *places, size_t width,
                            ehd_error *error) {
    ehd_status status = EHD_OK;
    size_t i = 0;
    for (char *field; !status && (field = csv_next_field(&line)); i++)
        for (size_t c = 0; c < num_columns && !status; c++)
            if (places[c] == (int)i)
                status = read_number(&columns[c].values[row], self, field, error);
    return status ? status : csv_check_width(self, i, width, error);
}

static ehd_status read_lines(table_column *columns, size_t num_columns, size_t *count,
                             csv_file *self, const int *places, size_t width, ehd_error *error) {
    const size_t room = csv_count_lines(self);
    ehd_status status = EHD_OK;
    for (size_t c = 0; c < num_columns; c++) {
        if (places[c] == NO_COLUMN) continue;
        columns[c].values = malloc(room * sizeof(double));
        if (!columns[c].values) return place_no_memory(error, self->path);
    }
    for (char *line; !status && (line = csv_next_line(self)); ++*count)
        status = read_line(columns, num_columns, *count, self, line, places, width, error);
    return status;
}

ehd_status csv_read_table(const char *path, table_column *columns, size_t num_columns,
                          size_t *count, ehd_error *error) {
    csv_file file;
    size_t width = 0;
    int *places = malloc((num_columns + 1) * sizeof *places);
    *count = 0;
    for (size_t c = 0; c < num_columns; c++)
        columns[c].values = NULL;
    ehd_status status = csv_open(&file, path, error);
    if (!status && !places) status = place_no_memory(error, path);
    if (!status) status = find_columns(places, &width, &file, columns, num_columns, error);
    if (!status) status = read_lines(columns, num_columns, count, &file, places, width, error);
    for (size_t c = 0; c < num_columns && status; c++) {
        free(columns[c].values);
        columns[c].values = NULL;
    }
    csv_close(&file);
    free(places);
    return status;
}
