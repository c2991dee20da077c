/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/traction.h"
#include "common/settings/scene_contact.h"
#include "tests/unit/check.h"
#include "tests/unit/problem.h"
#include "tests/unit/sample.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double slope = 0.02; // a/R

static ehd_contact with_sliding(ehd_contact contact, double slide_roll) {
    contact.radius = 0.0125;
    contact.half_width = slope * contact.radius;
    contact.speed = 1;
    contact.load = 1e5;
    contact.slide_roll = slide_roll;
    return contact;
}

static void set_shear(ehd_contact *contact, const char *law, double first, double second) {
    contact->lubricant.shear = laws_find(shear_laws, law);
    assert_non_null(contact->lubricant.shear);
    contact->lubricant.shear_constants[0] = first;
    contact->lubricant.shear_constants[1] = second;
}

static double viscosity_ratio(const ehd_contact *contact, double pressure) {
    double slope_of_log;

    return exp(contact->lubricant.viscosity->evaluate(
        &contact->lubricant, pressure * contact->hertz_pressure, &slope_of_log));
}

// ---- laws

static void laws_have_their_limits(void **state) {
    (void)state;
    ehd_contact contact = with_sliding(sample_contact("barus", "incompressible", 20, 8, 0.05), 0.1);
    const double hertz = contact.hertz_pressure;
    for (double pressure = 0.05; pressure < 1; pressure += 0.05) {
        const double film = 0.1;
        set_shear(&contact, "newtonian", NAN, NAN);
        const double newton = contact_shear_stress(&contact, pressure, film);
        // eta0 (u1 - u2)/h in units of p_H
        check_close(newton,
                    contact.lambda / 12 * slope * 0.1 / film * viscosity_ratio(&contact, pressure),
                    1e-14, 0);
        // far above its stresses every law is Newton's
        set_shear(&contact, "eyring", 1e6 * newton * hertz, NAN);
        check_close(contact_shear_stress(&contact, pressure, film), newton, 1e-12, 0);
        set_shear(&contact, "carreau", 1e7 * newton * hertz, 0.5);
        check_close(contact_shear_stress(&contact, pressure, film), newton, 1e-12, 0);
        set_shear(&contact, "limiting", 1e6 * newton / pressure, NAN);
        check_close(contact_shear_stress(&contact, pressure, film), newton, 1e-6, 0);
        // at them, by their definition: the rate of shear that belongs to the stress
        const double tau0 = newton * hertz / 3, viscous = newton * hertz;
        set_shear(&contact, "eyring", tau0, NAN);
        double stress = contact_shear_stress(&contact, pressure, film) * hertz;
        check_close(tau0 * sinh(stress / tau0), viscous, 1e-13, 0);
        set_shear(&contact, "limiting", newton / (3 * pressure), NAN);
        stress = contact_shear_stress(&contact, pressure, film) * hertz;
        check_close(-tau0 * log(1 - stress / tau0), viscous, 1e-13, 0);
        assert_true(stress < tau0);
        set_shear(&contact, "carreau", tau0, 0.4);
        stress = contact_shear_stress(&contact, pressure, film) * hertz;
        check_close(stress, viscous * pow(1 + 9, (0.4 - 1) / 2), 1e-13, 0);
        set_shear(&contact, "carreau", tau0, 1);
        check_close(contact_shear_stress(&contact, pressure, film), newton, 1e-14, 0);
        // the faster surface drags, whichever it is
        contact.slide_roll = -0.1;
        check_close(contact_shear_stress(&contact, pressure, film), -newton, 1e-14, 0);
        contact.slide_roll = 0.1;
    }
}

/* In closed form: Newton's by the viscosity's slope, an Eyring fluid's by asinh, and one at its
 * limit. */
static void slopes_are_those_of_the_laws(void **state) {
    (void)state;
    ehd_contact contact = with_sliding(sample_contact("barus", "incompressible", 20, 8, 0.05), 0.1);
    const double hertz = contact.hertz_pressure;

    for (double pressure = 0.05; pressure < 1; pressure += 0.1) {
        const double film = 0.1;
        set_shear(&contact, "newtonian", NAN, NAN);
        const double newton = contact_shear_stress(&contact, pressure, film);
        stress_slopes found = contact_stress_slopes(&contact, pressure, film);
        check_close(found.by_pressure, contact.alpha_p_H * newton, 1e-5, 0);
        check_close(found.by_film, -newton / film, 1e-5, 0);
        const double tau0 = 0.3 * newton;
        set_shear(&contact, "eyring", tau0 * hertz, NAN);
        found = contact_stress_slopes(&contact, pressure, film);
        const double by_viscous = 1 / hypot(1, newton / tau0);
        check_close(found.by_pressure, contact.alpha_p_H * newton * by_viscous, 1e-5, 0);
        check_close(found.by_film, -newton / film * by_viscous, 1e-5, 0);
        set_shear(&contact, "limiting", 1e-3 * newton, NAN);
        found = contact_stress_slopes(&contact, pressure, film);
        check_close(found.by_pressure, 1e-3 * newton, 1e-5, 0);
        check_close(found.by_film, 0, 0, 1e-9);
    }
}

/* A viscosity of hundreds of decades overflows nothing. */
static void stresses_stay_finite(void **state) {
    (void)state;
    ehd_contact contact =
        with_sliding(sample_contact("barus", "incompressible", 2000, 25, 0.05), 2);
    assert_true(contact.alpha_p_H > 400);
    set_shear(&contact, "eyring", 5e6, NAN);
    assert_true(isfinite(contact_shear_stress(&contact, 1, 1e-3)));
    set_shear(&contact, "carreau", 5e6, 0.3);
    assert_true(isfinite(contact_shear_stress(&contact, 1, 1e-3)));
    set_shear(&contact, "limiting", 0.08, NAN);
    check_close(contact_shear_stress(&contact, 1, 1e-3), 0.08, 1e-12, 0);
    assert_true(contact_shear_stress(&contact, 0, 1e-3) == 0);
}

// ---- integrals

/* A plug of constant film and pressure, as wide as the dry contact: all in closed form. */
static void plug_of_constant_film(void **state) {
    (void)state;
    const double film = 0.07, pressure = 0.6;
    for (int dimensions = 1; dimensions <= 2; dimensions++) {
        ehd_contact contact = dimensions == 1
                                  ? sample_contact("barus", "incompressible", 20, 8, 0.0625)
                                  : sample_point("barus", "incompressible", 20, 8, 64, true);
        contact = with_sliding(contact, -0.3);
        const ehd_grid *grid = &contact.grid;
        double *p = calloc(grid->num_nodes, sizeof *p), *h = malloc(grid->num_nodes * sizeof *h);
        double cells = 0;
        assert_true(p && h);
        for (size_t k = 0; k < grid->num_nodes; k++)
            h[k] = film;
        for (size_t r = 0; r < grid->num_inner; r++) {
            const size_t k = grid_node_of_row(grid, r);
            if (hypot(grid_x(grid, k), grid_y(grid, k)) > 1) continue;
            p[k] = pressure;
            cells += grid_weight(grid, k);
        }
        const contact_scalars scalars = {.load = 0.8, .exit_position = NAN};
        const contact_traction found = contact_traction_of(&contact, p, h, &scalars);
        const double here = -contact.lambda / 12 * slope * 0.3 / film;
        const double stress = here * viscosity_ratio(&contact, pressure);
        // behind the last node the stress goes over to that of no pressure within a step
        double force = stress * cells * grid_cell(grid), ends = 0;
        for (size_t r = 0; r < grid->num_inner; r++) {
            const size_t k = grid_node_of_row(grid, r);
            if (p[k] > 0 && !(p[k + 1] > 0)) ends += grid_weight(grid, k);
        }
        force += ends * grid_cell(grid) * here / 2;
        check_close(found.friction, force / contact.kind->load, 1e-13, 0);
        check_close(found.coefficient, found.friction / 0.8, 1e-14, 0);
        check_close(found.mean_stress, -stress, 1e-13, 0);
        check_close(found.largest_stress, -stress, 1e-14, 0);
        check_close(found.rolling_resistance, 0, 0, 1e-15);
        check_close(found.rolling_moment, 0, 0, 1e-15);
        check_close(found.power, -0.3 * found.friction, 1e-13, 0);
        free(p);
        free(h);
    }
}

/* Where the exit lies within the last cell, of stresses that vary linearly there: exact. */
static void exit_within_a_cell(void **state) {
    (void)state;
    ehd_contact contact = with_sliding(sample_contact("barus", "incompressible", 20, 0, 0.0625), 1);
    const ehd_grid *grid = &contact.grid;
    double *p = calloc(grid->num_nodes, sizeof *p), *h = malloc(grid->num_nodes * sizeof *h);
    assert_true(p && h);
    for (size_t k = 0; k < grid->num_nodes; k++) {
        h[k] = 0.1;
        p[k] = k > 0 && grid_x(grid, k) <= 1 ? 1e-300 : 0;
    }
    for (double place = 0; place <= 1; place += 0.25) {
        const contact_scalars scalars = {.load = 1, .exit_position = 1 + place * grid->step};
        const contact_traction found = contact_traction_of(&contact, p, h, &scalars);
        // from half a step before the first inner node on, which counts whole
        const double length = 1 + place * grid->step - grid->x_min + grid->step / 2;
        check_close(found.friction, contact.lambda / 12 * slope / 0.1 * length / M_PI_2, 1e-12, 0);
    }
    free(p);
    free(h);
}

/* Wherever the film rises with the pressure, the surfaces are pushed back by the same force. */
static void stresses_on_both_surfaces(void **state) {
    (void)state;
    ehd_contact contact =
        with_sliding(sample_contact("roelands", "dowson-higginson", 20, 8, 0.02), 0.2);
    full_settings settings = full_default_settings();
    problem solved;
    problem_solve_cold(&solved, &contact, &settings);
    const ehd_grid *grid = &contact.grid;
    double *on[2], sums[2] = {0, 0};
    for (int i = 0; i < 2; i++)
        on[i] = malloc(grid->num_nodes * sizeof **on);
    assert_true(on[0] && on[1]);
    const contact_scalars scalars = full_evaluate_scalars(&solved.state, &contact);
    const contact_traction found =
        contact_traction_of(&contact, solved.state.pressure, solved.state.film, &scalars);
    contact_surface_stresses(on[0], on[1], &contact, solved.state.pressure, solved.state.film);
    for (size_t k = 0; k < grid->num_nodes; k++)
        for (int i = 0; i < 2; i++)
            sums[i] += on[i][k] * grid->step / M_PI_2;
    check_close((sums[1] - sums[0]) / 2, found.friction, 1e-3, 0);
    check_close(-(sums[1] + sums[0]) / 2, found.rolling_resistance, 2e-2, 0);
    problem_free(&solved);
    free(on[0]);
    free(on[1]);
}

// ---- energy

/* int dP/rho, of which the pressures' power is made up in a barotropic fluid. */
static double specific_work(const ehd_contact *contact, double pressure) {
    enum { PARTS = 64 };
    double sum = 0;

    for (int i = 0; i < PARTS; i++) // Simpson's rule
        for (int part = 0; part <= 2; part++) {
            const double p = pressure * (i + part / 2.) / PARTS;
            sum += (part == 1 ? 4. : 1.) / 6 /
                   lubricant_density(&contact->lubricant, p * contact->hertz_pressure);
        }
    return sum * pressure / PARTS;
}

/* What the pressure flow dissipates, eps |grad P|^2/rho, by the rows of the Reynolds operator at
 * rest: sum by parts of the mobilities' fluxes times the differences of the pressures. */
static double dissipated(const problem *solved) {
    const ehd_contact *contact = &solved->contact;
    const ehd_grid *grid = &contact->grid;
    const size_t num_nodes = grid->num_nodes;
    double *memory = malloc(NUM_FLUID_ARRAYS * num_nodes * sizeof *memory), sum = 0;
    assert_non_null(memory);
    reynolds_fluid fluid = reynolds_fluid_in(memory, num_nodes, contact);
    reynolds_fluid_evaluate(&fluid, contact, solved->state.pressure, num_nodes);
    for (size_t r = 0; r < grid->num_inner; r++) {
        const size_t k = grid_node_of_row(grid, r);
        const reynolds_stencil stencil = reynolds_stencil_at(grid, k);
        reynolds_row row;
        reynolds_rows(&row, grid, 0, NULL, &stencil, 1, &fluid, solved->state.pressure,
                      solved->state.film);
        sum -= grid_load_weight(grid, k) * row.residual *
               specific_work(contact, solved->state.pressure[k]);
    }
    free(memory);
    return sum;
}

/* What the shear flow of the sliding dissipates, eta (u1 - u2)^2/h: of a film that is Newtonian. */
static double sheared(const problem *solved, const ehd_contact *sliding) {
    const ehd_grid *grid = &sliding->grid;
    const double speed = slope * sliding->slide_roll;
    double sum = 0;

    for (size_t r = 0; r < grid->num_inner; r++) {
        const size_t k = grid_node_of_row(grid, r);
        const double *pressure = solved->state.pressure + k, *film = solved->state.film + k;
        if (!(pressure[0] > 0)) continue;
        sum += grid_load_weight(grid, k) * viscosity_ratio(sliding, pressure[0]) / film[0];
        // a point contact ends at the next node, where there is no pressure; lines end before it
        if (!(pressure[1] > 0) && sliding->kind->dimensions == 2)
            sum += grid_load_weight(grid, k) / 2 / film[1];
    }
    return sum * sliding->lambda / 12 * speed * speed / slope;
}

/* In pure rolling all that the surfaces put in goes into the pressure flow, and the moment of the
 * pressures is what the tangential stresses of both surfaces make up. Where they slide, which the film
 * does not see, the rest goes into the shear flow. */
static void energy_and_moment(void **state) {
    (void)state;
    static const struct {
        const char *viscosity, *density;
        double M, L, step;
        size_t cells;       // of a point contact
        double ellipticity; // 1: round
    } cases[] = {{"barus", "incompressible", 10, 5, 0.0025, 0, 1},
                 {"roelands", "incompressible", 10, 4, 0.005, 0, 1},
                 {"roelands", "dowson-higginson", 20, 8, 0.0025, 0, 1},
                 {"no1", "dowson-higginson", 30, 5, 0.0025, 0, 1},
                 {"barus", "incompressible", 6, 2, 0, 256, 1},
                 {"roelands", "dowson-higginson", 6, 3, 0, 256, 1},
                 {"roelands", "dowson-higginson", 6, 3, 0, 256, 2}};
    full_settings settings = full_default_settings();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        ehd_contact contact = cases[i].cells > 0
                                  ? sample_point(cases[i].viscosity, cases[i].density, cases[i].M,
                                                 cases[i].L, cases[i].cells, true)
                                  : sample_contact(cases[i].viscosity, cases[i].density, cases[i].M,
                                                   cases[i].L, cases[i].step);
        if (cases[i].ellipticity != 1) {
            contact.grid.shape = shape_of(cases[i].ellipticity);
            contact_set_moes(&contact, cases[i].M, cases[i].L);
        }
        contact = with_sliding(contact, 0);
        contact.grid.boundary = BOUNDARY_ZERO;
        problem solved;
        problem_solve_cold(&solved, &contact, &settings);
        assert_int_equal(solved.info.status, EHD_OK);
        const contact_scalars scalars = full_evaluate_scalars(&solved.state, &contact);
        const contact_traction found =
            contact_traction_of(&contact, solved.state.pressure, solved.state.film, &scalars);
        assert_true(found.rolling_resistance > 0);
        assert_true(found.friction == 0);
        check_close(2 * found.rolling_resistance, slope * found.rolling_moment, 1e-9, 0);
        check_close(slope * dissipated(&solved) / contact.kind->load, found.power, 1e-4, 0);
        // on surfaces that slide so slowly that both parts count
        ehd_contact sliding = with_sliding(contact, 1);
        const double rolled = found.power * contact.kind->load;
        sliding.slide_roll = -sqrt(rolled / sheared(&solved, &sliding));
        const contact_traction slid =
            contact_traction_of(&sliding, solved.state.pressure, solved.state.film, &scalars);
        check_close(slope * dissipated(&solved) + sheared(&solved, &sliding),
                    slid.power * contact.kind->load, 1e-4, 0);
        check_close(slid.power, 2 * found.power, 1e-2, 0);
        problem_free(&solved);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(laws_have_their_limits), cmocka_unit_test(slopes_are_those_of_the_laws),
        cmocka_unit_test(stresses_stay_finite),   cmocka_unit_test(plug_of_constant_film),
        cmocka_unit_test(exit_within_a_cell),     cmocka_unit_test(stresses_on_both_surfaces),
        cmocka_unit_test(energy_and_moment)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
