/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files of comma-separated values: fields without quotes, spaces around them dropped; blank lines and
 * those that start with # are skipped. */
#ifndef EHD_CSV_H
#define EHD_CSV_H

#include "common/program/status.h"
#include "common/settings/place.h"
#include <stddef.h>

typedef struct csv_file {
    char *path;
    char *text;  // cut into fields as it is read
    char *rest;  // of the text
    place where; // the line read last
} csv_file;

/* Takes the text into memory. EHD_NOINPUT, EHD_IO, EHD_DATA (too large, a zero byte), EHD_MEMORY. */
ehd_status csv_open(
    // output:
    csv_file *self, // free with csv_close, also after a failure
    // input:
    const char *path, ehd_error *error);

void csv_close(csv_file *self);

/* At least as many as there are lines left. */
size_t csv_count_lines(const csv_file *self);

/* Cuts off the next line that is not skipped; NULL at the end. It lives as long as the file. */
char *csv_next_line(csv_file *self);

/* Cuts the next field off a line, which *rest then goes on with; NULL after the last one. */
char *csv_next_field(char **rest);

/* EHD_DATA unless a line had as many fields as the header. */
ehd_status csv_check_width(const csv_file *self, size_t found, size_t expected, ehd_error *error);

/* Reads the first column and the one with the name `column` of a file of numbers below a header.
 * EHD_DATA: no header or no such column, rows of other lengths, anything that is no number; and as
 * csv_open. */
ehd_status csv_read_columns(
    // input:
    const char *path, const char *column,
    // output:
    double **first,  // [count], as `values`; free with free()
    double **values, // NULL both after a failure
    size_t *count, ehd_error *error);

#endif
