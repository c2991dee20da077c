/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Conversion of return values of LAPACKE into a status and an error text. */
#include "common/algebra/lapack.h"
#include "tests/unit/check.h"

#include <lapacke.h>
#include <math.h>

static ehd_error error;

static void success_says_nothing(void **state) {
    double matrix[] = {4, 2, 2, 5};
    (void)state;

    assert_int_equal(
        lapack_outcome("dpotrf", LAPACKE_dpotrf(LAPACK_COL_MAJOR, 'L', 2, matrix, 2), &error),
        EHD_OK);
    check_close(matrix[0], 2, 1e-15, 0);
}

/* A matrix that is not positive definite, a matrix with NaN, and an invalid argument are internal
 * errors. */
static void what_a_routine_refuses_is_internal(void **state) {
    double indefinite[] = {1, 0, 0, -1}, no_number[] = {NAN, 0, 0, 1};
    (void)state;

    assert_int_equal(
        lapack_outcome("dpotrf", LAPACKE_dpotrf(LAPACK_COL_MAJOR, 'L', 2, indefinite, 2), &error),
        EHD_INTERNAL);
    assert_string_equal(error.text, "dpotrf: found info = 2, expected 0");
    assert_int_equal(
        lapack_outcome("dpotrf", LAPACKE_dpotrf(LAPACK_COL_MAJOR, 'L', 2, no_number, 2), &error),
        EHD_INTERNAL);
    assert_string_equal(error.text, "dpotrf: found info = -4, expected 0");
    assert_int_equal(lapack_outcome("dpotrf", LAPACKE_dpotrf(0, 'L', 2, indefinite, 2), &error),
                     EHD_INTERNAL);
}

static void a_missing_workspace_is_memory(void **state) {
    const int codes[] = {LAPACK_WORK_MEMORY_ERROR, LAPACK_TRANSPOSE_MEMORY_ERROR};
    (void)state;

    for (int i = 0; i < 2; i++) {
        assert_int_equal(lapack_outcome("dgels", codes[i], &error), EHD_MEMORY);
        assert_string_equal(error.text, "dgels: out of memory");
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(success_says_nothing),
        cmocka_unit_test(what_a_routine_refuses_is_internal),
        cmocka_unit_test(a_missing_workspace_is_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
