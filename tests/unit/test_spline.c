/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Natural cubic splines, compared with GSL's. */
#include "common/algebra/spline.h"
#include "tests/unit/allocation.h"
#include "tests/unit/check.h"

#include <gsl/gsl_spline.h>
#include <math.h>

enum { NUM = 9 };

static const double x[NUM] = {-2, -1.9, -1, -0.5, 0, 0.75, 1, 3, 3.5};
static const double values[NUM] = {1, 3, -2, 0.5, 0.25, 4, 4, -1, 2};

static void it_is_that_of_gsl(void **state) {
    (void)state;
    for (size_t num = 3; num <= NUM; num++) {
        spline *self = spline_create(num);
        gsl_spline *other = gsl_spline_alloc(gsl_interp_cspline, num);
        size_t near = 0;
        assert_true(self && other);
        gsl_spline_init(other, x, values, num);
        spline_fit(self, x, values);
        for (int i = 0; i <= 200; i++) {
            const double here = fmin(x[0] + (x[num - 1] - x[0]) * i / 200, x[num - 1]);
            const double value = gsl_spline_eval(other, here, NULL);
            near = spline_interval(self, here, near);
            check_close(spline_value(self, here, near), value, 1e-12, 1e-12);
            check_close(spline_at(self, here), value, 1e-12, 1e-12);
            check_close(spline_slope(self, here), gsl_spline_eval_deriv(other, here, NULL), 1e-12,
                        1e-11);
            check_close(spline_bend(self, here), gsl_spline_eval_deriv2(other, here, NULL), 1e-12,
                        1e-10);
            check_close(spline_integral(self, here), gsl_spline_eval_integ(other, x[0], here, NULL),
                        1e-12, 1e-12);
        }
        gsl_spline_free(other);
        assert_null(spline_free(self));
    }
    assert_null(spline_free(NULL));
}

static void lines_are_kept_outside_too(void **state) {
    (void)state;
    for (size_t num = 2; num <= NUM; num++) {
        double line[NUM];
        for (size_t i = 0; i < num; i++)
            line[i] = 3 - 2 * x[i];
        spline *self = spline_create(num);
        assert_non_null(self);
        spline_fit(self, x, line);
        for (double here = -10; here < 10; here += 0.37) {
            check_close(spline_at(self, here), 3 - 2 * here, 0, 1e-12);
            check_close(spline_slope(self, here), -2, 0, 1e-12);
            check_close(spline_bend(self, here), 0, 0, 1e-11);
        }
        check_close(spline_integral(self, 1), 9 - (1 - 4), 0, 1e-12);
        assert_true(isnan(spline_at(self, NAN)));
        spline_free(self);
    }
}

static void intervals_are_found_from_anywhere(void **state) {
    (void)state;
    spline *self = spline_create(NUM);
    assert_non_null(self);
    spline_fit(self, x, values);
    for (size_t near = 0; near < NUM + 2; near++)
        for (size_t i = 0; i + 1 < NUM; i++) {
            assert_int_equal(spline_interval(self, x[i], near), i);
            assert_int_equal(spline_interval(self, (x[i] + x[i + 1]) / 2, near), i);
        }
    assert_int_equal(spline_interval(self, -5, 3), 0);
    assert_int_equal(spline_interval(self, x[NUM - 1], 0), NUM - 2);
    assert_int_equal(spline_interval(self, 5, 0), NUM - 2);
    spline_free(self);
}

static void memory_may_fail(void **state) {
    (void)state;
    allocation_fail_at(0);
    assert_null(spline_create(NUM));
    assert_true(allocation_failed());
    assert_null(spline_create(SIZE_MAX / 8));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_is_that_of_gsl),
        cmocka_unit_test(lines_are_kept_outside_too),
        cmocka_unit_test(intervals_are_found_from_anywhere),
        cmocka_unit_test(memory_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
