/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The choice of the next training points: first the corners of the convex hull of all candidates,
 * then the worst candidates that lie apart. */
#include "snapgen/point_choice.h"
#include "tests/unit/allocation.h"
#include "tests/unit/check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- corners

static bool contains(const size_t *numbers, size_t count, size_t wanted) {
    for (size_t i = 0; i < count; i++)
        if (numbers[i] == wanted) return true;
    return false;
}

static void corners_of_a_grid_are_its_four(void **state) {
    double places[25][RANGE_AXES] = {{0}};
    size_t corners[25];
    (void)state;

    for (size_t i = 0; i < 25; i++) {
        places[i][0] = (double)(i % 5);
        places[i][1] = (double)(i / 5);
    }
    assert_int_equal(point_choice_corners(corners, (const double(*)[RANGE_AXES])places, 25, 1e-9),
                     4);
    for (size_t i = 0; i < 4; i++)
        assert_true(contains(corners, 4, (size_t[]){0, 4, 20, 24}[i]));
}

/* All points on a circle are corners. With a larger tolerance a few corners are enough, because the
 * other points may then lie a little outside of the hull of these corners. */
static void corners_of_a_circle_follow_the_tolerance(void **state) {
    enum { COUNT = 360 };
    double places[COUNT][RANGE_AXES] = {{0}};
    size_t corners[COUNT];
    (void)state;

    for (size_t i = 0; i < COUNT; i++) {
        places[i][0] = cos((double)i * acos(-1) / 180);
        places[i][1] = sin((double)i * acos(-1) / 180);
    }
    assert_int_equal(
        point_choice_corners(corners, (const double(*)[RANGE_AXES])places, COUNT, 1e-9), COUNT);
    // distance from chord to arc: 0.293 for 90 degrees, 0.076 for 45, 0.020 for 22 or 23
    assert_int_equal(point_choice_corners(corners, (const double(*)[RANGE_AXES])places, COUNT, 0.3),
                     4);
    assert_int_equal(point_choice_corners(corners, (const double(*)[RANGE_AXES])places, COUNT, 0.1),
                     8);
    assert_int_equal(
        point_choice_corners(corners, (const double(*)[RANGE_AXES])places, COUNT, 0.025), 16);
}

/* Finds the corners of 28 places: a skewed grid of 3 by 3 by 3 places, and one place outside of
 * this grid. The corners are the eight corners of the grid and the place outside. The fourth
 * coordinate is a multiple of the third. */
static void corners_of_a_body_span_it(void **state) {
    double places[28][RANGE_AXES];
    size_t corners[28], call = 0, count;
    (void)state;

    for (size_t i = 0; i < 27; i++) {
        places[i][0] = 7 + (double)(i % 3);
        places[i][1] = (double)(i / 3 % 3) + 0.3 * places[i][0];
        places[i][2] = (double)(i / 9) - 0.2 * places[i][1];
        places[i][3] = 0.3 * places[i][2];
    }
    for (int axis = 0; axis < RANGE_AXES; axis++)
        places[27][axis] = places[13][axis] + (axis == 2 ? 3 : axis == 3 ? 0.9 : 0);
    count = point_choice_corners(corners, (const double(*)[RANGE_AXES])places, 28, 1e-9);
    assert_int_equal(count, 9);
    for (size_t i = 0; i < 9; i++)
        assert_true(contains(corners, 9, (size_t[]){0, 2, 6, 8, 18, 20, 24, 26, 27}[i]));
    do { // failing allocations
        allocation_fail_at(call);
        count = point_choice_corners(corners, (const double(*)[RANGE_AXES])places, 28, 1e-9);
        if (!allocation_failed()) break;
        assert_true(count == 0 || count >= 9);
    } while (call++ < 1000);
    assert_int_equal(count, 9);
}

static void corners_of_few_points(void **state) {
    const double same[3][RANGE_AXES] = {{1, 2}, {1, 2}, {1, 2}};
    const double line[4][RANGE_AXES] = {{1, 0}, {0, 0}, {3, 0}, {2, 0}};
    size_t corners[4];
    (void)state;

    assert_int_equal(point_choice_corners(corners, NULL, 0, 1e-9), 0);
    assert_int_equal(point_choice_corners(corners, same, 3, 1e-9), 1);
    assert_int_equal(point_choice_corners(corners, line, 4, 1e-9), 2);
    assert_int_equal(corners[0], 1);
    assert_int_equal(corners[1], 2);
}

// ---- the worst candidates

/* Twelve candidates on a line from 0 to 11. The first and the last candidate were trained on before
 * ("taken"). All candidates have the same second coordinate. */
enum { NUM_LINE = 12 };
static tree_point line_points[NUM_LINE];
static bool line_taken[NUM_LINE];
static double line_indicated[NUM_LINE];

static candidates make_line(const double indicated[NUM_LINE], double enough) {
    for (size_t i = 0; i < NUM_LINE; i++) {
        line_points[i] = (tree_point){.place = {(double)i, 7}};
        line_taken[i] = i == 0 || i == NUM_LINE - 1;
        line_indicated[i] = indicated[i];
    }
    return (candidates){line_points, NUM_LINE, line_taken, line_indicated, enough};
}

static void check_choice(const candidates *from, size_t most, const size_t *expected,
                         size_t num_expected) {
    size_t chosen[NUM_LINE], count = 99;

    assert_int_equal(point_choice_worst(chosen, &count, from, most, NULL), EHD_OK);
    assert_int_equal(count, num_expected);
    for (size_t i = 0; i < count; i++)
        assert_int_equal(chosen[i], expected[i]);
}

/* The candidates beside the worst one are nearly as bad, but the second choice lies elsewhere. */
static void the_worst_come_first_and_apart(void **state) {
    const double indicated[] = {99, 1, 2, 7, 9, 8, 2, 1, 1, 3, 2, 99};
    const candidates from = make_line(indicated, 0);
    (void)state;

    // Candidate 4 is the worst, at a distance of 4 from the taken candidate 0. Next comes 9, at a
    // distance of 2 from the taken candidate 11. Next comes 2, at a distance of 2 from 0 and from
    // 4.
    check_choice(&from, 3, (size_t[]){4, 9, 2}, 3);
}

static void what_is_good_enough_or_taken_is_left(void **state) {
    const double indicated[] = {99, 1, 2, 7, 9, 8, 2, 1, 1, 3, 2, 99};
    const candidates from = make_line(indicated, 2.5);
    (void)state;

    // All candidates whose estimate exceeds 2.5 are chosen. Candidate 3 comes before 5: it is
    // nearer to a taken candidate, and may therefore be nearer to the chosen candidate 4
    // (point_choice_worst).
    check_choice(&from, NUM_LINE, (size_t[]){4, 9, 3, 5}, 4);
    const candidates none = make_line(indicated, 9);
    check_choice(&none, NUM_LINE, NULL, 0);
}

/* Two candidates that exceed the accuracy are both chosen, unless they lie at the same place. */
static void near_ones_are_taken_the_same_is_not(void **state) {
    const double indicated[] = {99, 1, 1, 1, 9, 8, 1, 1, 1, 1, 1, 99};
    const candidates from = make_line(indicated, 2);
    (void)state;

    line_points[5].place[0] = line_points[4].place[0] + 1e-6;
    check_choice(&from, NUM_LINE, (size_t[]){4, 5}, 2);
    line_points[5].place[0] = line_points[4].place[0];
    check_choice(&from, NUM_LINE, (size_t[]){4}, 1);
}

/* If no candidate has an error estimate, the chosen candidates are spread evenly. */
static void the_unknown_is_filled_evenly(void **state) {
    double indicated[NUM_LINE];
    (void)state;

    for (size_t i = 0; i < NUM_LINE; i++)
        indicated[i] = INFINITY;
    const candidates from = make_line(indicated, 0);
    check_choice(&from, 3, (size_t[]){5, 8, 2}, 3);
    check_choice(&from, 0, NULL, 0);
}

static void what_has_a_number_comes_every_second_time(void **state) {
    const double indicated[] = {99, 1, INFINITY, 7, 9, 8, INFINITY, 1, INFINITY, 3, 2, 99};
    const candidates from = make_line(indicated, 0);
    const double unknown[] = {99,       INFINITY, 5, INFINITY, INFINITY, 6,
                              INFINITY, INFINITY, 1, 1,        1,        99};
    (void)state;

    // Of the candidates without an estimate, 6 is farthest from the taken 0 and 11. Of the
    // candidates with an estimate that are far enough from 6, 3 has the largest estimate, 7.
    check_choice(&from, 2, (size_t[]){6, 3}, 2);
    const candidates more = make_line(unknown, 0);
    check_choice(&more, 4, (size_t[]){6, 2, 1, 9}, 4);
}

/* Candidates of different families (lubricants) are far from each other, wherever they lie. */
static void families_are_far_from_each_other(void **state) {
    const double indicated[] = {99, 1, 2, 7, 9, 8, 2, 1, 1, 3, 2, 99};
    const candidates from = make_line(indicated, 0);
    (void)state;

    line_points[5].family = 1;
    check_choice(&from, 2, (size_t[]){4, 5}, 2);
}

static void choice_survives_failing_allocations(void **state) {
    const double indicated[] = {99, 1, 2, 7, 9, 8, 2, 1, 1, 3, 2, 99};
    const candidates from = make_line(indicated, 0);
    size_t chosen[NUM_LINE], count, call = 0;
    (void)state;

    for (;; call++) {
        allocation_fail_at(call);
        ehd_status status = point_choice_worst(chosen, &count, &from, 3, NULL);
        if (!allocation_failed()) break;
        assert_int_equal(status, EHD_MEMORY);
    }
    assert_int_equal(call, 2);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(corners_of_a_grid_are_its_four),
                                       cmocka_unit_test(corners_of_a_circle_follow_the_tolerance),
                                       cmocka_unit_test(corners_of_a_body_span_it),
                                       cmocka_unit_test(corners_of_few_points),
                                       cmocka_unit_test(the_worst_come_first_and_apart),
                                       cmocka_unit_test(what_is_good_enough_or_taken_is_left),
                                       cmocka_unit_test(near_ones_are_taken_the_same_is_not),
                                       cmocka_unit_test(the_unknown_is_filled_evenly),
                                       cmocka_unit_test(what_has_a_number_comes_every_second_time),
                                       cmocka_unit_test(families_are_far_from_each_other),
                                       cmocka_unit_test(choice_survives_failing_allocations)};

    return cmocka_run_group_tests(tests, NULL, NULL);
}
