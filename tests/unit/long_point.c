/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The full model of a point contact on a series of grids: M = 20, L = 10, Barus, incompressible. */
#include "tests/unit/check.h"
#include "tests/unit/problem.h"
#include "tests/unit/sample.h"

#include <math.h>

enum { NUM_GRIDS = 4 };

/* Film thicknesses to which the multigrid program of Venner and Lubrecht converges on each grid, in
 * Moes units (bench_point.c). */
static const struct {
    size_t cells;
    double central, minimum;
} known[NUM_GRIDS] = {
    {64, 4.652, 2.885}, {128, 4.765, 2.946}, {256, 4.794, 2.957}, {512, 4.801, 2.960}};

static double central[NUM_GRIDS];

static void digits_of_the_multigrid_program(void **state) {
    (void)state;
    const full_settings settings = full_default_settings();
    const double unit = pow(30, 2. / 3);

    for (size_t i = 0; i < NUM_GRIDS; i++) {
        const ehd_contact contact =
            sample_published(sample_point("barus", "incompressible", 20, 10, known[i].cells, true));
        problem solved;
        problem_solve_cold(&solved, &contact, &settings);
        contact_scalars scalars = full_evaluate_scalars(&solved.state, &contact);
        central[i] = scalars.central_film_thickness * unit;
        check_close(central[i], known[i].central, 0, 6e-4);
        check_close(scalars.minimum_film_thickness * unit, known[i].minimum, 0, 6e-4);
        assert_true(solved.info.complementarity <= 1e-9);
        problem_free(&solved);
    }
}

static void central_film_converges_with_second_order(void **state) {
    (void)state;
    for (size_t i = 0; i + 2 < NUM_GRIDS; i++) {
        double order = log2((central[i + 1] - central[i]) / (central[i + 2] - central[i + 1]));
        print_message("order from %zu cells on: %.2f\n", known[i].cells, order);
        assert_true(order >= 1.8);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(digits_of_the_multigrid_program),
        cmocka_unit_test(central_film_converges_with_second_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
