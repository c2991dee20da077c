/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Comparison of doubles in tests. Tests include this header instead of cmocka.h, because the float
 * comparison of cmocka casts to float and lets NaN pass. */
#ifndef EHD_CHECK_H
#define EHD_CHECK_H

// cmocka.h needs these four headers before it
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdbool.h>

/* Returns true if tests run all cases (`make check-all`), false if only a few (`make check`). */
bool check_all(void);

/* Returns true if |actual - expected| <= absolute + relative * |expected|. Returns false if any
 * argument is NaN. An infinity is close only to itself. */
bool is_close(double actual, double expected, double relative, double absolute);

/* Fails the test unless is_close returns true. The message contains the values and the limit. */
#define check_close(actual, expected, relative, absolute)                                          \
    check_close_at(actual, expected, relative, absolute, #actual, __FILE__, __LINE__)

/* Compares `length` pairs like check_close. The message contains the first index that fails. */
#define check_close_array(actual, expected, length, relative, absolute)                            \
    check_close_array_at(actual, expected, length, relative, absolute, #actual, __FILE__, __LINE__)

void check_close_at(double actual, double expected, double relative, double absolute,
                    const char *what, const char *file, int line);
void check_close_array_at(const double *actual, const double *expected, size_t length,
                          double relative, double absolute, const char *what, const char *file,
                          int line);

#endif
