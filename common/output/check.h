/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks files, for --check FILE of every program. */
#ifndef EHD_CHECK_H
#define EHD_CHECK_H

#include "common/artefact/artefact.h"
#include "common/program/status.h"

/* Reader of one kind of file. */
typedef struct output_reader {
    const artefact_schema *kind;
    ehd_status (*read)(const char *path, ehd_error *error);
} output_reader;

/* Checks that a file is a whole and valid artefact and that the programs can read it. A result is
 * always read. For any other kind of file the grid is read, except for a table of cases, which has
 * no grid. Then the entry of `readers` for this kind, if there is one, reads the file. `readers`
 * ends with {0} and may be NULL. Errors: EHD_DATA, EHD_NOINPUT, EHD_MEMORY, EHD_IO. */
ehd_status output_check(const char *path, const output_reader *readers, ehd_error *error);

#endif
