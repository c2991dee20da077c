/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/exit.h"
#include "tests/unit/check.h"

static void violations_are_those_of_the_complementarity(void **state) {
    const reynolds_row row = {.residual = 3};
    (void)state;

    check_close(exit_multiplier(&row), -3, 0, 0);
    check_close(exit_violation(true, -0.1, -3), 0.1, 0, 0);
    check_close(exit_violation(false, -0.1, -3), 3, 0, 0);
    assert_true(exit_violation(true, 0.1, -3) < 0);
    assert_true(exit_violation(false, 0.1, 3) < 0);
}

// ---- an exit that is known: H = node, U = 2

static double film_is_the_node(void *context, size_t node) {
    (void)context;
    return (double)node;
}

typedef struct known_exit {
    double flux, multiplier;
    size_t flux_node; // that was asked for last
} known_exit;

static double known_flux(void *context, size_t node) {
    known_exit *known = context;
    known->flux_node = node;
    return known->flux;
}

static double known_multiplier(void *context, size_t node) {
    (void)node;
    return ((known_exit *)context)->multiplier;
}

static exit_line line_of(known_exit *known, const double *pressure) {
    return (exit_line){.pressure = pressure,
                       .first_node = 10,
                       .min_exit = 12,
                       .max_exit = 40,
                       .max_stride = 8,
                       .entrainment = 2,
                       .pressure_noise = 1e-3,
                       .multiplier_noise = 1e-2,
                       .state = known,
                       .film = film_is_the_node,
                       .flux = known_flux,
                       .multiplier = known_multiplier};
}

static void an_exit_that_nothing_moves_stays(void **state) {
    const double pressure[10] = {1, 1, 1, 1, 1, 1, 1, -0.9e-3, 1, 0};
    known_exit known = {.flux = 100, .multiplier = -0.9e-2};
    (void)state;

    const exit_line line = line_of(&known, pressure);
    assert_int_equal(exit_by_flux(&line, 20), 20);
}

static void negative_pressure_brings_it_back_to_where_the_film_carries_the_flux(void **state) {
    const double pressure[10] = {1, 1, 1, 1, -1.1e-3, 1, 1, 1, 1, 1};
    known_exit known = {.flux = 2 * 16.5};
    (void)state;

    exit_line line = line_of(&known, pressure);
    assert_int_equal(exit_by_flux(&line, 20), 17);
    assert_int_equal(known.flux_node, 14);
    known.flux = 2 * 5; // already at the negative node
    assert_int_equal(exit_by_flux(&line, 20), 14);
    known.flux = 2 * 30; // never as far as it was
    assert_int_equal(exit_by_flux(&line, 20), 19);
    line.min_exit = 16;
    known.flux = 2 * 5;
    assert_int_equal(exit_by_flux(&line, 20), 16);
}

static void a_negative_multiplier_takes_it_on(void **state) {
    const double pressure[30] = {0};
    known_exit known = {.flux = 2 * 24.5, .multiplier = -1.1e-2};
    (void)state;

    exit_line line = line_of(&known, pressure);
    assert_int_equal(exit_by_flux(&line, 20), 25);
    assert_int_equal(known.flux_node, 20);
    known.flux = 0; // by one node at least
    assert_int_equal(exit_by_flux(&line, 20), 21);
    known.flux = 2 * 100; // and by the longest stride at most
    assert_int_equal(exit_by_flux(&line, 20), 28);
    assert_int_equal(exit_by_flux(&line, 38), 40);
    assert_int_equal(exit_by_flux(&line, 40), 40);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(violations_are_those_of_the_complementarity),
        cmocka_unit_test(an_exit_that_nothing_moves_stays),
        cmocka_unit_test(negative_pressure_brings_it_back_to_where_the_film_carries_the_flux),
        cmocka_unit_test(a_negative_multiplier_takes_it_on),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
