/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Weights of the selected rows. The weights are exact if the selected rows can represent all
 * rows. */
#include "common/program/text.h"
#include "romrun/model/weighting.h"
#include "tests/unit/check.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

enum { NUM_MODES = 3, NUM_PAIRS = 12, NUM_NODES = 2 * NUM_PAIRS };

/* Computes the values of orthonormal cosines at some rows. The cosines extend over NUM_PAIRS nodes,
 * and each node occurs twice, so rows k and k + NUM_PAIRS are equal. `sampled`: [num_rows,
 * NUM_MODES]. */
static void sample_cosines(double *sampled, const size_t *rows, size_t num_rows) {
    for (size_t r = 0; r < num_rows; r++)
        for (size_t j = 0; j < NUM_MODES; j++) {
            double phase = M_PI * (double)j * ((double)(rows[r] % NUM_PAIRS) + 0.5) / NUM_PAIRS;
            double norm = sqrt((j == 0 ? 1. : 2.) / NUM_NODES);
            sampled[r * NUM_MODES + j] = norm * cos(phase);
        }
}

static void all_rows_weigh_one(void **state) {
    double sampled[NUM_NODES * NUM_MODES], factors[NUM_NODES];
    size_t rows[NUM_NODES];
    (void)state;

    for (size_t r = 0; r < NUM_NODES; r++)
        rows[r] = r;
    sample_cosines(sampled, rows, NUM_NODES);
    assert_int_equal(weighting_quadrature(factors, sampled, NUM_NODES, NUM_MODES, NULL), EHD_OK);
    for (size_t r = 0; r < NUM_NODES; r++)
        check_close(factors[r], 1, 1e-6, 0);
}

/* With only one row of each pair of equal rows, sum w q q^T = 1 holds to the tolerance of the
 * solution. */
static void half_of_the_rows_stand_for_all(void **state) {
    double sampled[NUM_PAIRS * NUM_MODES], factors[NUM_PAIRS];
    size_t rows[NUM_PAIRS];
    (void)state;

    for (size_t r = 0; r < NUM_PAIRS; r++)
        rows[r] = r % 2 ? r : r + NUM_PAIRS;
    sample_cosines(sampled, rows, NUM_PAIRS);
    assert_int_equal(weighting_quadrature(factors, sampled, NUM_PAIRS, NUM_MODES, NULL), EHD_OK);
    for (size_t i = 0; i < NUM_MODES; i++)
        for (size_t j = 0; j < NUM_MODES; j++) {
            double sum = 0;
            for (size_t r = 0; r < NUM_PAIRS; r++)
                sum += factors[r] * factors[r] * sampled[r * NUM_MODES + i] *
                       sampled[r * NUM_MODES + j];
            check_close(sum, i == j, 0, 1e-4);
        }
}

/* The rows lie close together on one side, and some rows get the least allowed weight. Gauss-Seidel
 * iteration therefore takes hundreds of sweeps. At the minimum the gradient is zero for free
 * weights, and not negative for weights at the bound. */
static void weights_are_those_of_the_minimum(void **state) {
    enum { ROWS = 20, MODES = 8 };
    const double tolerance = 1e-4;
    double sampled[ROWS][MODES], factors[ROWS];
    size_t num_bound = 0;
    (void)state;

    for (size_t r = 0; r < ROWS; r++)
        for (size_t j = 0; j < MODES; j++)
            sampled[r][j] = 0.3 * cos(M_PI * (double)j * pow((double)(r + 1) / ROWS, 2));
    assert_int_equal(weighting_quadrature(factors, sampled[0], ROWS, MODES, NULL), EHD_OK);
    for (size_t r = 0; r < ROWS; r++) {
        double gradient = 0;
        for (size_t s = 0; s <= ROWS; s++) { // the last term is -|q_r|^2
            double product = 0;
            for (size_t j = 0; j < MODES; j++)
                product += sampled[r][j] * sampled[s < ROWS ? s : r][j];
            gradient += s < ROWS ? factors[s] * factors[s] * product * product : -product;
        }
        const bool bound = factors[r] * factors[r] < 0.05 * (1 + 1e-9);
        num_bound += bound;
        assert_true(gradient > -tolerance && (bound || gradient < tolerance));
    }
    assert_in_range(num_bound, 1, ROWS - 1);
}

/* The rows are (1, 0), (0, 1) and (1, 1). The first two rows alone are exact, so the third row
 * would get the weight zero. The bound keeps its weight positive. */
static void weights_stay_positive(void **state) {
    const double sampled[] = {1, 0, 0, 1, 1, 1};
    double factors[3];
    (void)state;

    assert_int_equal(weighting_quadrature(factors, sampled, 3, 2, NULL), EHD_OK);
    check_close(factors[2], sqrt(0.05), 1e-9, 0);
    assert_true(factors[0] > 0.9 && factors[1] > 0.9);
}

static void plain_weights_are_one(void **state) {
    const double sampled[] = {0.6, 0.8};
    double factors[2] = {0, 0};
    (void)state;

    assert_int_equal(weighting_plain(factors, sampled, 2, 1, NULL), EHD_OK);
    check_close(factors[0], 1, 0, 0);
    check_close(factors[1], 1, 0, 0);
}

static void weightings_are_found_by_name(void **state) {
    (void)state;
    const weighting *found = entry_find(weightings, sizeof *weightings, "plain");
    assert_ptr_equal(found->weigh, weighting_plain);
    assert_null(entry_find(weightings, sizeof *weightings, "plai"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_rows_weigh_one),
        cmocka_unit_test(half_of_the_rows_stand_for_all),
        cmocka_unit_test(weights_are_those_of_the_minimum),
        cmocka_unit_test(weights_stay_positive),
        cmocka_unit_test(plain_weights_are_one),
        cmocka_unit_test(weightings_are_found_by_name),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
