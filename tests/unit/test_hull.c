/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/algebra/hull.h"
#include "tests/unit/allocation.h"
#include "tests/unit/check.h"

#include <math.h>

/* Points inside a cube and on its faces have the distance 0, other points a positive distance. Two
 * corners of the cube are given twice. */
static void distances_from_a_cube(void **state) {
    double cube[3 * 10];
    (void)state;

    for (size_t i = 0; i < 10; i++)
        for (size_t axis = 0; axis < 3; axis++)
            cube[axis * 10 + i] = (double)(i >> axis & 1);
    check_close(hull_distance(cube, 10, 3, (double[]){0.2, 0.7, 0.4}), 0, 0, 1e-10);
    check_close(hull_distance(cube, 10, 3, (double[]){1, 0, 0.5}), 0, 0, 1e-10);
    assert_true(hull_distance(cube, 10, 3, (double[]){1 + 1e-6, 0.5, 0.5}) > 1e-7);
    assert_true(hull_distance(cube, 10, 3, (double[]){0.5, 0.5, -1}) > 0.5);
    assert_true(isinf(hull_distance(cube, 10, 3, (double[]){0.5, NAN, 0.5})));
    allocation_fail_at(0);
    assert_true(isinf(hull_distance(cube, 10, 3, (double[]){0.5, 0.5, 0.5})));
    assert_true(allocation_failed());
}

/* Tests a segment and a single point, which have no volume. */
static void distances_from_what_is_flat(void **state) {
    const double segment[] = {0, 1, 0, 2}, lone[] = {0.3, 0.4};
    (void)state;

    check_close(hull_distance(segment, 2, 2, (double[]){0.25, 0.5}), 0, 0, 1e-10);
    assert_true(hull_distance(segment, 2, 2, (double[]){0.25, 0.6}) > 1e-2);
    assert_true(hull_distance(segment, 2, 2, (double[]){1.1, 2.2}) > 1e-2);
    check_close(hull_distance(lone, 1, 2, lone), 0, 0, 1e-10);
    assert_true(hull_distance(lone, 1, 2, (double[]){0.3, 0.5}) > 1e-2);
}

/* Results must not depend on the previous content of reused memory. */
static void kept_memory_changes_nothing(void **state) {
    const double segment[] = {0, 1, 0, 2}, places[][2] = {{0.25, 0.5}, {0.25, 0.6}, {1.1, 2.2}};
    double square[2 * 5];
    (void)state;

    for (size_t i = 0; i < 5; i++) {
        square[i] = (double)(i & 1);
        square[5 + i] = (double)(i >> 1 & 1);
    }
    hull_space *space = hull_space_create(5);
    assert_non_null(space);
    for (size_t i = 0; i < 3; i++) {
        assert_true(hull_distance_in(space, square, 5, 2, places[i]) ==
                    hull_distance(square, 5, 2, places[i]));
        assert_true(hull_distance_in(space, segment, 2, 2, places[i]) ==
                    hull_distance(segment, 2, 2, places[i]));
    }
    // more points than the memory was created for
    assert_true(isinf(hull_distance_in(space, square, 6, 1, places[0])));
    hull_space_free(space);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(distances_from_a_cube),
        cmocka_unit_test(distances_from_what_is_flat),
        cmocka_unit_test(kept_memory_changes_nothing),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
