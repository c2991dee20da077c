/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Weighted sums of two pressures whose spikes lie at different places. The basis can represent any
 * pressure at the nodes. The shifted sum must have one spike between the two places, not two
 * spikes. */
#include "romrun/model/start_shift.h"
#include "tests/unit/check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { NODES = 200, STATES = 3 };

static const double SPIKES[STATES] = {0.80, 0.92, 0.80};

typedef struct problem {
    reduced_model model;
    double modes[NODES * NODES], x[NODES];
    size_t nodes[NODES];
} problem;

/* Returns the value at x of a pressure that falls from x = 0 on and has a spike at x = `spike`. */
static double pressure_at(double x, double spike) {
    const double along = x < spike ? x / spike : 1 + x - spike;

    return x < 0 ? 1 + x : 1 - 0.5 * along * along + 0.6 * exp(-pow((along - 1) / 0.03, 2));
}

/* Makes a model and its states, whose coordinates are the pressures at the nodes. */
static problem *problem_create(deformation_kind deformation, size_t num_lines) {
    problem *self = calloc(1, sizeof *self);
    ehd_error error;

    assert_non_null(self);
    self->model = (reduced_model){
        .grid = grid_of(-0.5, 0.01, NODES, 1, false, DISCRETIZATION_ACCURATE),
        .deformation = deformation,
        .num_pressure = NODES,
        .num_unknowns = NODES + 1,
        .rows = {.num_needed = NODES, .needed_node = self->nodes, .pressure = self->modes},
        .band = {.num_lines = num_lines}};
    assert_int_equal(reduced_states_init(&self->model.states, STATES, 1, NODES + 1, &error),
                     EHD_OK);
    for (size_t q = 0; q < NODES; q++) {
        self->nodes[q] = q + 1;
        self->x[q] = grid_x(&self->model.grid, q + 1);
        self->modes[q * NODES + q] = 1;
        for (size_t s = 0; s < STATES; s++)
            self->model.states.coordinates[s * (NODES + 1) + q] =
                pressure_at(self->x[q], SPIKES[s]);
    }
    assert_int_equal(start_shift_build(&self->model, &error), EHD_OK);
    return self;
}

static void problem_free(problem *self) {
    reduced_model_free(&self->model);
    free(self);
}

static void add_states(double *coordinates, const problem *self, const size_t *states,
                       const double *weights, size_t count) {
    memset(coordinates, 0, NODES * sizeof *coordinates);
    for (size_t i = 0; i < count; i++)
        for (size_t q = 0; q < NODES; q++)
            coordinates[q] +=
                weights[i] * self->model.states.coordinates[states[i] * (NODES + 1) + q];
}

static double worst_error(const double *coordinates, const problem *self, double spike) {
    double worst = 0;

    for (size_t q = 0; q < NODES; q++)
        worst = fmax(worst, fabs(coordinates[q] - pressure_at(self->x[q], spike)));
    return worst;
}

static void one_spike_between_two(void **state) {
    (void)state;
    problem *self = problem_create(DEFORMATION_COUPLED, 1);
    const size_t states[] = {0, 1};
    double sum[NODES];

    for (double part = -0.25; part <= 1.25; part += 0.25) {
        const double weights[] = {1 - part, part};
        const double spike = weights[0] * SPIKES[0] + weights[1] * SPIKES[1];
        add_states(sum, self, states, weights, 2);
        if (part != 0 && part != 1) assert_true(worst_error(sum, self, spike) > 0.3);
        start_shift_apply(sum, &self->model, states, weights, 2);
        // error of cubic interpolation for a spike that is 0.6 high and six nodes wide
        assert_true(worst_error(sum, self, spike) < 0.06);
    }
    problem_free(self);
}

static void spikes_at_one_place_stay(void **state) {
    (void)state;
    problem *self = problem_create(DEFORMATION_COUPLED, 1);
    const size_t states[] = {0, 2};
    const double weights[] = {0.75, 0.25};
    double sum[NODES], shifted[NODES];

    for (size_t count = 1; count <= 2; count++) {
        const double one = 1, *all = count == 1 ? &one : weights;
        add_states(sum, self, states, all, count);
        memcpy(shifted, sum, sizeof sum);
        start_shift_apply(shifted, &self->model, states, all, count);
        for (size_t q = 0; q < NODES; q++)
            check_close(shifted[q], sum[q], 1e-13, 1e-13);
    }
    problem_free(self);
}

/* Sums of a point contact and of an independent basis are not shifted. */
static void others_have_none(void **state) {
    (void)state;
    problem *others[] = {problem_create(DEFORMATION_COUPLED, 3),
                         problem_create(DEFORMATION_INDEPENDENT, 1)};
    const size_t states[] = {0, 1};
    const double weights[] = {0.5, 0.5};
    double sum[NODES], shifted[NODES];

    for (size_t i = 0; i < 2; i++) {
        add_states(sum, others[i], states, weights, 2);
        memcpy(shifted, sum, sizeof sum);
        start_shift_apply(shifted, &others[i]->model, states, weights, 2);
        assert_memory_equal(shifted, sum, sizeof sum);
        problem_free(others[i]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_spike_between_two),
        cmocka_unit_test(spikes_at_one_place_stay),
        cmocka_unit_test(others_have_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
