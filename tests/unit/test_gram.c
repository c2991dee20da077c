/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/online/gram.h"
#include "tests/unit/check.h"

#include <math.h>
#include <stdlib.h>

enum { MOST = 100, NUM_ROWS = 37 };

static double matrix[NUM_ROWS * MOST], gram[MOST * MOST + 1];

/* Each entry is the product of its columns, whatever blocks they fall into, and nothing behind the
 * last one is touched. */
static void is_the_product_of_columns(void **state) {
    const double guard = 17;
    (void)state;

    for (size_t i = 0; i < NUM_ROWS * MOST; i++)
        matrix[i] = sin((double)(i * i));
    for (size_t n = 1; n <= MOST; n++)
        for (size_t num_rows = 1; num_rows <= NUM_ROWS; num_rows += 12) {
            gram[n * n] = guard;
            gram_matrix(gram, matrix, num_rows, n);
            assert_true(gram[n * n] == guard);
            for (size_t j = 0; j < n; j++)
                for (size_t i = j; i < n; i++) {
                    double product = 0;
                    for (size_t r = 0; r < num_rows; r++)
                        product += matrix[r * n + i] * matrix[r * n + j];
                    check_close(gram[j * n + i], product, 0, 1e-13);
                }
        }
}

static void not_finite_columns_show(void **state) {
    const size_t n = 33, bad = 20;
    (void)state;

    for (size_t i = 0; i < NUM_ROWS * n; i++)
        matrix[i] = 1;
    matrix[5 * n + bad] = NAN;
    gram_matrix(gram, matrix, NUM_ROWS, n);
    for (size_t j = 0; j < n; j++)
        for (size_t i = j; i < n; i++)
            assert_true(isnan(gram[j * n + i]) == (i == bad || j == bad));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(is_the_product_of_columns),
        cmocka_unit_test(not_finite_columns_show),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
