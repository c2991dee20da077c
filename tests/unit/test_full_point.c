/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The point contact: its rows with flow across, and solutions of the full model. */
#include "tests/unit/check.h"
#include "tests/unit/dense.h"
#include "tests/unit/problem.h"
#include "tests/unit/sample.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void *allocate(size_t count, size_t size) {
    void *memory = calloc(count, size);
    assert_non_null(memory);
    return memory;
}

// ---- rows

/* A few nodes with all fields on which the rows depend. */
typedef struct patch {
    ehd_contact contact;
    double *pressure, *film, *memory; // [num_nodes], [num_nodes], [NUM_FLUID_ARRAYS, num_nodes]
    reynolds_stencil *stencils;       // [num_inner]
    reynolds_row *rows;               // [num_inner]
} patch;

static void patch_init(patch *self, const ehd_contact *contact, size_t inner_lines, bool half) {
    self->contact = *contact;
    self->contact.grid = grid_of(-1, 0.1, 6, inner_lines, half, DISCRETIZATION_PUBLISHED);
    self->contact.grid.discretization = contact->grid.discretization;
    const ehd_grid *grid = &self->contact.grid;
    self->pressure = allocate((2 + NUM_FLUID_ARRAYS) * grid->num_nodes, sizeof(double));
    self->film = self->pressure + grid->num_nodes;
    self->memory = self->film + grid->num_nodes;
    self->stencils = allocate(grid->num_inner, sizeof *self->stencils);
    self->rows = allocate(grid->num_inner, sizeof *self->rows);
    for (size_t r = 0; r < grid->num_inner; r++)
        self->stencils[r] = reynolds_stencil_at(grid, grid_node_of_row(grid, r));
}

static void patch_free(patch *self) {
    free(self->pressure);
    free(self->stencils);
    free(self->rows);
}

static void patch_evaluate(patch *self) {
    const ehd_grid *grid = &self->contact.grid;
    size_t n = grid->num_nodes;
    reynolds_fluid fluid = reynolds_fluid_in(self->memory, n, &self->contact);

    reynolds_fluid_evaluate(&fluid, &self->contact, self->pressure, n);
    reynolds_rows(self->rows, grid, 0.8, NULL, self->stencils, grid->num_inner, &fluid,
                  self->pressure, self->film);
}

/* Returns the derivative of a row with respect to the value at a node. At the mirror line a stencil
 * may contain the node twice; both derivatives are then added. */
static double by_node(const double *by, const reynolds_stencil *stencil, size_t node) {
    double sum = 0;
    for (int a = 0; a < NUM_STENCIL; a++)
        if (stencil->node[a] == node) sum += by[a];
    return sum;
}

/* Checks all derivatives of the rows with respect to `values`, the film or the pressure. */
static void check_derivatives(patch *self, double *values, bool of_film) {
    const ehd_grid *grid = &self->contact.grid;
    double *up = allocate(2 * grid->num_inner, sizeof *up), *down = up + grid->num_inner;

    for (size_t k = 0; k < grid->num_nodes; k++) {
        const double kept = values[k], h = 1e-5 * kept;
        values[k] = kept + h;
        patch_evaluate(self);
        for (size_t r = 0; r < grid->num_inner; r++)
            up[r] = self->rows[r].residual;
        values[k] = kept - h;
        patch_evaluate(self);
        for (size_t r = 0; r < grid->num_inner; r++)
            down[r] = self->rows[r].residual;
        values[k] = kept;
        patch_evaluate(self);
        for (size_t r = 0; r < grid->num_inner; r++) {
            const reynolds_row *row = &self->rows[r];
            const double *by = of_film ? row->by_film : row->by_pressure;
            check_close(by_node(by, &self->stencils[r], k), (up[r] - down[r]) / (2 * h), 1e-6,
                        1e-7 * row_size(row));
        }
    }
    free(up);
}

static void row_derivatives(void **state) {
    (void)state;
    static const char *const lubricants[] = {"barus", "roelands", "no1"};
    static const char *const densities[] = {"incompressible", "dowson-higginson"};

    for (int i = 0; i < 48; i++) {
        ehd_contact contact =
            sample_point(lubricants[i % 3], densities[i / 3 % 2], 10, 6, 16, false);
        patch few;
        if (i < 36) {
            contact.grid.discretization = (ehd_discretization)(i / 12);
        } else { // an Eyring fluid with gradients Sigma up to 2
            contact.half_width = 1e-4;
            contact.radius = 0.01;
            contact.slide_roll = 0.3;
            contact.lubricant.thinning_stress = 2.5e-3 * contact.hertz_pressure;
        }
        patch_init(&few, &contact, i % 12 < 6 ? 5 : 4, i % 12 >= 6);
        for (size_t k = 0; k < few.contact.grid.num_nodes; k++) {
            few.pressure[k] = 0.5 + 0.3 * sin(2. * (double)k);
            few.film[k] = 0.4 + 0.1 * cos(3. * (double)k);
        }
        check_derivatives(&few, few.pressure, false);
        check_derivatives(&few, few.film, true);
        patch_free(&few);
    }
}

/* If nothing varies across, the rows on each grid line equal the rows of a line contact. */
static void rows_without_variation_across_are_the_line_s(void **state) {
    (void)state;
    ehd_contact contact = sample_point("barus", "dowson-higginson", 10, 6, 16, false);
    patch line, lines;

    for (int i = 0; i < 4; i++) {
        if (i >= 2) contact.grid.discretization = DISCRETIZATION_ACCURATE;
        patch_init(&line, &contact, 1, false);
        patch_init(&lines, &contact, 4, i % 2);
        const ehd_grid *grid = &lines.contact.grid;
        size_t width = grid_width(grid);
        for (size_t k = 0; k < grid->num_nodes; k++) {
            lines.pressure[k] = line.pressure[k % width] =
                0.5 + 0.3 * sin(2. * (double)(k % width));
            lines.film[k] = line.film[k % width] = 0.4 + 0.1 * cos(3. * (double)(k % width));
        }
        patch_evaluate(&line);
        patch_evaluate(&lines);
        for (size_t r = 0; r < grid->num_inner; r++) {
            const reynolds_row *along = &line.rows[r % grid->inner_x], *row = &lines.rows[r];
            check_close(row->residual, along->residual, 0, 0);
            for (int a = 0; a < NUM_LINE_STENCIL; a++) {
                double across =
                    a == NODE_HERE ? row->by_pressure[NODE_LEFT] + row->by_pressure[NODE_RIGHT] : 0;
                check_close(row->by_pressure[a] + across, along->by_pressure[a], 1e-13,
                            1e-13 * row_size(row));
                check_close(row->by_film[a], along->by_film[a], 0, 0);
            }
            check_close(row->by_film[NODE_LEFT], 0, 0, 0);
            check_close(row->by_film[NODE_RIGHT], 0, 0, 0);
        }
        patch_free(&line);
        patch_free(&lines);
    }
}

/* Returns the residual of a row for an exact isoviscous solution, with nodes `step` apart. The
 * lubricant also flows across, and the film varies exponentially along or across. With
 * P = lambda u,
 *
 *     H^3 = e^(g x), u = U int H^-2 dx + e^(b x) cos(rate y):
 *     (H^3 u_x)_x - U H_x = (rate/k)^2 H^3 u_1
 *
 * for the second term u_1 of u, where b (b + g) = (rate/k)^2. For a film that varies across, the
 * directions are exchanged and nothing is entrained. */
static double residual_of_solution(ehd_discretization discretization, double k, double step,
                                   bool film_across) {
    const double rate = 2.1, b = 1.7, place = 0.7;
    const double other = film_across ? rate * k : rate / k, g = other * other / b - b;
    ehd_contact contact = sample_point("barus", "incompressible", 10, 0, 16, false);
    patch few;

    contact.grid.discretization = discretization;
    patch_init(&few, &contact, 5, false);
    ehd_grid *grid = &few.contact.grid;
    grid->step = step;
    grid->shape = shape_of(k);
    const size_t node = grid->num_nodes / 2, r = grid_row_of_node(grid, node);
    for (size_t i = 0; i < grid->num_nodes; i++) {
        const double x = grid_x(grid, i) - grid_x(grid, node), y = grid_y(grid, i) + place;
        const double along = film_across ? y : x, across = film_across ? x + place : y;
        const double entrained = film_across ? 0 : -0.8 * 3 / (2 * g) * exp(-2 * g * along / 3);
        few.film[i] = exp(g * along / 3);
        few.pressure[i] =
            contact.lambda * (10 + entrained + 3 * exp(b * along) * cos(rate * across));
        assert_true(few.pressure[i] > 0);
    }
    patch_evaluate(&few);
    const double residual = few.rows[r].residual;
    patch_free(&few);
    return residual;
}

static void cross_fluxes_are_of_fourth_order(void **state) {
    (void)state;
    for (int i = 0; i < 6; i++) {
        const double k = (double[]){0.5, 1, 1.5}[i / 2];
        double residual[2][2];
        for (int j = 0; j < 4; j++)
            residual[j / 2][j % 2] =
                residual_of_solution(j < 2 ? DISCRETIZATION_ACCURATE : DISCRETIZATION_CROSS_FLUX, k,
                                     j % 2 ? 0.02 : 0.04, i % 2);
        check_close(residual[0][0] / residual[0][1], 4, 0.1, 0);
        check_close(residual[1][0] / residual[1][1], 16, 0.1, 0);
    }
}

// ---- solutions

static const struct {
    const char *lubricant, *density;
    double moes_M, moes_L;
} cases[] = {{"barus", "incompressible", 20, 10},
             {"barus", "dowson-higginson", 10, 0},
             {"roelands", "dowson-higginson", 50, 5},
             {"no1", "incompressible", 20, 5}};
enum { NUM_CASES = sizeof cases / sizeof *cases };

static ehd_contact contact_of_case(int i, size_t cells, bool half) {
    return sample_point(cases[i].lubricant, cases[i].density, cases[i].moes_M, cases[i].moes_L,
                        cells, half);
}

static ehd_status compare_exactly(full_system *system, double tolerance, size_t *iterations,
                                  ehd_error *error) {
    (void)tolerance; // tolerance of an inexact Newton step; not used
    return compare_linear_solvers(system, 1e-11, iterations, error);
}

static void every_step_equals_dense(void **state) {
    (void)state;
    full_settings settings = full_default_settings();
    settings.solve_linear = compare_exactly;
    for (int i = 0; i < NUM_CASES; i++) {
        const ehd_contact contact = contact_of_case(i, 32, false);
        problem both;
        problem_solve_cold(&both, &contact, &settings);
        problem_free(&both);
    }
}

static void inexact_newton_ends_where_dense_does(void **state) {
    (void)state;
    full_settings settings = full_default_settings(), dense = settings;
    dense.solve_linear = dense_solve;
    for (int i = 0; i < NUM_CASES; i++) {
        const ehd_contact contact = contact_of_case(i, 32, false);
        problem ours, reference;
        problem_solve_cold(&ours, &contact, &settings);
        problem_solve_cold(&reference, &contact, &dense);
        check_same_state(&ours, &reference);
        problem_free(&ours);
        problem_free(&reference);
    }
}

static void half_equals_whole(void **state) {
    (void)state;
    full_settings settings = full_default_settings();
    for (int i = 0; i < 3 * NUM_CASES; i++) {
        ehd_contact one = contact_of_case(i % NUM_CASES, 48, true),
                    both = contact_of_case(i % NUM_CASES, 48, false);
        one.grid.discretization = both.grid.discretization = (ehd_discretization)(i / NUM_CASES);
        const ehd_grid *grid = &one.grid, whole = grid_whole(grid);
        problem half, all;
        assert_true(grid_same(&whole, &both.grid));
        problem_solve_cold(&half, &one, &settings);
        problem_solve_cold(&all, &both, &settings);
        check_close(half.state.rigid_approach, all.state.rigid_approach, 1e-9, 0);
        for (size_t r = 0; r < whole.num_inner; r++) {
            size_t k = grid_node_of_row(grid, grid_row_of_whole(grid, r));
            size_t node = grid_node_of_row(&whole, r);
            check_close(fabs(grid_y(&whole, node)), grid_y(grid, k), 0, 1e-12);
            check_close(half.state.pressure[k], all.state.pressure[node], 0, 1e-9);
            check_close(half.state.film[k], all.state.film[node], 1e-9, 0);
        }
        contact_scalars a = full_evaluate_scalars(&half.state, &one);
        contact_scalars b = full_evaluate_scalars(&all.state, &both);
        check_close(a.load, b.load, 1e-9, 0);
        check_close(a.minimum_film_thickness, b.minimum_film_thickness, 1e-9, 0);
        check_close(a.exit_position, b.exit_position, 1e-12, 0);
        problem_free(&half);
        problem_free(&all);
    }
}

/* Checks the conditions of a solution. Nodes with pressure have f = 0 and P >= 0. All other nodes
 * have P = 0 and Lambda = -f >= 0. The film is positive, and the load is correct. */
static void check_solution(const ehd_contact *contact) {
    const full_settings settings = full_default_settings();
    const ehd_grid *grid = &contact->grid;
    reynolds_row *rows = allocate(grid->num_inner, sizeof *rows);
    size_t count = 0;
    double sum = 0;
    problem solved;

    problem_solve_cold(&solved, contact, &settings);
    problem_rows(rows, &solved);
    for (size_t r = 0; r < grid->num_inner; r++) {
        size_t k = grid_node_of_row(grid, r);
        double pressure = solved.state.pressure[k];
        assert_true(solved.state.film[k] > 0);
        sum += pressure * (grid->half && r >= grid->inner_x ? 2 : 1);
        if (full_has_pressure(&solved.state, k)) {
            assert_true(pressure >= -1e-9);
            check_close(rows[r].residual, 0, 0, 1e-9 * row_size(&rows[r]));
            count++;
        } else {
            check_close(pressure, 0, 0, 0);
            assert_true(rows[r].residual <= 1e-8 * row_size(&rows[r]));
        }
    }
    assert_true(count > grid->num_inner / 2 && count < grid->num_inner);
    const double beyond = far_field_load(contact, solved.state.rigid_approach).value;
    assert_true(beyond > 0 && beyond < 0.3);
    check_close(sum * grid->step * grid->step + beyond, 2 * M_PI / 3, 1e-9, 0);
    assert_true(solved.info.complementarity <= 1e-9);
    assert_false(full_is_cut(&solved.state, grid, false));
    // a large grid takes 7 to 12 GMRES iterations for each Newton iteration
    assert_true(solved.info.gmres_iterations <= 15 * solved.info.newton_iterations);
    problem_free(&solved);
    free(rows);
}

static void solution_satisfies_the_problem(void **state) {
    (void)state;
    for (int i = 0; i < 2 * NUM_CASES; i++) {
        const ehd_contact contact = contact_of_case(i / 2, 48, i % 2 == 0);
        check_solution(&contact);
    }
}

/* Solves on large grids, whose systems are preconditioned by multigrid. */
static void large_grids_satisfy_the_problem(void **state) {
    (void)state;
    for (int i = 0; i < 2; i++) {
        const ehd_contact contact =
            sample_point("barus", "dowson-higginson", 100, 10, i ? 144 : 112, i != 0);
        assert_true(full_is_large(&contact.grid));
        check_solution(&contact);
    }
    // the usual grids of trainings and studies are small: factors precondition their systems, so
    // that their results keep the same bits
    const ehd_contact usual = sample_point("barus", "incompressible", 20, 10, 128, true);
    assert_false(full_is_large(&usual.grid));
}

/* Compares films in Moes units with the converged digits of Venner and Lubrecht's multigrid program
 * (bench_point.c). */
static void digits_of_the_multigrid_program(void **state) {
    (void)state;
    const ehd_contact contact =
        sample_published(sample_point("barus", "incompressible", 20, 10, 64, true));
    const full_settings settings = full_default_settings();
    const double unit = pow(30, 2. / 3);
    problem solved;

    problem_solve_cold(&solved, &contact, &settings);
    contact_scalars scalars = full_evaluate_scalars(&solved.state, &contact);
    check_close(scalars.central_film_thickness * unit, 4.652, 0, 6e-4);
    check_close(scalars.minimum_film_thickness * unit, 2.885, 0, 6e-4);
    problem_free(&solved);
}

/* A start from coarser grids is near the solution, and its first linear systems may be solved
 * inexactly. On 128 cells this start takes 5 or 6 Newton iterations with 8 to 9 GMRES iterations
 * each. A start from the dry contact takes 13 Newton iterations. If all systems are solved
 * strictly, each takes 12 GMRES iterations. If systems are solved too inexactly, one more Newton
 * iteration is needed. */
static void fine_grids_take_few_iterations(void **state) {
    (void)state;
    const double moes_M[] = {20, 100}, moes_L[] = {10, 5};
    const full_settings settings = full_default_settings();
    size_t newton = 0, gmres = 0;

    for (int i = 0; i < 2; i++) {
        ehd_contact contact =
            sample_point("barus", "dowson-higginson", moes_M[i], moes_L[i], 128, true);
        problem solved;
        // with an open boundary the contacts take 7 and 5 Newton iterations, and 44 and 55 GMRES
        // iterations
        contact.grid.boundary = BOUNDARY_ZERO;
        problem_solve_cold(&solved, &contact, &settings);
        newton += solved.info.newton_iterations;
        gmres += solved.info.gmres_iterations;
        problem_free(&solved);
    }
    assert_true(newton <= 11);
    assert_true(gmres <= 95);
}

/* Returns the largest difference from the Hertz pressure away from its steep edge. */
static double deviation_from_hertz(double moes_M) {
    const ehd_contact contact = sample_point("barus", "incompressible", moes_M, 0, 96, true);
    const full_settings settings = full_default_settings();
    const ehd_grid *grid = &contact.grid;
    double worst = 0;
    problem solved;

    problem_solve_cold(&solved, &contact, &settings);
    for (size_t k = 0; k < grid->num_nodes; k++) {
        double r2 = 2 * grid_gap(grid, k);
        if (r2 < 0.64) worst = fmax(worst, fabs(solved.state.pressure[k] - sqrt(1 - r2)));
    }
    problem_free(&solved);
    return worst;
}

/* Without piezoviscosity the pressure approaches the dry pressure as the film becomes thinner. */
static void thin_films_approach_hertz(void **state) {
    (void)state;
    double thick = deviation_from_hertz(10), thin = deviation_from_hertz(50),
           thinner = deviation_from_hertz(200);
    print_message("deviation from Hertz: %g, %g, %g\n", thick, thin, thinner);
    assert_true(thin < 0.5 * thick && thinner < 0.5 * thin);
    assert_true(thinner < 0.06);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(row_derivatives),
        cmocka_unit_test(cross_fluxes_are_of_fourth_order),
        cmocka_unit_test(rows_without_variation_across_are_the_line_s),
        cmocka_unit_test(every_step_equals_dense),
        cmocka_unit_test(inexact_newton_ends_where_dense_does),
        cmocka_unit_test(half_equals_whole),
        cmocka_unit_test(solution_satisfies_the_problem),
        cmocka_unit_test(large_grids_satisfy_the_problem),
        cmocka_unit_test(digits_of_the_multigrid_program),
        cmocka_unit_test(fine_grids_take_few_iterations),
        cmocka_unit_test(thin_films_approach_hertz),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
