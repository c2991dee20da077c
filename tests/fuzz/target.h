/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is fuzzed: a target takes any bytes and hands them to the programs as a file. */
#ifndef FUZZ_TARGET_H
#define FUZZ_TARGET_H

#include "common/artefact/artefact.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { MAX_BASES = 4, MAX_COMMANDS = 12 };
#define FUZZ_OUTPUT "out.h5" // of all commands

typedef struct fuzz_target {
    const char *name;
    // the bytes are the file, or edits (edit.h, flat_edit.h) of a valid one, led by lines "base N" and "run N"
    const char *file;                   // what it is called, "work.h5"; NULL: there is none
    const char *bases[MAX_BASES];       // valid files to edit; NULL: the bytes are the file
    const artefact_schema *schema;      // of these; NULL: none
    bool flat;                          // these are flat models, with edits of flat_edit.h
    const char *commands[MAX_COMMANDS]; // of which "run N" says one; where nothing does, the second
    // in place of commands: the status of what reads the bytes
    ehd_status (*read)(const char *bytes, size_t length, ehd_error *error);
} fuzz_target;

extern const fuzz_target fuzz_targets[]; // ends with {0}

/* NULL: none of this name. */
const fuzz_target *fuzz_find(const char *name);

/* To be called once, in a folder with the valid files (with-bases.sh), before fuzz_run. Standard output
 * and error are the programs' from then on; what fuzz_run complains of goes to `standard_error`, a
 * duplicate of it, and so do the sanitizers' reports. */
void fuzz_start(int standard_error);

/* Runs a target: the exit code of the command that "run N" names, or the status of its `read`; EHD_INTERNAL
 * where HDF5 could not make the edits (edit_file), which nothing is learned from. Ends the
 * process (abort) where a program ends with a code that no file must lead to, fails without a line that
 * says so or with anything else than such lines, or leaves an output all the same. */
int fuzz_run(const fuzz_target *target, const uint8_t *bytes, size_t length);

// ---- what that is made of

/* Runs a command of a program and returns its exit code; complains where what it says is not lines of the
 * program, or where it fails without one. */
int fuzz_call(const char *command);
/* What the last one said, up to a few kilobytes. */
const char *fuzz_said(void);
/* Says so, and ends the process. */
_Noreturn void fuzz_complain(const char *command, int code, const char *found, const char *text);

#endif
