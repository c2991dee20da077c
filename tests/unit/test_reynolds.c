/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows of the Reynolds equation and their derivatives. Flow across the lines of point contacts is
 * tested in test_full_point.c. */
#include "common/physics/eyring_flow.h"
#include "common/physics/reynolds.h"
#include "common/physics/traction.h"
#include "tests/unit/check.h"
#include "tests/unit/sample.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const densities[] = {"incompressible", "dowson-higginson"};
enum { NUM_DENSITIES = 2 };

enum { NUM_NODES = 14 }; // number of nodes of the small grid, with boundary nodes

/* A contact on a small grid, with all stencils and memory for the fluid's properties. */
typedef struct small_problem {
    ehd_contact contact;
    double memory[NUM_FLUID_ARRAYS * NUM_NODES];
    reynolds_stencil stencils[NUM_NODES - 2];
    double pressure[NUM_NODES], film[NUM_NODES];
} small_problem;

static void small_init(small_problem *small, const ehd_contact *contact) {
    small->contact = *contact;
    small->contact.grid = grid_like(&contact->grid, -1, 0.1, NUM_NODES - 2, 1);
    for (size_t r = 0; r < NUM_NODES - 2; r++)
        small->stencils[r] = reynolds_stencil_at(&small->contact.grid, r + 1);
}

static void small_rows(reynolds_row *rows, small_problem *small, double entrainment) {
    reynolds_fluid fluid = reynolds_fluid_in(small->memory, NUM_NODES, &small->contact);
    reynolds_fluid_evaluate(&fluid, &small->contact, small->pressure, NUM_NODES);
    reynolds_rows(rows, &small->contact.grid, entrainment, NULL, small->stencils, NUM_NODES - 2,
                  &fluid, small->pressure, small->film);
}

/* Computes the residuals' derivatives with respect to *value, a pressure or film of `small`. */
static void difference(double *derivative, small_problem *small, double *value) {
    reynolds_row up[NUM_NODES - 2], down[NUM_NODES - 2];
    double kept = *value, h = 1e-5 * kept;

    *value = kept + h;
    small_rows(up, small, 0.8);
    *value = kept - h;
    small_rows(down, small, 0.8);
    *value = kept;
    for (size_t r = 0; r < NUM_NODES - 2; r++)
        derivative[r] = (up[r].residual - down[r].residual) / (2 * h);
}

/* Returns a row's derivative with respect to the value at `node`, zero outside of the stencil. */
static double by_node(const double *by, const reynolds_stencil *stencil, size_t node) {
    for (int a = 0; a < NUM_STENCIL; a++)
        if (stencil->node[a] == node) return by[a];
    return 0;
}

static double largest_of(const double *by) {
    double largest = 0;
    for (int a = 0; a < NUM_STENCIL; a++)
        largest = fmax(largest, fabs(by[a]));
    return largest;
}

static void check_row_derivatives(const ehd_contact *contact) {
    small_problem small;
    reynolds_row rows[NUM_NODES - 2];
    double derivative[NUM_NODES - 2];

    small_init(&small, contact);
    for (size_t k = 0; k < NUM_NODES; k++) {
        small.pressure[k] = 0.5 + 0.3 * sin(2. * (double)k);
        small.film[k] = 0.4 + 0.1 * cos(3. * (double)k);
    }
    small_rows(rows, &small, 0.8);
    for (size_t k = 0; k < NUM_NODES; k++) {
        difference(derivative, &small, &small.pressure[k]);
        for (size_t r = 0; r < NUM_NODES - 2; r++)
            check_close(by_node(rows[r].by_pressure, &small.stencils[r], k), derivative[r], 1e-6,
                        1e-7 * largest_of(rows[r].by_pressure));
        difference(derivative, &small, &small.film[k]);
        for (size_t r = 0; r < NUM_NODES - 2; r++)
            check_close(by_node(rows[r].by_film, &small.stencils[r], k), derivative[r], 1e-6,
                        1e-7 * largest_of(rows[r].by_film));
    }
}

/* Returns the contact with a flow that is thinned by sliding. At P = 0.5 and H = 0.4 the Newtonian
 * shear stress is `rate` times the Eyring stress. */
static ehd_contact thinned(ehd_contact contact, double rate) {
    contact.grid.discretization = DISCRETIZATION_ACCURATE;
    contact.half_width = 1e-4;
    contact.radius = 0.01;
    contact.slide_roll = 0.3;
    contact.lubricant.thinning_stress = 0;
    contact.lubricant.thinning_stress =
        fabs(contact_shear_stress(&contact, 0.5, 0.4, 0)) * contact.hertz_pressure / rate;
    return contact;
}

static void row_derivatives(void **state) {
    (void)state;
    for (int l = 0; l < NUM_SAMPLE_LUBRICANTS; l++)
        for (int d = 0; d < 2 * NUM_DENSITIES; d++) {
            ehd_contact contact = sample_contact(sample_lubricants[l], densities[d / 2], 5, 6, 0.1);
            if (d % 2) contact.grid.discretization = DISCRETIZATION_ACCURATE;
            check_row_derivatives(&contact);
            // thinned flows with dimensionless pressure gradients Sigma of up to 0.3, 6 and 60
            const double largest[] = {0.3, 6, 60};
            for (int i = 0; i < 3; i++) {
                contact = thinned(contact, 3);
                const double of_all = 0.5 * 5 * traction_thinning(&contact).gradient;
                contact.half_width *= largest[i] / of_all;
                contact.slide_roll *= of_all / largest[i];
                check_row_derivatives(&contact);
            }
        }
}

/* The difference of the thinned rows from the Newtonian rows is inversely proportional to the
 * square of the Eyring stress. */
static void thinned_rows_have_the_newtonian_limit(void **state) {
    (void)state;
    const ehd_contact contact = sample_contact("roelands", densities[1], 5, 6, 0.1);
    reynolds_row newton[NUM_NODES - 2], eyring[NUM_NODES - 2];
    small_problem small;
    double off[2] = {0, 0};

    small_init(&small, &contact);
    small.contact.grid.discretization = DISCRETIZATION_ACCURATE;
    small_init(&small, &small.contact);
    for (size_t k = 0; k < NUM_NODES; k++) {
        small.pressure[k] = 0.5 + 0.03 * sin(2. * (double)k);
        small.film[k] = 0.4 + 0.1 * cos(3. * (double)k);
    }
    small_rows(newton, &small, 0.8);
    for (int i = 0; i < 2; i++) {
        small.contact = thinned(small.contact, i == 0 ? 1e-2 : 1e-3);
        small_rows(eyring, &small, 0.8);
        for (size_t r = 0; r < NUM_NODES - 2; r++)
            off[i] = fmax(off[i], fabs(eyring[r].residual - newton[r].residual) /
                                      (fabs(newton[r].residual) + 1));
    }
    assert_true(off[0] > 1e-8 && off[0] < 1e-3);
    check_close(off[1], off[0] / 100, 0.02, 0);
}

/* A link is the flow between two neighbouring nodes. If the pressures at both nodes are equal, or
 * nearly equal, the link has the Newtonian mobility times the factor of thinning for the shear
 * stress at this pressure. */
static void thinned_links_are_of_the_stress_there(void **state) {
    (void)state;
    for (int d = 0; d < NUM_DENSITIES; d++) {
        const ehd_contact contact = thinned(sample_contact("barus", densities[d], 5, 6, 0.1), 3);
        ehd_contact newtonian = contact;
        newtonian.lubricant.thinning_stress = 0;
        const double rate = fabs(contact_shear_stress(&newtonian, 0.5, 0.3, 0)) *
                            contact.hertz_pressure / contact.lubricant.thinning_stress;
        small_problem small;
        small_init(&small, &contact);
        reynolds_fluid fluid = reynolds_fluid_in(small.memory, NUM_NODES, &small.contact);
        for (int i = 0; i < 2; i++) {
            for (size_t k = 0; k < NUM_NODES; k++) {
                small.pressure[k] = 0.5 + i * 1e-7 * (double)k;
                small.film[k] = 0.3;
            }
            reynolds_fluid_evaluate(&fluid, &contact, small.pressure, NUM_NODES);
            const reynolds_link link =
                reynolds_link_ahead(&small.stencils[5], &fluid, small.pressure, small.film);
            const double drop = small.pressure[7] - small.pressure[6];
            const double gradient = traction_thinning(&contact).gradient * 0.3 * drop / 0.1;
            const eyring_gradient of = eyring_gradient_of(gradient);
            const double mobility = fluid.mobility[6] * eyring_along(&of, rate).value;
            check_close(link.by_after, mobility, i ? 1e-5 : 1e-13, 0);
            check_close(link.by_before, -mobility, i ? 1e-5 : 1e-13, 0);
            check_close(link.value, mobility * drop, 1e-5, 0);
        }
    }
}

/* Neighbouring rows share the flux half way between their nodes. A row nevertheless has the same
 * result in any order of the rows, and alone. This holds for entrainment in both directions. */
static void rows_do_not_depend_on_those_beside(void **state) {
    const size_t shuffled[] = {4, 3, 5, 6, 0, 1, 11, 10, 8, 9, 2, 7};
    ehd_contact contact = sample_contact("no1", densities[1], 5, 6, 0.1);
    reynolds_row in_list[NUM_NODES - 2], alone, mixed[NUM_NODES - 2];
    reynolds_stencil of_mixed[NUM_NODES - 2];
    small_problem small;
    (void)state;

    contact.grid.discretization = DISCRETIZATION_ACCURATE;
    small_init(&small, &contact);
    for (size_t k = 0; k < NUM_NODES; k++) {
        small.pressure[k] = 0.4 + 0.05 * sin((double)(3 * k));
        small.film[k] = 0.2 + 0.03 * cos((double)(2 * k));
    }
    for (int way = 0; way < 2; way++) {
        const ehd_grid *grid = &small.contact.grid;
        for (size_t r = 0; r < NUM_NODES - 2 && way == 1; r++)
            small.stencils[r] = reynolds_stencil_reversed(grid, r + 1);
        small_rows(in_list, &small, 0.8);
        const reynolds_fluid fluid = reynolds_fluid_in(small.memory, NUM_NODES, &small.contact);
        for (size_t r = 0; r < NUM_NODES - 2; r++)
            of_mixed[r] = small.stencils[shuffled[r]];
        reynolds_rows(mixed, grid, 0.8, NULL, of_mixed, NUM_NODES - 2, &fluid, small.pressure,
                      small.film);
        for (size_t r = 0; r < NUM_NODES - 2; r++) {
            reynolds_rows(&alone, grid, 0.8, NULL, &small.stencils[r], 1, &fluid, small.pressure,
                          small.film);
            assert_memory_equal(&in_list[r], &alone, sizeof alone);
            assert_memory_equal(&mixed[r], &in_list[shuffled[r]], sizeof alone);
        }
    }
}

/* If the mobility of a node underflows to zero, the node has no flow, and all rows are finite. */
static void rows_are_finite_at_any_viscosity(void **state) {
    (void)state;
    ehd_contact contact = sample_contact("barus", "dowson-higginson", 1000, 20, 0.1);
    small_problem small;
    reynolds_row rows[NUM_NODES - 2];

    contact.grid.discretization = DISCRETIZATION_ACCURATE;
    small_init(&small, &contact);
    for (size_t k = 0; k < NUM_NODES; k++) {
        small.pressure[k] = k < 4 ? 0 : k < 8 ? 1.5 * (double)k : 1;
        small.film[k] = 1e-3;
    }
    small_rows(rows, &small, 1);
    assert_true(small.memory[7] == 0 && small.memory[2] > 0);
    for (size_t r = 0; r < NUM_NODES - 2; r++) {
        assert_true(isfinite(rows[r].residual));
        for (int a = 0; a < NUM_STENCIL; a++)
            assert_true(isfinite(rows[r].by_pressure[a]) && isfinite(rows[r].by_film[a]));
    }
}

/* Returns the largest residual of an exact solution on 16 * refine intervals. The film is
 * H = 1/(1.5 + X/2), and the flux is 0.4 everywhere. With a Barus law the reduced pressure
 * (1 - exp(-a P))/(a lambda) then has the derivative (H - 0.4)/H^3, a polynomial in X. Rows near
 * the inlet are left out, because they have lower order. */
static double residual_of_constant_flux(ehd_discretization discretization, size_t refine) {
    ehd_contact contact = sample_contact("barus", "incompressible", 2, 6, 0.1);
    const size_t count = 16 * refine, num_nodes = count + 3;
    double *memory = calloc((NUM_FLUID_ARRAYS + 2) * num_nodes, sizeof *memory), largest = 0;
    assert_non_null(memory);
    double *pressure = memory + NUM_FLUID_ARRAYS * num_nodes, *film = pressure + num_nodes;

    contact.grid = grid_of(-1, 1 / (double)(8 * refine), count + 1, 1, false, discretization);
    reynolds_fluid fluid = reynolds_fluid_in(memory, num_nodes, &contact);
    for (size_t k = 0; k < num_nodes; k++) {
        double s = 1.5 + grid_x(&contact.grid, k) / 2;
        double reduced = 2 * (s * s * s / 3 - 0.4 * s * s * s * s / 4);
        film[k] = 1 / s;
        pressure[k] = -log(1 - 0.01 * reduced) / contact.alpha_p_H;
    }
    contact.lambda = 0.01 / contact.alpha_p_H;
    reynolds_fluid_evaluate(&fluid, &contact, pressure, num_nodes);
    for (size_t k = 4; k + 3 < num_nodes; k++) {
        reynolds_stencil stencil = reynolds_stencil_at(&contact.grid, k);
        reynolds_row row;
        reynolds_rows(&row, &contact.grid, 1, NULL, &stencil, 1, &fluid, pressure, film);
        largest = fmax(largest, fabs(row.residual));
        check_close(reynolds_flux(&contact.grid, 1, &stencil, &fluid, pressure, film).residual, 0.4,
                    5e-3, 0);
    }
    free(memory);
    return largest;
}

static void order_of_a_constant_flux(void **state) {
    (void)state;
    for (size_t refine = 2; refine <= 4; refine *= 2) {
        double published = residual_of_constant_flux(DISCRETIZATION_PUBLISHED, refine) /
                           residual_of_constant_flux(DISCRETIZATION_PUBLISHED, 2 * refine);
        double accurate = residual_of_constant_flux(DISCRETIZATION_ACCURATE, refine) /
                          residual_of_constant_flux(DISCRETIZATION_ACCURATE, 2 * refine);
        assert_true(published > 3.2 && published < 4.5); // second order
        assert_true(accurate > 12 && accurate < 20);     // fourth order
    }
}

/* Returns the integral of the mobility over P as a sum of `count` links with equal steps of P. */
static double reduced_change(const ehd_contact *contact, double before, double after,
                             size_t count) {
    const reynolds_stencil stencil = {.node = {[NODE_HERE] = 0, [NODE_AHEAD] = 1}};
    double sum = 0;

    for (size_t i = 0; i < count; i++) {
        double memory[2 * NUM_FLUID_ARRAYS], pressure[2];
        reynolds_fluid fluid = reynolds_fluid_in(memory, 2, contact);
        for (size_t j = 0; j < 2; j++)
            pressure[j] = before + (after - before) * (double)(i + j) / (double)count;
        reynolds_fluid_evaluate(&fluid, contact, pressure, 2);
        sum += reynolds_link_ahead(&stencil, &fluid, pressure, NULL).value;
    }
    return sum;
}

/* Links are exact if the viscosity is exponential in the pressure. Otherwise links have fourth
 * order in the pressure difference, or second order with a small factor for compressible
 * lubricants. */
static void order_of_the_reduced_pressure(void **state) {
    (void)state;
    for (size_t l = 0; l < NUM_SAMPLE_LUBRICANTS; l++) {
        const ehd_contact contact =
            sample_contact(sample_lubricants[l], "incompressible", 20, 10, 0.1);
        const double exact = reduced_change(&contact, 0.1, 0.2, 256);
        const double whole = fabs(reduced_change(&contact, 0.1, 0.2, 1) / exact - 1);
        const double halves = fabs(reduced_change(&contact, 0.1, 0.2, 2) / exact - 1);
        if (strcmp(sample_lubricants[l], "barus") == 0)
            assert_true(whole < 1e-13 && halves < 1e-13);
        else
            assert_true(whole > 1e-8 && whole < 1e-2 && whole / halves > 11 && whole / halves < 20);
    }
}

/* Whatever the pressures, the flow is directed from the higher to the lower pressure. */
static void flow_follows_the_pressures(void **state) {
    (void)state;
    for (size_t l = 0; l < NUM_SAMPLE_LUBRICANTS; l++) {
        const ehd_contact contact =
            sample_contact(sample_lubricants[l], "dowson-higginson", 20, 10, 0.1);
        for (double before = -0.1; before < 2; before += 0.07)
            for (double after = before + 0.01; after < 2; after += 0.07) {
                assert_true(reduced_change(&contact, before, after, 1) > 0);
                assert_true(reduced_change(&contact, after, before, 1) < 0);
            }
    }
}

static void first_row_has_no_second_node_back(void **state) {
    (void)state;
    ehd_grid grid = grid_of(-1, 0.1, NUM_NODES - 2, 1, false, DISCRETIZATION_PUBLISHED);
    reynolds_stencil first = reynolds_stencil_at(&grid, 1), second = reynolds_stencil_at(&grid, 2);
    assert_true(first.node[NODE_BACK2] == NO_NODE);
    assert_int_equal(first.node[NODE_BACK], 0);
    assert_int_equal(first.node[NODE_HERE], 1);
    assert_int_equal(first.node[NODE_AHEAD], 2);
    assert_int_equal(second.node[NODE_BACK2], 0);
}

/* For an isoviscous lubricant and simple fields, the rows can be computed by hand, including their
 * discretisation error. */
static void manufactured_rows(void **state) {
    (void)state;
    ehd_contact contact = sample_published(sample_contact("barus", "dowson-higginson", 10, 0, 0.1));
    small_problem small;
    reynolds_row rows[NUM_NODES - 2];
    const double film_slope = 0.2, pressure_slope = 0.3, curvature = 0.7, h = 0.1;

    small_init(&small, &contact);
    double lambda = contact.lambda;
    for (size_t k = 0; k < NUM_NODES; k++) {
        small.film[k] = 0.6;
        small.pressure[k] = 1 + pressure_slope * grid_x(&small.contact.grid, k);
    }
    small_rows(rows, &small, 1);
    for (size_t r = 0; r < NUM_NODES - 2; r++)
        check_close(rows[r].residual, 0, 0, 1e-11 / lambda);

    // linear film: half way between nodes H^3 is the mean of both nodes, so the derivative of H^3
    // becomes 3 H^2 H' + H'^3 h^2
    for (size_t k = 0; k < NUM_NODES; k++)
        small.film[k] = 0.6 + film_slope * grid_x(&small.contact.grid, k);
    small_rows(rows, &small, 0.5);
    for (size_t r = 0; r < NUM_NODES - 2; r++) {
        double film = small.film[r + 1];
        double flow = pressure_slope * (3 * film * film * film_slope + pow(film_slope, 3) * h * h);
        check_close(rows[r].residual, flow / lambda - 0.5 * film_slope, 1e-11, 1e-10);
    }

    // constant film, quadratic pressure
    for (size_t k = 0; k < NUM_NODES; k++) {
        small.film[k] = 0.6;
        small.pressure[k] = 2 + curvature * pow(grid_x(&small.contact.grid, k), 2);
    }
    small_rows(rows, &small, 1);
    for (size_t r = 0; r < NUM_NODES - 2; r++)
        check_close(rows[r].residual, 2 * curvature * pow(0.6, 3) / lambda, 1e-11, 0);
}

// ---- squeeze

static void squeezed_rows(reynolds_row *rows, const ehd_contact *contact,
                          const reynolds_squeeze *squeeze, const double *pressure,
                          const double *film) {
    double memory[NUM_FLUID_ARRAYS * NUM_NODES];
    reynolds_fluid fluid = reynolds_fluid_in(memory, NUM_NODES, contact);
    reynolds_stencil stencils[NUM_NODES - 2];
    ehd_grid grid = grid_of(-1, 0.1, NUM_NODES - 2, 1, false, DISCRETIZATION_PUBLISHED);

    for (size_t r = 0; r < NUM_NODES - 2; r++)
        stencils[r] = reynolds_stencil_at(&grid, r + 1);
    reynolds_fluid_evaluate(&fluid, contact, pressure, NUM_NODES);
    reynolds_rows(rows, &grid, 0.8, squeeze, stencils, NUM_NODES - 2, &fluid, pressure, film);
}

/* Checks the squeeze term: `rate` times rho H of the row's node, plus `previous`. It is subtracted
 * from the residual of the row without squeeze. Also checks the derivatives of the rows, which the
 * squeeze changes only at the row's own node. */
static void check_squeeze_derivatives(const ehd_contact *contact) {
    double pressure[NUM_NODES], film[NUM_NODES], previous[NUM_NODES - 2];
    reynolds_row rows[NUM_NODES - 2], steady[NUM_NODES - 2], up[NUM_NODES - 2], down[NUM_NODES - 2];
    const double h = 1e-5;

    for (size_t k = 0; k < NUM_NODES; k++) {
        pressure[k] = 0.5 + 0.3 * sin(2. * (double)k);
        film[k] = 0.4 + 0.1 * cos(3. * (double)k);
    }
    for (size_t r = 0; r < NUM_NODES - 2; r++)
        previous[r] = sin(5. * (double)r);
    const reynolds_squeeze squeeze = {37, previous};
    squeezed_rows(rows, contact, &squeeze, pressure, film);
    squeezed_rows(steady, contact, NULL, pressure, film);
    for (size_t r = 0; r < NUM_NODES - 2; r++) {
        double mass = film[r + 1] * lubricant_density(&contact->lubricant,
                                                      pressure[r + 1] * contact->hertz_pressure);
        check_close(rows[r].residual, steady[r].residual - 37 * mass - previous[r], 1e-12,
                    1e-12 * fabs(steady[r].residual));
    }
    for (size_t k = 1; k + 1 < NUM_NODES; k++)
        for (int of_film = 0; of_film < 2; of_film++) {
            double *value = of_film ? &film[k] : &pressure[k], kept = *value;
            const reynolds_row *row = &rows[k - 1];
            *value = kept + h;
            squeezed_rows(up, contact, &squeeze, pressure, film);
            *value = kept - h;
            squeezed_rows(down, contact, &squeeze, pressure, film);
            *value = kept;
            double slope = (up[k - 1].residual - down[k - 1].residual) / (2 * h);
            check_close(of_film ? row->by_film[NODE_HERE] : row->by_pressure[NODE_HERE], slope,
                        1e-6, 1e-7);
            // derivatives with respect to other nodes do not contain the squeeze
            for (int a = 0; a < NUM_STENCIL; a++)
                if (a != NODE_HERE) {
                    check_close(row->by_film[a], steady[k - 1].by_film[a], 0, 0);
                    check_close(row->by_pressure[a], steady[k - 1].by_pressure[a], 0, 0);
                }
        }
}

static void squeeze_derivatives(void **state) {
    (void)state;
    ehd_contact compressible = sample_contact("roelands", "dowson-higginson", 5, 6, 0.1);
    ehd_contact incompressible = sample_contact("barus", "incompressible", 5, 3, 0.1);
    check_squeeze_derivatives(&compressible);
    check_squeeze_derivatives(&incompressible);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(row_derivatives),
        cmocka_unit_test(thinned_rows_have_the_newtonian_limit),
        cmocka_unit_test(thinned_links_are_of_the_stress_there),
        cmocka_unit_test(rows_do_not_depend_on_those_beside),
        cmocka_unit_test(rows_are_finite_at_any_viscosity),
        cmocka_unit_test(order_of_a_constant_flux),
        cmocka_unit_test(order_of_the_reduced_pressure),
        cmocka_unit_test(flow_follows_the_pressures),
        cmocka_unit_test(first_row_has_no_second_node_back),
        cmocka_unit_test(manufactured_rows),
        cmocka_unit_test(squeeze_derivatives),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
