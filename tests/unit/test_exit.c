/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/exit.h"
#include "tests/unit/check.h"
#include "tests/unit/sample.h"

#include <math.h>
#include <string.h>

static void violations_are_those_of_the_complementarity(void **state) {
    const reynolds_row row = {.residual = 3};
    (void)state;

    check_close(exit_multiplier(&row), -3, 0, 0);
    check_close(exit_violation(true, -0.1, -3), 0.1, 0, 0);
    check_close(exit_violation(false, -0.1, -3), 3, 0, 0);
    assert_true(exit_violation(true, 0.1, -3) < 0);
    assert_true(exit_violation(false, 0.1, 3) < 0);
}

// ---- an exit between two nodes

enum { NUM_NODES = 9, LAST = 5 }; // size of the grid and last node with pressure

typedef struct small_exit {
    ehd_contact contact;
    double memory[NUM_FLUID_ARRAYS * NUM_NODES], pressure[NUM_NODES], film[NUM_NODES];
    double offset;
} small_exit;

static reynolds_fluid fluid_of(small_exit *small) {
    reynolds_fluid fluid = reynolds_fluid_in(small->memory, NUM_NODES, &small->contact);

    reynolds_fluid_evaluate(&fluid, &small->contact, small->pressure, NUM_NODES);
    return fluid;
}

static double flux_before(small_exit *small, size_t node) {
    const ehd_grid *grid = &small->contact.grid;
    const reynolds_stencil stencil = reynolds_stencil_at(grid, node);
    const reynolds_fluid fluid = fluid_of(small);

    return reynolds_flux(grid, 0.8, &stencil, &fluid, small->pressure, small->film).residual;
}

static exit_cell cell_of(small_exit *small) {
    const reynolds_stencil stencil = reynolds_stencil_at(&small->contact.grid, LAST);
    const reynolds_fluid fluid = fluid_of(small);
    exit_cell cell;

    const reynolds_row flux =
        reynolds_flux(&small->contact.grid, 0.8, &stencil, &fluid, small->pressure, small->film);
    exit_cell_at(&cell, &small->contact.grid, 0.8, small->offset, flux.residual, &stencil, &fluid,
                 small->pressure, small->film);
    exit_cell_add_flux(&cell, &flux);
    return cell;
}

/* Moves the exit to the place where the film without pressure carries the flux. Returns the exit
 * cell at this place. */
static exit_cell settled_cell(small_exit *small) {
    exit_cell cell = cell_of(small);

    for (int i = 0; i < 20; i++) {
        small->offset += cell.offset.residual;
        cell = cell_of(small);
    }
    check_close(cell.offset.residual, 0, 0, 1e-13);
    return cell;
}

static void small_init(small_exit *small, const char *density) {
    *small = (small_exit){.contact = sample_contact("barus", density, 5, 6, 0.1), .offset = 0.5};
    small->contact.grid.discretization = DISCRETIZATION_ACCURATE;
    small->contact.grid = grid_like(&small->contact.grid, -1, 0.1, NUM_NODES - 2, 1);
    for (int k = 0; k < NUM_NODES; k++) {
        double x = 0.1 * k, before = fmax(LAST + 0.6 - k, 0);
        small->film[k] = 0.5 + 0.04 * x + 0.3 * x * x;
        small->pressure[k] = k <= LAST ? 1.2e-3 * before * before * (1 + 0.1 * x) : 0;
    }
}

/* Checks the derivatives of the row and of the offset with respect to a value of the state. */
static void check_derivatives(small_exit *small, double *value, double by_value, double scale,
                              double offset_by_value) {
    const double kept = *value, h = 1e-5 * fmax(kept, 1e-2), offset = small->offset;
    double row[2], place[2];

    for (int side = 0; side < 2; side++) {
        *value = side ? kept + h : kept - h;
        row[side] = settled_cell(small).row.residual;
        place[side] = small->offset;
        small->offset = offset;
    }
    *value = kept;
    check_close(by_value, (row[1] - row[0]) / (2 * h), 1e-6, 1e-7 * scale);
    check_close(offset_by_value, (place[1] - place[0]) / (2 * h), 1e-6, 1e-8);
}

static void the_cell_s_derivatives_are_those_of_its_residual(void **state) {
    static const char *const densities[] = {"incompressible", "dowson-higginson"};
    (void)state;

    for (int d = 0; d < 2; d++) {
        small_exit small;
        small_init(&small, densities[d]);
        const exit_cell cell = settled_cell(&small);
        const reynolds_stencil stencil = reynolds_stencil_at(&small.contact.grid, LAST);
        const double scale = fabs(cell.row.by_pressure[NODE_HERE]);
        assert_true(small.offset > 0.1 && small.offset < 0.9 && cell.curvature > 0);
        for (int a = 0; a < NUM_LINE_STENCIL; a++) {
            const size_t node = stencil.node[a];
            if (a <= NODE_HERE)
                check_derivatives(&small, &small.pressure[node], cell.row.by_pressure[a], scale,
                                  cell.offset.by_pressure[a]);
            check_derivatives(&small, &small.film[node], cell.row.by_film[a], scale,
                              cell.offset.by_film[a]);
        }
    }
}

/* Sets *pressure, one of the pressures of `small`, to a zero of `function` (secant method). */
static void solve_for(double *pressure, double (*function)(small_exit *small), small_exit *small) {
    double last = *pressure, before = function(small), now;

    for (*pressure *= 1.01; fabs(now = function(small)) > 1e-14;) {
        double next = *pressure - now * (*pressure - last) / (now - before);
        last = *pressure;
        before = now;
        *pressure = next;
    }
}

static double what_flows_after_the_last(small_exit *small) {
    return flux_before(small, LAST + 1) - 0.8 * small->film[LAST + 1];
}

static double what_flows_before_the_last(small_exit *small) {
    return flux_before(small, LAST) - 0.8 * small->film[LAST + 1];
}

/* If the exit is at the next node, fluxes that satisfy the Reynolds rows also satisfy the equations
 * of the cell with offset 1. So the solution does not jump when the exit passes a node. */
static void at_a_node_the_cell_s_equations_are_the_rows(void **state) {
    small_exit small;
    (void)state;

    small_init(&small, "incompressible");
    solve_for(&small.pressure[LAST], what_flows_after_the_last, &small);
    solve_for(&small.pressure[LAST - 1], what_flows_before_the_last, &small);
    assert_true(small.pressure[LAST] > 1e-4 && small.pressure[LAST - 1] > small.pressure[LAST]);
    small.offset = 1;
    exit_cell cell = cell_of(&small);
    check_close(cell.row.residual, 0, 0, 1e-10 * fabs(cell.row.by_pressure[NODE_HERE]));
    check_close(cell.offset.residual, 0, 0, 1e-12);
    // P = curvature (distance / step)^2, except for terms of third order
    check_close(small.pressure[LAST], cell.curvature, 0.15, 0);
}

// ---- the place of an exit at a node

enum { NUM_PLACED = 12 };

/* Returns the error of the position of an exit, in grid steps. The film is entrained and squeezed:
 * H = H0 + a x^2 - b T, with a = `rise` and b = `fall`, at T = 0. The pressure belongs to the flow
 * F(x) = U H(x_e) - b (x_e - x), and ends at x_e. */
static double place_off(double exit, double rise, double fall, bool in_time) {
    const double step = 0.1, entrainment = 0.8, rate = 20;
    ehd_contact contact = sample_contact("barus", "incompressible", 5, 0, 0.1);
    double memory[NUM_FLUID_ARRAYS * NUM_PLACED], pressure[NUM_PLACED], film[NUM_PLACED];
    double previous[3];

    contact.grid.discretization = DISCRETIZATION_ACCURATE;
    contact.grid = grid_like(&contact.grid, 1, step, NUM_PLACED - 2, 1);
    contact.lambda = 1e-3;
    const size_t last = (size_t)floor((exit - grid_x(&contact.grid, 0)) / step);
    if (!in_time) fall = 0;
    for (size_t k = 0; k < NUM_PLACED; k++) {
        const double x = grid_x(&contact.grid, k) - 1;
        film[k] = 0.5 + rise * x * x;
    }
    // the pressure of this flow from node to node, for an isoviscous fluid
    memset(pressure, 0, sizeof pressure);
    const double film_exit = 0.5 + rise * (exit - 1) * (exit - 1);
    for (size_t k = last + 1; k-- > 0;) {
        const double to = k == last ? exit : grid_x(&contact.grid, k + 1);
        const double from = grid_x(&contact.grid, k);
        for (int i = 0; i < 200; i++) {
            const double x = from + (to - from) * (i + 0.5) / 200,
                         h = 0.5 + rise * (x - 1) * (x - 1);
            const double flow = entrainment * (h - film_exit) + fall * (exit - x);
            pressure[k] -= contact.lambda * flow / (h * h * h) * (to - from) / 200;
        }
        pressure[k] += pressure[k + 1];
    }
    reynolds_fluid fluid = reynolds_fluid_in(memory, NUM_PLACED, &contact);
    reynolds_fluid_evaluate(&fluid, &contact, pressure, NUM_PLACED);
    for (size_t i = 0; i < 3; i++)
        previous[i] = -fall - rate * film[last - 1 + i];
    const reynolds_squeeze squeeze = {rate, previous};
    const reynolds_stencil stencil = reynolds_stencil_at(&contact.grid, last);
    const double flux =
        reynolds_flux(&contact.grid, entrainment, &stencil, &fluid, pressure, film).residual;
    const double place = exit_place(&contact.grid, entrainment, flux, in_time ? &squeeze : NULL,
                                    &stencil, &fluid, film);
    return place - (exit - grid_x(&contact.grid, last)) / step;
}

static void an_exit_is_placed_by_what_flows(void **state) {
    (void)state;
    for (double exit = 1.5; exit < 1.7; exit += 0.013)
        for (int in_time = 0; in_time < 2; in_time++) {
            const double off = fabs(place_off(exit, 0.7, 0.2, in_time));
            assert_true(off < (in_time ? 0.02 : 1e-4));
        }
    // a film that is squeezed faster than entrained has no exit
    assert_true(isnan(place_off(1.5, 0.01, 0.8, true)));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(violations_are_those_of_the_complementarity),
        cmocka_unit_test(the_cell_s_derivatives_are_those_of_its_residual),
        cmocka_unit_test(an_exit_is_placed_by_what_flows),
        cmocka_unit_test(at_a_node_the_cell_s_equations_are_the_rows),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
