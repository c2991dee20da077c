/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads tables of comma-separated values: a header with the names of the columns, then one row per
 * line. If the header has no commas, semicolons or tabs separate the columns. A name or value may
 * stand in double quotes (RFC 4180), which may span lines. Spaces around fields are dropped; blank
 * lines and lines that start with # are skipped. */
#ifndef EHD_CSV_H
#define EHD_CSV_H

#include "common/program/status.h"
#include "common/program/text.h"
#include "common/settings/place.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

typedef struct csv_file {
    char *path;
    FILE *stream; // read row by row; NULL: the whole file is in `text`
    char *text;   // the whole file, or the row read last; `names` and `fields` point into it
    // of `text`: its bytes, the bytes allocated, and the first byte not yet parsed
    size_t length, room, at;
    char *line; // buffer for getline
    size_t line_room;
    char *header;   // text that `names` point into, if the file is read row by row
    size_t lines;   // parsed so far
    size_t bytes;   // bytes of the file parsed so far
    bool ended;     // the last row ended with a line break, not with the file
    place where;    // first line of the last row
    char separator; // between columns
    size_t width;   // number of columns
    char **names;   // [width], "" where a column has no name
    // [width], values of the row read last; valid until csv_close or, with csv_open_rows, the next
    // row
    char **fields;
} csv_file;

/* Reads a file into memory and parses its header. EHD_NOINPUT, EHD_IO, EHD_MEMORY. EHD_DATA: the
 * file is too large, has a zero byte or no header, or a name comes twice. */
ehd_status csv_open(
    // output:
    csv_file *self, // free with csv_close, also after a failure
    // input:
    const char *path, ehd_error *error);

/* Opens a file of any length like csv_open. Only one row is in memory, and its values are valid
 * until the next row is read. */
ehd_status csv_open_rows(csv_file *self, const char *path, ehd_error *error);

void csv_close(csv_file *self);

/* Returns an upper bound on the number of rows left, after csv_open. */
size_t csv_count_rows(const csv_file *self);

/* Reads the next row into `fields`. *found is false after the last one. EHD_DATA: the number of
 * values is not the number of columns, or a quote does not end. */
ehd_status csv_next_row(
    // output:
    bool *found,
    // in and out:
    csv_file *self,
    // output:
    ehd_error *error);

/* A column to read from a table of numbers, CSV or HDF5 (artefact/table.h). */
typedef struct table_column {
    const char *const *names; // possible names, NULL at the end; the first that exists is read
    bool optional;
    bool alone;     // in CSV: refused if several of the names exist
    double *values; // [count], free with free(); NULL: the column is missing, or after a failure
} table_column;

enum { NAMES_TEXT = 320 }; // bytes, with the closing zero

/* Lists the columns of a table for messages: "T, load, speed", the end of a long list as "...". */
void table_show_columns(char shown[NAMES_TEXT], char *const *names, size_t count);

/* Joins names for messages: "row|rows". */
void table_show_names(char shown[SHOWN_TEXT], const char *const *names);

/* Reads columns of a file of numbers by their names; the values of other columns are ignored.
 * EHD_DATA: no such column, or several; a value that is not a finite number. Other errors are
 * those of csv_open and csv_next_row. */
ehd_status csv_read_table(
    // input:
    const char *path,
    // in and out:
    table_column *columns, size_t num_columns,
    // output:
    size_t *count, ehd_error *error);

#endif
