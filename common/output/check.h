/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Implements --check FILE for every program. */
#ifndef EHD_CHECK_H
#define EHD_CHECK_H

#include "common/artefact/artefact.h"
#include "common/program/program.h"

/* Reader of one kind of file. */
typedef struct output_reader {
    const artefact_schema *kind;
    ehd_status (*read)(const char *path, ehd_error *error);
} output_reader;

/* Checks that a file is a whole and valid artefact and can be read by the programs. A result is
 * always read. Any other kind is read by the entry of `readers` for this kind, if there is one,
 * after its grid (a table of cases has no grid). `readers` ends with {0}; NULL: none. Errors are
 * those of reading the file: EHD_DATA, EHD_NOINPUT, EHD_MEMORY, EHD_IO. */
ehd_status output_check_file(const char *path, const output_reader *readers, ehd_error *error);

/* Checks the file caller->check with output_check_file. Prints nothing if it is valid, else one
 * line with the error. Frees the program and returns the exit code for main: 0, 65, 66, 71 or
 * 74. */
int output_check(program *caller, const output_reader *readers);

#endif
