/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The source location of a setting, for error messages. */
#ifndef EHD_PLACE_H
#define EHD_PLACE_H

#include "common/program/status.h"
#include <stddef.h>

typedef struct place {
    const char *file; // or "--set"; NULL when unknown
    size_t line;      // line number, from 1; 0: the line is not known
} place;

/* Fails like ehd_fail with EHD_DATA. Writes "file:line: " before the text, as far as known. */
ehd_status place_fail(
    // output:
    ehd_error *error,
    // input:
    place where, const char *format, ...) __attribute__((format(printf, 3, 4)));

#ifdef __clang_analyzer__ // see status.h
#define place_fail(...) (place_fail(__VA_ARGS__), EHD_DATA)
#endif

/* Returns the path of `name` in the folder of `path`. An absolute `name` is returned as it is. The
 * caller frees the result with free(). Returns NULL without memory. */
char *path_beside(const char *path, const char *name);

#endif
