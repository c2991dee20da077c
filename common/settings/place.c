/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/settings/place.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#undef place_fail
ehd_status place_fail(ehd_error *error, place where, const char *format, ...) {
    ehd_error text;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text.text, sizeof text.text, format, arguments);
    va_end(arguments);
    if (!where.file) return ehd_fail(error, EHD_DATA, "%s", text.text);
    if (!where.line) return ehd_fail(error, EHD_DATA, "%s: %s", where.file, text.text);
    return ehd_fail(error, EHD_DATA, "%s:%zu: %s", where.file, where.line, text.text);
}

char *path_beside(const char *path, const char *name) {
    const char *slash = strrchr(path, '/');
    const size_t folder = *name == '/' || !slash ? 0 : (size_t)(slash - path) + 1;
    char *joined = malloc(folder + strlen(name) + 1);
    if (!joined) return NULL;
    memcpy(joined, path, folder);
    strcpy(joined + folder, name);
    return joined;
}
