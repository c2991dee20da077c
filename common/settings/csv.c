/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/settings/csv.h"

#include "common/program/text.h"
#include "common/settings/yaml_tree.h"
#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_RECORD = 1 << 20 }; // bytes of a row; limits the search for the end of a quote

// ---- text

static size_t count_char(const char *text, char of) {
    size_t count = 0;
    for (; *text; text++)
        count += *text == of;
    return count;
}

static ehd_status found_zero(const csv_file *self, size_t line, ehd_error *error) {
    return place_fail(error, (place){self->path, line}, "found a zero byte, expected text");
}

/* Appends the next line of the stream to the text. *found is false if there is no further line. */
static ehd_status append_line(bool *found, csv_file *self, ehd_error *error) {
    const ssize_t length = getline(&self->line, &self->line_room, self->stream);
    *found = length > 0;
    if (length <= 0 && ferror(self->stream))
        return ehd_fail(error, EHD_IO, "%s: found an error while reading (%s)", self->path,
                        strerror(errno));
    if (length <= 0) return feof(self->stream) ? EHD_OK : ehd_no_memory(error, self->path);
    if (memchr(self->line, '\0', (size_t)length)) return found_zero(self, self->lines + 1, error);
    const size_t needed = self->length + (size_t)length + 1;
    if (needed > self->room) {
        char *grown = realloc(self->text, 2 * needed);
        if (!grown) return ehd_no_memory(error, self->path);
        self->text = grown;
        self->room = 2 * needed;
    }
    memcpy(self->text + self->length, self->line, (size_t)length + 1);
    self->length += (size_t)length;
    return EHD_OK;
}

/* Checks whether there is text at `at`, and reads a line of the stream if necessary. */
static ehd_status more_text(bool *found, csv_file *self, size_t at, ehd_error *error) {
    *found = at < self->length;
    return *found || !self->stream ? EHD_OK : append_line(found, self, error);
}

/* State of the scan of a record before its next character. */
typedef enum csv_state { FIELD_BEGINS, IN_FIELD, IN_QUOTES, QUOTE_MAY_END } csv_state;

static csv_state state_after(csv_state state, char next, const char *separators) {
    if (state == IN_QUOTES) return next == '"' ? QUOTE_MAY_END : IN_QUOTES;
    if (state == QUOTE_MAY_END && next == '"') return IN_QUOTES;
    if (strchr(separators, next)) return FIELD_BEGINS;
    if (state != FIELD_BEGINS) return IN_FIELD;
    return next == '"' ? IN_QUOTES : strchr(" \t\r", next) ? FIELD_BEGINS : IN_FIELD;
}

/* Finds the end of the record that begins at `start`. *end becomes the index of the record's line
 * break, or of the end of the text. If a quoted field spans several lines, the further lines are
 * read. */
static ehd_status find_end(size_t *end, csv_file *self, size_t start, const char *separators,
                           ehd_error *error) {
    csv_state state = FIELD_BEGINS;
    ehd_status status = EHD_OK;
    bool found = true;
    for (*end = start; !status && found; (*end)++) {
        if (!self->text[*end] || self->text[*end] == '\n') {
            self->lines++;
            if (state != IN_QUOTES) return EHD_OK;
            status = *end - start > MAX_RECORD ? EHD_OK : more_text(&found, self, *end + 1, error);
            found = found && *end - start <= MAX_RECORD;
        }
        if (found) state = state_after(state, self->text[*end], separators);
    }
    return status ? status
                  : place_fail(error, self->where,
                               "found a quote that does not end, expected its end");
}

/* Reads the next record that is neither blank nor a comment; *record is NULL at the end. */
static ehd_status next_record(char **record, csv_file *self, const char *separators,
                              ehd_error *error) {
    ehd_status status = EHD_OK;
    bool found = true;
    *record = NULL;
    while (!status && !*record) {
        if (self->stream && self->at >= self->length) self->at = self->length = 0;
        status = more_text(&found, self, self->at, error);
        if (status || !found) return status;
        const char *start = self->text + self->at;
        const char first = start[strspn(start, " \t\r")];
        size_t end = self->at + strcspn(start, "\n");
        const bool skipped = !first || first == '\n' || first == '#';
        self->where.line = self->lines + 1;
        if (skipped)
            self->lines++;
        else
            status = find_end(&end, self, self->at, separators, error);
        if (status) return status;
        self->ended = self->text[end] == '\n';
        self->text[end] = '\0';
        if (!skipped) *record = self->text + self->at;
        self->bytes += end - self->at + self->ended;
        self->at = end + 1;
    }
    return status;
}

/* Removes the quotes around a field that starts with a quote, and replaces each doubled quote in
 * the field by a single quote. Any other quotes are left as part of the field. Returns the end of
 * the field: a separator or the end of the record. */
static char *unquote(char *field, char separator) {
    const char stops[] = {separator, '\0'};
    char *from = field + 1, *to = field;
    for (; *from && (*from != '"' || from[1] == '"'); from++)
        from += *from == '"';
    char *end = *from ? from + 1 : from;
    while (*end && *end != separator && strchr(" \t\r", *end))
        end++;
    if (!*from || (*end && *end != separator)) return field + strcspn(field, stops);
    for (const char *c = field + 1; c < from; c++) {
        c += *c == '"';
        *to++ = *c;
    }
    *to = '\0';
    return end;
}

/* Returns the next field of a record, or NULL after the last field. *rest moves on to the rest of
 * the record. */
static char *next_field(char **rest, char separator) {
    if (!*rest) return NULL;
    const char stops[] = {separator, '\0'};
    char *field = *rest;
    while (*field && *field != separator && strchr(" \t", *field))
        field++;
    char *end = field + strcspn(field, stops);
    const bool quoted = *field == '"';
    if (quoted) end = unquote(field, separator);
    *rest = *end ? end + 1 : NULL;
    *end = '\0';
    for (end = field + strlen(field); end > field && strchr(" \t\r", end[-1]);)
        *--end = '\0';
    return field;
}

// ---- header

static int compare_names(const void *left, const void *right) {
    return strcmp(*(char *const *)left, *(char *const *)right);
}

/* Checks that no two columns have the same name. Several columns may have no name, because no
 * column is looked up by an empty name. */
static ehd_status check_once(const csv_file *self, ehd_error *error) {
    char shown[SHOWN_TEXT], all[NAMES_TEXT];
    const char *again = NULL;
    char **sorted = malloc(self->width * sizeof *sorted);

    if (!sorted) return ehd_no_memory(error, self->path);
    memcpy(sorted, self->names, self->width * sizeof *sorted);
    qsort(sorted, self->width, sizeof *sorted, compare_names);
    for (size_t i = 1; i < self->width && !again; i++)
        if (*sorted[i] && strcmp(sorted[i], sorted[i - 1]) == 0) again = sorted[i];
    free(sorted);
    if (!again) return EHD_OK;
    text_show(shown, again);
    table_show_columns(all, self->names, self->width);
    return place_fail(error, self->where, "%s: found again in the columns %s, expected only once",
                      shown, all);
}

/* Returns the separator: a comma if the header has one outside of quotes, otherwise a semicolon or
 * a tab. */
static char separator_of(const char *header) {
    const char all[] = ",;\t";
    bool has[sizeof all] = {false};
    csv_state state = FIELD_BEGINS;
    for (; *header; header++) {
        const char *found = state == IN_QUOTES ? NULL : strchr(all, *header);
        if (found) has[found - all] = true;
        state = state_after(state, *header, all);
    }
    for (size_t i = 0; all[i]; i++)
        if (has[i]) return all[i];
    return ',';
}

/* Cuts off the unit in brackets or parentheses at the end of a name. Returns the unit; NULL: there
 * is none, or it is "1" or "-". */
static char *take_unit(char *name) {
    const size_t length = strlen(name); // NOLINT: all names are set
    const char last = length > 0 ? name[length - 1] : '\0';
    char *open = last == ']' ? strrchr(name, '[') : last == ')' ? strrchr(name, '(') : NULL;

    if (!open || open == name || open + 2 > name + length - 1) return NULL;
    name[length - 1] = *open = '\0';
    for (char *end = open; end > name && strchr(" \t", end[-1]);)
        *--end = '\0';
    return strcmp(open + 1, "-") == 0 || strcmp(open + 1, "1") == 0 ? NULL : open + 1;
}

static ehd_status read_header(csv_file *self, ehd_error *error) {
    char *record = NULL;
    const ehd_status status = next_record(&record, self, ",;\t", error);
    if (status) return status;
    if (!record)
        return place_fail(error, (place){self->path, 0}, "found an empty file, expected a header");
    self->separator = separator_of(record);
    const size_t room = count_char(record, self->separator) + 1;
    self->names = calloc(room, sizeof *self->names);
    self->units = calloc(room, sizeof *self->units);
    self->fields = malloc(room * sizeof *self->fields);
    if (!self->names || !self->units || !self->fields) return ehd_no_memory(error, self->path);
    for (char *field; (field = next_field(&record, self->separator));)
        self->names[self->width++] = field;
    if (self->stream) { // the next rows must not overwrite the names
        self->header = self->text;
        self->text = NULL;
        self->at = self->length = self->room = 0;
    }
    const ehd_status once = check_once(self, error); // of names with their units
    for (size_t i = 0; i < self->width && !once; i++)
        self->units[i] = take_unit(self->names[i]);
    return once;
}

static const char byte_order_mark[] = "\xef\xbb\xbf";

static ehd_status begin(csv_file *self, const char *path, ehd_error *error) {
    *self = (csv_file){.path = strdup(path)};
    if (!self->path) return ehd_no_memory(error, path);
    self->where.file = self->path;
    return EHD_OK;
}

ehd_status csv_open(csv_file *self, const char *path, ehd_error *error) {
    ehd_status status = begin(self, path, error);
    if (!status) status = tree_read_text(&self->text, &self->length, path, error);
    if (status) return status;
    if (strlen(self->text) != self->length)
        return found_zero(self, count_char(self->text, '\n') + 1, error);
    self->at = strncmp(self->text, byte_order_mark, 3) == 0 ? 3 : 0;
    return read_header(self, error);
}

ehd_status csv_open_rows(csv_file *self, const char *path, ehd_error *error) {
    bool found = false;
    ehd_status status = begin(self, path, error);
    if (!status) status = tree_open(&self->stream, path, error);
    if (!status) status = more_text(&found, self, 0, error);
    if (status) return status;
    if (found && strncmp(self->text, byte_order_mark, 3) == 0) self->at = self->bytes = 3;
    return read_header(self, error);
}

void csv_close(csv_file *self) {
    if (self->stream) fclose(self->stream);
    free(self->path);
    free(self->text);
    free(self->line);
    free(self->header);
    free(self->names);
    free(self->units);
    free(self->fields);
    *self = (csv_file){0};
}

void table_show_columns(char shown[NAMES_TEXT], char *const *names, size_t count) {
    char name[SHOWN_TEXT];
    size_t used = 0;
    *shown = '\0';
    for (size_t i = 0; i < count; i++) {
        if (*names[i]) // NOLINT: all of them are set
            text_show(name, names[i]);
        else
            strcpy(name, "(no name)");
        const bool fits = used + strlen(name) + sizeof ", , ..." <= NAMES_TEXT;
        used += (size_t)snprintf(shown + used, NAMES_TEXT - used, "%s%s", i > 0 ? ", " : "",
                                 fits ? name : "...");
        if (!fits) return;
    }
}

// ---- rows

size_t csv_count_rows(const csv_file *self) {
    return count_char(self->text + self->at, '\n') + 1;
}

void csv_take_decimal_comma(const csv_file *self, size_t column) {
    char *comma = self->separator == ',' ? NULL : strchr(self->fields[column], ',');
    double number;

    if (!comma) return;
    *comma = '.';
    if (!number_read(&number, self->fields[column])) *comma = ',';
}

ehd_status csv_next_row(bool *found, csv_file *self, ehd_error *error) {
    const char separators[] = {self->separator, '\0'};
    char *record = NULL;
    size_t count = 0;
    const ehd_status status = next_record(&record, self, separators, error);
    *found = record != NULL;
    if (!record) return status;
    for (char *field; (field = next_field(&record, self->separator)); count++)
        if (count < self->width) self->fields[count] = field;
    if (count == self->width) return EHD_OK;
    return place_fail(error, self->where, "found %zu column%s, expected %zu as in the header",
                      count, count == 1 ? "" : "s", self->width);
}

// ---- numbers

enum { NO_COLUMN = -1 };

void table_show_names(char shown[SHOWN_TEXT], const char *const *names) {
    char all[2 * SHOWN_TEXT] = "";
    for (size_t i = 0; names[i]; i++)
        snprintf(all + strlen(all), sizeof all - strlen(all), "%s%s", i > 0 ? "|" : "", names[i]);
    text_show(shown, all);
}

/* Returns the index of a name in the list, or the length of the list if it is not there. */
static int rank_of(const char *name, const char *const *names) {
    int rank = 0;
    while (names[rank] && strcmp(name, names[rank]) != 0)
        rank++;
    return rank;
}

/* Finds the index of a column in the table; NO_COLUMN if an optional column is missing. */
static ehd_status find_column(int *place_of, const csv_file *self, const table_column *column,
                              ehd_error *error) {
    char shown[SHOWN_TEXT], all[NAMES_TEXT];
    const int none = rank_of("", column->names); // the rank of any name that is not in the list
    int best = none, count = 0;
    bool again = false; // two columns have the best name, with different units
    *place_of = NO_COLUMN;
    for (size_t i = 0; i < self->width; i++) {
        const int rank = rank_of(self->names[i], column->names);
        count += rank < none;
        if (rank == best && rank < none) again = true;
        if (rank >= best) continue;
        again = false;
        best = rank;
        *place_of = (int)i;
    }
    const bool several = again || (column->alone && count > 1);
    if (!several && (count > 0 || column->optional)) return EHD_OK;
    table_show_names(shown, column->names);
    table_show_columns(all, self->names, self->width);
    return place_fail(error, self->where, "found the columns %s, expected %s column %s", all,
                      several ? "only one" : "a", shown);
}

static ehd_status read_row(table_column *columns, size_t num_columns, size_t row,
                           const csv_file *self, const int *places, ehd_error *error) {
    char name[SHOWN_TEXT], shown[SHOWN_TEXT];
    for (size_t c = 0; c < num_columns; c++) {
        if (places[c] == NO_COLUMN) continue;
        const char *field = self->fields[places[c]];
        csv_take_decimal_comma(self, (size_t)places[c]);
        if (number_read(&columns[c].values[row], field)) continue;
        text_show(name, self->names[places[c]]);
        text_show(shown, field);
        return place_fail(error, self->where, "%s: found %s, expected a number", name, shown);
    }
    return EHD_OK;
}

static ehd_status read_rows(table_column *columns, size_t num_columns, size_t *count,
                            csv_file *self, const int *places, ehd_error *error) {
    const size_t room = csv_count_rows(self);
    ehd_status status = EHD_OK;
    bool found = true;
    for (size_t c = 0; c < num_columns; c++) {
        if (places[c] == NO_COLUMN) continue;
        columns[c].values = malloc(room * sizeof(double));
        if (!columns[c].values) return ehd_no_memory(error, self->path);
    }
    while (!status && !(status = csv_next_row(&found, self, error)) && found)
        status = read_row(columns, num_columns, (*count)++, self, places, error);
    return status;
}

ehd_status csv_read_table(const char *path, table_column *columns, size_t num_columns,
                          size_t *count, ehd_error *error) {
    csv_file file;
    int *places = malloc((num_columns + 1) * sizeof *places);
    *count = 0;
    for (size_t c = 0; c < num_columns; c++)
        columns[c].values = NULL;
    ehd_status status = csv_open(&file, path, error);
    if (!status && !places) status = ehd_no_memory(error, path);
    for (size_t c = 0; c < num_columns && !status; c++)
        status = find_column(&places[c], &file, &columns[c], error);
    if (!status) status = read_rows(columns, num_columns, count, &file, places, error);
    for (size_t c = 0; c < num_columns && !status; c++) {
        const char *unit = places[c] == NO_COLUMN ? NULL : file.units[places[c]];
        snprintf(columns[c].unit, UNIT_TEXT, "%s", unit ? unit : "");
    }
    for (size_t c = 0; c < num_columns && status; c++) {
        free(columns[c].values);
        columns[c].values = NULL;
    }
    csv_close(&file);
    free(places);
    return status;
}
