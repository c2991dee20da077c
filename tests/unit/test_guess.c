/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Starts from trained solutions: what is quadratic in the place is met where training lies all around, what is affine
 * wherever it spans a plane, and otherwise the nearest one is taken. */
#include "romrun/online/reduced_solver.h"
#include "tests/unit/check.h"

#include <math.h>
#include <string.h>

enum { MOST = 7, UNKNOWNS = 2 };

static const double SPACING[2] = {0.14, 0.06}; // of places: ln M, ln(1 + alpha p_H) / 2

typedef struct training {
    reduced_model model;
    band_line line;
    reduced_state state;
} training;

static double field(double x, double y, size_t unknown, bool quadratic) {
    double affine = (double)unknown + 0.7 * x - 1.3 * y;

    return quadratic ? affine + 2 * x * x - 3 * x * y + 0.5 * y * y : affine;
}

/* States at columns by rows of places, whose coordinates are the fields. */
static void training_init(training *self, size_t columns, size_t rows, bool quadratic) {
    reduced_states *states = &self->model.states;
    ehd_error error;

    memset(self, 0, sizeof *self);
    self->line = (band_line){.min_exit = 40, .max_exit = 60};
    self->model.grid = grid_of(-4, 0.05, 98, 1, false);
    self->model.band.num_lines = 1;
    self->model.band.lines = &self->line;
    self->model.num_unknowns = UNKNOWNS;
    assert_int_equal(reduced_states_init(states, columns * rows, 1, UNKNOWNS, &error), EHD_OK);
    assert_int_equal(reduced_state_init(&self->state, &self->model, &error), EHD_OK);
    for (size_t s = 0; s < columns * rows; s++) {
        double x = SPACING[0] * (double)(s % columns), y = SPACING[1] * (double)(s / columns);
        states->moes_M[s] = exp(x);
        states->alpha_p_H[s] = expm1(2 * y);
        states->stationary[s] = true;
        states->exit[s] = 45 + 2 * (s % columns);
        for (size_t j = 0; j < UNKNOWNS; j++)
            states->coordinates[s * UNKNOWNS + j] = field(x, y, j, quadratic);
    }
}

static void training_free(training *self) {
    reduced_states_free(&self->model.states);
    reduced_state_free(&self->state);
}

/* The guess at a place in units of the spacing, against the field at another one. */
static void check_guess(training *self, const double at[2], const double as[2], bool quadratic) {
    reduced_guess(&self->state, &self->model, exp(SPACING[0] * at[0]),
                  expm1(2 * SPACING[1] * at[1]));
    for (size_t j = 0; j < UNKNOWNS; j++)
        check_close(self->state.coordinates[j],
                    field(SPACING[0] * as[0], SPACING[1] * as[1], j, quadratic), 1e-8, 1e-8);
}

static void quadratic_amid_training(void **state) {
    (void)state;
    training self;

    training_init(&self, MOST, MOST, true);
    for (double x = 2; x <= 4; x += 0.25)
        for (double y = 2; y <= 4; y += 0.25) {
            const double at[2] = {x, y};
            check_guess(&self, at, at, true);
            assert_true(fabs((double)self.state.exit - (45 + 2 * x)) <= 0.5 + 1e-6);
        }
    training_free(&self);
}

/* Also where two rows leave the second derivative open, and outside. */
static void affine_where_training_spans_a_plane(void **state) {
    (void)state;
    training self;

    training_init(&self, 4, 2, false);
    for (double x = -0.25; x <= 3.25; x += 0.25)
        for (double y = 0; y <= 1; y += 0.25) {
            const double at[2] = {x, y};
            check_guess(&self, at, at, false);
        }
    training_free(&self);
}

static void nearest_on_a_line_and_far_away(void **state) {
    (void)state;
    training self;

    training_init(&self, MOST, 1, true);
    for (double x = 0.25; x < MOST - 1; x++) {
        const double at[2] = {x, 0.1}, as[2] = {x - 0.25, 0};
        check_guess(&self, at, as, true);
    }
    training_free(&self);
    training_init(&self, MOST, MOST, true);
    const double at[2] = {40, 40}, as[2] = {MOST - 1, MOST - 1};
    check_guess(&self, at, as, true);
    training_free(&self);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(quadratic_amid_training),
        cmocka_unit_test(affine_where_training_spans_a_plane),
        cmocka_unit_test(nearest_on_a_line_and_far_away),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
