/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Clang-tidy reads this file before each test, because cmocka does not declare that a failed
 * assertion does not return. */
#ifndef TESTS_LINT_H
#define TESTS_LINT_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#undef assert_true
#undef assert_non_null
#undef assert_int_equal
#undef fail_msg
#define assert_true(holds)       ((holds) ? (void)0 : abort())
#define assert_non_null(pointer) assert_true((pointer) != NULL)
#define assert_int_equal(a, b)   assert_true((long long)(a) == (long long)(b))
#define fail_msg(...)            (print_error(__VA_ARGS__), abort())

#endif
