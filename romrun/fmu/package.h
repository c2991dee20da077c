/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes the zip of an FMU. Equal contents give equal bytes. */
#ifndef EHD_FMU_PACKAGE_H
#define EHD_FMU_PACKAGE_H

#include "common/program/status.h"
#include <stdbool.h>
#include <stddef.h>
#include <time.h>

typedef struct package_entry {
    const char *name;  // name in the zip
    const void *bytes; // content; NULL: the content is the file `path`
    size_t size;
    const char *path; // file with the content; NULL: the content is `bytes`
} package_entry;

/* Writes the zip to PATH.partial and renames this file to PATH. The entries are sorted by name and
 * all have the time `when` (UTC; 0: 1980, the earliest time in zips). EHD_CANTCREATE: PATH exists
 * without `force`, or cannot be created; EHD_NOINPUT: the file of an entry is missing; EHD_IO:
 * reading or writing fails; EHD_MEMORY. */
ehd_status package_write(const char *path, package_entry *entries, size_t num_entries, time_t when,
                         bool force, ehd_error *error);

#endif
