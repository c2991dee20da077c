/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Row weights: exact where the selected rows can stand for all of them. */
#include "deimselect/weighting.h"
#include "tests/unit/check.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

enum { NUM_MODES = 3, NUM_PAIRS = 12, NUM_NODES = 2 * NUM_PAIRS };

/* Orthonormal cosines over NUM_PAIRS nodes, each node doubled: rows k and k + NUM_PAIRS are equal. */
static void make_modes(double *modes) {
    for (size_t j = 0; j < NUM_MODES; j++)
        for (size_t k = 0; k < NUM_NODES; k++) {
            double phase = M_PI * (double)j * ((double)(k % NUM_PAIRS) + 0.5) / NUM_PAIRS;
            double norm = sqrt((j == 0 ? 1. : 2.) / NUM_NODES);
            modes[j * NUM_NODES + k] = norm * cos(phase);
        }
}

static void all_rows_weigh_one(void **state) {
    double modes[NUM_MODES * NUM_NODES], factors[NUM_NODES];
    size_t rows[NUM_NODES];
    (void)state;

    make_modes(modes);
    for (size_t r = 0; r < NUM_NODES; r++)
        rows[r] = r;
    assert_int_equal(
        weighting_quadrature(factors, modes, NUM_MODES, NUM_NODES, rows, NUM_NODES, NULL), EHD_OK);
    for (size_t r = 0; r < NUM_NODES; r++)
        check_close(factors[r], 1, 1e-6, 0);
}

/* One of each pair of equal rows: together they must weigh as all, so that
 * sum w q q^T = 1 to the tolerance of the solution. */
static void half_of_the_rows_stand_for_all(void **state) {
    double modes[NUM_MODES * NUM_NODES], factors[NUM_PAIRS];
    size_t rows[NUM_PAIRS];
    (void)state;

    make_modes(modes);
    for (size_t r = 0; r < NUM_PAIRS; r++)
        rows[r] = r % 2 ? r : r + NUM_PAIRS;
    assert_int_equal(
        weighting_quadrature(factors, modes, NUM_MODES, NUM_NODES, rows, NUM_PAIRS, NULL), EHD_OK);
    for (size_t i = 0; i < NUM_MODES; i++)
        for (size_t j = 0; j < NUM_MODES; j++) {
            double sum = 0;
            for (size_t r = 0; r < NUM_PAIRS; r++)
                sum += factors[r] * factors[r] * modes[i * NUM_NODES + rows[r]] *
                       modes[j * NUM_NODES + rows[r]];
            check_close(sum, i == j, 0, 1e-4);
        }
}

/* Rows (1, 0), (0, 1) and (1, 1): the first two are exact, so that the third would get zero weight;
 * the bound keeps it a say. */
static void weights_stay_positive(void **state) {
    const double modes[] = {1, 0, 1, 0, 1, 1};
    const size_t rows[] = {0, 1, 2};
    double factors[3];
    (void)state;

    assert_int_equal(weighting_quadrature(factors, modes, 2, 3, rows, 3, NULL), EHD_OK);
    check_close(factors[2], sqrt(0.05), 1e-9, 0);
    assert_true(factors[0] > 0.9 && factors[1] > 0.9);
}

static void plain_weights_are_one(void **state) {
    const double modes[] = {0.6, 0.8};
    const size_t rows[] = {1, 0};
    double factors[2] = {0, 0};
    (void)state;

    assert_int_equal(weighting_plain(factors, modes, 1, 2, rows, 2, NULL), EHD_OK);
    check_close(factors[0], 1, 0, 0);
    check_close(factors[1], 1, 0, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_rows_weigh_one),
        cmocka_unit_test(half_of_the_rows_stand_for_all),
        cmocka_unit_test(weights_stay_positive),
        cmocka_unit_test(plain_weights_are_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
