/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps in time with the factors of an earlier Jacobian. */
#include "romrun/online/kept_factors.h"
#include "tests/unit/check.h"
#include "tests/unit/reduced_problem.h"

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

/* A step in time of a trained contact from its stationary solution, with a previous film that is a
 * little off. */
typedef struct time_step {
    size_t state;
    double rate;
    double previous[400]; // of inner nodes
} time_step;

static double previous_film(void *context, size_t node) {
    const time_step *self = context;

    return self->previous[node - 1];
}

/* Solves it, with factors kept for a step `shorter` times as short; 0: with none. */
static reduced_info take_time_step(time_step *self, double shorter) {
    const ehd_contact *contact = &training.contacts[self->state];
    reduced_settings settings = reduced_default_settings();
    reduced_problem reduced;
    double pressure[400], mass[400];

    reduced_problem_init(&reduced, &coupled, NULL, 0, &settings);
    const reduced_model *model = &reduced.model;
    assert_true(model->rows.num_rows <= 400);
    memcpy(reduced.state.coordinates,
           coupled.states.coordinates + self->state * model->num_unknowns,
           model->num_unknowns * sizeof(double));
    reduced.state.exit = training.set.exit[self->state];
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

/* Factors of the same step do as well as a Jacobian of every iteration, those of one that is a
 * sixth of it shorter take a few iterations more. Those of a step a third as long converge with a
 * rate of 0.6, which the second iteration shows: then a Jacobian is made, and only one of the
 * iterations was in vain. */
static void kept_factors_serve_steps_alike(void **state) {
    (void)state;
    for (size_t s = 0; s < TRAINED_STATES; s += 5)
        for (double length = 0.09; length > 5e-3; length *= 0.3) {
            time_step step = {.state = s, .rate = 1 / length};
            const reduced_info own = take_time_step(&step, 0), same = take_time_step(&step, 1);
            const reduced_info near = take_time_step(&step, 1.2), far = take_time_step(&step, 3);
            const double film = own.scalars.central_film_thickness;
            assert_true(own.own_jacobian && !same.own_jacobian && !near.own_jacobian);
            assert_int_equal(same.iterations, own.iterations);
            assert_true(near.iterations <= own.iterations + 5);
            check_close(same.scalars.central_film_thickness, film, 2e-7, 0);
            check_close(near.scalars.central_film_thickness, film, 5e-6, 0);
            assert_true(far.own_jacobian);
            assert_true(far.iterations <= own.iterations + 1);
            check_close(far.scalars.central_film_thickness, film, 1e-9, 0);
        }
}

/* By 0.025 half widths on each line of a point contact, on coarse grids by a node. */
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
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
