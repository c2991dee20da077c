/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Estimates of what domain and step do to a solution, against solutions on wider and finer
 * grids. */
#include "fullrun/resolution.h"

#include "tests/unit/allocation.h"
#include "tests/unit/check.h"
#include "tests/unit/sample.h"

#include <math.h>

/* A cold solution; free with full_state_free. */
static void solve(full_state *state, const ehd_contact *contact) {
    const full_settings settings = full_default_settings();
    full_solver *solver;
    full_info info;

    assert_int_equal(full_solver_create(&solver, contact->kind, &contact->grid, &settings, NULL),
                     EHD_OK);
    assert_int_equal(full_state_init(state, &contact->grid, NULL), EHD_OK);
    assert_int_equal(full_solve_cold(&info, state, solver, contact, NULL), EHD_OK);
    assert_int_equal(info.status, EHD_OK);
    full_solver_free(solver);
}

static full_resolution estimate(const ehd_contact *contact) {
    full_resolution resolution;
    full_state state;

    solve(&state, contact);
    assert_int_equal(full_resolution_estimate(&resolution, &state, contact, NULL, NULL), EHD_OK);
    full_state_free(&state);
    return resolution;
}

typedef struct film_pair {
    double central, minimum;
} film_pair;

static film_pair films_of(const ehd_contact *contact) {
    full_state state;

    solve(&state, contact);
    const contact_scalars scalars = full_evaluate_scalars(&state, contact);
    full_state_free(&state);
    return (film_pair){scalars.central_film_thickness, scalars.minimum_film_thickness};
}

static double central_film(const ehd_contact *contact) {
    return films_of(contact).central;
}

static void set_inlet(ehd_contact *contact, double x_min) {
    const double step = contact->grid.step;

    contact->grid = grid_of(x_min, step, (size_t)lround((2 - x_min) / step) + 1, 1, false,
                            contact->grid.discretization);
}

/* From -4 and -2.5 on, against an inlet from -24 on. */
static void inlet_effect_is_what_a_long_inlet_does(void **state) {
    (void)state;
    static const struct {
        const char *lubricant, *density;
        double moes_M, moes_L, within;
    } cases[] = {
        {"barus", "incompressible", 5, 10, 0.1},   {"barus", "incompressible", 40, 10, 0.1},
        {"barus", "incompressible", 10, 2.5, 0.3}, {"roelands", "dowson-higginson", 5, 25, 0.1},
        {"no1", "dowson-higginson", 12, 12, 0.1},  {"barus", "incompressible", 2, 0, 0.6}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        ehd_contact contact = sample_contact(cases[i].lubricant, cases[i].density, cases[i].moes_M,
                                             cases[i].moes_L, 0.02);
        const double effect = estimate(&contact).effects.of[EFFECT_INLET];
        const double of_minimum = estimate(&contact).effects.of[EFFECT_INLET_MINIMUM];
        const film_pair films = films_of(&contact);
        set_inlet(&contact, -24);
        const film_pair wide = films_of(&contact);
        check_close(effect, wide.central / films.central - 1, cases[i].within, 0);
        // which follows the central film by four fifths, below M = 5 by up to five thirds
        check_close(of_minimum, wide.minimum / films.minimum - 1, cases[i].within + 0.25, 0);
        assert_true(fabs(estimate(&contact).effects.of[EFFECT_INLET]) < 0.02 * effect);
    }
}

/* Without piezoviscosity the viscous pressure is the pressure, and the effect one integral over
 * the missing inlet, here by the trapezoidal rule in t = ln(X / x_min) on many more points. */
static void inlet_effect_is_integrated_finely(void **state) {
    (void)state;
    const ehd_contact contact = sample_contact("barus", "incompressible", 10, 0, 0.02);
    const double start = grid_x(&contact.grid, 0), centre = -contact.grid.x_min;
    const double end = 12, stride = 1e-4; // exp(-3 end) of the integral is behind its end
    full_resolution resolution;
    full_state solution;
    double sum = 0;

    solve(&solution, &contact);
    const double flux = solution.film[solution.exit];
    for (double t = 0; t < end; t += stride) {
        const double x = start * exp(t);
        const double film = solution.film[0] + contact_gap(&shape_round, x, 0) -
                            contact_gap(&shape_round, start, 0) - 0.5 * t;
        const double slope = contact.lambda * (film - flux) / (film * film * film);
        sum += (t > 0 ? 1 : 0.5) * stride * slope * fabs(x);
    }
    const double central_pressure =
        solution.pressure[(size_t)lround(centre / contact.grid.step) + 1];
    assert_int_equal(full_resolution_estimate(&resolution, &solution, &contact, NULL, NULL),
                     EHD_OK);
    check_close(resolution.effects.of[EFFECT_INLET], 8. / 11 * sum / central_pressure, 5e-5, 0);
    full_state_free(&solution);
}

/* A point contact on a domain from -length on, half as wide to either side. */
static ehd_contact point_from(double moes_M, double moes_L, double length, double step) {
    ehd_contact contact = sample_point("barus", "incompressible", moes_M, moes_L, 24, true);

    contact.grid =
        grid_of(-length, step, (size_t)lround((length + 2) / step) + 1,
                (size_t)lround(length / 2 / step) + 1, true, contact.grid.discretization);
    return contact;
}

/* Against the films on long domains, whose effect goes with one over their length; on the grid of
 * twice the step, on which it is estimated. The minimum film's is a bound. */
static void inlet_effect_of_a_point_contact(void **state) {
    (void)state;
    static const struct {
        double moes_M, moes_L, central; // error
        double minimum[2];              // bounds of estimate over effect
    } cases[] = {{10, 0, 0.04, {0.8, 8}}, {6, 0, 0.08, {0.8, 2}}, {15, 1, 0.04, {0.8, 8}}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const double lengths[] = {6, 24, 48}, M = cases[i].moes_M, L = cases[i].moes_L;
        const ehd_contact contact = point_from(M, L, lengths[0], 0.125);
        const film_effects found = estimate(&contact).effects;
        film_pair films[3];
        for (int d = 0; d < 3; d++) {
            const ehd_contact on_domain = point_from(M, L, lengths[d], 0.25);
            films[d] = films_of(&on_domain);
        }
        const double central = (2 * films[2].central - films[1].central) / films[0].central - 1;
        const double minimum = (2 * films[2].minimum - films[1].minimum) / films[0].minimum - 1;
        const double ratio = found.of[EFFECT_INLET_MINIMUM] / minimum;
        check_close(found.of[EFFECT_INLET], central, cases[i].central, 0);
        assert_true(ratio > cases[i].minimum[0] && ratio < cases[i].minimum[1]);
    }
}

/* With the far field around, of a domain from -length on, three quarters as wide to either
 * side. */
static ehd_contact open_point_from(double moes_M, double moes_L, double length, double step,
                                   bool half) {
    ehd_contact contact = sample_point("barus", "incompressible", moes_M, moes_L, 24, half);
    const size_t beside = (size_t)lround(0.75 * length / step);

    contact.grid = grid_of(-length, step, (size_t)lround((length + fmax(2, length / 2)) / step) + 1,
                           half ? beside + 1 : 2 * beside + 1, half, contact.grid.discretization);
    contact.grid.boundary = BOUNDARY_OPEN;
    return contact;
}

/* Against the film on a domain of twice the length, on the grid of twice the step, on which it is
 * estimated from a shorter one. With zero around these effects are 30 to 100 times as large. */
static void inlet_effect_of_an_open_point_contact(void **state) {
    (void)state;
    static const double cases[][3] = {{2, 0, 8}, {3, 5, 4}, {10, 0, 4}, {20, 5, 4}}; // M, L, length
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const double M = cases[i][0], L = cases[i][1], length = cases[i][2];
        const ehd_contact half = open_point_from(M, L, length, 0.125, true);
        const ehd_contact whole = open_point_from(M, L, length, 0.125, false);
        const ehd_contact coarse = open_point_from(M, L, length, 0.25, true);
        const ehd_contact longer = open_point_from(M, L, 2 * length, 0.25, true);
        const film_effects found = estimate(&half).effects, of_whole = estimate(&whole).effects;
        const double effect = central_film(&longer) / central_film(&coarse) - 1;
        const double ratio = found.of[EFFECT_INLET] / effect;
        assert_true(fabs(effect) < 0.03);
        assert_true(ratio > 0.4 && ratio < 2);
        check_close(found.of[EFFECT_INLET], of_whole.of[EFFECT_INLET], 1e-3, 1e-6);
        check_close(found.of[EFFECT_INLET_MINIMUM], of_whole.of[EFFECT_INLET_MINIMUM], 1e-3, 1e-6);
    }
}

/* Against the extrapolation from two finer grids. */
static void step_effect_is_what_a_fine_step_does(void **state) {
    (void)state;
    static const double cases[][2] = {{12, 12}, {40, 5}, {100, 2.5}, {20, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        ehd_contact contact = sample_published(
            sample_contact("barus", "dowson-higginson", cases[i][0], cases[i][1], 0.01));
        full_resolution resolution = estimate(&contact);
        double film = central_film(&contact);
        contact = sample_published(
            sample_contact("barus", "dowson-higginson", cases[i][0], cases[i][1], 0.005));
        double fine = central_film(&contact);
        contact = sample_published(
            sample_contact("barus", "dowson-higginson", cases[i][0], cases[i][1], 0.0025));
        double finest = central_film(&contact);
        double measured = (finest + (finest - fine) / 3) / film - 1;
        check_close(resolution.effects.of[EFFECT_STEP], measured, 0.15, 0);
        check_close(resolution.order, 2, 0.2, 0);
    }
}

/* The same of the minimum film, and of the accurate rows: what they do to the central film falls by
 * 70 at M = 100, L = 20, more than with the fourth power up to which the estimate counts; with the
 * first at M = 5, by where the zero before the inlet lies; with both, of unlike sign, at M = 20. */
static void step_effects_are_of_the_right_size(void **state) {
    (void)state;
    static const struct {
        ehd_discretization discretization;
        double moes_M, moes_L, central[2], minimum[2]; // bounds of estimate over effect
    } cases[] = {{DISCRETIZATION_PUBLISHED, 40, 5, {0.87, 1.15}, {0.5, 2}},
                 {DISCRETIZATION_PUBLISHED, 100, 10, {0.87, 1.15}, {0.5, 2}},
                 {DISCRETIZATION_ACCURATE, 5, 20, {0.8, 1.25}, {0.7, 2.5}},
                 {DISCRETIZATION_ACCURATE, 20, 5, {0.8, 1.25}, {0.7, 10}},
                 {DISCRETIZATION_ACCURATE, 50, 10, {1, 5}, {0.4, 2}},
                 {DISCRETIZATION_ACCURATE, 100, 20, {1, 7}, {0.5, 2}}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        ehd_contact contact =
            sample_contact("roelands", "dowson-higginson", cases[i].moes_M, cases[i].moes_L, 0.01);
        contact.grid.discretization = cases[i].discretization;
        const full_resolution found = estimate(&contact);
        const film_pair films = films_of(&contact);
        contact = sample_contact("roelands", "dowson-higginson", cases[i].moes_M, cases[i].moes_L,
                                 0.00125);
        contact.grid.discretization = DISCRETIZATION_ACCURATE;
        const film_pair exact = films_of(&contact);
        const double central =
            fabs(found.effects.of[EFFECT_STEP] / (exact.central / films.central - 1));
        const double minimum =
            fabs(found.effects.of[EFFECT_STEP_MINIMUM] / (exact.minimum / films.minimum - 1));
        assert_true(central > cases[i].central[0] && central < cases[i].central[1]);
        assert_true(minimum > cases[i].minimum[0] && minimum < cases[i].minimum[1]);
    }
}

/* Films F (1 + c h^p) on steps h, 2h, 4h. */
static void make_films(double films[3], double limit, double error, double order) {
    for (int g = 0; g < 3; g++)
        films[g] = limit * (1 + error * exp2(g * order));
}

static void orders_of_manufactured_films(void **state) {
    (void)state;
    double films[3];

    for (double order = 0.5; order <= 5; order += 0.5)
        for (double error = -0.01; error <= 0.01; error += 0.02) {
            make_films(films, 0.3, error, order);
            check_close(full_observed_order(films), order, 1e-10, 0);
            // exact within the bounds; beyond them what these make of the finest change
            const double used = fmin(fmax(order, 1), 2);
            const double change = films[0] - films[1];
            const double exact = 0.3 / films[0] - 1;
            const double bounded = change / films[0] / (exp2(used) - 1);
            check_close(full_step_effect(films), used == order ? exact : bounded, 1e-9, 0);
            if (order >= 1 && order <= 2)
                check_close(full_step_effect_minimum(films), fabs(exact), 1e-9, 0);
            if (order <= 4) check_close(full_step_effect_accurate(films, 0.5, 5), exact, 1e-9, 0);
            if (order >= 4) // the coarser change is the larger one for fourth order
                check_close(full_step_effect_accurate(films, 3, 4),
                            change * exp2(order) / films[0] / 240, 1e-9, 0);
            if (order <= 3)
                check_close(full_step_effect_accurate(films, 3, 4), change / films[0] / 7, 1e-9, 0);
        }
}

static void films_without_an_order(void **state) {
    (void)state;
    const double to_and_fro[] = {1, 1.03, 1}, no_third[] = {1, 1.03, NAN}, alone[] = {1, NAN, NAN};
    const double by_chance[] = {1, 1 + 1e-9, 1.12};

    assert_true(isnan(full_observed_order(to_and_fro)));
    assert_true(isnan(full_observed_order(no_third)));
    check_close(full_step_effect(to_and_fro), -0.01, 1e-12, 0);
    check_close(full_step_effect(no_third), -0.01, 1e-12, 0);
    check_close(full_step_effect_minimum(no_third), 0.01, 1e-12, 0);
    assert_true(isinf(full_step_effect(alone)));
    assert_true(isinf(full_step_effect_minimum(alone)));
    // the finest two agree though the third is far off: second order leaves 0.12 / 4 / 3
    assert_true(fabs(full_step_effect(by_chance)) < 1e-9);
    check_close(full_step_effect_minimum(by_chance), 0.01, 1e-6, 0);
    check_close(full_step_effect_accurate(by_chance, 3, 4), -0.12 / 240, 1e-6, 0);
    check_close(full_step_effect_accurate(to_and_fro, 3, 4), -0.01, 1e-12, 0);
    check_close(full_step_effect_accurate(no_third, 3, 4), -0.01, 1e-12, 0);
    assert_true(isinf(full_step_effect_accurate(alone, 3, 4)));
}

/* With the published rows: the accurate ones alternate before a spike that the grid does not resolve,
 * so that it is one node wide on both grids. */
static void nodes_grow_with_the_grid(void **state) {
    (void)state;
    const ehd_contact coarse =
        sample_published(sample_contact("barus", "incompressible", 12, 8, 0.01));
    const ehd_contact fine =
        sample_published(sample_contact("barus", "incompressible", 12, 8, 0.0025));
    full_resolution few = estimate(&coarse), many = estimate(&fine);
    check_close((double)many.inlet_nodes, 4. * (double)few.inlet_nodes, 0.05, 0);
    check_close((double)many.outlet_nodes, 4. * (double)few.outlet_nodes, 0.15, 0);
    assert_true(few.spike_nodes >= 1 && many.spike_nodes > few.spike_nodes);
    assert_true(few.inlet_nodes > 50 && few.inlet_nodes < 200);
    // without piezoviscosity there is one maximum
    ehd_contact smooth = sample_contact("barus", "incompressible", 12, 0, 0.01);
    assert_int_equal(estimate(&smooth).spike_nodes, 0);
}

/* A grid that just resolves the film: twice its step does not. */
static void too_coarse_to_tell(void **state) {
    (void)state;
    ehd_contact contact = sample_contact("barus", "incompressible", 1000, 0, 0.01);
    full_resolution resolution = estimate(&contact);
    assert_true(isinf(resolution.effects.of[EFFECT_STEP]));
    assert_true(isinf(resolution.effects.of[EFFECT_STEP_MINIMUM]));
    assert_true(isnan(resolution.order));
    assert_true(isfinite(resolution.effects.of[EFFECT_INLET]));
}

/* An even number of nodes, and one for which no coarser node lies at X = 0. */
static void any_number_of_nodes(void **state) {
    (void)state;
    ehd_contact contact = sample_contact("barus", "incompressible", 12, 8, 0.01);
    double effect = estimate(&contact).effects.of[EFFECT_STEP];
    for (int shift = 1; shift < 4; shift++) {
        const ehd_grid grid = contact.grid;
        contact.grid = grid_like(&grid, grid.x_min, grid.step, grid.inner_x - 1, 1);
        check_close(estimate(&contact).effects.of[EFFECT_STEP], effect, 0.1, 0);
        contact.grid = grid_like(&grid, grid.x_min + grid.step, grid.step, grid.inner_x - 2, 1);
        check_close(estimate(&contact).effects.of[EFFECT_STEP], effect, 0.1, 0);
    }
}

static void estimate_without_memory(void **state) {
    (void)state;
    const ehd_contact contacts[] = {
        sample_contact("barus", "dowson-higginson", 12, 8, 0.05),
        sample_point("barus", "incompressible", 15, 4, 48, true),
    };
    for (int c = 0; c < 2; c++) {
        full_resolution resolution;
        full_state solution;
        size_t call = 0;
        bool failed;

        solve(&solution, &contacts[c]);
        do {
            allocation_fail_at(call);
            ehd_status status =
                full_resolution_estimate(&resolution, &solution, &contacts[c], NULL, NULL);
            failed = allocation_failed();
            assert_int_equal(status, failed ? EHD_MEMORY : EHD_OK);
        } while (failed && call++ < 300);
        assert_true(call >= 30 && call < 300);
        full_state_free(&solution);
    }
}

/* Coarser grids of a point contact may reach farther to the sides than the grid does; of half of it
 * they do as of all. */
static void half_and_whole_say_the_same(void **state) {
    (void)state;
    for (size_t cells = 48; cells <= 54; cells += 2) {
        const ehd_contact half = sample_point("barus", "incompressible", 15, 4, cells, true);
        const ehd_contact whole = sample_point("barus", "incompressible", 15, 4, cells, false);
        const full_resolution one = estimate(&half), other = estimate(&whole);
        check_close(one.effects.of[EFFECT_STEP], other.effects.of[EFFECT_STEP], 1e-3, 1e-5);
        assert_int_equal(one.outlet_nodes, other.outlet_nodes);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(inlet_effect_is_what_a_long_inlet_does),
        cmocka_unit_test(inlet_effect_is_integrated_finely),
        cmocka_unit_test(inlet_effect_of_a_point_contact),
        cmocka_unit_test(inlet_effect_of_an_open_point_contact),
        cmocka_unit_test(step_effect_is_what_a_fine_step_does),
        cmocka_unit_test(step_effects_are_of_the_right_size),
        cmocka_unit_test(orders_of_manufactured_films),
        cmocka_unit_test(films_without_an_order),
        cmocka_unit_test(nodes_grow_with_the_grid),
        cmocka_unit_test(too_coarse_to_tell),
        cmocka_unit_test(any_number_of_nodes),
        cmocka_unit_test(half_and_whole_say_the_same),
        cmocka_unit_test(estimate_without_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
