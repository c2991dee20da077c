/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Estimated effects of the domain's length and of the grid step on a solution. The estimates are
 * compared with solutions on longer domains and finer grids. */
#include "fullrun/resolution.h"

#include "tests/unit/allocation.h"
#include "tests/unit/check.h"
#include "tests/unit/sample.h"

#include <math.h>

/* Computes a solution from a cold start. The caller frees it with full_state_free. */
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

/* Checks that an estimate is at least the effect and at most `factor` times the effect. */
static void check_bound(double estimated, double effect, double factor) {
    assert_true(estimated >= fabs(effect));
    assert_true(estimated <= factor * fabs(effect));
}

static void set_inlet(ehd_contact *contact, double x_min) {
    const double step = contact->grid.step;

    contact->grid = grid_of(x_min, step, (size_t)lround((2 - x_min) / step) + 1, 1, false,
                            contact->grid.discretization);
}

/* Compares the estimated inlet effect with the change of the films if the inlet begins at -32
 * instead of -4. Under light loads the load of the missing inlet matters, and the minimum film may
 * change more or less than the central film. */
static void inlet_effect_is_what_a_long_inlet_does(void **state) {
    (void)state;
    static const struct {
        const char *lubricant, *density;
        double moes_M, moes_L;
    } cases[] = {{"barus", "incompressible", 5, 10},   {"barus", "incompressible", 40, 10},
                 {"barus", "incompressible", 10, 2.5}, {"roelands", "dowson-higginson", 5, 25},
                 {"no1", "dowson-higginson", 12, 12},  {"barus", "incompressible", 2, 0},
                 {"barus", "incompressible", 5, 0},    {"barus", "incompressible", 10, 0},
                 {"barus", "incompressible", 3, 5},    {"roelands", "incompressible", 2.5, 10}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        ehd_contact contact = sample_contact(cases[i].lubricant, cases[i].density, cases[i].moes_M,
                                             cases[i].moes_L, 0.02);
        const film_effects found = estimate(&contact).effects;
        const film_pair films = films_of(&contact);
        set_inlet(&contact, -32);
        const film_pair wide = films_of(&contact);
        check_bound(found.of[EFFECT_INLET], wide.central / films.central - 1, 1.4);
        // this estimate is at least the estimate of the central film, which usually changes more
        check_bound(found.of[EFFECT_INLET_MINIMUM], wide.minimum / films.minimum - 1, 1.75);
    }
}

/* Like the load of the missing inlet, the estimated effect is inversely proportional to the square
 * of the inlet's length, also for thick films, as in a rigid isoviscous contact. */
static void inlet_effect_of_a_thick_film(void **state) {
    (void)state;
    static const double cases[][2] = {{0.5, -32}, {1, -16}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        ehd_contact contact = sample_contact("barus", "incompressible", cases[i][0], 0, 0.04);
        double effect[2], film[2];
        for (int k = 0; k < 2; k++) {
            set_inlet(&contact, cases[i][1] * (1 + k));
            effect[k] = estimate(&contact).effects.of[EFFECT_INLET];
            film[k] = central_film(&contact);
        }
        check_close(effect[0] / effect[1], 4, 0.1, 0);
        // the films differ by 3/4 of the effect, because twice the length leaves a quarter of it
        check_bound(effect[0], 4. / 3 * (film[1] / film[0] - 1), 1.35);
    }
}

/* Returns a point contact on a domain that begins at X = -length and ends at |Y| = length / 2. */
static ehd_contact point_from(double moes_M, double moes_L, double length, double step) {
    ehd_contact contact = sample_point("barus", "incompressible", moes_M, moes_L, 24, true);

    contact.grid =
        grid_of(-length, step, (size_t)lround((length + 2) / step) + 1,
                (size_t)lround(length / 2 / step) + 1, true, contact.grid.discretization);
    return contact;
}

/* Compares the estimate with the change of the film from this domain to the limit of long domains.
 * The limit is extrapolated from two lengths: the difference from the limit is taken as
 * proportional to one over the length. The films are computed on grids with twice the step, as in
 * the estimate. For the minimum film the estimate is only an upper bound. */
static void inlet_effect_of_a_point_contact(void **state) {
    (void)state;
    static const struct {
        double moes_M, moes_L, central; // largest ratio of estimate to effect
        double minimum[2];              // limits of this ratio for the minimum film
    } cases[] = {{10, 0, 1.62, {1, 12}}, {6, 0, 1.62, {1, 3}}, {15, 1, 1.62, {1, 12}}};
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
        const double ratio = found.of[EFFECT_INLET_MINIMUM] / fabs(minimum);
        check_bound(found.of[EFFECT_INLET], central, cases[i].central);
        assert_true(ratio > cases[i].minimum[0] && ratio < cases[i].minimum[1]);
    }
}

/* Returns a point contact with far field, on X >= -length and |Y| <= 3/4 length. */
static ehd_contact open_point_from(double moes_M, double moes_L, double length, double step,
                                   bool half) {
    ehd_contact contact = sample_point("barus", "incompressible", moes_M, moes_L, 24, half);
    const size_t beside = (size_t)lround(0.75 * length / step);

    contact.grid = grid_of(-length, step, (size_t)lround((length + fmax(2, length / 2)) / step) + 1,
                           half ? beside + 1 : 2 * beside + 1, half, contact.grid.discretization);
    contact.grid.boundary = BOUNDARY_OPEN;
    return contact;
}

/* Compares the estimated inlet effect with the change of the film on a domain of twice the length.
 * Both films are computed on grids with twice the step; the estimate uses four times the step. If
 * the pressure around the domain were zero, these effects would be 30 to 100 times as large. */
static void inlet_effect_of_an_open_point_contact(void **state) {
    (void)state;
    // M, L, length, step
    static const double cases[][4] = {
        {2, 0, 8, 0.125}, {3, 5, 4, 0.125}, {10, 0, 4, 0.0625}, {20, 5, 3, 0.0625}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const double M = cases[i][0], L = cases[i][1], length = cases[i][2], step = cases[i][3];
        const ehd_contact half = open_point_from(M, L, length, step, true);
        const ehd_contact whole = open_point_from(M, L, length, step, false);
        const ehd_contact coarse = open_point_from(M, L, length, 2 * step, true);
        const ehd_contact longer = open_point_from(M, L, 2 * length, 2 * step, true);
        const film_effects found = estimate(&half).effects, of_whole = estimate(&whole).effects;
        const double effect = central_film(&longer) / central_film(&coarse) - 1;
        assert_true(fabs(effect) < 0.03);
        check_bound(found.of[EFFECT_INLET], effect, 2.6);
        check_close(found.of[EFFECT_INLET], of_whole.of[EFFECT_INLET], 1e-3, 1e-6);
        check_close(found.of[EFFECT_INLET_MINIMUM], of_whole.of[EFFECT_INLET_MINIMUM], 1e-3, 1e-6);
    }
}

static double rolling_of(const ehd_contact *contact) {
    full_state state;

    solve(&state, contact);
    const double moment = full_evaluate_traction(&state, contact).rolling_moment;
    full_state_free(&state);
    return moment;
}

static ehd_contact in_size(ehd_contact contact) {
    contact.half_width = 1e-4;
    contact.radius = 1e-2;
    return contact;
}

/* The estimate for the rolling resistance is between one and four times the effect. The effect is
 * the change with an inlet that begins at -24, or for points with a domain three times as long. */
static void inlet_effect_of_the_rolling(void **state) {
    (void)state;
    static const double lines[][2] = {{5, 10}, {10, 2.5}, {40, 10}}; // M, L
    static const double points[][3] = {{10, 0, 4}, {50, 8, 3}};      // M, L, length
    for (size_t i = 0; i < 3; i++) {
        ehd_contact line =
            in_size(sample_contact("barus", "incompressible", lines[i][0], lines[i][1], 0.02));
        const double found = estimate(&line).effects.of[EFFECT_INLET_ROLLING];
        const double here = rolling_of(&line);
        set_inlet(&line, -24);
        const double ratio = found / (rolling_of(&line) / here - 1);
        assert_true(ratio > 1 && ratio < 4);
    }
    for (size_t i = 0; i < 2; i++) {
        const double M = points[i][0], L = points[i][1], length = points[i][2];
        const ehd_contact point = in_size(open_point_from(M, L, length, 0.125, true));
        const ehd_contact longer = in_size(open_point_from(M, L, 3 * length, 0.125, true));
        const double off = fabs(rolling_of(&longer) / rolling_of(&point) - 1);
        const double ratio = estimate(&point).effects.of[EFFECT_INLET_ROLLING] / off;
        assert_true(ratio > 1 && ratio < 4);
    }
}

/* Compares the estimate with an extrapolation from two finer grids. */
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
        check_bound(resolution.effects.of[EFFECT_STEP], measured, 1.5);
        check_close(resolution.order, 2, 0.2, 0);
    }
}

/* In the accurate discretisation, the error of the central film at M = 100, L = 20 falls by a
 * factor of 70, faster than with third order, the highest order of the estimate. At M = 5 the error
 * falls with first order, because the place of zero pressure before the inlet depends on the step.
 * At M = 20 both errors occur, with opposite signs. */
static void step_effects_are_of_the_right_size(void **state) {
    (void)state;
    static const struct {
        ehd_discretization discretization;
        double moes_M, moes_L, central, minimum; // largest ratio of estimate to effect
    } cases[] = {
        {DISCRETIZATION_PUBLISHED, 40, 5, 1.5, 3}, {DISCRETIZATION_PUBLISHED, 100, 10, 1.5, 3},
        {DISCRETIZATION_ACCURATE, 5, 20, 2, 4},    {DISCRETIZATION_ACCURATE, 20, 5, 2, 30},
        {DISCRETIZATION_ACCURATE, 50, 10, 10, 4},  {DISCRETIZATION_ACCURATE, 100, 20, 30, 15}};
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
        check_bound(found.effects.of[EFFECT_STEP], exact.central / films.central - 1,
                    cases[i].central);
        check_bound(found.effects.of[EFFECT_STEP_MINIMUM], exact.minimum / films.minimum - 1,
                    cases[i].minimum);
    }
}

/* Compares the estimate for point contacts, whose rows have second order, with an extrapolation
 * from two finer grids. With a larger grid step the far field also begins farther out. */
static void step_effect_of_a_point_contact(void **state) {
    (void)state;
    static const double cases[][2] = {{3, 0}, {10, 5}, {20, 0}}; // M, L
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const double M = cases[i][0], L = cases[i][1], length = 4;
        const ehd_contact own = open_point_from(M, L, length, 0.125, true);
        const ehd_contact fine = open_point_from(M, L, length, 0.0625, true);
        const ehd_contact finest = open_point_from(M, L, length, 0.03125, true);
        const film_effects found = estimate(&own).effects;
        const double films[3] = {central_film(&own), central_film(&fine), central_film(&finest)};
        const double effect = (films[2] + (films[2] - films[1]) / 3) / films[0] - 1;
        // at M = 10 the films on the three grids alternate, and the estimate is 5.9 times the effect
        check_bound(found.of[EFFECT_STEP], effect, M == 10 ? 6 : 5);
    }
}

/* Makes the films F (1 + c h^p) for the steps h = 1, 2 and 4. */
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
            // If the order is 1 to 2, the highest order of this estimate, the estimate is exact. If
            // it is lower, the estimate is the change from 2h to h. If it is higher, the estimate
            // follows with second order from the change from 4h to 2h.
            const double change = fabs(films[0] - films[1]) / films[0];
            const double exact = fabs(0.3 / films[0] - 1);
            const double found = full_step_effect(films, 2, 1);
            if (order < 1)
                check_close(found, change, 1e-9, 0);
            else if (order <= 2)
                check_close(found, exact, 1e-9, 0);
            else
                check_close(found, change * exp2(order) / 12, 1e-9, 0);
            check_close(full_step_effect(films, 5, 1), order < 1 ? change : exact, 1e-9, 0);
        }
}

static void films_without_an_order(void **state) {
    (void)state;
    const double to_and_fro[] = {1, 1.03, 1.01}, no_third[] = {1, 1.03, NAN},
                 alone[] = {1, NAN, NAN};
    const double by_chance[] = {1, 1 + 1e-9, 1.12}, across[] = {1, 1.01, 0.97};

    assert_true(isnan(full_observed_order((const double[]){1, 1.03, 1})));
    assert_true(isnan(full_observed_order(no_third)));
    check_close(full_step_effect(to_and_fro, 2, 0.04), 0.03, 1e-12, 0);
    check_close(full_step_effect(no_third, 2, 0.04), 0.03, 1e-12, 0);
    // if the change exceeds the limit of 0.02, there is no estimate
    assert_true(isinf(full_step_effect(to_and_fro, 2, 0.02)));
    assert_true(isinf(full_step_effect(no_third, 2, 0.02)));
    assert_true(isinf(full_step_effect(alone, 2, 1)));
    // the two finest films agree by chance, but the third film is far off: with second order the
    // estimate is 0.12 / 4 / 3
    check_close(full_step_effect(by_chance, 2, 0.02), 0.01, 1e-6, 0);
    check_close(full_step_effect(by_chance, 3, 0.02), 0.12 / 8 / 7, 1e-6, 0);
    // If the changes from 4h to 2h and from 2h to h have opposite signs, the estimate is the change
    // from 2h to h. An eighth of the change from 4h to 2h takes its place if this eighth is larger.
    check_close(full_step_effect(across, 2, 0.001), 0.01, 1e-12, 0);
    check_close(full_step_effect((const double[]){1, 1.01, 0.77}, 2, 0.001), 0.03, 1e-12, 0);
}

/* The numbers of nodes in the inlet, the outlet and the spike grow with the grid. This is tested in
 * the published discretisation. In the accurate discretisation neither grid resolves the spike:
 * pressures before it alternate from node to node, and it is one node wide on both grids. */
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
    // without piezoviscosity the pressure has one maximum and no spike
    ehd_contact smooth = sample_contact("barus", "incompressible", 12, 0, 0.01);
    assert_int_equal(estimate(&smooth).spike_nodes, 0);
}

/* There is no estimate if a grid with twice the step does not resolve the film. */
static void too_coarse_to_tell(void **state) {
    (void)state;
    ehd_contact contact = sample_contact("barus", "incompressible", 500, 0, 0.01);
    full_resolution resolution = estimate(&contact);
    assert_true(isinf(resolution.effects.of[EFFECT_STEP]));
    assert_true(isinf(resolution.effects.of[EFFECT_STEP_MINIMUM]));
    assert_true(isnan(resolution.order));
    assert_true(isfinite(resolution.effects.of[EFFECT_INLET]));
    // with twice the step the central film differs by 6 % and the minimum film by 36 %
    contact = sample_contact("barus", "incompressible", 1000, 10, 0.02);
    resolution = estimate(&contact);
    assert_true(isinf(resolution.effects.of[EFFECT_STEP]));
    assert_true(isinf(resolution.effects.of[EFFECT_STEP_MINIMUM]));
    // with four steps per half width the central film of this point contact is wrong by 19 %
    contact = open_point_from(5.2, 18, 4, 0.25, true);
    resolution = estimate(&contact);
    assert_true(isinf(resolution.effects.of[EFFECT_STEP]));
}

/* The estimate hardly changes with an even number of nodes, or on grids whose coarser grid has no
 * node at X = 0. */
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

/* The half grid and the whole grid have the same estimates, although the coarser grids of a point
 * contact may extend farther to the sides than its own grid. */
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
        cmocka_unit_test(inlet_effect_of_a_thick_film),
        cmocka_unit_test(inlet_effect_of_a_point_contact),
        cmocka_unit_test(inlet_effect_of_an_open_point_contact),
        cmocka_unit_test(inlet_effect_of_the_rolling),
        cmocka_unit_test(step_effect_is_what_a_fine_step_does),
        cmocka_unit_test(step_effects_are_of_the_right_size),
        cmocka_unit_test(step_effect_of_a_point_contact),
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
