/* SPDX-License-Identifier: GPL-3.0-or-later */
/* --check FILE, the same in every program. */
#ifndef EHD_CHECK_H
#define EHD_CHECK_H

#include "common/artefact/artefact.h"
#include "common/program/program.h"

/* How a kind of file is read by the programs that take it. */
typedef struct output_reader {
    const artefact_schema *kind;
    ehd_status (*read)(const char *path, ehd_error *error);
} output_reader;

/* Whether a file is a whole and valid artefact, which the reader of its kind takes, if any of `readers`
 * (which end with {0}; NULL: none) is of that kind; results are read in any case, and of all others
 * the grid. Errors as where the file is read: EHD_DATA, EHD_NOINPUT, EHD_MEMORY, EHD_IO. */
ehd_status output_check_file(const char *path, const output_reader *readers, ehd_error *error);

/* The same of caller->check. Silent where it is; else one line says what is wrong. Frees the program
 * and returns the exit code for main: 0, 65, 66, 71 or 74. */
int output_check(program *caller, const output_reader *readers);

#endif
