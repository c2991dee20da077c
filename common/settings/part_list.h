/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads a list of reduced models for parts of a region (schemas/models.md). */
#ifndef EHD_PART_LIST_H
#define EHD_PART_LIST_H

#include "common/program/status.h"
#include <stdbool.h>
#include <stddef.h>

enum { MAX_PARTS = 16 };

typedef struct part_list {
    size_t num;
    char *paths[MAX_PARTS]; // paths of models
} part_list;

/* Checks whether a file is a list of models: the name of a list ends with ".yml" or ".yaml". */
bool part_list_is(const char *path);

/* Reads a list of models. If the file is not a list, the result is a list with this file alone.
 * Errors: EHD_NOINPUT, EHD_IO, EHD_DATA, EHD_MEMORY. */
ehd_status part_list_read(
    // output:
    part_list *self, // free with part_list_free, also after a failure
    // input:
    const char *path, ehd_error *error);
void part_list_free(part_list *self);

#endif
