/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What all programs share: the command line, messages, progress, interruption, and the build's
 * version. */
#ifndef EHD_PROGRAM_H
#define EHD_PROGRAM_H

#include "common/program/stage.h"
#include "common/program/status.h"
#include "common/program/text.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* What an option's argument becomes. */
typedef enum option_type {
    AS_FLAG,  // bool, without argument
    AS_TEXT,  // const char *, as given
    AS_COUNT, // size_t, from min to max
    AS_REAL,  // double, from min to max
    AS_READ,  // by `read`
    AS_ALIAS  // another name of the option before, not in the help
} option_type;

/* An option of a program's own: a row of a table that parsing and --help follow from. */
typedef struct program_option {
    const char *name;     // "rows"
    int letter;           // 'j' for -j; 0: none
    const char *argument; // "N" in the help; NULL: none
    const char *help;
    option_type type;
    size_t member; // offset in the program's own options
    double min, max;
    /* EHD_USAGE where the member cannot be read from the argument. */
    ehd_status (*read)(void *member, const char *argument, ehd_error *error);
} program_option;

enum { MAX_OPTIONS = 24 };

// the last columns of such a row, of the struct that a program names OWN_OPTIONS
#define OPTION_FLAG(member)            AS_FLAG, offsetof(OWN_OPTIONS, member), 0, 0, NULL
#define OPTION_TEXT(member)            AS_TEXT, offsetof(OWN_OPTIONS, member), 0, 0, NULL
#define OPTION_COUNT(member, min, max) AS_COUNT, offsetof(OWN_OPTIONS, member), min, max, NULL
#define OPTION_REAL(member, min, max)  AS_REAL, offsetof(OWN_OPTIONS, member), min, max, NULL
#define OPTION_READ(member, function)  AS_READ, offsetof(OWN_OPTIONS, member), 0, 0, function

/* Filled by the common options: --quiet --verbose --set --force --check FILE --print FILE
 * --si --vtk FILE -o FILE. */
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
    bool si;                // in SI units, with --print
    const char *vtk;        // --vtk FILE, to `output`; NULL when not given
    const char **overrides; // --set key=value, in order; [num_overrides]
    size_t num_overrides;
    const char **arguments; // positional; [num_arguments]
    size_t num_arguments;
    const program_option *options; // the program's own
    unsigned given;                // a bit for each of them
    stage stage;                   // of a pipeline, where it is one
} program;

/* A program: its own options beside the common ones, and its arguments. */
typedef struct program_options {
    const program_option *options;       // ends with {0}; at most MAX_OPTIONS
    void *own;                           // that they are members of
    const char *arguments_doc;           // "SCENE.yml -o result.h5"
    const char *doc;                     // what the program does
    void (*help_tail)(void);             // prints more help to stdout (settings table), may be NULL
    size_t min_arguments, max_arguments; // positional ones (any number with --print)
    bool needs_output; // -o is demanded (not with --check, --print; always with --vtk)
} program_options;

/* Parses the command line. --help and --version print to stdout and exit with 0; misuse prints
 * one line to stderr and exits with 64. Also sets the C locale and one OpenBLAS thread, and
 * catches SIGINT and SIGTERM. The result is freed with program_finish. */
void program_start(program *program, int argc, char **argv, const program_options *options);

/* Whether an own option was on the command line, by its name. */
bool program_was_given(const program *program, const char *option);

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

/* Shows the progress of long work: "name: 37/120 M=12 L=7, 4 s left", and in a pipeline "; stage 1 of 5, about
 * 9 s in all" as far as that is known (stage.h). The time left is that of the items left, each as long as the mean
 * item, and at least the wait since the last item. On a terminal one line is rewritten; elsewhere a
 * line comes at most every two seconds, and one at the end. Nothing is shown with --quiet. */
typedef struct progress {
    const program *program;
    size_t total;
    double
        rest; // s, what comes behind it in the same stage; NAN: as the stage expects. 0 at the start
    bool more;         // behind that there may be more
    size_t done;       // as last told
    double started;    // s, monotonic
    double advanced;   // s, monotonic, when that last grew
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
/* EHD_MEMORY, with both numbers, where that is less than `bytes`, which `count` `things` of `part`
 * of an object take `with` (" with --jobs 4", or ""). To be asked before they are taken. */
ehd_status program_check_memory(const char *object, const char *part, size_t count,
                                const char *things, const char *with, double bytes,
                                ehd_error *error);

/* Monotonic seconds. */
double program_seconds(void);

/* Seconds of the processor that the calling thread has taken: what work takes however busy the machine is. */
double program_seconds_of_thread(void);

/* Opens a regular file to read; anything else might never answer. NULL with errno: EISDIR for a folder,
 * ENOTSUP for what else is no file. */
FILE *program_open(const char *path);

/* Version, git revision, compiler, flags and library versions of this build, one line. */
const char *program_build(void);

#endif
