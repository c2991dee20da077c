/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The transient full model on the grid of the paper's transient load (Maier et al. 2015): M = 120,
 * L = 10, Barus, incompressible. */
#include "tests/unit/marched.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static marched first, second;

static void run_paper(marched *self, double step, const char *transient) {
    scene of = marched_scene(120, 10, "incompressible", step, transient);
    strcpy(of.discretization, "published");
    marched_all(self, &of);
}

/* With a tenth of the default tolerance, the central film changes by less than 0.2 %. */
static void default_tolerance_is_enough(void **state) {
    static const double periods[] = {0.5, 1, 2};
    (void)state;
    for (size_t i = 0; i < sizeof periods / sizeof *periods; i++) {
        char text[128];
        snprintf(text, sizeof text, "end_time: 3, load: {law: sine, amplitude: 0.1, period: %g}",
                 periods[i]);
        run_paper(&first, 0.005, text);
        const double tolerance = first.scene.transient.tolerance;
        snprintf(text, sizeof text,
                 "end_time: 3, tolerance: %g, load: {law: sine, amplitude: 0.1, period: %g}",
                 tolerance / 10, periods[i]);
        run_paper(&second, 0.005, text);
        const double deviation = marched_deviation(&first, &second);
        print_message("period %g: %zu and %zu steps, %.2g %%\n", periods[i], first.count,
                      second.count, 100 * deviation);
        assert_true(deviation < 2e-3);
        assert_true(second.count > 3 * first.count / 2);
        marched_end(&first);
        marched_end(&second);
    }
}

/* Runs with amplitudes and periods beyond the range of the paper must end with a positive film. */
static void large_amplitudes_are_completed(void **state) {
    static const double amplitudes[] = {0.1, 0.3, 0.5}, periods[] = {0.25, 0.5, 1, 2};
    (void)state;
    for (size_t a = 0; a < sizeof amplitudes / sizeof *amplitudes; a++)
        for (size_t p = 0; p < sizeof periods / sizeof *periods; p++) {
            char text[128];
            snprintf(text, sizeof text,
                     "end_time: %g, tolerance: 1e-3, load: {law: sine, amplitude: %g, period: %g}",
                     2 * periods[p], amplitudes[a], periods[p]);
            run_paper(&first, 0.005, text);
            for (size_t k = 0; k < first.count; k++) {
                check_close(first.load[k],
                            1 + amplitudes[a] * sin(2 * M_PI * first.time[k] / periods[p]), 1e-9,
                            0);
                assert_true(first.least_film[k] > 0 && first.least_film[k] <= first.film[k]);
            }
            marched_end(&first);
        }
}

/* Halving the time step reduces the difference between the central films of two runs to a quarter,
 * also with the paper's parameters. */
static void fine_grid_is_of_second_order(void **state) {
    static const double steps[] = {0.02, 0.01, 0.005, 0.0025};
    double film[4];
    (void)state;
    for (int s = 0; s < 4; s++) {
        char text[128];
        snprintf(text, sizeof text,
                 "end_time: 2.2, fixed_step: %g, load: {law: sine, amplitude: 0.1, period: 2}",
                 steps[s]);
        run_paper(&first, 0.005, text);
        film[s] = first.film[first.count - 1];
        marched_end(&first);
    }
    print_message("orders %.3f %.3f\n", log2((film[0] - film[1]) / (film[1] - film[2])),
                  log2((film[1] - film[2]) / (film[2] - film[3])));
    check_close(log2((film[1] - film[2]) / (film[2] - film[3])), 2, 0, 0.3);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fine_grid_is_of_second_order),
        cmocka_unit_test(default_tolerance_is_enough),
        cmocka_unit_test(large_amplitudes_are_completed),
    };
    return cmocka_run_group_tests_name("long_transient", tests, NULL, NULL);
}
