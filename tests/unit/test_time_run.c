/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A transient run that ends early and is resumed must report the same as a run without an
 * interruption. The films come from a stub solver and are known. */
#include "common/output/time_run.h"

#include "common/output/time_result.h"
#include "common/settings/scene_contact.h"
#include "tests/unit/check.h"
#include "tests/unit/folder.h"
#include "tests/unit/marched.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { NEVER = 0, TEXT = 8192 };

static const double ATTEMPT_SECONDS = 2e-3;

// ---- the stub solver, with steps of 0.1 to T = 1; all special events lie in the first half

typedef struct stub_solver {
    double time, new_time;
    size_t num_attempts;   // number of attempts in this process
    size_t before;         // number in earlier processes, from the saved state
    size_t interrupted_at; // number of the attempt to interrupt, in all processes
    bool interrupted_at_start, fails_at_start;
    double fails_from; // no step beyond this T converges
} stub_solver;

static stub_solver stub;

static contact_scalars scalars_at(double time) {
    return (contact_scalars){.central_film_thickness = 2 - time,
                             .minimum_film_thickness = 0.1 + fabs(time - 0.2),
                             .central_pressure = 1 + time,
                             .load = 1};
}

static ehd_status start(march_step *outcome, void *solver, const contact_frame *frame,
                        ehd_error *error) {
    stub_solver *self = solver;

    *outcome = (march_step){.reason = "", .frame = *frame, .scalars = scalars_at(0)};
    self->time = 0;
    if (self->fails_at_start) {
        outcome->status = EHD_NOT_CONVERGED;
        outcome->reason = "no way in";
    }
    if (!self->interrupted_at_start) return EHD_OK;
    raise(SIGINT);
    return ehd_fail(error, EHD_INTERRUPTED, "start: interrupted");
}

static ehd_status attempt(march_step *outcome, void *solver, const contact_frame *frame,
                          double step, ehd_error *error) {
    const size_t fails_at = 2, untrusted_at = 4, again_at = 9;
    const struct timespec pause = {.tv_nsec = (long)(ATTEMPT_SECONDS * 1e9)};
    stub_solver *self = solver;
    size_t number = self->before + ++self->num_attempts;
    (void)step, (void)error;

    nanosleep(&pause, NULL);
    self->new_time = frame->time;
    *outcome = (march_step){.reason = "",
                            .frame = *frame,
                            .scalars = scalars_at(frame->time),
                            .effect = -0.01,
                            .effect_minimum = frame->time < 0.5 ? 0.02 : 0,
                            .iterations = number};
    if (number == fails_at || frame->time > self->fails_from) {
        outcome->status = EHD_NOT_CONVERGED;
        outcome->reason = "no luck";
    } else if (number == untrusted_at || number == again_at) {
        outcome->status = EHD_UNTRUSTED;
        outcome->reason = number == again_at ? "another value" : "a value that is outré";
    }
    if (number == self->interrupted_at) raise(SIGINT);
    return EHD_OK;
}

static void accept(void *solver) {
    stub_solver *self = solver;
    self->time = self->new_time;
}

static void restart(void *solver) {
    (void)solver;
}

static size_t saved_size(const void *solver) {
    (void)solver;
    return 2;
}

static void save(double *saved, const void *solver) {
    const stub_solver *self = solver;
    saved[0] = self->time;
    saved[1] = (double)(self->before + self->num_attempts);
}

static ehd_status restore(void *solver, const double *saved, ehd_error *error) {
    stub_solver *self = solver;
    (void)error;
    self->time = saved[0];
    self->before = (size_t)saved[1];
    return EHD_OK;
}

static void exits(double *positions, const void *solver) {
    (void)solver;
    for (size_t i = 0; i < GRID_EXITS; i++)
        positions[i] = NAN;
}

static solve_seconds seconds(const void *solver) {
    const stub_solver *self = solver;
    const double attempts = (double)self->num_attempts;
    return (solve_seconds){.rows = attempts, .linear = 2 * attempts, .exit = NAN};
}

// ---- a run, in a separate process because an interruption cannot be undone

static char path[128], partial[160], out_path[128], scene_path[128], err_path[128];
static char out[TEXT], err[TEXT];
static scene given;
static ehd_contact contact;
static ehd_error error;

static int set_up(void **state) {
    if (make_folder(state)) return -1;
    snprintf(path, sizeof path, "%s/r.h5", folder);
    snprintf(partial, sizeof partial, "%s.partial", path);
    snprintf(out_path, sizeof out_path, "%s/out", folder);
    snprintf(err_path, sizeof err_path, "%s/err", folder);
    snprintf(scene_path, sizeof scene_path, "%s/scene.yml", folder);
    FILE *scene_file = fopen(scene_path, "w");
    if (!scene_file || fclose(scene_file) != 0) return -1;
    stub = (stub_solver){.fails_from = INFINITY};
    given = marched_scene(20, 5, "incompressible", 0.1, "end_time: 1, fixed_step: 0.1");
    return scene_contact(&contact, &given, &error) ? -1 : 0;
}

static void print_trace(const time_trace *trace) {
    for (size_t i = 0; i < trace->count; i++)
        printf("entry %zu: %.17g %.17g %.17g\n", i, trace->time[i],
               trace->central_film_thickness[i], trace->central_pressure[i]);
}

static int run_child(bool resume, bool written) {
    char *words[] = {"fullrun", "--quiet", scene_path, written ? "-o" : NULL, path, NULL};
    const program_options options = {.min_arguments = 1, .max_arguments = 1};
    ehd_error why = {""};
    program self;
    time_trace trace;

    program_start(&self, written ? 5 : 3, words, &options);
    const time_run_task task = {.caller = &self,
                                .given = &given,
                                .reference = &contact,
                                .settings_text = "scene",
                                .solver = {.self = &stub,
                                           .attempt = attempt,
                                           .accept = accept,
                                           .restart = restart,
                                           .start = start,
                                           .saved_size = saved_size,
                                           .save = save,
                                           .restore = restore,
                                           .exits = exits,
                                           .seconds = seconds},
                                .resume = resume};
    ehd_status status = time_run(&trace, &task, &why);
    print_trace(&trace);
    time_trace_free(&trace);
    return program_finish(&self, status, &why);
}

static void slurp(char text[TEXT], const char *name) {
    FILE *stream = fopen(name, "r");
    assert_non_null(stream);
    text[fread(text, 1, TEXT - 1, stream)] = '\0';
    fclose(stream);
}

/* Returns the exit code of run_child in a child process, whose output goes to `out` and `err`. */
static int run(bool resume, bool written) {
    int outcome = 0;

    fflush(NULL);
    pid_t child = fork();
    if (child == 0) {
        if (!freopen(out_path, "w", stdout) || !freopen(err_path, "w", stderr)) _exit(99);
        exit(run_child(resume, written));
    }
    waitpid(child, &outcome, 0);
    assert_true(WIFEXITED(outcome));
    slurp(out, out_path);
    slurp(err, err_path);
    return WEXITSTATUS(outcome);
}

/* Removes the line that begins with `start_of_it`: its seconds differ from run to run. */
static void drop_line(char text[TEXT], const char *start_of_it) {
    char *line = strstr(text, start_of_it);
    assert_non_null(line);
    char *next = strchr(line, '\n');
    assert_non_null(next);
    memmove(line, next + 1, strlen(next + 1) + 1);
}

static double attribute(const char *name) {
    static const artefact_schema *const schemas[] = {&schema_result, NULL};
    artefact *file = NULL;
    double value = NAN;

    if (artefact_open(&file, path, schemas, &error) ||
        artefact_get_real(file, name, &value, &error))
        fail_msg("%s", error.text);
    artefact_close(&file);
    return value;
}

// ---- tests

static void check_contains(const char *text, const char *part) {
    if (!strstr(text, part)) fail_msg("found \"%s\", expected in it \"%s\"", text, part);
}

/* For each attempt: interrupts a run at this attempt, interrupts the resumed run two attempts
 * later, and resumes the run again. */
static void resumed_reports_what_an_uninterrupted_run_does(void **state) {
    (void)state;
    char whole_out[TEXT], whole_err[TEXT];
    static const char *const counted[] = {"steps", "rejected_steps", "total_newton_iterations",
                                          "solve_seconds_rows", "solve_seconds_linear"};
    double expected[5];

    assert_int_equal(run(false, true), EHD_UNTRUSTED);
    snprintf(whole_out, TEXT, "%s", out);
    snprintf(whole_err, TEXT, "%s", err);
    drop_line(whole_out, "solution");
    check_contains(whole_out, "smallest film           0.1");
    check_contains(whole_out, "largest central film    2");
    check_contains(whole_out,
                   "effect of the steps     central film 1 % rms, 1 % at most; minimum film "
                   "2 % at most\n");
    check_contains(whole_out, "1 more rejected");
    check_contains(whole_out, "not to be trusted       first at T = 0.2: a value that is outré\n");
    check_contains(whole_err, "found a value that is outré, first at T = 0.2, expected");
    for (size_t i = 0; i < 5; i++)
        expected[i] = attribute(counted[i]);
    const size_t num_attempts = (size_t)expected[3];
    assert_true(num_attempts > 10);
    unlink(path);

    for (size_t at = 1; at + 3 <= num_attempts; at++) {
        stub.interrupted_at = at;
        assert_int_equal(run(false, true), EHD_INTERRUPTED);
        assert_null(strstr(out, "time "));
        stub.interrupted_at = at + 2;
        assert_int_equal(run(true, true), EHD_INTERRUPTED);
        stub.interrupted_at = NEVER;
        assert_int_equal(run(true, true), EHD_UNTRUSTED);
        drop_line(out, "solution");
        assert_string_equal(out, whole_out);
        assert_string_equal(err, whole_err);
        for (size_t i = 0; i < 5; i++)
            check_close(attribute(counted[i]), expected[i], 0, 0);
        assert_true(attribute("solve_seconds") >= ATTEMPT_SECONDS * (double)num_attempts);
        unlink(path);
    }
}

static void interrupted_at_the_start(void **state) {
    (void)state;
    stub.interrupted_at_start = true;
    assert_int_equal(run(false, true), EHD_INTERRUPTED);
    assert_true(access(partial, F_OK) == 0);
    stub.interrupted_at_start = false;
    assert_int_equal(run(true, true), EHD_UNTRUSTED);
    check_contains(out, "T = 0 to 1 in ");
}

static void a_start_that_fails_is_told(void **state) {
    (void)state;
    char told[256];

    stub.fails_at_start = true;
    snprintf(told, sizeof told,
             "fullrun: %s: not converged: found no stationary solution to start from (no way in), "
             "expected one\n",
             scene_path);
    for (int written = 0; written < 2; written++) {
        assert_int_equal(run(false, written), EHD_NOT_CONVERGED);
        assert_string_equal(err, told);
        assert_string_equal(out, "");
        assert_true(access(path, F_OK) != 0);
    }
}

static void an_early_end_is_told(void **state) {
    (void)state;
    char line[256];

    stub.fails_from = 0.55;
    assert_int_equal(run(false, true), EHD_NOT_CONVERGED);
    snprintf(line, sizeof line,
             "ended early             at T = 0.55 of 1, not converged; results up to there are in "
             "%s\n",
             partial);
    check_contains(out, line);
    check_contains(err, "not converged: found a step size of");
    assert_true(access(path, F_OK) != 0);

    // if the resumed run gets no further, it reports the same
    assert_int_equal(run(true, true), EHD_NOT_CONVERGED);
    check_contains(out, line);
    check_contains(out, "smallest film           0.1");
    check_contains(out, "not to be trusted       first at T = 0.2: a value that is outré\n");

    assert_int_equal(run(false, false), EHD_NOT_CONVERGED);
    check_contains(out, "ended early             at T = 0.55 of 1, not converged; not written\n");
}

int main(void) {
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, remove_folder)
    const struct CMUnitTest tests[] = {
        TEST(resumed_reports_what_an_uninterrupted_run_does),
        TEST(interrupted_at_the_start),
        TEST(a_start_that_fails_is_told),
        TEST(an_early_end_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
