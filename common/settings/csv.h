/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads tables of comma-separated values: a header with the names of the columns, then one row per
 * line. Commas separate the columns; semicolons or tabs do so if the header has no comma. A name or
 * value may stand in double quotes (RFC 4180) and may then span several lines. Spaces around fields
 * are dropped; blank lines and lines that start with # are skipped. Numbers may have a decimal
 * comma if another character separates the columns. */
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
    FILE *stream; // the file if it is read row by row; NULL: the whole file is in `text`
    char *text;   // the whole file; if it is read row by row, only the row read last
    // `text`: number of bytes, number of allocated bytes, index of the first byte not yet parsed
    size_t length, room, at;
    char *line; // buffer for getline
    size_t line_room;
    char *header;   // the header line if the file is read row by row, else NULL
    size_t lines;   // lines parsed so far
    size_t bytes;   // bytes of the file parsed so far
    bool ended;     // whether the row read last ended with a line break, not with the file
    place where;    // first line of the row read last
    char separator; // between columns
    size_t width;   // number of columns
    // [width] pointers into `header` or, if it is NULL, into `text`; "" where a column has no name
    char **names;
    // [width] unit in brackets behind a name, as "N/mm" of "Fn [N/mm]", which `names` has without
    // the brackets; NULL: no unit
    char **units;
    // [width] values of the row read last, pointers into `text`. They are valid until csv_close; in
    // a file that is read row by row only until the next row is read
    char **fields;
} csv_file;

/* Reads a file into memory and parses its header. Returns EHD_DATA if the file is too large, has a
 * zero byte or no header, or if two columns have the same name. Other errors: EHD_NOINPUT, EHD_IO,
 * EHD_MEMORY. */
ehd_status csv_open(
    // output:
    csv_file *self, // free with csv_close, also after a failure
    // input:
    const char *path, ehd_error *error);

/* Opens a file of any length like csv_open. Only one row is in memory, and its values are valid
 * until the next row is read. */
ehd_status csv_open_rows(csv_file *self, const char *path, ehd_error *error);

void csv_close(csv_file *self);

/* Returns an upper bound on the number of unread rows of a file that csv_open has opened. */
size_t csv_count_rows(const csv_file *self);

/* Reads the next row into `fields`. *found is false after the last row. Returns EHD_DATA if the
 * number of values is not the number of columns, or if a quote does not end. */
ehd_status csv_next_row(
    // output:
    bool *found,
    // in and out:
    csv_file *self,
    // output:
    ehd_error *error);

enum { UNIT_TEXT = 32 }; // bytes, with the closing zero

/* Replaces a decimal comma of a field by a point, if the field is a number and another character
 * separates the columns. */
void csv_take_decimal_comma(const csv_file *self, size_t column);

/* A column to read from a table of numbers, CSV or HDF5 (artefact/table.h). */
typedef struct table_column {
    // possible names, NULL at the end; the first name that the table has is read
    const char *const *names;
    bool optional;
    bool alone;     // in CSV: the table is refused if it has several of these names
    double *values; // [count], free with free(); NULL if the column is missing, and after a failure
    char unit[UNIT_TEXT]; // unit in the header of the column; "": none
} table_column;

enum { NAMES_TEXT = 320 }; // bytes, with the closing zero

/* Lists the columns of a table for messages: "T, load, speed". In a long list "..." stands for the
 * last columns. */
void table_show_columns(char shown[NAMES_TEXT], char *const *names, size_t count);

/* Joins names for messages: "row|rows". */
void table_show_names(char shown[SHOWN_TEXT], const char *const *names);

/* Reads columns of a file of numbers by their names; the values of other columns are ignored.
 * Returns EHD_DATA if a required column is missing, if several columns match a column with `alone`,
 * or if a value is not a finite number. Other errors: see csv_open and csv_next_row. */
ehd_status csv_read_table(
    // input:
    const char *path,
    // in and out:
    table_column *columns, size_t num_columns,
    // output:
    size_t *count, ehd_error *error);

#endif
