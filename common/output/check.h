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

/* Whether caller->check is a whole and valid artefact, which the reader of its kind takes, if any
 * of `readers` (which end with {0}; NULL: none) is of that kind; results are read in any case, and
 * of all others the grid. Silent where it is; else one line says what is wrong. Frees the program
 * and returns the exit code for main: 0, or as where the file is read: 65, 66, 71, 74. */
int output_check(program *caller, const output_reader *readers);

#endif
