/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/unit/check.h"

#include <math.h>
#include <stdlib.h>

bool check_all(void) {
    const char *all = getenv("CHECK_ALL");

    return all && *all;
}

bool is_close(double actual, double expected, double relative, double absolute) {
    const double limit = absolute + relative * fabs(expected);
    if (isnan(actual) || isnan(expected) || isnan(relative) || isnan(absolute)) return false;
    if (actual == expected) return true;
    // relative * infinity must not accept a finite value
    return isfinite(limit) && fabs(actual - expected) <= limit;
}

void check_close_at(double actual, double expected, double relative, double absolute,
                    const char *what, const char *file, int line) {
    if (is_close(actual, expected, relative, absolute)) return;
    print_error("%s: found %.17g, expected %.17g; difference %.3g, allowed %.3g\n", what, actual,
                expected, fabs(actual - expected), absolute + relative * fabs(expected));
    _fail(file, line);
}

void check_close_array_at(const double *actual, const double *expected, size_t length,
                          double relative, double absolute, const char *what, const char *file,
                          int line) {
    for (size_t i = 0; i < length; i++) {
        if (is_close(actual[i], expected[i], relative, absolute)) continue;
        print_error("entry %zu of %zu\n", i, length);
        check_close_at(actual[i], expected[i], relative, absolute, what, file, line);
    }
}
