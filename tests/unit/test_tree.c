/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tree of training points and the order of its points: an example that was worked by hand, and
 * properties of larger trees. */
#include "common/training/tree.h"
#include "tests/unit/allocation.h"
#include "tests/unit/check.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

enum { NUM_SMALL = 5, NUM_LARGE = 60 };

/* Four points at 0, 1, 2 and 10 on a line, and a single point of another family. The second point
 * is the easiest to solve. */
static const tree_point small[NUM_SMALL] = {
    {0, {0, 5}, 2}, {0, {1, 5}, 1}, {0, {2, 5}, 3}, {0, {10, 5}, 4}, {1, {1, 5}, 9}};

static void assert_numbers(const size_t *found, const size_t *expected, size_t count) {
    for (size_t i = 0; i < count; i++)
        assert_int_equal(found[i], expected[i]);
}

static void test_hand_worked(void **state) {
    const size_t expected_parent[] = {1, NO_PARENT, 1, 2, NO_PARENT};
    const size_t expected_order[] = {1, 2, 0, 3, 4}; // the subtrees have the heights 1 3 2 1 1
    const size_t expected_walk[] = {1, 0, 2, 3, 4};
    size_t parent[NUM_SMALL], order[NUM_SMALL], walk[NUM_SMALL];
    (void)state;

    assert_int_equal(tree_build(parent, small, NUM_SMALL, NULL), EHD_OK);
    assert_numbers(parent, expected_parent, NUM_SMALL);
    assert_int_equal(tree_order(order, parent, NUM_SMALL, NULL), EHD_OK);
    assert_numbers(order, expected_order, NUM_SMALL);
    assert_int_equal(tree_walk(walk, parent, NUM_SMALL, NULL), EHD_OK);
    assert_numbers(walk, expected_walk, NUM_SMALL);
}

/* Both coordinates have the same weight, whatever their units. */
static void test_scaled(void **state) {
    const tree_point points[] = {
        {0, {0, 0}, 0}, {0, {1, 0}, 1}, {0, {0.6, 500}, 1}, {0, {0, 1000}, 1}};
    size_t parent[4];
    const size_t expected[] = {NO_PARENT, 2, 0, 2};
    (void)state;

    assert_int_equal(tree_build(parent, points, 4, NULL), EHD_OK);
    assert_numbers(parent, expected, 4);
}

static void make_large(tree_point points[NUM_LARGE]) {
    for (size_t i = 0; i < NUM_LARGE; i++) {
        double a = fmod(0.618 * (double)i, 1), b = fmod(0.755 * (double)i, 1);
        points[i] = (tree_point){i % 3, {a, 40 * b}, hypot(a - 0.5, b)};
    }
    points[NUM_LARGE - 2].place[0] = points[NUM_LARGE - 2].place[1] = 0;
    points[NUM_LARGE - 1].place[0] = 1; // so that the coordinates have the ranges 1 and 40
    points[NUM_LARGE - 1].place[1] = 40;
}

static double length(const tree_point *left, const tree_point *right) {
    return hypot(left->place[0] - right->place[0], (left->place[1] - right->place[1]) / 40);
}

/* Returns the longest edge on the path through the tree between two points. A spanning tree is
 * minimal if, for each pair of points, this edge is not longer than their distance. */
static double longest_edge(const tree_point *points, const size_t *parent, size_t from, size_t to) {
    double longest = 0;
    bool above[NUM_LARGE] = {false};

    for (size_t k = from; k != NO_PARENT; k = parent[k])
        above[k] = true;
    size_t meet = to;
    for (; !above[meet]; meet = parent[meet])
        longest = fmax(longest, length(&points[meet], &points[parent[meet]]));
    for (size_t k = from; k != meet; k = parent[k])
        longest = fmax(longest, length(&points[k], &points[parent[k]]));
    return longest;
}

static void test_minimal(void **state) {
    tree_point points[NUM_LARGE];
    size_t parent[NUM_LARGE], num_roots = 0;
    (void)state;

    make_large(points);
    assert_int_equal(tree_build(parent, points, NUM_LARGE, NULL), EHD_OK);
    for (size_t i = 0; i < NUM_LARGE; i++) {
        num_roots += parent[i] == NO_PARENT;
        if (parent[i] != NO_PARENT) assert_int_equal(points[parent[i]].family, points[i].family);
        for (size_t k = 0; k < i; k++)
            if (points[i].family == points[k].family)
                assert_true(longest_edge(points, parent, i, k) <=
                            (1 + 1e-12) * length(&points[i], &points[k]));
    }
    assert_int_equal(num_roots, 3);
}

static void test_orders_are_complete(void **state) {
    tree_point points[NUM_LARGE];
    size_t parent[NUM_LARGE], lists[2][NUM_LARGE];
    (void)state;

    make_large(points);
    assert_int_equal(tree_build(parent, points, NUM_LARGE, NULL), EHD_OK);
    assert_int_equal(tree_order(lists[0], parent, NUM_LARGE, NULL), EHD_OK);
    assert_int_equal(tree_walk(lists[1], parent, NUM_LARGE, NULL), EHD_OK);
    for (int list = 0; list < 2; list++) {
        bool seen[NUM_LARGE] = {false};
        for (size_t i = 0; i < NUM_LARGE; i++) {
            size_t point = lists[list][i];
            assert_false(seen[point]);
            assert_true(parent[point] == NO_PARENT || seen[parent[point]]);
            seen[point] = true;
        }
    }
}

static void test_no_memory(void **state) {
    size_t parent[NUM_SMALL], other[NUM_SMALL];
    (void)state;

    assert_int_equal(tree_build(parent, small, NUM_SMALL, NULL), EHD_OK);
    for (size_t call = 0; call < 2; call++) {
        allocation_fail_at(call);
        assert_int_equal(tree_build(parent, small, NUM_SMALL, NULL), EHD_MEMORY);
        assert_true(allocation_failed());
        allocation_fail_at(call);
        assert_int_equal(tree_walk(other, parent, NUM_SMALL, NULL), EHD_MEMORY);
        assert_true(allocation_failed());
    }
    allocation_fail_at(0);
    assert_int_equal(tree_order(other, parent, NUM_SMALL, NULL), EHD_MEMORY);
    assert_true(allocation_failed());
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_hand_worked), cmocka_unit_test(test_scaled),
        cmocka_unit_test(test_minimal),     cmocka_unit_test(test_orders_are_complete),
        cmocka_unit_test(test_no_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
