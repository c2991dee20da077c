/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Outcomes that all functions and programs share. A status value is also the exit code. */
#ifndef EHD_STATUS_H
#define EHD_STATUS_H

typedef enum ehd_status {
    EHD_OK = 0,
    EHD_NOT_CONVERGED = 3, // an outcome, no error, but the result must not be used
    EHD_UNTRUSTED = 4,     // solved, but outside of the range for which the model was made or
                           // checked
    EHD_USAGE = 64,        // wrong command line (sysexits.h from here on)
    EHD_DATA = 65,         // bad data or setting
    EHD_NOINPUT = 66,      // input file missing or unreadable
    EHD_UNAVAILABLE = 69,  // an optional program or package is missing
    EHD_INTERNAL = 70,     // a library failed in a way that should not happen
    EHD_MEMORY = 71,       // out of memory
    EHD_CANTCREATE = 73,   // output cannot be created, or exists without --force
    EHD_IO = 74,           // reading or writing failed midway
    EHD_INTERRUPTED = 130  // Ctrl-C or SIGTERM
} ehd_status;

typedef struct ehd_error {
    char text[1024]; // one line "object: found X, expected Y", no newline, no program name
} ehd_error;

/* Writes the text (printf-style) into *error, which may be NULL, and returns `status`. Example:
 * if (bad) return ehd_fail(error, EHD_DATA, "grid.step: found %g, expected > 0", step); */
ehd_status ehd_fail(
    // output:
    ehd_error *error,
    // input:
    ehd_status status, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* Writes "object: out of memory" into *error, which may be NULL, and returns EHD_MEMORY. */
ehd_status ehd_no_memory(ehd_error *error, const char *object);

/* Shows clang-tidy, which reads one source at a time, that these functions return their status. */
#ifdef __clang_analyzer__
#define ehd_fail(error, status, ...) (ehd_fail(error, status, __VA_ARGS__), (status))
#define ehd_no_memory(...)           (ehd_no_memory(__VA_ARGS__), EHD_MEMORY)
#endif

#endif
