/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The comparison of doubles, on which all other tests rely. */
#include "tests/unit/check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

static void accepts_what_is_within_the_limits(void **state) {
    (void)state;
    assert_true(is_close(1.0, 1.0, 0.0, 0.0));
    assert_true(is_close(1.0 + 1e-13, 1.0, 1e-12, 0.0));
    assert_true(is_close(-1.0 - 1e-13, -1.0, 1e-12, 0.0));
    assert_true(is_close(1e-13, 0.0, 0.0, 1e-12));
    assert_true(is_close(1e20 * (1 + 1e-13), 1e20, 1e-12, 0.0));
    assert_true(is_close(1.5, 1.0, 0.25, 0.25));
    assert_true(is_close(INFINITY, INFINITY, 0.0, 0.0));
    assert_true(is_close(0.0, -0.0, 0.0, 0.0));
}

static void refuses_what_is_outside(void **state) {
    (void)state;
    assert_false(is_close(1.0 + 1e-11, 1.0, 1e-12, 0.0));
    assert_false(is_close(1.0, -1.0, 0.5, 0.5));
    assert_false(is_close(1e-11, 0.0, 1.0, 1e-12));
    assert_false(is_close(1.51, 1.0, 0.25, 0.25));
    // a float has 24 bits: this difference is lost in a cast to float
    assert_false(is_close(1.0 + 1e-9, 1.0, 1e-12, 0.0));
}

static void refuses_nan_anywhere(void **state) {
    (void)state;
    assert_false(is_close(NAN, 1.0, 1.0, 1.0));
    assert_false(is_close(1.0, NAN, 1.0, 1.0));
    assert_false(is_close(NAN, NAN, 1.0, 1.0));
    assert_false(is_close(1.0, 1.0, NAN, 1.0));
    assert_false(is_close(1.0, 1.0, 1.0, NAN));
}

static void infinity_is_close_only_to_itself(void **state) {
    (void)state;
    assert_false(is_close(1.0, INFINITY, 1.0, 1.0));
    assert_false(is_close(INFINITY, 1.0, 1.0, 1.0));
    assert_false(is_close(-INFINITY, INFINITY, 1.0, 1.0));
    assert_false(is_close(1.0, INFINITY, 0.0, 1.0));
}

/* Runs one test silently in a child process; returns the number of failed tests. */
static int outcome_of(const struct CMUnitTest test) {
    const struct CMUnitTest group[] = {test};
    int status = 0;
    fflush(NULL);
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        if (!freopen("/dev/null", "w", stdout) || !freopen("/dev/null", "w", stderr)) _exit(99);
        _exit(cmocka_run_group_tests(group, NULL, NULL));
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

static void close_value(void **state) {
    (void)state;
    check_close(1.0 + 1e-13, 1.0, 1e-12, 0.0);
}

static void distant_value(void **state) {
    (void)state;
    check_close(1.0 + 1e-11, 1.0, 1e-12, 0.0);
}

static void close_array(void **state) {
    (void)state;
    check_close_array(((double[]){1, 2, 3}), ((double[]){1, 2, 3}), 3, 1e-12, 0.0);
}

static void distant_last_entry(void **state) {
    (void)state;
    check_close_array(((double[]){1, 2, NAN}), ((double[]){1, 2, 3}), 3, 1e-12, 0.0);
}

static void a_refused_value_fails_its_test(void **state) {
    (void)state;
    assert_int_equal(outcome_of((struct CMUnitTest)cmocka_unit_test(close_value)), 0);
    assert_int_equal(outcome_of((struct CMUnitTest)cmocka_unit_test(distant_value)), 1);
    assert_int_equal(outcome_of((struct CMUnitTest)cmocka_unit_test(close_array)), 0);
    assert_int_equal(outcome_of((struct CMUnitTest)cmocka_unit_test(distant_last_entry)), 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(accepts_what_is_within_the_limits),
        cmocka_unit_test(refuses_what_is_outside),
        cmocka_unit_test(refuses_nan_anywhere),
        cmocka_unit_test(infinity_is_close_only_to_itself),
        cmocka_unit_test(a_refused_value_fails_its_test),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
