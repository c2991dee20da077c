/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/program/status.h"

#include "common/program/text.h"

#include <stdarg.h>
#include <stdio.h>

#undef ehd_fail
ehd_status ehd_fail(ehd_error *error, ehd_status status, const char *format, ...) {
    if (error) {
        va_list arguments;
        va_start(arguments, format);
        vsnprintf(error->text, sizeof error->text, format, arguments);
        va_end(arguments);
        text_make_printable(error->text, "");
    }
    return status;
}

#undef ehd_no_memory
ehd_status ehd_no_memory(ehd_error *error, const char *object) {
    return ehd_fail(error, EHD_MEMORY, "%s: out of memory", object);
}
