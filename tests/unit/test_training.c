/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Training points that an earlier run has solved, and that are read again. */
#include "fullrun/training.h"
#include "tests/unit/allocation.h"
#include "tests/unit/check.h"
#include "tests/unit/sample.h"

#include <malloc.h>
#include <stdlib.h>

enum { NUM_POINTS = 3 };

static ehd_error error;

/* If a point appears several times in a file, only the last solution is kept in memory. */
static void a_point_is_kept_once(void **state) {
    (void)state;
    const ehd_contact contact = sample_contact("barus", "dowson-higginson", 12, 4, 0.05);
    const training_set set = {.grid = contact.grid, .num_points = NUM_POINTS};
    double *pressure = calloc(contact.grid.num_inner, sizeof *pressure);
    training self;
    assert_non_null(pressure);
    assert_int_equal(training_init(&self, NULL, &set, &error), EHD_OK);
    for (int point = 0; point < NUM_POINTS; point++)
        assert_int_equal(training_restore(&self, (size_t)point, pressure, 0.5, 80, &error), EHD_OK);
    size_t in_use = 0;
    for (int i = 0; i < 100; i++) {
        if (i == 50) in_use = mallinfo2().uordblks;
        pressure[30] = i;
        assert_int_equal(training_restore(&self, 1, pressure, 0.5, 80, &error), EHD_OK);
    }
    assert_int_equal(mallinfo2().uordblks, in_use);
    check_close(self.points[1].pressure[31], 99, 0, 0);
    assert_int_equal(self.num_done, NUM_POINTS);
    assert_int_equal(training_restore(&self, 1, NULL, 0, 0, &error), EHD_OK);
    assert_null(self.points[1].pressure);
    assert_int_equal(self.num_failed, 1);
    training_free(&self);
    free(pressure);
}

static void memory_may_fail(void **state) {
    (void)state;
    const ehd_contact contact = sample_contact("barus", "dowson-higginson", 12, 4, 0.05);
    const training_set set = {.grid = contact.grid, .num_points = NUM_POINTS};
    double *pressure = calloc(contact.grid.num_inner, sizeof *pressure);
    assert_non_null(pressure);
    for (size_t call = 0;; call++) {
        training self;
        allocation_fail_at(call);
        ehd_status status = training_init(&self, NULL, &set, &error);
        if (!status) status = training_restore(&self, 0, pressure, 0.5, 80, &error);
        const bool failed = allocation_failed();
        assert_int_equal(status, failed ? EHD_MEMORY : EHD_OK);
        training_free(&self);
        if (!failed) break;
    }
    free(pressure);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_point_is_kept_once),
        cmocka_unit_test(memory_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
