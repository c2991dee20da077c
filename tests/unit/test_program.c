/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Behaviour that all programs share. The tests use child processes, because programs read argv and
 * exit. */
#include "common/program/program.h"
#include "tests/unit/check.h"

#include <fcntl.h>
#include <locale.h>
#include <math.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

// ---- a program for the tests

typedef struct own_options {
    size_t jobs;
    bool resume;
} own_options;

#define OWN_OPTIONS own_options

static const program_option own_rows[] = {
    {"jobs", 'j', "N", "Run N points at a time", OPTION_COUNT(jobs, 1, 64)},
    {"resume", 0, NULL, "Continue NAME.partial", OPTION_FLAG(resume)},
    {0}};

static void print_tail(void) {
    printf("Tail of the help.\n");
}

static own_options own;
static const program_options options = {.options = own_rows,
                                        .own = &own,
                                        .arguments_doc = "SCENE.yml -o result.h5",
                                        .doc = "Does nothing, in good manners.",
                                        .help_tail = print_tail,
                                        .min_arguments = 1,
                                        .max_arguments = 2,
                                        .needs_output = true};

// ---- children

typedef struct outcome {
    int code; // exit code, or minus the number of the signal
    char out[16384];
    char err[16384];
} outcome;

static outcome child;
static char *child_arguments[32]; // ends with NULL

/* Function that a child runs after program_start. Returns the exit code of the child. */
typedef int body(program *self);

static int finish_well(program *self) {
    return program_finish(self, EHD_OK, NULL);
}

static void read_back(FILE *file, char *text, size_t size) {
    rewind(file);
    text[fread(text, 1, size - 1, file)] = '\0';
    fclose(file);
}

static int count_arguments(void) {
    int count = 0;
    while (child_arguments[count])
        count++;
    return count;
}

static void run_in_child(body *act) {
    program self;
    program_start(&self, count_arguments(), child_arguments, &options);
    exit(act(&self));
}

/* Runs `act` in a child process and stores the outcome in `child`. Standard output goes to the file
 * `out_path`; if this is NULL, it goes to child.out. */
static void run_to(const char *out_path, body *act) {
    FILE *out = out_path ? fopen(out_path, "w") : tmpfile(), *err = tmpfile();
    int status = 0;
    assert_true(out && err);
    fflush(NULL);
    const pid_t id = fork();
    assert_true(id >= 0);
    if (id == 0) {
        dup2(fileno(out), STDOUT_FILENO);
        dup2(fileno(err), STDERR_FILENO);
        run_in_child(act);
    }
    assert_int_equal(waitpid(id, &status, 0), id);
    child.code = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
    child.out[0] = '\0';
    if (out_path)
        fclose(out);
    else
        read_back(out, child.out, sizeof child.out);
    read_back(err, child.err, sizeof child.err);
}

#define run(act, ...) run_list(act, (const char *[]){"/usr/bin/trial", __VA_ARGS__, NULL})
static void run_list(body *act, const char *const *arguments) {
    size_t i = 0;
    for (; arguments[i]; i++)
        child_arguments[i] = (char *)(uintptr_t)arguments[i];
    child_arguments[i] = NULL;
    run_to(NULL, act);
}

/* Expects one line on standard error that starts with "trial: " and `start`, no output, and exit
 * code 64. */
static void expect_misuse(const char *start) {
    const char *newline = strchr(child.err, '\n');
    if (child.code != EHD_USAGE || strncmp(child.err, "trial: ", 7) != 0 ||
        strncmp(child.err + 7, start, strlen(start)) != 0 || !newline || newline[1] || *child.out)
        fail_msg("exit %d, stderr \"%s\", expected \"%s\"", child.code, child.err, start);
}

// ---- the command line

static int print_options(program *self) {
    printf("%s %d%d%d %s %s %zu %d", self->name, self->quiet, self->verbose, self->force,
           self->output ? self->output : "-", self->check ? self->check : "-", own.jobs,
           own.resume);
    for (size_t i = 0; i < self->num_overrides; i++)
        printf(" [%s]", self->overrides[i]);
    for (size_t i = 0; i < self->num_arguments; i++)
        printf(" <%s>", self->arguments[i]);
    for (int i = 1; i < self->argc; i++)
        printf(" %s", self->argv[i]);
    return program_finish(self, EHD_OK, NULL);
}

static void reads_options_and_keeps_argv(void **state) {
    (void)state;
    run(print_options, "a.yml", "-qf", "--set", "x=1", "b.yml", "--set=y=2=3", "-o", "r.h5", "-j4",
        "--resume");
    assert_int_equal(child.code, 0);
    assert_string_equal(child.err, "");
    assert_string_equal(child.out, "trial 101 r.h5 - 4 1 [x=1] [y=2=3] <a.yml> <b.yml> a.yml -qf "
                                   "--set x=1 b.yml --set=y=2=3 -o r.h5 -j4 --resume");
    run(print_options, "-q", "-v", "--output=r", "--", "-a");
    assert_string_equal(child.out, "trial 010 r - 0 0 <-a> -q -v --output=r -- -a");
    run(print_options, "--check", "x.h5");
    assert_string_equal(child.out, "trial 000 - x.h5 0 0 --check x.h5");
}

static void help_goes_to_stdout(void **state) {
    (void)state;
    run(finish_well, "--help");
    assert_int_equal(child.code, 0);
    assert_string_equal(child.err, "");
    assert_non_null(strstr(child.out, "Usage: trial [OPTION...] SCENE.yml -o result.h5"));
    assert_non_null(strstr(child.out, "--set=KEY=VALUE"));
    assert_non_null(strstr(child.out, "--jobs=N"));
    assert_non_null(strstr(child.out, "Tail of the help."));
    run(finish_well, "--unknown", "--help");
    expect_misuse("unrecognized option '--unknown'");
    run(finish_well, "--help", "--unknown");
    assert_int_equal(child.code, 0);
}

static void version_goes_to_stdout(void **state) {
    (void)state;
    run(finish_well, "--version");
    assert_int_equal(child.code, 0);
    int major, minor, patch;
    assert_int_equal(sscanf(child.out, "trial (ehdrom) %d.%d.%d\n", &major, &minor, &patch), 3);
    assert_non_null(strstr(child.out, program_build()));
}

static void build_is_one_line(void **state) {
    (void)state;
    assert_null(strchr(program_build(), '\n'));
    assert_non_null(strstr(program_build(), "OpenBLAS"));
    assert_non_null(strstr(program_build(), "GSL 2"));
    assert_non_null(strstr(program_build(), "fftw-3"));
}

static void misuse_is_one_line_and_64(void **state) {
    (void)state;
    run(finish_well, "--unknown");
    expect_misuse("unrecognized option '--unknown' (see --help)");
    run(finish_well, "-x");
    expect_misuse("invalid option -- 'x'");
    run(finish_well, "a.yml", "-o");
    expect_misuse("option requires an argument -- 'o'");
    run(finish_well, "--ver");
    expect_misuse("option '--ver' is ambiguous");
    run(finish_well, "--force=1");
    expect_misuse("option '--force' doesn't allow an argument");
    run(finish_well, "--set", "moes.M");
    expect_misuse("--set: found moes.M, expected KEY=VALUE");
    run(finish_well, "--set", "=1");
    expect_misuse("--set: found =1");
    run(finish_well, "--jobs", "0");
    expect_misuse("--jobs: found 0, expected a whole number from 1 to 64");
    run(finish_well, "-o", "", "a.yml");
    expect_misuse("--output: found nothing");
    run(finish_well, "-o", "r.h5");
    expect_misuse("command line: found no SCENE.yml, expected SCENE.yml -o result.h5");
    run(finish_well, "-o", "r.h5", "a", "b", "c");
    expect_misuse("command line: found 3 files");
    run(finish_well, "a.yml");
    expect_misuse("--output: found nothing, expected -o FILE");
    run(finish_well, "--bad\nline");
    expect_misuse("unrecognized option '--bad (see");
}

// ---- numbers

static void parse_real_is_strict(void **state) {
    static const char *const bad[] = {"",     " 1",    "1 ", "1x", "nan", "inf",
                                      "0x10", "1e999", "1e", ".",  "2.5", "-0.5"};
    ehd_error error;
    double value = 7;
    (void)state;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_int_equal(parse_real(&value, bad[i], 0, 2, "--x", EHD_USAGE, &error), EHD_USAGE);
        assert_non_null(strstr(error.text, "expected a number from 0 to 2"));
        check_close(value, 7, 0, 0);
    }
    assert_int_equal(parse_real(&value, "1.5e0", 0, 2, "--x", EHD_USAGE, &error), EHD_OK);
    check_close(value, 1.5, 0, 0);
    parse_real(&value, "x", -INFINITY, INFINITY, "--x", EHD_DATA, &error);
    assert_string_equal(error.text, "--x: found x, expected a finite number");
    parse_real(&value, "-1", 0, INFINITY, "--x", EHD_DATA, &error);
    assert_string_equal(error.text, "--x: found -1, expected a number of at least 0");
    parse_real(&value, "3", -INFINITY, 2, "--x", EHD_DATA, &error);
    assert_string_equal(error.text, "--x: found 3, expected a number of at most 2");
}

static void parse_count_is_strict(void **state) {
    static const char *const bad[] = {"",
                                      "-1",
                                      "+1",
                                      "1.0",
                                      "1e1",
                                      "0x1",
                                      " 1",
                                      "0",
                                      "11",
                                      "18446744073709551616",
                                      "99999999999999999999999"};
    ehd_error error;
    size_t value = 7;
    (void)state;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(parse_count(&value, bad[i], 1, 10, "n", EHD_DATA, &error), EHD_DATA);
    assert_int_equal(value, 7);
    assert_int_equal(parse_count(&value, "10", 1, 10, "n", EHD_DATA, &error), EHD_OK);
    assert_int_equal(value, 10);
    assert_int_equal(
        parse_count(&value, "18446744073709551616", 1, SIZE_MAX, "n", EHD_DATA, &error), EHD_DATA);
    assert_string_equal(error.text,
                        "n: found 18446744073709551616, expected a whole number of at least 1");
}

static void numbers_round_trip(void **state) {
    static const double values[] = {0.1, 0.005, 1.0 / 3, 1e300, 5e-324, 123456.78901234567,
                                    0,   2e10};
    char shown[NUMBER_TEXT];
    (void)state;
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        number_show(shown, values[i]);
        check_close(strtod(shown, NULL), values[i], 0, 0);
    }
    number_show(shown, 0.1);
    assert_string_equal(shown, "0.1");
}

// ---- outcomes

static int finish_with_error(program *self) {
    const ehd_error error = {"scene.yml:3: moes.M: found\tx\ny, expected a number"};
    return program_finish(self, EHD_DATA, &error);
}

static int finish_without_text(program *self) {
    const ehd_error error = {""};
    return program_finish(self, EHD_UNTRUSTED, &error);
}

/* All kinds of control characters are replaced; other texts do not change. */
static void foreign_text_is_printable(void **state) {
    static const char *const texts[][2] = {
        {"plain, \302\265m, \342\202\254, \360\237\230\200", NULL},
        {"", NULL},
        {"\033[31m\r\n\t\b\177", "?[31m?????"},
        {"\302\200\302\233\302\237\302\240", "???\302\240"}, // C1 controls, a no-break space
        // line separators, direction marks
        {"\342\200\250\342\200\251\342\200\256\342\201\246", "????"},
        {"\342\200\247\342\200\257\342\201\245\342\201\252", NULL}, // the characters next to them
        {"\233\377\302", "???"},                                    // not UTF-8
        {"\300\200\340\200\200\355\240\200", "????????"}, // overlong encodings, a surrogate
        {"\357\277\276\357\277\277\357\277\275", "??\357\277\275"}};
    (void)state;
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        ehd_error error;
        assert_int_equal(ehd_fail(&error, EHD_DATA, "%s", texts[i][0]), EHD_DATA);
        assert_string_equal(error.text, texts[i][1] ? texts[i][1] : texts[i][0]);
    }
    char kept[] = "a\nb\tc\033";
    text_make_printable(kept, "\n\t");
    assert_string_equal(kept, "a\nb\tc?");
}

static void finish_prints_one_line(void **state) {
    (void)state;
    run(finish_with_error, "a.yml", "-o", "r.h5", "-q");
    assert_int_equal(child.code, EHD_DATA);
    assert_string_equal(child.err, "trial: scene.yml:3: moes.M: found?x?y, expected a number\n");
    run(finish_without_text, "a.yml", "-o", "r.h5");
    assert_int_equal(child.code, EHD_UNTRUSTED);
    assert_string_equal(child.err, "");
}

static int print_much(program *self) {
    for (int i = 0; i < 10000; i++)
        printf("line %d of many\n", i);
    return program_finish(self, EHD_OK, NULL);
}

static int print_into_closed_pipe(program *self) {
    int ends[2];
    if (pipe(ends) != 0) return 1;
    dup2(ends[1], STDOUT_FILENO);
    close(ends[0]);
    return print_much(self);
}

static int print_beyond_quota(program *self) {
    const struct rlimit limit = {8192, 8192};
    setrlimit(RLIMIT_FSIZE, &limit);
    return print_much(self);
}

static void failed_output_is_an_io_error(void **state) {
    (void)state;
    // a reader that has seen enough, as with `| head`, is no failure
    run(print_into_closed_pipe, "a.yml", "-o", "r.h5");
    assert_int_equal(child.code, EHD_OK);
    assert_string_equal(child.err, "");
    run(print_beyond_quota, "a.yml", "-o", "r.h5");
    assert_int_equal(child.code, EHD_IO);
    assert_non_null(strstr(child.err, "trial: stdout: found a failed write"));
    run_to("/dev/full", print_much);
    assert_int_equal(child.code, EHD_IO);
    run(print_much, "a.yml", "-o", "r.h5");
    assert_int_equal(child.code, EHD_OK);
}

// ---- messages and progress

static int say_all(program *self) {
    progress shown;
    program_note(self, "note %d", 1);
    program_detail(self, "detail %d", 2);
    program_warn(self, "warning %d", 3);
    progress_start(&shown, self, 3);
    for (size_t i = 0; i <= 3; i++)
        progress_show(&shown, i, "M=12 L=7");
    progress_finish(&shown);
    return program_finish(self, EHD_OK, NULL);
}

static void messages_heed_quiet_and_verbose(void **state) {
    (void)state;
    run(say_all, "a.yml", "-o", "r.h5", "--quiet");
    assert_string_equal(child.err, "trial: warning 3\n");
    run(say_all, "a.yml", "-o", "r.h5");
    assert_string_equal(child.err, "trial: note 1\ntrial: warning 3\ntrial: 0/3 M=12 L=7\n"
                                   "trial: 3/3 M=12 L=7, 0 s\n");
    run(say_all, "a.yml", "-o", "r.h5", "--verbose");
    assert_non_null(strstr(child.err, "trial: note 1\ntrial: detail 2\ntrial: warning 3\n"));
    assert_string_equal(child.out, "");
}

static int show_time_left(program *self) {
    progress shown;
    progress_start(&shown, self, 120);
    shown.started -= 100; // as if the program had run for 100 s
    progress_show(&shown, 40, "a");
    progress_show(&shown, 41, "too early for another line");
    shown.last_shown -= 3;
    shown.started -= 500; // as if the next points had taken 500 s
    progress_show(&shown, 119, "near the end");
    shown.last_shown -= 3;
    shown.advanced -= 500;
    progress_show(&shown, 119, "and stuck there");
    shown.last_shown -= 3;
    shown.started += 500;
    shown.started -= 10000;
    progress_show(&shown, 60, "b");
    shown.last_shown -= 3;
    shown.started -= 1e6;
    progress_show(&shown, 60, "c");
    return program_finish(self, EHD_OK, NULL);
}

static void progress_tells_the_time_left(void **state) {
    (void)state;
    run(show_time_left, "a.yml", "-o", "r.h5");
    assert_string_equal(child.err,
                        "trial: 40/120 a, 3 min left\ntrial: 119/120 near the end, 5 s left\n"
                        "trial: 119/120 and stuck there, 8 min left\n"
                        "trial: 60/120 b, 2.8 h left\n"
                        "trial: 60/120 c, 280.6 h left\n");
}

// ---- environment

static int check_surroundings(program *self) {
    char number[32];
    snprintf(number, sizeof number, "%.1f", 0.5);
    const double before = program_seconds();
    const bool good = strcmp(setlocale(LC_NUMERIC, NULL), "C") == 0 && !strcmp(number, "0.5") &&
                      program_seconds() >= before && !program_interrupted();
    return program_finish(self, good ? EHD_OK : EHD_INTERNAL, NULL);
}

static void numbers_keep_their_point(void **state) {
    (void)state;
    setenv("LC_ALL", "C.UTF-8", 1); // the only locale besides C that every system has
    assert_non_null(setlocale(LC_ALL, ""));
    run(check_surroundings, "a.yml", "-o", "r.h5");
    setlocale(LC_ALL, "C");
    unsetenv("LC_ALL");
    assert_int_equal(child.code, EHD_OK);
}

static int raise_once(program *self) {
    raise(SIGTERM);
    return program_finish(self, program_interrupted() ? EHD_INTERRUPTED : EHD_OK, NULL);
}

static int raise_twice(program *self) {
    raise(SIGINT);
    if (!program_interrupted()) return 1;
    printf("still running\n");
    fflush(stdout);
    raise(SIGTERM);
    return program_finish(self, EHD_OK, NULL);
}

/* If a program is started with closed standard streams, a file that it opens does not get the
 * descriptor of one of these streams. */
static int open_first(program *self) {
    static const char *const words[] = {"trial", "a.yml", "-o", "r.h5"};
    program again;
    for (int i = STDIN_FILENO; i <= STDERR_FILENO; i++)
        close(i);
    program_start(&again, 4, (char **)(uintptr_t)words, &options);
    const int file = open("/dev/null", O_RDONLY);
    const bool lost = write(STDOUT_FILENO, "x", 1) < 0 && write(STDERR_FILENO, "x", 1) < 0;
    program_finish(&again, EHD_OK, NULL);
    program_finish(self, EHD_OK, NULL);
    return file > STDERR_FILENO && lost ? 0 : 1;
}

static void closed_files_are_not_written_to(void **state) {
    (void)state;
    run(open_first, "a.yml", "-o", "r.h5");
    assert_int_equal(child.code, 0);
}

static void second_signal_ends_at_once(void **state) {
    (void)state;
    run(raise_once, "a.yml", "-o", "r.h5");
    assert_int_equal(child.code, EHD_INTERRUPTED);
    run(raise_twice, "a.yml", "-o", "r.h5");
    assert_int_equal(child.code, 130);
    assert_string_equal(child.out, "still running\n");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reads_options_and_keeps_argv),
        cmocka_unit_test(help_goes_to_stdout),
        cmocka_unit_test(version_goes_to_stdout),
        cmocka_unit_test(build_is_one_line),
        cmocka_unit_test(misuse_is_one_line_and_64),
        cmocka_unit_test(parse_real_is_strict),
        cmocka_unit_test(parse_count_is_strict),
        cmocka_unit_test(numbers_round_trip),
        cmocka_unit_test(foreign_text_is_printable),
        cmocka_unit_test(finish_prints_one_line),
        cmocka_unit_test(failed_output_is_an_io_error),
        cmocka_unit_test(messages_heed_quiet_and_verbose),
        cmocka_unit_test(progress_tells_the_time_left),
        cmocka_unit_test(numbers_keep_their_point),
        cmocka_unit_test(closed_files_are_not_written_to),
        cmocka_unit_test(second_signal_ends_at_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
