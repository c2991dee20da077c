/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Declares the functions that all programs share: command line, messages, progress, interruption,
 * and the version of the build. */
#ifndef EHD_PROGRAM_H
#define EHD_PROGRAM_H

#include "common/program/stage.h"
#include "common/program/status.h"
#include "common/program/text.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* Type of an option's value. */
typedef enum option_type {
    AS_FLAG,  // bool, without argument
    AS_TEXT,  // const char *, as given
    AS_COUNT, // size_t, from min to max
    AS_REAL,  // double, from min to max
    AS_ENTRY, // pointer to an entry of `table`, found by its name
    AS_READ,  // any type, converted by `read`
    AS_ALIAS  // another name of the option in the row before, hidden in the help
} option_type;

/* An option that only this program has: a row of a table, from which parsing and --help follow. */
typedef struct program_option {
    const char *name;     // "rows"
    int letter;           // 'j' for -j; 0: the option has no letter
    const char *argument; // name of the argument in the help, such as "N"; NULL: no argument
    const char *help;
    option_type type;
    size_t member; // offset in the struct of the program's own options
    double min, max;
    const void *table; // as in entry_find, for AS_ENTRY
    size_t size;       // bytes of an entry
    /* Converts the argument, for AS_READ. EHD_USAGE: the argument is not valid. */
    ehd_status (*read)(void *member, const char *argument, ehd_error *error);
    unsigned modes; // bit i: mode i has the option; 0: all modes have it
} program_option;

enum { MAX_OPTIONS = 24, MAX_PROGRAM_MODES = 8 };

// Macros for the last columns of a row in a table of options; `.modes = …` may follow. Before it
// uses these macros, a program defines OWN_OPTIONS as the type of the struct of its own options.
#define OPTION_(kind, name)           .type = (kind), .member = offsetof(OWN_OPTIONS, name)
#define OPTION_FLAG(name)             OPTION_(AS_FLAG, name)
#define OPTION_TEXT(name)             OPTION_(AS_TEXT, name)
#define OPTION_COUNT(name, low, high) OPTION_(AS_COUNT, name), .min = (low), .max = (high)
#define OPTION_REAL(name, low, high)  OPTION_(AS_REAL, name), .min = (low), .max = (high)
#define OPTION_ENTRY(name, entries)                                                                \
    OPTION_(AS_ENTRY, name), .table = (entries), .size = sizeof *(entries)
#define OPTION_READ(name, function) OPTION_(AS_READ, name), .read = (function)

/* A program's arguments and the values of the common options --quiet --verbose --set --force
 * --check FILE --describe SCENE --print FILE --si --plot FILE --vtk FILE -o FILE. */
typedef struct program {
    const char *name; // "fullrun"
    int argc;         // as main received them, for the history of the output
    char **argv;
    bool quiet;
    bool verbose;
    bool force;
    const char *output;     // -o, --output; NULL when not given
    const char *check;      // --check FILE; NULL when not given
    const char *describe;   // --describe SCENE; NULL when not given
    const char *print;      // --print FILE; `arguments` are then names in FILE; NULL when not given
    bool si;                // --si, with --print: print in SI units
    const char *plot;       // --plot FILE, drawn into `output`; NULL when not given
    const char *vtk;        // --vtk FILE, written to `output`; NULL when not given
    const char **overrides; // --set key=value, in order; [num_overrides]
    size_t num_overrides;
    const char **arguments; // positional; [num_arguments], ended by NULL
    size_t num_arguments;
    const program_option *options;    // options that only this program has
    unsigned given;                   // bit i: options[i] was given
    const struct program_mode *modes; // NULL: the program has no modes
    size_t mode;                      // modes[mode] is the mode in use
    stage stage;                      // present stage, if the program runs in a pipeline
} program;

typedef enum output_use { OUTPUT_OPTIONAL, OUTPUT_NEEDED, OUTPUT_NONE } output_use;

/* A mode of a program, such as "romrun cases SCENE.yml CASES.csv". It is a row of a table, from
 * which usage, --help and refusals follow. The first argument chooses the mode. A hidden option
 * such as --cases, the earlier spelling, also chooses the mode. */
typedef struct program_mode {
    const char *word; // "cases"; NULL: the mode without a word, which is the first row
    // word, arguments and options, such as "cases SCENE.yml CASES.csv -m MODEL.h5". With the prefix
    // "  or:  romrun [OPTION...] " the text has at most 79 columns, since argp breaks longer lines
    const char *usage;
    const char *doc;                     // what the mode does
    size_t min_arguments, max_arguments; // without the word
    output_use output;
    bool option_has_argument; // true: the option of the same name takes the last argument
    /* Does the work. `own` are the program's own options. */
    ehd_status (*run)(const program *self, void *own, ehd_error *error);
} program_mode;

/* Description of a program: its own options and its arguments. */
typedef struct program_options {
    const program_option *options;       // ends with {0}; at most MAX_OPTIONS
    void *own;                           // struct whose members the options set
    const char *arguments_doc;           // "SCENE.yml -o result.h5"
    const char *doc;                     // what the program does
    void (*help_tail)(void);             // prints more help to stdout (settings table), may be NULL
    size_t min_arguments, max_arguments; // positional; --print takes any number
    bool needs_output; // -o is required (never with --check or --print, always with --vtk)
    // at most MAX_PROGRAM_MODES rows, then {0}; NULL: the program has no modes. With modes, the row
    // of a mode gives the usage, the number of arguments and the use of -o, instead of the members
    // above
    const program_mode *modes;
} program_options;

/* Parses the command line. --help and --version print to stdout and exit with 0; misuse prints one
 * line to stderr and exits with 64. Also sets the C locale and one OpenBLAS thread, and catches
 * SIGINT and SIGTERM. program_finish frees the result. */
void program_start(program *program, int argc, char **argv, const program_options *options);

/* Checks whether one of the program's own options was on the command line. `option` is its name. */
bool program_was_given(const program *program, const char *option);

/* Prints "name: " and error->text if status is not EHD_OK and the text is not empty. Frees the
 * lists of `program`. Flushes stdout; a failed write to stdout gives EHD_IO, unless status is an
 * error already. Returns the exit code for main. */
int program_finish(program *program, ehd_status status, const ehd_error *error);

/* Print a line "name: ..." to stderr. program_note prints nothing with --quiet; program_detail
 * prints only with --verbose. */
void program_note(const program *program, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
void program_detail(const program *program, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/* Prints a warning, even with --quiet. */
void program_warn(const program *program, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Shows the progress of long work: "name: 37/120 M=12 L=7, 4 s left". In a pipeline "; stage 1 of
 * 5, about 9 s in all" follows, without the time if it is not known (stage.h). The time left is the
 * number of items left times the mean time of an item, and at least the time since the last item
 * was done. On a terminal, one line is rewritten in place. Elsewhere a new line is printed at most
 * every two seconds, and at the end. Nothing is shown with --quiet. */
typedef struct progress {
    const program *program;
    size_t total;
    // duration of the work that follows in the same stage, s. progress_start sets `rest` to 0. NAN:
    // this duration is not known, so the expected duration of the stage is used
    double rest;
    bool more;         // more work of unknown duration may follow
    size_t done;       // items done at the last progress_show
    double started;    // s, monotonic
    double advanced;   // s, monotonic, time at which `done` last grew
    double last_shown; // s, monotonic; -inf before the first line
    bool terminal;
} progress;
void progress_start(progress *progress, const program *program, size_t total);
void progress_show(progress *progress, size_t done, const char *current);
void progress_finish(progress *progress);

/* Returns true after SIGINT or SIGTERM. A second signal ends the process at once with 130. */
bool program_interrupted(void);

/* Returns the bytes of memory available to this process: the free memory of the system or the limit
 * of the process, whichever is lower. Returns infinity if neither is known. */
double program_memory(void);
/* Checks that program_memory is at least `bytes`; call it before the memory is taken. EHD_MEMORY:
 * less memory is available. The message is "OBJECT: PART: found COUNT THINGS, which take about 900
 * MB WITH, expected at most 500 MB, which are free". `with` is " with --jobs 4" or "". */
ehd_status program_check_memory(const char *object, const char *part, size_t count,
                                const char *things, const char *with, double bytes,
                                ehd_error *error);

/* Returns the time of the monotonic clock in seconds. */
double program_seconds(void);

/* Returns the processor time of the calling thread in seconds. Unlike program_seconds, it does not
 * depend on how busy the machine is. */
double program_seconds_of_thread(void);

/* Opens a regular file for reading. Opening a file of another kind, such as a pipe, could wait
 * without end. Returns NULL with errno after a failure: EISDIR for a folder, ENOTSUP for other
 * files that are not regular. */
FILE *program_open(const char *path);

/* Returns version, git revision, compiler, flags and library versions of this build in one line. */
const char *program_build(void);

#endif
