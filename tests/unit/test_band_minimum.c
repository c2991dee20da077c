/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The minimum over a range of nodes. It is exact for functions whose dips are not too narrow. */
#include "romrun/state/band_minimum.h"
#include "tests/unit/check.h"

#include <math.h>

/* Dips with the shape of a Gaussian. */
typedef struct dips {
    size_t num;
    struct {
        double place, depth, width; // place and width in nodes, depth dimensionless
    } dip[3];
    size_t most_node;
} dips;

static size_t num_calls;

static double value_at(const void *context, size_t node) {
    const dips *self = context;
    double value = 1;

    num_calls++;
    assert_true(node >= 100 && node <= self->most_node);
    for (size_t i = 0; i < self->num; i++) {
        double x = ((double)node - self->dip[i].place) / self->dip[i].width;
        value -= self->dip[i].depth * exp(-x * x);
    }
    return value;
}

static double least_of_all(const dips *self) {
    double least = INFINITY;

    for (size_t node = 100; node <= self->most_node; node++)
        least = fmin(least, value_at(self, node));
    return least;
}

static void check_least(const dips *self) {
    const double expected = least_of_all(self);

    num_calls = 0;
    const band_values values = {value_at, NULL, self};
    size_t node;
    check_close(band_minimum(&node, &values, 100, self->most_node), expected, 0, 0);
    const size_t calls = num_calls;
    check_close(value_at(self, node), expected, 0, 0);
    num_calls = calls;
}

static void one_dip_anywhere(void **state) {
    (void)state;
    for (size_t most = 100; most < 420; most += 7)
        for (double place = 95; place < (double)most + 5; place += 1.5) {
            const dips one = {1, {{place, 0.5, 15}}, most};
            check_least(&one);
            assert_true(num_calls < 80);
        }
}

/* The coarse search may come nearer to the bottom of the shallower dip than to the bottom of the
 * deeper dip. */
static void the_deeper_of_two_dips(void **state) {
    (void)state;
    for (double place = 240; place < 300; place += 0.5)
        for (double depth = 0.4; depth < 0.6; depth += 0.02) {
            const dips two = {2, {{130, 0.5, 30}, {place, depth, 12}}, 310};
            check_least(&two);
        }
}

/* Returns the minimum of the values between the neighbours of a node. Beyond node 200 it is lower
 * than the value at the node, so the second dip is deeper than the first. */
static double value_between(const void *context, size_t node) {
    return value_at(context, node) - (node > 200 ? 0.1 : 0);
}

static void the_smallest_node_need_not_be_in_the_deepest_dip(void **state) {
    const dips two = {2, {{130, 0.55, 20}, {280, 0.5, 20}}, 310};
    const band_values nodes = {value_at, NULL, &two}, values = {value_at, value_between, &two};
    size_t node;
    (void)state;

    check_close(band_minimum(&node, &nodes, 100, 310), 0.45, 1e-9, 0);
    assert_int_equal(node, 130);
    check_close(band_minimum(&node, &values, 100, 310), 0.4, 1e-9, 0);
    assert_int_equal(node, 280);
}

static void a_single_node_and_a_slope(void **state) {
    const dips single = {0, {{0, 0, 1}}, 100}, slope = {1, {{400, 0.5, 200}}, 311};
    (void)state;

    check_least(&single);
    check_least(&slope);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_dip_anywhere),
        cmocka_unit_test(the_deeper_of_two_dips),
        cmocka_unit_test(the_smallest_node_need_not_be_in_the_deepest_dip),
        cmocka_unit_test(a_single_node_and_a_slope),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
