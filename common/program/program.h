/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What all programs share: the command line, messages, progress, interruption, and the build's
 * version. */
#ifndef EHD_PROGRAM_H
#define EHD_PROGRAM_H

#include "common/program/status.h"
#include "common/program/text.h"
#include <argp.h>
#include <stdbool.h>
#include <stddef.h>

/* Filled by the common options: --quiet --verbose --set --force --check FILE --print FILE -o
 * FILE. */
typedef struct program {
    const char *name; // "fullrun"
    int argc;         // as main received them, for the history line
    char **argv;
    bool quiet;
    bool verbose;
    bool force;
    const char *output;     // -o, --output; NULL when not given
    const char *check;      // --check FILE; NULL when not given
    const char *print;      // --print FILE, the arguments are names in it; NULL when not given
    const char **overrides; // --set key=value, in order; [num_overrides]
    size_t num_overrides;
    const char **arguments; // positional; [num_arguments]
    size_t num_arguments;
} program;

/* One group of options: a program adds its own to the common ones. Its `parse` gets the same
 * (key, argument, state) as an argp parser; `state->input` is the program's own options struct. */
typedef struct program_options {
    const struct argp_option *options;   // ends with {0}; keys below 0x100 or from 0x200 on
    argp_parser_t parse;                 // NULL when the program has no own options
    void *own;                           // handed to parse as state->input
    const char *arguments_doc;           // "SCENE.yml -o result.h5"
    const char *doc;                     // what the program does
    void (*help_tail)(void);             // prints more help to stdout (settings table), may be NULL
    size_t min_arguments, max_arguments; // positional ones (any number with --print)
    bool needs_output;                   // -o is demanded (not with --check, --print)
} program_options;

/* Parses the command line. --help and --version print to stdout and exit with 0; misuse prints
 * one line to stderr and exits with 64. Also sets the C locale and one OpenBLAS thread, and
 * catches SIGINT and SIGTERM. The result is freed with program_finish. */
void program_start(program *program, int argc, char **argv, const program_options *options);

/* Prints error->text after "name: " when status is not EHD_OK and text is not empty; frees; flushes
 * stdout and turns a failed write there into EHD_IO. Returns the exit code for main. */
int program_finish(program *program, ehd_status status, const ehd_error *error);

/* A message line "name: ..." on stderr: notes unless --quiet, details only with --verbose. */
void program_note(const program *program, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
void program_detail(const program *program, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/* A warning is shown with --quiet too. */
void program_warn(const program *program, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Progress of long work: "name: 37/120 M=12 L=7, 4 s left". On a terminal one line that is
 * rewritten; otherwise a line at most every two seconds, and the last one. Silent with --quiet. */
typedef struct progress {
    const program *program;
    size_t total;
    double started;    // s, monotonic
    double last_shown; // s, monotonic; -inf before the first line
    bool terminal;
} progress;
void progress_start(progress *progress, const program *program, size_t total);
void progress_show(progress *progress, size_t done, const char *current);
void progress_finish(progress *progress);

/* True after SIGINT or SIGTERM; a second signal ends the process at once with 130. */
bool program_interrupted(void);

/* Bytes of memory available to this process: what the system has free, within the process's limit;
 * infinite where neither is known. */
double program_memory(void);

/* Monotonic seconds. */
double program_seconds(void);

/* Version, git revision, compiler, flags and library versions of this build, one line. */
const char *program_build(void);

#endif
