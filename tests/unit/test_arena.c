/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/program/arena.h"
#include "tests/unit/allocation.h"
#include "tests/unit/check.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static void arrays_are_zero_apart_and_aligned(void **state) {
    (void)state;
    arena memory = {0};
    char *bytes = arena_array(&memory, 3, 1);
    double *numbers = arena_array(&memory, 100, sizeof *numbers);

    assert_non_null(bytes);
    assert_non_null(numbers);
    assert_int_equal((uintptr_t)numbers % _Alignof(max_align_t), 0);
    memset(bytes, 7, 3);
    for (size_t i = 0; i < 100; i++)
        assert_true(numbers[i] == 0);
    assert_false(memory.failed);
    arena_free(&memory);
    assert_null(memory.last);
}

/* Arrays about as large as a huge page (2 MB) and larger must be zero, also in the third round,
 * which gets memory that an earlier round has written. */
static void large_arrays_are_zero(void **state) {
    const size_t sizes[] = {(size_t)2 << 20, ((size_t)4 << 20) - 64, ((size_t)9 << 20) + 3};
    (void)state;
    for (int round = 0; round < 3; round++) {
        arena memory = {0};
        for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
            char *bytes = arena_array(&memory, sizes[i], 1);
            assert_non_null(bytes);
            for (size_t k = 0; k < sizes[i]; k++)
                assert_true(bytes[k] == 0);
            memset(bytes, 7, sizes[i]);
        }
        arena_free(&memory);
    }
}

static void an_empty_array_is_an_array(void **state) {
    (void)state;
    arena memory = {0};

    assert_non_null(arena_array(&memory, 0, 8));
    assert_false(memory.failed);
    arena_free(&memory);
}

static void sizes_that_overflow_are_refused(void **state) {
    (void)state;
    arena memory = {0};

    assert_null(arena_array(&memory, SIZE_MAX / 8 + 1, 8));
    assert_true(memory.failed);
    assert_null(arena_array(&memory, 1, SIZE_MAX - 8));
    arena_free(&memory);
    assert_false(memory.failed);
}

static void a_failure_is_remembered(void **state) {
    (void)state;
    arena memory = {0};

    allocation_fail_at(1);
    assert_non_null(arena_array(&memory, 4, 8));
    assert_null(arena_array(&memory, 4, 8));
    assert_true(allocation_failed());
    assert_non_null(arena_array(&memory, 4, 8));
    assert_true(memory.failed);
    arena_free(&memory);
}

/* A damaged file may have axes so long that the product of their lengths overflows. */
static void arrays_that_overflow_are_refused(void **state) {
    (void)state;
    const size_t huge = (size_t)1 << 61;
    assert_null(array_new(huge, 1, 8));
    assert_null(array_new(huge, 8, 1));
    assert_null(array_new(1, huge + 1, 8));
    assert_null(array_new((size_t)1 << 32, (size_t)1 << 32, 1));
    void *one = array_new(1, 1, 8);
    assert_non_null(one);
    free(one);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(arrays_that_overflow_are_refused),
        cmocka_unit_test(arrays_are_zero_apart_and_aligned),
        cmocka_unit_test(large_arrays_are_zero),
        cmocka_unit_test(an_empty_array_is_an_array),
        cmocka_unit_test(sizes_that_overflow_are_refused),
        cmocka_unit_test(a_failure_is_remembered),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
