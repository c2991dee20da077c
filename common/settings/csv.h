/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files of comma-separated values, without quotes. Spaces around fields are dropped; blank lines
 * and lines that start with # are skipped. */
#ifndef EHD_CSV_H
#define EHD_CSV_H

#include "common/program/status.h"
#include "common/program/text.h"
#include "common/settings/place.h"
#include <stdbool.h>
#include <stddef.h>

typedef struct csv_file {
    char *path;
    char *text;  // of the whole file; separators become zeros as it is read
    char *rest;  // the part of text not yet read
    place where; // of the line read last
} csv_file;

/* Reads the file into memory. EHD_NOINPUT, EHD_IO, EHD_DATA (too large, a zero byte),
 * EHD_MEMORY. */
ehd_status csv_open(
    // output:
    csv_file *self, // free with csv_close, also after a failure
    // input:
    const char *path, ehd_error *error);

void csv_close(csv_file *self);

/* An upper bound on the number of lines left. */
size_t csv_count_lines(const csv_file *self);

/* The next line that is not skipped, NULL at the end. It is valid until csv_close. */
char *csv_next_line(csv_file *self);

/* The next field of a line, NULL after the last one; *rest moves on to the rest of the line. */
char *csv_next_field(char **rest);

/* EHD_DATA unless a line had as many fields as the header. */
ehd_status csv_check_width(const csv_file *self, size_t found, size_t expected, ehd_error *error);

/* A column that is wanted of a table of numbers, CSV or HDF5 (artefact/table.h). */
typedef struct table_column {
    const char *const *names; // the first of these that there is, NULL at the end; NULL: the first
                              // column of the file
    bool optional;
    double *values; // [count] as read, free with free(); NULL: not there, or after a failure
} table_column;

/* "row|rows", for messages. */
void table_show_names(char shown[SHOWN_TEXT], const char *const *names);

/* Reads columns of a file of numbers below a header; of other columns nothing is looked at.
 * EHD_DATA: no header or no such column, lines of other lengths, anything that is no number; and as
 * csv_open. */
ehd_status csv_read_table(
    // input:
    const char *path,
    // in and out:
    table_column *columns, size_t num_columns,
    // output:
    size_t *count, ehd_error *error);

#endif
