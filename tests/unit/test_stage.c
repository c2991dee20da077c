/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stages of a pipeline: the current stage, and the time that the other stages take. */
#include "common/program/stage.h"

#include "common/program/program.h"
#include "tests/unit/check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static const char path[] = "test_stage.tmp";
static const char names[] = "training a-basis a-rows a-check b-basis b-rows";

static stage stage_at(const char *here) {
    char text[256];

    snprintf(text, sizeof text, "%s %s %s", path, here, names);
    setenv("EHDROM_STAGES", text, 1);
    return stage_here();
}

static int set_up(void **state) {
    (void)state;
    unlink(path);
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    unsetenv("EHDROM_STAGES");
    unlink(path);
    return 0;
}

static void write_file(const char *text) {
    FILE *file = fopen(path, "w");

    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

static void read_file(char text[512]) {
    FILE *file = fopen(path, "r");

    assert_non_null(file);
    text[fread(text, 1, 511, file)] = '\0';
    fclose(file);
}

static void test_position(void **state) {
    (void)state;
    assert_int_equal(stage_at("training").number, 1);
    assert_int_equal(stage_at("b-basis").number, 5);
    assert_int_equal(stage_at("b-rows").total, 6);
    // a stage that is not in the list; a text without stages; no text
    assert_null(stage_at("c-basis").names);
    setenv("EHDROM_STAGES", "file", 1);
    assert_null(stage_here().names);
    unsetenv("EHDROM_STAGES");
    assert_null(stage_here().names);
}

/* stage_next moves to the next stage only if the next stage has the given name, because a pipeline
 * may leave out checks of models. */
static void test_next(void **state) {
    stage self = stage_at("a-rows");
    (void)state;

    stage_next(&self, "check");
    assert_int_equal(self.number, 4);
    self = stage_at("b-rows");
    stage_next(&self, "check");
    assert_int_equal(self.number, 6);
    self = stage_at("a-basis");
    stage_next(&self, "check");
    assert_int_equal(self.number, 2);
    stage_next(&self, "ows"); // the whole name after the "-" must agree
    assert_int_equal(self.number, 2);
}

static void test_left(void **state) {
    stage self = stage_at("a-basis");
    bool at_least = true;
    (void)state;

    // no times are known
    assert_true(isnan(stage_left(&at_least, &self, 5, true)));
    assert_false(at_least);
    write_file(
        "training 99 0\na-basis 7 0\na-rows 20 0\na-check 300 0\nb-basis 4000 0\nb-rows 50000 0\n");
    check_close(stage_left(&at_least, &self, 5, true), 54325, 0, 1e-9);
    assert_false(at_least);
    assert_true(isnan(stage_left(&at_least, &self, NAN, true)));
    // during the current stage, which is assumed to take at least its time from the file
    self.started = program_seconds() - 3;
    check_close(stage_left(&at_least, &self, 1, false), 54324, 0, 0.5);
    check_close(stage_left(&at_least, &self, NAN, false), 54324, 0, 0.5);
    check_close(stage_left(&at_least, &self, 6, false), 54326, 0, 0.5);
    // for one stage only a lower bound of its time is known
    write_file("a-rows 20 0\na-check 300 1\nb-basis 4000 0\nb-rows 50000 0\n");
    check_close(stage_left(&at_least, &self, 5, true), 54325, 0, 1e-9);
    assert_true(at_least);
    assert_true(isnan(stage_left(&at_least, &self, 5, false)));
    // the time of one stage is not known
    write_file("a-rows 20 0\na-check 300 1\nb-rows 50000 0\n");
    assert_true(isnan(stage_left(&at_least, &self, 5, true)));
    // a program outside of a pipeline
    unsetenv("EHDROM_STAGES");
    self = stage_here();
    assert_true(isnan(stage_left(&at_least, &self, 5, true)));
}

static void test_kept(void **state) {
    stage self = stage_at("a-basis");
    char text[512];
    (void)state;

    write_file("training 99 0\na-basis 7 0\na-rows 20 0\n");
    stage_expect(&self, "rows", 30);
    stage_expect(&self, "basis", 5); // has no effect on the current stage
    read_file(text);
    assert_string_equal(text,
                        "training 99 0\na-basis 7 0\na-rows 30 1\nb-basis 5 1\nb-rows 30 1\n");
    self.started = program_seconds() - 1234;
    stage_end(&self);
    read_file(text);
    assert_string_equal(
        text, "training 99 0\na-basis 1.23e+03 0\na-rows 30 1\nb-basis 5 1\nb-rows 30 1\n");
    // if the file cannot be written, nothing happens
    setenv("EHDROM_STAGES", "no/such/folder a b", 1);
    self = stage_here();
    stage_end(&self);
    unsetenv("EHDROM_STAGES");
    self = stage_here();
    stage_end(&self);
    stage_expect(&self, "rows", 1);
    stage_next(&self, "rows");
    assert_int_equal(self.number, 0);
}

/* Checks the text that a stage adds to a progress line. */
static void test_shown(void **state) {
    program here = {.name = "trial", .stage = stage_at("a-check")};
    FILE *errors = tmpfile();
    const int kept = dup(STDERR_FILENO);
    progress shown;
    char text[512];
    (void)state;

    write_file("b-basis 40 0\nb-rows 50 0\n");
    dup2(fileno(errors), STDERR_FILENO);
    progress_start(&shown, &here, 4);
    progress_show(&shown, 0, "a");
    shown.last_shown -= 3;
    shown.started -= 10;
    progress_show(&shown, 2, "b");
    shown.last_shown -= 3;
    shown.more = true;
    shown.rest = 5;
    progress_show(&shown, 2, "c");
    shown.rest = NAN; // unknown time
    progress_show(&shown, 4, "d");
    dup2(kept, STDERR_FILENO);
    close(kept);
    rewind(errors);
    text[fread(text, 1, sizeof text - 1, errors)] = '\0';
    fclose(errors);
    assert_string_equal(text, "trial: 0/4 a; stage 4 of 6\n"
                              "trial: 2/4 b, 10 s left; stage 4 of 6, about 2 min in all\n"
                              "trial: 2/4 c, 10 s left; stage 4 of 6, at least 2 min in all\n"
                              "trial: 4/4 d, 10 s; stage 4 of 6\n");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_position, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_next, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_left, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_kept, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_shown, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
