/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes output files other than HDF5. A file is called NAME.partial until it is finished. */
#ifndef EHD_OUTPUT_FILE_H
#define EHD_OUTPUT_FILE_H

#include "common/program/status.h"
#include <stdbool.h>
#include <stdio.h>

typedef struct output_file {
    FILE *stream; // for writing; output_file_finish reports failures
    char *path, *partial;
} output_file;

/* Checks whether the output can be created; call it before the work. EHD_CANTCREATE: a file of this
 * name exists and `force` is not set; the existing file is no regular file; or the folder does not
 * exist or is not writable. EHD_MEMORY. */
ehd_status output_file_check(const char *path, bool force, ehd_error *error);

/* Checks that the output is not the same file as an input, even if the names differ. `inputs` ends
 * with NULL; NULL means no inputs. EHD_CANTCREATE: the output is an input. With `force` a program
 * replaces an earlier output, but never a file that it reads. */
ehd_status output_file_check_inputs(const char *path, const char *const *inputs, ehd_error *error);

/* Checks the output like output_file_check, and starts PATH.partial anew. EHD_CANTCREATE also if
 * PATH.partial cannot be created, or another process is writing it; EHD_IO, EHD_MEMORY. */
ehd_status output_file_create(
    // output:
    output_file *self, // give to output_file_finish or output_file_drop
    // input:
    const char *path, bool force, ehd_error *error);

/* Opens the output like output_file_create, but leaves the content of PATH.partial as it is. Call
 * output_file_keep next. */
ehd_status output_file_open(output_file *self, const char *path, bool force, ehd_error *error);

/* Keeps the first `kept` bytes of PATH.partial; later writes follow them. EHD_IO: the function has
 * then called output_file_leave. */
ehd_status output_file_keep(output_file *self, size_t kept, ehd_error *error);

/* Writes all data to the disk, gives the file its name, and frees `self`. EHD_IO: PATH.partial is
 * removed. */
ehd_status output_file_finish(output_file *self, ehd_error *error);

/* Leaves PATH.partial with what was written, and frees `self`. Does nothing if no file is open. */
void output_file_leave(output_file *self);

/* Removes PATH.partial and frees `self`. Does nothing if no file is open. */
void output_file_drop(output_file *self);

#endif
