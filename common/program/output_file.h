/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An output that is no HDF5 file: it appears under its name only when it is finished, and is
 * NAME.partial until then. */
#ifndef EHD_OUTPUT_FILE_H
#define EHD_OUTPUT_FILE_H

#include "common/program/status.h"
#include <stdbool.h>
#include <stdio.h>

typedef struct output_file {
    FILE *stream; // to write to; failures are seen by output_file_finish
    char *path, *partial;
} output_file;

/* EHD_CANTCREATE where the name exists and `force` is not set, may not be the program's, or lies in a folder that is not
 * there or not to be written; EHD_MEMORY. To be called before the work. */
ehd_status output_file_check(const char *path, bool force, ehd_error *error);

/* EHD_CANTCREATE where the output is one of the inputs (NULL at the end, or for none), by whatever name:
 * `force` replaces an earlier output, never what the program reads. */
ehd_status output_file_check_inputs(const char *path, const char *const *inputs, ehd_error *error);

/* The same check as output_file_check, and starts PATH.partial anew. EHD_CANTCREATE also where that cannot be created, or
 * another process is writing it; EHD_MEMORY. */
ehd_status output_file_create(
    // output:
    output_file *self, // give to output_file_finish or output_file_drop
    // input:
    const char *path, bool force, ehd_error *error);

/* As output_file_create, but leaves the content of PATH.partial as it is. output_file_keep comes next. */
ehd_status output_file_open(output_file *self, const char *path, bool force, ehd_error *error);

/* Keeps the first `kept` bytes; what is written comes behind them. EHD_IO. */
ehd_status output_file_keep(output_file *self, size_t kept, ehd_error *error);

/* Writes what is left, to the disk, and gives the file its name; EHD_IO, and no file. Frees. */
ehd_status output_file_finish(output_file *self, ehd_error *error);

/* Leaves PATH.partial with what was written, and frees; nothing where there is none. */
void output_file_leave(output_file *self);

/* Removes what was written, and frees; nothing where there is none. */
void output_file_drop(output_file *self);

#endif
