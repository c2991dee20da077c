/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Time steps with the factors of an earlier Jacobian. */
#include "romrun/solve/kept_factors.h"
#include "tests/unit/check.h"
#include "tests/unit/reduced_problem.h"
#include "tests/unit/sample.h"

#include <math.h>
#include <string.h>

static trained training;      // 301 nodes
static reduced_basis coupled; // all modes that the training spans

static int set_up(void **state) {
    (void)state;
    trained_init(&training, 0.02);
    trained_basis(&coupled, &training, DEFORMATION_COUPLED, 0, 0);
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    reduced_basis_free(&coupled);
    trained_free(&training);
    return 0;
}

/* A time step that starts from the stationary solution of a training contact. Its previous film
 * differs slightly from the stationary film. */
typedef struct time_step {
    size_t state;
    double rate;
    double previous[400]; // at inner nodes
} time_step;

static double previous_film(void *context, size_t node) {
    const time_step *self = context;

    return self->previous[node - 1];
}

/* Solves the step with the factors of a Jacobian that belongs to a time step shorter by the factor
 * `shorter`. If `shorter` is 0, there are no such factors. */
static reduced_info take_time_step(time_step *self, double shorter) {
    const ehd_contact *contact = &training.contacts[self->state];
    reduced_settings settings = reduced_defaults;
    reduced_problem reduced;
    double pressure[400], mass[400];

    reduced_problem_init(&reduced, &coupled, NULL, 0, &settings);
    const reduced_model *model = &reduced.model;
    assert_true(model->rows.num_rows <= 400);
    memcpy(reduced.state.coordinates,
           coupled.states.coordinates + self->state * model->num_unknowns,
           model->num_unknowns * sizeof(double));
    reduced.state.exit = training.states->exit[self->state];
    reduced_problem_solve(&reduced, contact);
    reduced_row_values(pressure, mass, reduced.solver, contact);
    for (size_t r = 0; r < model->rows.num_rows; r++) {
        double x = grid_x(&model->grid, model->rows.node[r]);
        self->previous[r] = -self->rate * mass[r] * (1 + 1e-3 * sin(2 * x));
    }
    const reduced_squeeze squeeze = {.rate = self->rate,
                                     .previous = self->previous,
                                     .previous_at = previous_film,
                                     .context = self};
    if (shorter > 0)
        reduced_keep_factors(reduced.solver, &reduced.state, contact, shorter * self->rate);
    assert_int_equal(
        reduced_solve(&reduced.info, &reduced.state, reduced.solver, contact, &squeeze, NULL),
        EHD_OK);
    assert_int_equal(reduced.info.status, EHD_OK);
    reduced_info info = reduced.info;
    reduced_problem_free(&reduced);
    return info;
}

/* Factors of a step of the same length are as good as a new Jacobian. With factors of a step that
 * is shorter by a sixth, the solver needs a few more iterations. With factors of a step a third as
 * long, the iteration would converge at a rate of 2/3, so the solver does not use them. */
static void kept_factors_serve_steps_alike(void **state) {
    (void)state;
    for (size_t s = 0; s < TRAINED_STATES; s += 5)
        for (double length = 0.09; length > 5e-3; length *= 0.3) {
            time_step step = {.state = s, .rate = 1 / length};
            const reduced_info own = take_time_step(&step, 0), same = take_time_step(&step, 1);
            const reduced_info near = take_time_step(&step, 1.2), far = take_time_step(&step, 3);
            const double film = own.scalars.central_film_thickness;
            assert_true(own.own_jacobian && !same.own_jacobian && !near.own_jacobian);
            assert_true(own.near_factors && !same.near_factors);
            assert_true(same.iterations <= own.iterations);
            assert_true(near.iterations <= own.iterations + 5);
            check_close(same.scalars.central_film_thickness, film, 2e-7, 0);
            check_close(near.scalars.central_film_thickness, film, 5e-6, 0);
            assert_true(far.own_jacobian && far.near_factors);
            assert_int_equal(far.iterations, own.iterations);
            check_close(far.scalars.central_film_thickness, film, 2e-7, 0);
        }
}

/* With factors of a step twice as long, each iteration changes the solution by twice the right
 * amount. The solver detects this in the second iteration. It then uses the Jacobian at the state
 * that it has reached. */
static void slow_factors_are_replaced_near_the_solution(void **state) {
    size_t num_own = 0, num_slow = 0;
    (void)state;
    for (size_t s = 0; s < TRAINED_STATES; s += 5) {
        time_step step = {.state = s, .rate = 1 / 0.027};
        const reduced_info own = take_time_step(&step, 0), slow = take_time_step(&step, 0.5);
        assert_true(slow.own_jacobian && slow.near_factors);
        check_close(slow.scalars.central_film_thickness, own.scalars.central_film_thickness, 2e-7,
                    0);
        num_own += own.iterations;
        num_slow += slow.iterations;
    }
    // a new start from the beginning would take three more iterations
    assert_true(num_slow <= num_own + 1);
}

/* Far from the solution, the rows of a time step use a mobility that is linear in the pressure: at
 * each node, the tangent to the curve of the mobility at one pressure. In the first iterations this
 * is the higher of the current pressure and the pressure after the last time step. Later, where the
 * pressure has risen, it is the current pressure. Where the pressure has fallen, it is the pressure
 * at which the mobility equals the mobility of the linear rows. */
static void rows_are_linear_about_other_pressures(void **state) {
    const size_t s = 5;
    const scene exponential = sample_scene("barus", "incompressible", 20, 10);
    ehd_contact barus;
    const ehd_contact *contact = &barus;
    const reduced_settings settings = reduced_defaults;
    reduced_problem reduced;
    row_system system;
    node_state nodes;
    arena memory = {.failed = false};
    double last[400], here[400], mobility[400], slope[400], residual[400];
    (void)state;

    assert_int_equal(scene_contact(&barus, &exponential, NULL), EHD_OK);
    reduced_problem_init(&reduced, &coupled, NULL, 0, &settings);
    const reduced_model *model = &reduced.model;
    const size_t num = model->rows.num_needed, num_rows = model->rows.num_rows;
    assert_true(num_rows <= 400 && num <= 400);
    nodes_init(&nodes, model, &memory);
    system_init(&system, model, &memory);
    nodes_move_exit(&nodes, &training.states->exit[s]);
    nodes_expand_state(&nodes, NULL, coupled.states.coordinates + s * model->num_unknowns);
    memcpy(here, nodes.now.pressure, num * sizeof *here);
    for (size_t q = 0; q < num; q++)
        last[q] = here[q] + 0.1 * sin((double)q);

    const double *about = system_about(&system, &nodes, 0, contact, last);
    for (size_t q = 0; q < num; q++)
        assert_true(about[q] == (nodes.pressurised[q] ? fmax(here[q], last[q]) : here[q]));
    system_evaluate(&system, &nodes, 0, contact, NULL, about);
    memcpy(last, about, num * sizeof *last);
    memcpy(mobility, system.fluid_memory, num * sizeof *mobility);
    memcpy(slope, system.fluid_memory + num, num * sizeof *slope);
    for (size_t r = 0; r < num_rows; r++) {
        // residual at the state, plus its linear change if the pressure changes by 0.1 cos(node)
        residual[r] = system.rows[r].residual;
        for (int a = 0; a < NUM_STENCIL; a++)
            if (model->rows.stencils[r].node[a] != NO_NODE)
                residual[r] += 0.1 * system.rows[r].by_pressure[a] *
                               cos((double)model->rows.stencils[r].node[a]);
    }
    for (size_t q = 0; q < num; q++)
        nodes.now.pressure[q] += 0.1 * cos((double)q);
    system_evaluate(&system, &nodes, 0, contact, NULL, last);
    for (size_t r = 0; r < num_rows; r++)
        check_close(system.rows[r].residual, residual[r], 1e-9, 1e-12);

    about = system_about(&system, &nodes, 0, contact, NULL);
    for (size_t q = 0; q < num; q++) {
        const double fall = last[q] - nodes.now.pressure[q];
        assert_true(nodes.pressurised[q] && fall > 0 ? about[q] > nodes.now.pressure[q]
                                                     : about[q] == nodes.now.pressure[q]);
        // mobility of the linear rows at nodes where the pressure has fallen
        last[q] = mobility[q] - slope[q] * fmax(fall, 0);
    }
    system_evaluate(&system, &nodes, 0, contact, NULL, about);
    for (size_t q = 0; q < num; q++) // below zero pressure the viscosity is constant
        if (about[q] > fmax(nodes.now.pressure[q], 0))
            check_close(system.fluid_memory[q], last[q], 1e-9, 0);
    system_free(&system);
    arena_free(&memory);
    reduced_problem_free(&reduced);
}

/* Kept factors may be used if the exit on each line of a point contact has moved by at most 0.025
 * half widths, or by one node on coarse grids. */
static void factors_serve_while_exits_are_near(void **state) {
    size_t at[] = {50, 60}, here[] = {50, 60};
    const kept_factors kept = {.exit = at};
    const reduced_state moved = {.exits = here};
    reduced_model model = {.band = {.num_lines = 2}};
    (void)state;

    const struct {
        double step;
        size_t nodes;
    } grids[] = {{0.1, 1}, {0.025, 1}, {0.0124, 2}, {0.005, 5}};
    for (size_t g = 0; g < 4; g++) {
        model.grid.step = grids[g].step;
        for (size_t line = 0; line < 2; line++) {
            here[line] = at[line] + grids[g].nodes;
            assert_true(kept_factors_are_near(&kept, &model, &moved));
            here[line] = at[line] - grids[g].nodes - 1;
            assert_false(kept_factors_are_near(&kept, &model, &moved));
            here[line] = at[line];
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(factors_serve_while_exits_are_near),
        cmocka_unit_test(kept_factors_serve_steps_alike),
        cmocka_unit_test(slow_factors_are_replaced_near_the_solution),
        cmocka_unit_test(rows_are_linear_about_other_pressures),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
