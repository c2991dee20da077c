/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/program/program.h"

#include "common/program/openblas.h"
#include "common/program/processor.h"

#include <argp.h>
#include <cblas.h>
#include <errno.h>
#include <fcntl.h>
#include <fftw3.h>
#include <gsl/gsl_version.h>
#include <locale.h>
#include <math.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

// defaults for builds without the Makefile, which defines these macros
#ifndef EHD_VERSION
#define EHD_VERSION "0.0.0"
#endif
#ifndef EHD_REVISION
#define EHD_REVISION "unknown"
#endif
#ifndef EHD_FLAGS
#define EHD_FLAGS "unknown"
#endif

// ---- the build

const char *program_build(void) {
    static char build[1024];
    // openblas_get_config returns "OpenBLAS 0.3.21 …"
    if (!*build)
        snprintf(build, sizeof build,
                 "ehdrom " EHD_VERSION " (revision " EHD_REVISION "), compiler " __VERSION__
                 " (" EHD_FLAGS "), %s, GSL %s, %s",
                 openblas_get_config(), gsl_version, fftw_version);
    return build;
}

FILE *program_open(const char *path) {
    // without O_NONBLOCK a pipe would wait for a writer
    const int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    struct stat about;

    if (file < 0) return NULL;
    const bool known = fstat(file, &about) == 0;
    if (known && !S_ISREG(about.st_mode)) errno = S_ISDIR(about.st_mode) ? EISDIR : ENOTSUP;
    FILE *stream = known && S_ISREG(about.st_mode) ? fdopen(file, "rb") : NULL;
    const int reason = errno;
    if (!stream) close(file);
    errno = reason;
    return stream;
}

static double seconds_of(clockid_t clock) {
    struct timespec now;
    clock_gettime(clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

double program_seconds(void) {
    return seconds_of(CLOCK_MONOTONIC);
}

double program_seconds_of_thread(void) {
    return seconds_of(CLOCK_THREAD_CPUTIME_ID);
}

// ---- interruption

static volatile sig_atomic_t interrupted;

static void on_signal(int number) {
    (void)number;
    if (interrupted) _exit(EHD_INTERRUPTED);
    interrupted = 1;
}

/* Returns MemAvailable of /proc/meminfo in bytes; infinity if there is no such line. */
static double free_memory(void) {
    FILE *file = fopen("/proc/meminfo", "r");
    double bytes = INFINITY, kilobytes;
    char line[128];

    while (file && fgets(line, sizeof line, file))
        if (sscanf(line, "MemAvailable: %lf kB", &kilobytes) == 1) bytes = 1024 * kilobytes;
    if (file) fclose(file);
    return bytes;
}

double program_memory(void) {
    struct rlimit limit;
    double bytes = free_memory();

    if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
        bytes = fmin(bytes, (double)limit.rlim_cur);
    return bytes;
}

ehd_status program_check_memory(const char *object, const char *part, size_t count,
                                const char *things, const char *with, double bytes,
                                ehd_error *error) {
    const double megabyte = 1e6, there = program_memory();

    if (bytes <= there) return EHD_OK;
    return ehd_fail(error, EHD_MEMORY,
                    "%s: %s: found %zu %s, which take about %.0f MB%s, expected at most %.0f MB, "
                    "which are free",
                    object, part, count, things, bytes / megabyte, with, there / megabyte);
}

bool program_interrupted(void) {
    return interrupted != 0;
}

// ---- libraries that end the process

static const char *name_of_program; // NULL: program_start was not called

/* Writes the program's name and a text to stderr. It does not use stdio, because a call of stdio
 * may be under way. */
static void say(const char *text) {
    if (write(STDERR_FILENO, name_of_program, strlen(name_of_program)) < 0 ||
        write(STDERR_FILENO, text, strlen(text)) < 0)
        return;
}

static void say_no_memory(void) {
    say(": out of memory\n");
}

/* Ends the process with EHD_MEMORY in place of exit(-1), which HDF5 may call if memory is
 * refused. */
static void on_foreign_exit(int code, void *unused) {
    (void)unused;
    if (code != -1) return;
    say_no_memory();
    _exit(EHD_MEMORY);
}

/* Replaces the function that FFTW calls when memory is refused. FFTW's own function prints a line
 * and aborts. */
void fftw_assertion_failed(const char *text, int line, const char *file);
void fftw_assertion_failed(const char *text, int line, const char *file) {
    (void)text, (void)line, (void)file;
    if (!name_of_program) abort();
    say_no_memory();
    _exit(EHD_MEMORY);
}

// a sanitizer has its own signal handlers
#if defined(__SANITIZE_ADDRESS__)
#define HAS_SANITIZER
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define HAS_SANITIZER
#endif
#endif

#ifndef HAS_SANITIZER
/* Ends the process with a message after two kinds of crashes: HDF5 crashes when memory is refused,
 * or a mapped file has been cut off or has become unreadable on the disk. After any other crash the
 * default action follows, which SA_RESETHAND restores. */
static void on_crash(int number, siginfo_t *info, void *unused) {
    (void)unused;
    if (number == SIGBUS && info->si_code == BUS_ADRERR) {
        say(": mapped file: found it cut or unreadable while it was in use, expected it whole\n");
        _exit(EHD_IO);
    }
    if (errno != ENOMEM) return;
    say_no_memory();
    _exit(EHD_MEMORY);
}
#endif

static void set_last_resort(void) {
    on_exit(on_foreign_exit, NULL);
#ifndef HAS_SANITIZER
    struct sigaction crash = {.sa_sigaction = on_crash,
                              .sa_flags = (int)(SA_RESETHAND | SA_SIGINFO)};
    sigemptyset(&crash.sa_mask);
    sigaction(SIGABRT, &crash, NULL);
    sigaction(SIGSEGV, &crash, NULL);
    sigaction(SIGBUS, &crash, NULL);
    sigaction(SIGFPE, &crash, NULL);
#endif
}

static void set_signals(void) {
    struct sigaction catch = {.sa_handler = on_signal, .sa_flags = SA_RESTART};
    struct sigaction ignore = {.sa_handler = SIG_IGN};
    sigemptyset(&catch.sa_mask);
    sigaddset(&catch.sa_mask, SIGINT);
    sigaddset(&catch.sa_mask, SIGTERM);
    sigemptyset(&ignore.sa_mask);
    sigaction(SIGINT, &catch, NULL);
    sigaction(SIGTERM, &catch, NULL);
    // a closed pipe or a file size limit must make the write fail, not kill the process
    sigaction(SIGPIPE, &ignore, NULL);
    sigaction(SIGXFSZ, &ignore, NULL);
}

// ---- messages

/* Prints "name: text" as one line, whatever the text contains. */
static void print_line(const program *self, const char *text) {
    ehd_error line;
    snprintf(line.text, sizeof line.text, "%s", text);
    text_make_printable(line.text, "");
    // on a terminal the line replaces a progress line
    fprintf(stderr, "%s%s: %s\n", isatty(STDERR_FILENO) == 1 ? "\r\033[K" : "", self->name,
            line.text);
}

static void print_arguments(const program *self, const char *format, va_list arguments) {
    ehd_error text;
    vsnprintf(text.text, sizeof text.text, format, arguments);
    print_line(self, text.text);
}

void program_note(const program *self, const char *format, ...) {
    va_list arguments;
    if (self->quiet) return;
    va_start(arguments, format);
    print_arguments(self, format, arguments);
    va_end(arguments);
}

void program_detail(const program *self, const char *format, ...) {
    va_list arguments;
    if (!self->verbose) return;
    va_start(arguments, format);
    print_arguments(self, format, arguments);
    va_end(arguments);
}

void program_warn(const program *self, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    print_arguments(self, format, arguments);
    va_end(arguments);
}

// ---- the command line

enum {
    KEY_HELP = 0x100,
    KEY_VERSION,
    KEY_SET,
    KEY_CHECK,
    KEY_DESCRIBE,
    KEY_PRINT,
    KEY_SI,
    KEY_PLOT,
    KEY_VTK
};

static const struct argp_option common_options[] = {
    {.doc = "Common to all programs:", .group = 10},
    {.name = "output", .key = 'o', .arg = "FILE", .doc = "Write the result to FILE", .group = 10},
    {.name = "set",
     .key = KEY_SET,
     .arg = "KEY=VALUE",
     .doc = "Override a setting of the scene, or unset it where no VALUE follows; repeatable",
     .group = 10},
    {.name = "force", .key = 'f', .doc = "Replace an output that exists", .group = 10},
    {.name = "check",
     .key = KEY_CHECK,
     .arg = "FILE",
     .doc = "Only check that FILE is whole and valid: exit 0, or print what is wrong",
     .group = 10},
    {.name = "describe",
     .key = KEY_DESCRIBE,
     .arg = "FILE",
     .doc = "Only print what follows from a scene, such as Hertz pressure; romrun: or a model",
     .group = 10},
    {.name = "print",
     .key = KEY_PRINT,
     .arg = "FILE NAME...",
     .doc = "Only print these datasets, axes and attributes of FILE as CSV, a line for each entry. "
            "Without a NAME, print which ones there are. The axes that are not named come first. "
            "After each line of a grid comes an empty line, after each grid two, as gnuplot's "
            "splot and index expect. FILE may be a NAME.partial",
     .group = 10},
    {.name = "si",
     .key = KEY_SI,
     .doc = "With --print of a result: values in SI units, which stand behind each name",
     .group = 10},
    {.name = "plot",
     .key = KEY_PLOT,
     .arg = "FILE",
     .doc = "Only draw a result, a training, a basis or a model: -o NAME.png, .svg or .pdf. --plot "
            "TABLE X Y draws column Y over X",
     .group = 10},
    {.name = "vtk",
     .key = KEY_VTK,
     .arg = "RESULT.h5",
     .doc = "Only write the fields of a result, in SI units, for ParaView: -o NAME.vti or .pvd",
     .group = 10},
    {.name = "quiet", .key = 'q', .doc = "No progress and no notes", .group = 10},
    {.name = "verbose", .key = 'v', .doc = "Also details", .group = 10},
    {.name = "help", .key = KEY_HELP, .doc = "Print this help", .group = 10},
    {.name = "version", .key = KEY_VERSION, .doc = "Print version and build", .group = 10},
    {0}};

/* Input of parse_common and parse_own. */
typedef struct parsing {
    program *program;
    void *own; // the program's own options
    bool help;
    bool version;
    const char *mode_argument; // argument of the option that chose the mode; NULL: no argument
} parsing;

// ---- modes

/* Chooses a mode. EHD_USAGE: the command line has already chosen another mode. */
static ehd_status choose_mode(program *self, size_t mode, ehd_error *error) {
    const program_mode *modes = self->modes;

    if (self->mode > 0 && self->mode != mode)
        return ehd_fail(error, EHD_USAGE, "command line: found %s and %s, expected one mode",
                        modes[self->mode].word, modes[mode].word);
    self->mode = mode;
    return EHD_OK;
}

/* Checks whether the program only looks at a file. */
static bool looks_only(const program *self) {
    return self->check || self->print || self->describe || self->plot || self->vtk;
}

/* If the first argument is the word of a mode, removes it and chooses this mode. An option may have
 * chosen a mode before; `last` is then the argument of this option, and is appended to the
 * arguments. */
static ehd_status take_mode(program *self, const char *last, ehd_error *error) {
    const program_mode *mode = self->modes;
    ehd_status status = EHD_OK;

    // with --print and --plot the arguments are names in the file
    if (!mode || looks_only(self)) return EHD_OK;
    for (mode++; mode->word && self->num_arguments > 0; mode++)
        if (strcmp(mode->word, self->arguments[0]) == 0) {
            status = choose_mode(self, (size_t)(mode - self->modes), error);
            self->num_arguments--;
            memmove(self->arguments, self->arguments + 1,
                    (self->num_arguments + 1) * sizeof *self->arguments);
            break;
        }
    if (last) self->arguments[self->num_arguments++] = last;
    return status;
}

static bool has_option(size_t mode, const program_option *row) {
    return row->modes == 0 || (row->modes >> mode & 1);
}

/* Appends the name of a mode, "romrun cases" or "romrun SCENE.yml", to a text. */
static void append_mode(char text[256], const char *before, const program *self, size_t mode) {
    const size_t used = strlen(text);
    const char *usage = self->modes[mode].usage;

    snprintf(text + used, 256 - used, "%s%s %.*s", before, self->name, (int)strcspn(usage, " "),
             usage);
}

/* Refuses an option that the mode does not have. */
static ehd_status check_options(const program *self, ehd_error *error) {
    const program_option *row = self->options;
    char found[256] = "", owners[256] = "";
    size_t i = 0;

    while (row[i].name && (!(self->given >> i & 1) || has_option(self->mode, &row[i])))
        i++;
    if (!row[i].name) return EHD_OK;
    append_mode(found, "", self, self->mode);
    for (size_t mode = 0; self->modes[mode].usage; mode++)
        if (has_option(mode, &row[i])) append_mode(owners, *owners ? ", " : "", self, mode);
    return ehd_fail(error, EHD_USAGE, "--%s: found with %s, expected with %s", row[i].name, found,
                    owners);
}

// ---- a program's own options

enum { FIRST_KEY = 0x200, MODE_KEY = 0x300 }; // keys of options without a letter, and of modes

static int key_of(const program_option *rows, size_t i) {
    return rows[i].letter ? rows[i].letter : FIRST_KEY + (int)i;
}

enum { MAX_OWN = MAX_OPTIONS + MAX_PROGRAM_MODES + 1 };

/* Fills the table of options for argp. The help shows only options of the present mode. */
static void make_own_options(struct argp_option own[MAX_OWN], const program *self) {
    const program_option *rows = self->options;
    size_t count = 0;

    memset(own, 0, MAX_OWN * sizeof *own);
    for (; rows && count < MAX_OPTIONS && rows[count].name; count++) {
        const program_option *row = &rows[count];
        const bool alias = row->type == AS_ALIAS, shown = !alias && has_option(self->mode, row);
        own[count] =
            (struct argp_option){.name = row->name,
                                 .key = alias ? 0 : key_of(rows, count),
                                 .arg = row->argument,
                                 .doc = row->help,
                                 .flags = (alias ? OPTION_ALIAS : 0) | (shown ? 0 : OPTION_HIDDEN)};
    }
    for (size_t i = 1; self->modes && i < MAX_PROGRAM_MODES && self->modes[i].word; i++)
        own[count++] =
            (struct argp_option){.name = self->modes[i].word,
                                 .key = MODE_KEY + (int)i,
                                 .arg = self->modes[i].option_has_argument ? "FILE" : NULL,
                                 .flags = OPTION_HIDDEN};
}

static ehd_status read_option(void *own, const program_option *row, const char *argument,
                              ehd_error *error) {
    void *member = (char *)own + row->member;
    char object[64];

    snprintf(object, sizeof object, "--%s", row->name);
    switch (row->type) {
    case AS_FLAG:
        *(bool *)member = true;
        return EHD_OK;
    case AS_TEXT:
        *(const char **)member = argument;
        if (*argument) return EHD_OK;
        return ehd_fail(error, EHD_USAGE, "%s: found nothing, expected %s", object, row->argument);
    case AS_COUNT:
        return parse_count(member, argument, (size_t)row->min, (size_t)row->max, object, EHD_USAGE,
                           error);
    case AS_REAL:
        return parse_real(member, argument, row->min, row->max, object, EHD_USAGE, error);
    case AS_ENTRY:
        *(const void **)member = entry_find(row->table, row->size, argument);
        if (*(const void **)member) return EHD_OK;
        return ehd_fail(error, EHD_USAGE, "%s: found %.40s, expected one of --help", object,
                        argument);
    default:
        return row->read(member, argument, error);
    }
}

static error_t parse_own(int key, char *argument, struct argp_state *state) {
    parsing *input = state->input;
    program *self = input->program;
    const program_option *rows = self->options;
    ehd_error error = {""};
    ehd_status status;
    size_t i = 0;

    while (rows && rows[i].name && key_of(rows, i) != key)
        i++;
    if (rows && rows[i].name) {
        self->given |= 1u << i;
        status = read_option(input->own, &rows[i], argument, &error);
    } else if (key > MODE_KEY && key < MODE_KEY + MAX_PROGRAM_MODES) {
        input->mode_argument = argument;
        status = choose_mode(self, (size_t)(key - MODE_KEY), &error);
    } else {
        return ARGP_ERR_UNKNOWN;
    }
    if (!status) return 0;
    argp_error(state, "%s", error.text);
    return EINVAL;
}

bool program_was_given(const program *self, const char *option) {
    for (size_t i = 0; self->options && self->options[i].name; i++)
        if (strcmp(self->options[i].name, option) == 0) return self->given >> i & 1;
    return false;
}

// ---- the common options

static error_t add_override(program *self, char *text, const struct argp_state *state) {
    if (!strchr(text, '=') || *text == '=') {
        char found[SHOWN_TEXT];
        text_show(found, text);
        argp_error(state, "--set: found %s, expected KEY=VALUE", found);
        return EINVAL;
    }
    self->overrides[self->num_overrides++] = text;
    return 0;
}

static error_t set_file(const char **file, const char *option, const char *text,
                        const struct argp_state *state) {
    if (*text == '\0') {
        argp_error(state, "%s: found nothing, expected the name of a file", option);
        return EINVAL;
    }
    *file = text;
    return 0;
}

static error_t parse_common(int key, char *argument, struct argp_state *state) {
    parsing *input = state->input;
    program *self = input->program;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = input;
        return 0;
    case ARGP_KEY_ARG:
        self->arguments[self->num_arguments++] = argument;
        return 0;
    case KEY_HELP:
        input->help = true;
        return 0;
    case KEY_VERSION:
        input->version = true;
        return 0;
    case KEY_SET:
        return add_override(self, argument, state);
    case KEY_CHECK:
        return set_file(&self->check, "--check", argument, state);
    case KEY_DESCRIBE:
        return set_file(&self->describe, "--describe", argument, state);
    case KEY_PRINT:
        return set_file(&self->print, "--print", argument, state);
    case KEY_PLOT:
        return set_file(&self->plot, "--plot", argument, state);
    case KEY_VTK:
        return set_file(&self->vtk, "--vtk", argument, state);
    case KEY_SI:
        self->si = true;
        return 0;
    case 'o':
        return set_file(&self->output, "--output", argument, state);
    case 'f':
        self->force = true;
        return 0;
    case 'q':
    case 'v': // the last option wins
        self->quiet = key == 'q';
        self->verbose = key == 'v';
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static char *base_name(char *path) {
    char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* Runs argp. Keeps only the first line of its error message, without the program's name. */
static ehd_status run_argp(program *self, const struct argp *argp, char **arguments, parsing *input,
                           ehd_error *error) {
    const unsigned flags = ARGP_NO_HELP | ARGP_NO_EXIT;
    const size_t prefix = strlen(self->name) + strlen(": ");
    char *complaint = NULL;
    size_t length = 0;
    FILE *const terminal = stderr;
    FILE *const capture = open_memstream(&complaint, &length);
    if (!capture) return ehd_no_memory(error, "command line");

    // getopt and argp print errors on several lines; glibc lets a program exchange its stderr
    stderr = capture;
    const error_t failure = argp_parse(argp, self->argc, arguments, flags, NULL, input);
    stderr = terminal;

    ehd_status status = EHD_OK;
    if (fclose(capture) || failure == ENOMEM) {
        status = ehd_no_memory(error, "command line");
    } else if (failure) {
        const char *text = length > prefix ? complaint + prefix : "found a misused option";
        status = ehd_fail(error, EHD_USAGE, "%.*s (see --help)", (int)strcspn(text, "\n"), text);
    }
    free(complaint);
    return status;
}

/* Checks the number of arguments. The message names the first missing argument. `by_option`: an
 * option gave the last argument. */
static ehd_status check_count(const program *self, const program_mode *mode, bool by_option,
                              ehd_error *error) {
    const bool none = self->vtk || self->describe;
    const size_t found = self->num_arguments, most = none ? 0 : mode->max_arguments;
    const char *usage = mode->usage && !none ? mode->usage : "none", *missing = usage;
    const char *name = self->modes && !none ? self->name : "", *space = *name ? " " : "";

    if (found > most)
        return ehd_fail(error, EHD_USAGE, "command line: found %zu file%s, expected %s%s%s", found,
                        found == 1 ? "" : "s", name, space, usage);
    if (self->check || none || found >= mode->min_arguments) return EHD_OK;
    for (size_t i = found + (mode->word ? 1 : 0) - (by_option ? 1 : 0); i > 0; i--)
        missing += strcspn(missing, " ") + 1;
    return ehd_fail(error, EHD_USAGE, "command line: found no %.*s, expected %s%s%s",
                    (int)strcspn(missing, " "), missing, name, space, usage);
}

/* Refuses two of the options that only look at a file. */
static ehd_status check_only_one(const program *self, ehd_error *error) {
    const struct {
        const char *name, *file;
    } options[] = {{"check", self->check},
                   {"print", self->print},
                   {"describe", self->describe},
                   {"plot", self->plot},
                   {"vtk", self->vtk}};
    const char *first = NULL;

    for (size_t i = 0; i < sizeof options / sizeof *options; i++) {
        if (options[i].file && first)
            return ehd_fail(error, EHD_USAGE, "--%s: found --%s too, expected one of them",
                            options[i].name, first);
        if (options[i].file) first = options[i].name;
    }
    return EHD_OK;
}

static ehd_status check_arguments(const program *self, const program_mode *mode, bool by_option,
                                  ehd_error *error) {
    const bool draws = self->vtk || self->plot;
    ehd_status status = check_only_one(self, error);

    if (status || self->print) return status;
    if (self->si)
        return ehd_fail(error, EHD_USAGE, "--si: found without --print, expected with it");
    if (self->describe && self->output)
        return ehd_fail(error, EHD_USAGE, "--describe: found --output too, expected one of them");
    if (self->modes && !looks_only(self)) status = check_options(self, error);
    if (!status && !self->plot) status = check_count(self, mode, by_option, error);
    if (status || self->check || self->describe) return status;
    if ((mode->output == OUTPUT_NEEDED || draws) && !self->output)
        return ehd_fail(error, EHD_USAGE, "--output: found nothing, expected -o FILE");
    if (mode->output == OUTPUT_NONE && self->output && !draws)
        return ehd_fail(error, EHD_USAGE, "--output: found with %s %s, expected none", self->name,
                        mode->word);
    return EHD_OK;
}

/* Prints the help of the mode in use. For the mode without a word, the help starts with the usage
 * lines of all modes. */
static void print_help(const program *self, struct argp argp, void (*tail)(void)) {
    char *name = strdup(self->name), *usages = NULL;
    size_t size;
    const program_mode *mode = self->modes ? &self->modes[self->mode] : NULL;
    FILE *stream = mode ? open_memstream(&usages, &size) : NULL;

    if (stream) {
        fputs(mode->usage, stream);
        for (size_t i = 1; self->mode == 0 && mode[i].word; i++)
            fprintf(stream, "\n%s", mode[i].usage);
        fclose(stream);
        argp.args_doc = usages;
    }
    if (self->mode > 0) argp.doc = mode->doc;
    if (name)
        argp_help(&argp, stdout, ARGP_HELP_SHORT_USAGE | ARGP_HELP_LONG | ARGP_HELP_DOC, name);
    if (tail && self->mode == 0) {
        putchar('\n');
        tail();
    }
    free(usages);
    free(name);
}

static void print_version(const program *self) {
    printf("%s (ehdrom) " EHD_VERSION "\n%s\n", self->name, program_build());
}

static ehd_status parse_arguments(program *self, const program_options *options, bool *done,
                                  ehd_error *error) {
    struct argp_option own_options[MAX_OWN];
    const struct argp own = {.options = own_options, .parser = parse_own};
    const struct argp_child children[] = {{.argp = &own}, {0}};
    const struct argp argp = {.options = common_options,
                              .parser = parse_common,
                              .args_doc = options->arguments_doc,
                              .doc = options->doc,
                              .children = children};
    parsing input = {.program = self, .own = options->own};
    const program_mode only = {.usage = options->arguments_doc,
                               .min_arguments = options->min_arguments,
                               .max_arguments = options->max_arguments,
                               .output = options->needs_output ? OUTPUT_NEEDED : OUTPUT_OPTIONAL};
    const size_t room = (size_t)self->argc + 1;
    char **arguments = calloc(room, sizeof *arguments); // a copy, because argp reorders it
    ehd_status status;

    self->options = options->options;
    self->modes = options->modes;
    make_own_options(own_options, self);
    self->overrides = calloc(room, sizeof *self->overrides);
    self->arguments = calloc(room, sizeof *self->arguments);
    if (!arguments || !self->overrides || !self->arguments) {
        status = ehd_no_memory(error, "command line");
    } else {
        memcpy(arguments, self->argv, (size_t)self->argc * sizeof *arguments);
        // errors of getopt start with argument 0, errors of argp with the last part of the path in
        // argument 0; this line makes both equal
        if (self->argc > 0) arguments[0] = base_name(self->argv[0]);
        status = run_argp(self, &argp, arguments, &input, error);
        if (!status) status = take_mode(self, input.mode_argument, error);
    }
    *done = input.help || input.version;
    if (input.help) {
        make_own_options(own_options, self);
        print_help(self, argp, options->help_tail);
    } else if (input.version) {
        print_version(self);
    } else if (!status) {
        status = check_arguments(self, self->modes ? &self->modes[self->mode] : &only,
                                 input.mode_argument != NULL, error);
    }
    free(arguments);
    return *done ? EHD_OK : status;
}

/* Opens /dev/null for each standard file that is closed. Otherwise the next opened file would get
 * the number of the standard file, and messages would be written into that file. Writes to
 * /dev/null fail here, because it is opened for reading. */
static void fill_standard_files(void) {
    int file;

    do
        file = open("/dev/null", O_RDONLY | O_CLOEXEC);
    while (file >= 0 && file <= STDERR_FILENO);
    if (file >= 0) close(file);
}

void program_start(program *self, int argc, char **argv, const program_options *options) {
    ehd_error error = {""};
    bool done;
    fill_standard_files();
    *self = (program){.name = argc > 0 ? base_name(argv[0]) : "ehdrom", .argc = argc, .argv = argv};
    setlocale(LC_ALL, "C"); // numbers are written and read with a decimal point
    name_of_program = self->name;
    // processor_check has already run as a constructor; this call makes the linker include it
    processor_check(argc, argv, NULL);
    set_signals();
    self->stage = stage_here();
    set_last_resort();
    openblas_one_thread();

    ehd_status status = parse_arguments(self, options, &done, &error);
    const bool no_buffer = !status && !done && openblas_take_buffers(1) < 1;
    if (no_buffer)
        status = ehd_fail(&error, EHD_MEMORY, "OpenBLAS: found too little memory, expected %d MB",
                          OPENBLAS_BUFFER_MB);
    if (status || done) {
        const int code = program_finish(self, status, &error);
        // at exit OpenBLAS would wait for its threads, and these threads wait until there is memory
        if (no_buffer) _exit(code);
        exit(code);
    }
}

/* Checks whether stdout is a pipe that nobody reads any more, as with `| head`. */
static bool has_no_reader(void) {
    struct pollfd out = {.fd = STDOUT_FILENO, .events = POLLOUT};

    return poll(&out, 1, 0) > 0 && (out.revents & POLLERR) != 0;
}

int program_finish(program *self, ehd_status status, const ehd_error *error) {
    const bool unflushed = fflush(stdout) != 0;
    // an earlier write may have failed already
    const bool lost = (ferror(stdout) || unflushed) && !has_no_reader();
    if (status != EHD_OK && error && *error->text) print_line(self, error->text);
    if (lost && status < EHD_USAGE) {
        print_line(self, "stdout: found a failed write, expected to print the result");
        status = EHD_IO;
    }
    free(self->overrides);
    free(self->arguments);
    self->overrides = self->arguments = NULL;
    self->num_overrides = self->num_arguments = 0;
    return (int)status;
}
