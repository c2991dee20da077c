/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/settings/csv.h"

#include "common/program/text.h"
#include "common/settings/yaml_tree.h"
#include <stdbool.h>
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

/* The columns of the header, and which of them has the name. */
static ehd_status find_column(size_t *found, size_t *num_columns, csv_file *self,
                              const char *column, ehd_error *error) {
    char shown[SHOWN_TEXT];
    char *line = csv_next_line(self);
    bool known = false;
    *num_columns = 0;
    text_show(shown, column);
    if (!line)
        return place_fail(error, (place){self->path, 0},
                          "found an empty file, expected a header such as T,%s", shown);
    for (char *field; (field = csv_next_field(&line)); ++*num_columns) {
        if (known || strcmp(field, column) != 0) continue;
        *found = *num_columns;
        known = true;
    }
    if (known) return EHD_OK;
    return place_fail(error, self->where,
                      "found no column %s in the header, expected it beside the time", shown);
}

static ehd_status read_number(double *value, const csv_file *self, const char *field,
                              ehd_error *error) {
    char shown[SHOWN_TEXT];
    if (number_read(value, field)) return EHD_OK;
    text_show(shown, field);
    return place_fail(error, self->where, "found %s, expected a number", shown);
}

static ehd_status read_row(double *first, double *value, const csv_file *self, char *line,
                           size_t column, size_t num_columns, ehd_error *error) {
    ehd_status status = EHD_OK;
    size_t i = 0;
    for (char *field; !status && (field = csv_next_field(&line)); i++) {
        if (i == 0) status = read_number(first, self, field, error);
        if (i == column && !status) status = read_number(value, self, field, error);
    }
    return status ? status : csv_check_width(self, i, num_columns, error);
}

static ehd_status read_rows(double **first, double **values, size_t *count, csv_file *self,
                            size_t column, size_t num_columns, ehd_error *error) {
    const size_t room = csv_count_lines(self);
    ehd_status status = EHD_OK;
    *first = malloc(room * sizeof **first);
    *values = malloc(room * sizeof **values);
    if (!*first || !*values) return place_no_memory(error, self->path);
    for (char *line; !status && (line = csv_next_line(self)); ++*count)
        status =
            read_row(*first + *count, *values + *count, self, line, column, num_columns, error);
    return status;
}

ehd_status csv_read_columns(const char *path, const char *column, double **first, double **values,
                            size_t *count, ehd_error *error) {
    csv_file file;
    size_t found = 0, num_columns = 0;
    *first = *values = NULL;
    *count = 0;
    ehd_status status = csv_open(&file, path, error);
    if (!status) status = find_column(&found, &num_columns, &file, column, error);
    if (!status) status = read_rows(first, values, count, &file, found, num_columns, error);
    if (status) {
        free(*first);
        free(*values);
        *first = *values = NULL;
    }
    csv_close(&file);
    return status;
}
