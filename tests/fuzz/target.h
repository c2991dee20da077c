/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Declares the fuzz targets. Each target passes arbitrary bytes to the programs as a file. */
#ifndef FUZZ_TARGET_H
#define FUZZ_TARGET_H

#include "common/artefact/artefact.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { MAX_BASES = 4, MAX_COMMANDS = 12 };
#define FUZZ_OUTPUT "out.h5" // output of all commands

typedef struct fuzz_target {
    const char *name;
    // The bytes are the file itself, or a text with edits (edit.h, flat_edit.h) of a valid file. In
    // such a text, "base N" chooses the valid file.
    const char *file;              // name of the file, such as "work.h5"; NULL: no file
    const char *bases[MAX_BASES];  // valid files to edit; NULL: the bytes are the file
    const artefact_schema *schema; // schema of the bases; NULL: they have no schema
    bool flat;                     // the bases are flat models, edited by flat_edit.h
    // "run N" chooses a command; the default is the second command, or the only command
    const char *commands[MAX_COMMANDS];
    // replaces the commands: reads the bytes and returns a status
    ehd_status (*read)(const char *bytes, size_t length, ehd_error *error);
} fuzz_target;

extern const fuzz_target fuzz_targets[]; // ends with {0}

/* Returns the target of this name; NULL if there is none. */
const fuzz_target *fuzz_find(const char *name);

/* Prepares fuzz_run. Call it once, in a folder with the valid files (with-bases.sh). From then on
 * standard output and error belong to the programs. Complaints of fuzz_run and reports of
 * sanitizers go to `standard_error`, a duplicate of the original standard error. */
void fuzz_start(int standard_error);

/* Runs a target. Returns the exit code of the command that "run N" chooses, or the status of
 * `read`; EHD_INTERNAL if HDF5 could not make the edits (edit_file), so that nothing was tested.
 * Ends the process (abort) in four cases: a program exits with a code that no file may cause, fails
 * without a line, prints anything but its own lines, or fails and leaves an output. */
int fuzz_run(const fuzz_target *target, const uint8_t *bytes, size_t length);

// ---- parts of fuzz_run

/* Runs a command of a program and returns its exit code. Complains if the program fails without a
 * line, or prints lines that do not start with its name. */
int fuzz_call(const char *command);
/* Returns the messages of the last command, up to 4095 bytes, valid until the next call. */
const char *fuzz_said(void);
/* Prints a complaint and ends the process (abort). */
_Noreturn void fuzz_complain(const char *command, int code, const char *found, const char *text);

#endif
