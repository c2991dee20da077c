/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/traction.h"

#include "common/physics/far_field.h"
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
        const double newton = contact_shear_stress(&contact, pressure, film, 0);
        // the Newtonian stress eta0 (u1 - u2)/h, in units of p_H
        check_close(newton,
                    contact.lambda / 12 * slope * 0.1 / film * viscosity_ratio(&contact, pressure),
                    1e-14, 0);
        // at stresses far below the characteristic stress of a law, the law is Newtonian
        set_shear(&contact, "eyring", 1e6 * newton * hertz, NAN);
        check_close(contact_shear_stress(&contact, pressure, film, 0), newton, 1e-12, 0);
        set_shear(&contact, "carreau", 1e7 * newton * hertz, 0.5);
        check_close(contact_shear_stress(&contact, pressure, film, 0), newton, 1e-12, 0);
        set_shear(&contact, "limiting", 1e6 * newton / pressure, NAN);
        check_close(contact_shear_stress(&contact, pressure, film, 0), newton, 1e-6, 0);
        // near its characteristic stress a law is checked by its definition, which gives the rate
        // of shear for a stress
        const double tau0 = newton * hertz / 3, viscous = newton * hertz;
        set_shear(&contact, "eyring", tau0, NAN);
        double stress = contact_shear_stress(&contact, pressure, film, 0) * hertz;
        check_close(tau0 * sinh(stress / tau0), viscous, 1e-13, 0);
        set_shear(&contact, "limiting", newton / (3 * pressure), NAN);
        stress = contact_shear_stress(&contact, pressure, film, 0) * hertz;
        check_close(-tau0 * log(1 - stress / tau0), viscous, 1e-13, 0);
        assert_true(stress < tau0);
        set_shear(&contact, "carreau", tau0, 0.4);
        stress = contact_shear_stress(&contact, pressure, film, 0) * hertz;
        check_close(stress, viscous * pow(1 + 9, (0.4 - 1) / 2), 1e-13, 0);
        set_shear(&contact, "carreau", tau0, 1);
        check_close(contact_shear_stress(&contact, pressure, film, 0), newton, 1e-14, 0);
        // the sign of the sliding determines the sign of the stress
        contact.slide_roll = -0.1;
        check_close(contact_shear_stress(&contact, pressure, film, 0), -newton, 1e-14, 0);
        contact.slide_roll = 0.1;
    }
}

/* Compares the slopes with closed forms: the slope of the viscosity for a Newtonian fluid, the
 * derivative of asinh for an Eyring fluid, and the limit for a limiting stress. */
static void slopes_are_those_of_the_laws(void **state) {
    (void)state;
    ehd_contact contact = with_sliding(sample_contact("barus", "incompressible", 20, 8, 0.05), 0.1);
    const double hertz = contact.hertz_pressure;

    for (double pressure = 0.05; pressure < 1; pressure += 0.1) {
        const double film = 0.1;
        set_shear(&contact, "newtonian", NAN, NAN);
        const double newton = contact_shear_stress(&contact, pressure, film, 0);
        stress_slopes found = contact_stress_slopes(&contact, pressure, film, 0);
        check_close(found.by_pressure, contact.alpha_p_H * newton, 1e-5, 0);
        check_close(found.by_film, -newton / film, 1e-5, 0);
        const double tau0 = 0.3 * newton;
        set_shear(&contact, "eyring", tau0 * hertz, NAN);
        found = contact_stress_slopes(&contact, pressure, film, 0);
        const double by_viscous = 1 / hypot(1, newton / tau0);
        check_close(found.by_pressure, contact.alpha_p_H * newton * by_viscous, 1e-5, 0);
        check_close(found.by_film, -newton / film * by_viscous, 1e-5, 0);
        set_shear(&contact, "limiting", 1e-3 * newton, NAN);
        found = contact_stress_slopes(&contact, pressure, film, 0);
        check_close(found.by_pressure, 1e-3 * newton, 1e-5, 0);
        check_close(found.by_film, 0, 0, 1e-9);
    }
}

/* If the viscosity rises by hundreds of decades, stresses do not overflow. */
static void stresses_stay_finite(void **state) {
    (void)state;
    ehd_contact contact =
        with_sliding(sample_contact("barus", "incompressible", 2000, 25, 0.05), 2);
    assert_true(contact.alpha_p_H > 400);
    set_shear(&contact, "eyring", 5e6, NAN);
    assert_true(isfinite(contact_shear_stress(&contact, 1, 1e-3, 0)));
    set_shear(&contact, "carreau", 5e6, 0.3);
    assert_true(isfinite(contact_shear_stress(&contact, 1, 1e-3, 0)));
    set_shear(&contact, "limiting", 0.08, NAN);
    check_close(contact_shear_stress(&contact, 1, 1e-3, 0), 0.08, 1e-12, 0);
    assert_true(contact_shear_stress(&contact, 0, 1e-3, 0) == 0);
}

// ---- integrals

/* The results for a plug of constant film and pressure, wider than the dry contact, equal closed
 * forms. */
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
            if (hypot(grid_x(grid, k), grid_y(grid, k)) > 1.2) continue;
            p[k] = pressure;
            cells += grid_weight(grid, k);
        }
        const contact_scalars scalars = {.load = 0.8, .exit_position = NAN};
        const contact_traction found = contact_traction_of(&contact, p, h, &scalars);
        const traction_sums beyond = contact_traction_beyond(&contact, &scalars);
        const double here = -contact.lambda / 12 * slope * 0.3 / film;
        const double stress = here * viscosity_ratio(&contact, pressure);
        // within a grid step behind the last node with pressure, the stress falls to its value
        // without pressure
        double force = stress * cells * grid_cell(grid), ends = 0;
        for (size_t r = 0; r < grid->num_inner; r++) {
            const size_t k = grid_node_of_row(grid, r);
            if (p[k] > 0 && !(p[k + 1] > 0)) ends += grid_weight(grid, k);
        }
        force += ends * grid_cell(grid) * here / 2 + beyond.friction;
        check_close(found.friction, force / contact.kind->load, 1e-13, 0);
        check_close(found.coefficient, found.friction / 0.8, 1e-14, 0);
        check_close(found.mean_stress, -stress, 1e-13, 0);
        check_close(found.largest_stress, -stress, 1e-14, 0);
        check_close(found.rolling_moment, beyond.rolling / contact.kind->load, 1e-12, 0);
        check_close(2 * found.rolling_resistance, slope * found.rolling_moment, 1e-12, 0);
        check_close(found.power, -0.3 * found.friction + slope * found.rolling_moment, 1e-13, 0);
        free(p);
        free(h);
    }
}

/* The exit lies inside the last cell. The friction is exact if the stress varies linearly there. */
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
        // the length begins half a step before the first inner node, because its whole cell counts
        const double length = 1 + place * grid->step - grid->x_min + grid->step / 2;
        const double within = contact.lambda / 12 * slope / 0.1 * length;
        const double beyond = contact_traction_beyond(&contact, &scalars).friction;
        check_close(found.friction, (within + beyond) / M_PI_2, 1e-12, 0);
    }
    free(p);
    free(h);
}

/* The friction is half of the difference between the forces on the two surfaces. The rolling
 * resistance within the grid is minus half of their sum. */
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
    contact_surface_stresses(on[0], on[1], &contact, solved.state.pressure, solved.state.film,
                             scalars.rigid_approach);
    for (size_t k = 0; k < grid->num_nodes; k++)
        for (int i = 0; i < 2; i++)
            sums[i] += on[i][k] * grid->step / M_PI_2;
    check_close((sums[1] - sums[0]) / 2, found.friction, 1e-3, 0);
    const double beyond = contact_traction_beyond(&contact, &scalars).rolling;
    check_close(-(sums[1] + sums[0]) / 2, found.rolling_resistance - slope * beyond / M_PI, 2e-2,
                0);
    problem_free(&solved);
    free(on[0]);
    free(on[1]);
}

/* The error of the mean stress over the dry contact has second order in the grid step, wherever the
 * edge of the dry contact lies between nodes. The stress is 1/(1 + X^2) for a line and 1 - r^2/2
 * for a point. */
static void mean_over_the_area(void **state) {
    (void)state;
    for (int dimensions = 1; dimensions <= 2; dimensions++)
        for (int i = 0; i < 6; i++) {
            const double step = 0.17 / (1 + 0.3 * i), expected = dimensions == 1 ? M_PI_4 : 0.75;
            ehd_contact contact = dimensions == 1
                                      ? sample_contact("barus", "incompressible", 20, 0, 0.1)
                                      : sample_point("barus", "incompressible", 20, 0, 32, true);
            contact = with_sliding(contact, 1);
            const ehd_grid old = contact.grid;
            const size_t across = dimensions == 1 ? 1 : (size_t)(1.4 / step) + 1;
            contact.grid = grid_like(&old, -1.5 + 0.37 * step, step, (size_t)(3 / step), across);
            const ehd_grid *grid = &contact.grid;
            double *p = malloc(grid->num_nodes * sizeof *p),
                   *h = malloc(grid->num_nodes * sizeof *h);
            assert_true(p && h);
            for (size_t k = 0; k < grid->num_nodes; k++) {
                const double square = grid_square_distance(grid, k);
                p[k] = 1e-9;
                h[k] = dimensions == 1 ? 1 + square : 1 / fmax(1 - square / 2, 0.1);
            }
            const contact_scalars scalars = {.load = 1, .exit_position = NAN};
            const contact_traction found = contact_traction_of(&contact, p, h, &scalars);
            const double unit = contact.lambda / 12 * slope;
            check_close(found.mean_stress / unit, expected, 0, 0.35 * step * step);
            free(p);
            free(h);
        }
}

// ---- beyond the grid

/* The inlet upstream of the grid agrees with the closed form of Martin (1916) for a rigid parabola,
 * with X = sqrt(2 H0) tan(theta). This holds for any length of the grid and any flow. */
static void inlet_of_a_rigid_line(void **state) {
    (void)state;
    for (int i = 0; i < 3; i++)
        for (double approach = 0.02; approach < 3; approach *= 4) {
            ehd_contact contact =
                with_sliding(sample_contact("barus", "incompressible", 5, 0, 0.05), 0.3);
            contact.grid = grid_like(&contact.grid, -1.5 * exp2(i), 0.05, 100, 1);
            const double first = -grid_x(&contact.grid, 0), root = sqrt(2 * approach);
            const double theta = atan(first / root), left = M_PI_2 - theta;
            const double carried = 1.226 * approach;
            const contact_scalars scalars = {.rigid_approach = approach,
                                             .central_film_thickness = carried};
            traction_sums found = contact_traction_beyond(&contact, &scalars);
            // int dX/H and int dX/H^2 from minus infinity
            const double once = root / approach * left;
            const double twice = root / (approach * approach) * (left / 2 - sin(2 * theta) / 4);
            check_close(found.rolling, contact.lambda * (once - carried * twice), 1e-5, 0);
            const double at_first = approach + first * first / 2;
            check_close(found.friction,
                        contact.lambda / 12 * slope * 0.3 * (once + 0.025 / at_first), 1e-5, 0);
            // with reversed entrainment the inlet lies at positive X
            contact.grid =
                grid_like(&contact.grid, -first - 99 * 0.05 + 2 * first - 0.05, 0.05, 100, 1);
            contact.entrainment = -0.7;
            check_close(grid_x(&contact.grid, 101), first, 1e-12, 0);
            found = contact_traction_beyond(&contact, &scalars);
            check_close(found.rolling, -0.7 * contact.lambda * (once - carried * twice), 1e-5, 0);
        }
}

/* Compares the rolling and the friction outside of the grid, for point and elliptic contacts, with
 * another quadrature. This quadrature uses rings around the cells of the grid, with equal parts of
 * ln r. From each pressure it subtracts the pressure at the outer rim in the same direction. */
static void around_a_point(void **state) {
    (void)state;
    const double ellipticities[] = {1, 0.5, 3}, approach = -0.4;
    for (size_t e = 0; e < 3; e++) {
        ehd_contact contact = sample_point("barus", "incompressible", 10, 0, 48, true);
        const double k = ellipticities[e];
        if (k != 1) contact.grid.shape = shape_of(k);
        contact_set_moes(&contact, 10, 0);
        contact = with_sliding(contact, 0.3);
        const ehd_grid *grid = &contact.grid;
        const grid_extent inner = grid_extent_of(grid);
        const double half = grid->step / 2, side = k * (inner.y_max + grid_step_across(grid) / 2);
        enum { RAYS = 800, RINGS = 200 };
        double rolling = 0, friction = 0;
        for (int i = 0; i < RAYS; i++) {
            const double phi = M_PI * (i + 0.5) / RAYS, along = -cos(phi), across = sin(phi);
            const double rim = 1 / (slope * hypot(along, grid->shape.far.ratio * across));
            const double to_side = side / across;
            const double to_end =
                along < 0 ? (half - inner.x_min) / -along : (half + inner.x_max) / along;
            const double end = fmin(to_side, to_end), part = log(rim / end) / RINGS;
            const double at_rim =
                far_field_pressure(&contact, approach, rim * along, rim * across / k).value;
            if (!(at_rim > 0)) continue;
            for (int j = 0; j < RINGS; j++) {
                const double r = end * exp((j + 0.5) * part), x = r * along, y = r * across / k;
                const double area = 2 * M_PI / RAYS * r * r * part / k;
                const double film = far_field_film(&grid->shape, approach, x, y);
                const double p = far_field_pressure(&contact, approach, x, y).value;
                rolling -= (p - at_rim) * x * area;
                friction += contact.lambda / 12 * slope * 0.3 / film * area;
            }
        }
        const contact_scalars scalars = {.rigid_approach = approach};
        const traction_sums found = contact_traction_beyond(&contact, &scalars);
        // the integral over the grid includes the pressures at its boundary nodes
        check_close(found.rolling, rolling, 2e-3, 0);
        check_close(found.friction, friction, 2e-3, 0);
    }
}

static contact_traction traction_from(double x_min, const char *kind, double M, double L,
                                      double step) {
    full_settings settings = full_default_settings();
    scene given = sample_scene("roelands", "dowson-higginson", M, L);
    ehd_contact contact;
    problem solved;
    snprintf(given.contact, sizeof given.contact, "%s", kind);
    given.grid = (grid_settings){.x_min = x_min, .x_max = 2, .step = step, .y_max = NAN, .half = 1};
    if (strcmp(kind, "line") != 0) {
        strcpy(given.boundary, "open");
        given.grid.y_max = -0.75 * x_min;
    }
    assert_int_equal(scene_contact(&contact, &given, NULL), EHD_OK);
    contact = with_sliding(contact, 0);
    problem_solve_cold(&solved, &contact, &settings);
    assert_int_equal(solved.info.status, EHD_OK);
    const contact_traction found = full_evaluate_traction(&solved.state, &contact);
    problem_free(&solved);
    return found;
}

/* Without the inlet upstream of the grid, 5 % of the rolling resistance of this line and a third of
 * the rolling resistance of this point would be missing. */
static void hardly_depends_on_the_domain(void **state) {
    (void)state;
    const double line = traction_from(-24, "line", 10, 5, 0.02).rolling_resistance;
    check_close(traction_from(-6, "line", 10, 5, 0.02).rolling_resistance, line, 4e-3, 0);
    check_close(traction_from(-12, "line", 10, 5, 0.02).rolling_resistance, line, 8e-4, 0);
    const double point = traction_from(-12, "point", 20, 5, 0.125).rolling_resistance;
    check_close(traction_from(-3, "point", 20, 5, 0.125).rolling_resistance, point, 1.2e-2, 0);
    check_close(traction_from(-6, "point", 20, 5, 0.125).rolling_resistance, point, 1.5e-3, 0);
}

/* Next to the boundary the pressure gradient includes the far field, so the stresses are smooth. */
static void stresses_beside_the_boundary(void **state) {
    (void)state;
    full_settings settings = full_default_settings();
    ehd_contact contact = with_sliding(sample_point("barus", "incompressible", 10, 2, 48, true), 0);
    problem solved;
    problem_solve_cold(&solved, &contact, &settings);
    const ehd_grid *grid = &contact.grid;
    double *on_1 = malloc(grid->num_nodes * sizeof *on_1),
           *on_2 = malloc(grid->num_nodes * sizeof *on_2);
    assert_true(on_1 && on_2);
    contact_surface_stresses(on_1, on_2, &contact, solved.state.pressure, solved.state.film,
                             solved.state.rigid_approach);
    for (size_t l = grid_first_line(grid); l + 1 < grid_lines(grid); l++) {
        const double *line = on_1 + l * grid_width(grid);
        check_close(line[1], 2 * line[2] - line[3], 0.1, 2e-3 * fabs(line[grid->inner_x / 2]));
    }
    problem_free(&solved);
    free(on_1);
    free(on_2);
}

// ---- energy

/* Returns int dP/rho, the work of the pressure per mass of a barotropic fluid. */
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

/* Returns the dissipation of the pressure flow, eps |grad P|^2/rho, from the rows of the Reynolds
 * equation without entrainment. Summation by parts turns the sum over the rows into fluxes times
 * differences of the pressure. */
static double dissipated(const problem *solved) {
    const ehd_contact *contact = &solved->contact;
    const ehd_grid *grid = &contact->grid;
    const size_t num_nodes = grid->num_nodes;
    double *memory = malloc((NUM_FLUID_ARRAYS + 1) * num_nodes * sizeof *memory), sum = 0;
    assert_non_null(memory);
    double *pressure = memory + NUM_FLUID_ARRAYS * num_nodes;
    memcpy(pressure, solved->state.pressure, num_nodes * sizeof *pressure);
    if (far_field_is_there(grid))
        for (size_t k = 0; k < num_nodes; k++)
            if (far_field_is_at(grid, k))
                pressure[k] = far_field_pressure(contact, solved->state.rigid_approach,
                                                 grid_x(grid, k), grid_y(grid, k))
                                  .value;
    reynolds_fluid fluid = reynolds_fluid_in(memory, num_nodes, contact);
    reynolds_fluid_evaluate(&fluid, contact, pressure, num_nodes);
    for (size_t r = 0; r < grid->num_inner; r++) {
        const size_t k = grid_node_of_row(grid, r);
        const reynolds_stencil stencil = reynolds_stencil_at(grid, k);
        reynolds_row row;
        reynolds_rows(&row, grid, 0, NULL, &stencil, 1, &fluid, pressure, solved->state.film);
        sum -= grid_load_weight(grid, k) * row.residual *
               specific_work(contact, solved->state.pressure[k]);
    }
    free(memory);
    return sum;
}

/* Returns the dissipation of the shear flow, eta (u1 - u2)^2/h, in a Newtonian film. */
static double sheared(const problem *solved, const ehd_contact *sliding) {
    const ehd_grid *grid = &sliding->grid;
    const double speed = slope * sliding->slide_roll;
    double sum = 0;

    for (size_t r = 0; r < grid->num_inner; r++) {
        const size_t k = grid_node_of_row(grid, r);
        const double *pressure = solved->state.pressure + k, *film = solved->state.film + k;
        if (!(pressure[0] > 0)) continue;
        sum += grid_load_weight(grid, k) * viscosity_ratio(sliding, pressure[0]) / film[0];
        // the shear zone of a point contact ends at the next node without pressure, the shear zone
        // of a line contact ends before this node
        if (!(pressure[1] > 0) && sliding->kind->dimensions == 2)
            sum += grid_load_weight(grid, k) / 2 / film[1];
    }
    return sum * sliding->lambda / 12 * speed * speed / slope;
}

/* In pure rolling the pressure flow dissipates the whole power of the surfaces. The moment of the
 * pressure equals the moment of the tangential stresses on both surfaces. If the surfaces also
 * slide, the film does not change, and the shear flow dissipates the additional power. */
static void energy_and_moment(void **state) {
    (void)state;
    static const struct {
        const char *viscosity, *density;
        double M, L, step;
        size_t cells;       // number of cells of a point contact; 0: line contact
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
        problem solved;
        problem_solve_cold(&solved, &contact, &settings);
        assert_int_equal(solved.info.status, EHD_OK);
        const contact_scalars scalars = full_evaluate_scalars(&solved.state, &contact);
        const contact_traction found =
            contact_traction_of(&contact, solved.state.pressure, solved.state.film, &scalars);
        assert_true(found.rolling_resistance > 0);
        assert_true(found.friction == 0);
        check_close(2 * found.rolling_resistance, slope * found.rolling_moment, 1e-9, 0);
        const traction_sums around = contact_traction_beyond(&contact, &scalars);
        const double within = dissipated(&solved);
        check_close(slope * (within + around.rolling) / contact.kind->load, found.power, 1e-4, 0);
        // the surfaces slide so slowly that both flows dissipate the same power
        ehd_contact sliding = with_sliding(contact, 1);
        const double rolled = found.power * contact.kind->load;
        sliding.slide_roll = -sqrt(rolled / (sheared(&solved, &sliding) +
                                             contact_traction_beyond(&sliding, &scalars).friction));
        const contact_traction slid =
            contact_traction_of(&sliding, solved.state.pressure, solved.state.film, &scalars);
        const double beyond =
            slope * around.rolling +
            sliding.slide_roll * contact_traction_beyond(&sliding, &scalars).friction;
        check_close(slope * within + sheared(&solved, &sliding) + beyond,
                    slid.power * contact.kind->load, 1e-4, 0);
        check_close(slid.power, 2 * found.power, 1e-2, 0);
        problem_free(&solved);
    }
}

/* Returns the dissipation of a thinned flow by quadrature. It is the integral of stress times rate
 * of shear over the velocity profiles half way between nodes, in units of p_H u_m a. */
static double dissipated_by_profile(const problem *solved) {
    enum { PARTS = 400 };
    const ehd_contact *contact = &solved->contact;
    const ehd_grid *grid = &contact->grid;
    const double stress = contact->lubricant.thinning_stress / contact->hertz_pressure;
    double sum = 0;

    for (size_t k = 0; k + 1 < grid->num_nodes; k++) {
        const double *pressure = solved->state.pressure + k, *film = solved->state.film + k;
        if (!(pressure[0] > 0 || pressure[1] > 0)) continue;
        const double height = (film[0] + film[1]) / 2;
        const double change = slope * height * (pressure[1] - pressure[0]) / grid->step / stress;
        const double rate = contact->lambda / 12 * slope * contact->slide_roll *
                            viscosity_ratio(contact, (pressure[0] + pressure[1]) / 2) / height /
                            stress;
        double low = 0, high = asinh(rate) + fabs(change), middle = 0, power = 0;
        for (int i = 0; i < 50; i++) {
            double slid = 0;
            middle = (low + high) / 2;
            for (int part = 0; part < PARTS; part++)
                slid += sinh(middle + change * ((part + 0.5) / PARTS - 0.5)) / PARTS;
            *(slid < rate ? &low : &high) = middle;
        }
        for (int part = 0; part < PARTS; part++) {
            const double here = middle + change * ((part + 0.5) / PARTS - 0.5);
            power += here * sinh(here) / PARTS;
        }
        sum += grid->step * stress * contact->slide_roll / rate * power;
    }
    return sum;
}

/* Checks that the power of the surfaces equals the dissipation, if sliding thins the flow. */
static void energy_of_a_thinned_flow(void **state) {
    (void)state;
    const double slides[] = {0.01, 1}, stresses[] = {5e-4, 2e-3};
    full_settings settings = full_default_settings();

    for (int i = 0; i < 4; i++) {
        ehd_contact contact =
            with_sliding(sample_contact("barus", "incompressible", 10, 5, 0.01), slides[i % 2]);
        contact.lubricant.thinning_stress = stresses[i / 2] * contact.hertz_pressure;
        set_shear(&contact, "eyring", contact.lubricant.thinning_stress, NAN);
        problem solved;
        problem_solve_cold(&solved, &contact, &settings);
        assert_int_equal(solved.info.status, EHD_OK);
        const contact_scalars scalars = full_evaluate_scalars(&solved.state, &contact);
        const contact_traction found =
            contact_traction_of(&contact, solved.state.pressure, solved.state.film, &scalars);
        const traction_sums beyond = contact_traction_beyond(&contact, &scalars);
        const double outside = contact.slide_roll * beyond.friction + slope * beyond.rolling;
        check_close((dissipated_by_profile(&solved) + outside) / contact.kind->load, found.power,
                    1e-3, 0);
        // with a stress that leaves out the pressure gradient, the power would be larger
        ehd_contact newtonian = contact;
        newtonian.lubricant.thinning_stress = 0;
        const contact_traction without =
            contact_traction_of(&newtonian, solved.state.pressure, solved.state.film, &scalars);
        assert_true(without.power > (i % 2 ? 1.01 : 1.0002) * found.power);
        problem_free(&solved);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(laws_have_their_limits),
                                       cmocka_unit_test(slopes_are_those_of_the_laws),
                                       cmocka_unit_test(stresses_stay_finite),
                                       cmocka_unit_test(plug_of_constant_film),
                                       cmocka_unit_test(exit_within_a_cell),
                                       cmocka_unit_test(stresses_on_both_surfaces),
                                       cmocka_unit_test(mean_over_the_area),
                                       cmocka_unit_test(inlet_of_a_rigid_line),
                                       cmocka_unit_test(around_a_point),
                                       cmocka_unit_test(hardly_depends_on_the_domain),
                                       cmocka_unit_test(stresses_beside_the_boundary),
                                       cmocka_unit_test(energy_and_moment),
                                       cmocka_unit_test(energy_of_a_thinned_flow)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
