/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The zip of an FMU: the same contents give the same bytes. */
#ifndef EHD_FMU_PACKAGE_H
#define EHD_FMU_PACKAGE_H

#include "common/program/status.h"
#include <stdbool.h>
#include <stddef.h>
#include <time.h>

typedef struct package_entry {
    const char *name;  // in the zip
    const void *bytes; // NULL: of the file
    size_t size;
    const char *path; // a file that is taken; NULL: the bytes
} package_entry;

/* Writes PATH.partial and renames it, with the entries in the order of their names, all of the time
 * `when` (UTC; 0: 1980, the first that a zip knows). EHD_CANTCREATE: PATH exists, and not `force`,
 * or it cannot be created; EHD_NOINPUT, EHD_IO: an entry's file; EHD_MEMORY. */
ehd_status package_write(const char *path, package_entry *entries, size_t num_entries, time_t when,
                         bool force, ehd_error *error);

#endif
