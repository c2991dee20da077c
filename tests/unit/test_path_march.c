/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The march of the reduced model with transport along the path, for lines and points. */
#include "common/physics/minimum.h"
#include "fullrun/full_march.h"
#include "tests/unit/marching.h"
#include "tests/unit/reduced_problem.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STATE = 6 }; // training state with which a march starts

static const double STEP = 0.02;

/* A training and its bases. The grid of a point contact covers one half of the domain. */
typedef struct problem {
    trained training;
    reduced_basis basis, nodes; // `nodes` has one mode for every node
} problem;

enum { LINE, POINT, OPEN_POINT, NUM_PROBLEMS }; // line: 121 nodes; points: 33 by 17 nodes

static problem problems[NUM_PROBLEMS];
static ehd_error error;

#define check_ok(call)                                                                             \
    if (call) fail_msg("%s", error.text)

static int set_up(void **state) {
    (void)state;
    trained_init_accurate(&problems[LINE].training, 0.05);
    trained_init_point(&problems[POINT].training, true, "zero");
    trained_init_point(&problems[OPEN_POINT].training, true, "open");
    for (size_t p = 0; p < NUM_PROBLEMS; p++) {
        problem *self = &problems[p];
        trained_basis(&self->basis, &self->training, DEFORMATION_COUPLED, 0, 0);
        self->nodes = identity_basis(&self->training.set, DEFORMATION_COUPLED, self->basis.weight);
        reduced_states *const both[] = {&self->basis.states, &self->nodes.states};
        for (int i = 0; i < 2; i++)
            both[i]->rate[0] = both[i]->load_rate[0] = INFINITY; // every rate counts as trained
        for (size_t l = 0; l < self->basis.states.num_lines; l++)
            if (grid_is_inner_line(&self->nodes.grid, l))
                self->nodes.states.exit[l] = grid_width(&self->nodes.grid) - 2;
    }
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    for (size_t p = 0; p < NUM_PROBLEMS; p++) {
        reduced_basis_free(&problems[p].basis);
        reduced_basis_free(&problems[p].nodes);
        trained_free(&problems[p].training);
    }
    return 0;
}

/* Returns a frame in which load and speed oscillate, so the path of a step varies. Radius and
 * modulus oscillate with the amplitude `others`. At T = 0 all factors are 1. */
static contact_frame frame_of_all(const marching *self, double time, double swing, double others) {
    const double phase = 2 * M_PI * time / 0.5;
    const double values[] = {1 + 0.1 * swing * sin(phase), 1 + 0.3 * swing * sin(phase),
                             1 + others * sin(0.5 * phase), 1 - others * sin(0.8 * phase)};
    contact_frame frame = frame_at(self->reference.kind, time, values, NAN);

    frame.path = time + 0.3 * swing * (1 - cos(phase)) * 0.5 / (2 * M_PI);
    return frame;
}

static contact_frame frame_after(const marching *self, double time, double swing) {
    return frame_of_all(self, time, swing, 0);
}

static void marching_init(marching *self, const problem *from, bool full_rank, bool compressible) {
    ehd_contact contact = from->training.contacts[STATE];
    const contact_frame frame = frame_at(contact.kind, 0, (double[]){1, 1, 1, 1}, NAN);

    contact.transport = TRANSPORT_PATH;
    contact.smoothing = 2 * contact.grid.step;
    if (!compressible) contact.lubricant.density = NULL;
    marching_start(self, &contact, full_rank ? &from->nodes : &from->basis, &frame);
    assert_int_not_equal(self->last.status, EHD_NOT_CONVERGED);
}

/* Starts the march again, now with error estimates of the films. */
static void indicate_bounds(marching *self) {
    const contact_frame start = frame_after(self, 0, 1);

    reduced_march_indicate(self->march, (film_factors){1, 1, 0, 0});
    check_ok(self->solver.start(&self->last, self->solver.self, &start, &error));
}

static void step_on(march_step *last, const march_solver *solver, const contact_frame *frame,
                    double step) {
    check_ok(solver->attempt(last, solver->self, frame, step, &error));
    if (last->status == EHD_NOT_CONVERGED) fail_msg("%s", last->reason);
    solver->accept(solver->self);
}

/* Returns the number of iterations of twenty steps with this time-step tolerance. *film is the
 * central film after these steps. */
static size_t iterations_with(double *film, double tolerance) {
    const size_t num_steps = 20;
    marching self;

    marching_init(&self, &problems[LINE], true, false);
    size_t iterations = 0;
    reduced_march_set_tolerance(self.march, tolerance);
    for (size_t i = 1; i <= num_steps; i++) {
        const contact_frame frame = frame_after(&self, (double)i * STEP, 1);
        step_on(&self.last, &self.solver, &frame, STEP);
        iterations += self.last.iterations;
    }
    *film = self.last.scalars.central_film_thickness;
    marching_free(&self);
    return iterations;
}

/* If a tolerance of the time steps is set, the solver makes fewer iterations. The resulting change
 * of the film is much smaller than this tolerance. */
static void a_tolerance_of_the_steps_saves_iterations(void **state) {
    (void)state;
    const double tolerance = 1.5e-3;
    double exact, film, close;
    const size_t most = iterations_with(&exact, NAN);

    assert_true(iterations_with(&film, tolerance) < most);
    check_close(film, exact, 0.01 * tolerance, 0.0);
    assert_int_equal(iterations_with(&close, 1e-15), most);
    check_close(close, exact, 0.0, 0.0);
}

static void constant_conditions_keep_the_stationary_state(void **state) {
    (void)state;
    for (size_t p = 0; p < NUM_PROBLEMS; p++) {
        marching self;

        marching_init(&self, &problems[p], false, true);
        const double film = self.last.scalars.central_film_thickness;
        for (size_t i = 1; i < 30; i++) {
            const contact_frame frame = frame_after(&self, (double)i * STEP, 0);
            step_on(&self.last, &self.solver, &frame, STEP);
            check_close(self.last.scalars.central_film_thickness, film, 1e-6, 0);
        }
        marching_free(&self);
    }
}

/* As in the full model, a step is rejected if its film is far from the prediction. */
static void a_film_far_from_its_prediction_is_not_taken(void **state) {
    (void)state;
    for (size_t p = 0; p < NUM_PROBLEMS; p++) {
        marching self;
        march_step far;

        marching_init(&self, &problems[p], false, true);
        for (size_t i = 1; i < 5; i++) {
            const contact_frame frame = frame_after(&self, (double)i * STEP, 0);
            step_on(&self.last, &self.solver, &frame, STEP);
        }
        contact_frame frame =
            frame_at(self.reference.kind, 5 * STEP, (double[]){0.7, 1, 1, 1}, NAN);
        frame.path = 5 * STEP;
        check_ok(self.solver.attempt(&far, self.solver.self, &frame, STEP, &error));
        assert_int_equal(far.status, EHD_NOT_CONVERGED);
        assert_string_equal(far.reason, "a film far from its prediction");
        frame = frame_after(&self, 5 * STEP, 0);
        step_on(&self.last, &self.solver, &frame, STEP);
        marching_free(&self);
    }
}

/* Compares the full model with a reduced model that has a mode for each node. The results are only
 * nearly equal, because the two models filter different fields. The full model also filters the
 * rest of a pressure that is cut at an exit, and products of filtered fields. */
static void march_as_the_full_model(const problem *of, bool compressible, double others,
                                    size_t num_steps, double central, double minimum) {
    const double bound = of->basis.grid.inner_lines > 1 ? 1e-3 : 1e-6;
    const full_settings settings = full_default_settings();
    full_march *full;
    march_step step;
    marching self;
    double least = INFINITY, most = 0, effects = 0, off = 0;

    marching_init(&self, of, true, compressible);
    indicate_bounds(&self);
    const contact_frame start = frame_after(&self, 0, 1);
    check_ok(full_march_create(&full, &self.reference, &settings, NAN, &error));
    march_solver solver = full_march_solver(full);
    check_ok(solver.start(&step, solver.self, &start, &error));
    for (size_t i = 1; i <= num_steps; i++) {
        const contact_frame frame = frame_of_all(&self, (double)i * STEP, 1, others);
        step_on(&step, &solver, &frame, STEP);
        step_on(&self.last, &self.solver, &frame, STEP);
        const double film = step.scalars.central_film_thickness;
        check_close(self.last.scalars.central_film_thickness, film, central, 0);
        check_close(self.last.scalars.minimum_film_thickness, step.scalars.minimum_film_thickness,
                    minimum, 0);
        // the local error of the reduced model leaves out four more nodes near the exit, which
        // matters on this coarse grid
        assert_true(self.last.local_error <= 1.1 * step.local_error);
        assert_true(self.last.local_error >= 0.2 * step.local_error);
        // the estimate is almost zero, because the residuals of all rows are zero
        assert_true(self.last.indicated < bound);
        // the reduced model does not count errors close to the exit
        assert_true(self.last.taken_up <= 1.5 * step.taken_up);
        assert_true(self.last.taken_up >= 0.6 * step.taken_up);
        effects += step.effect * step.effect;
        off += pow(self.last.effect - step.effect, 2);
        least = fmin(least, film);
        most = fmax(most, film);
    }
    assert_true(most > 1.04 * least);
    // the estimated effects of the time steps differ, because the two models interpolate them by
    // splines at different places
    assert_true(effects > 0 && sqrt(off / effects) < (of == &problems[OPEN_POINT] ? 0.5 : 0.25));
    full_march_free(full);
    marching_free(&self);
}

static void full_rank_marches_as_the_full_model(void **state) {
    (void)state;
    for (int others = 0; others < 2; others++) {
        march_as_the_full_model(&problems[LINE], false, 0.02 * others, 60, 1e-6, 1e-4);
        march_as_the_full_model(&problems[LINE], true, 0.02 * others, 60, 1e-6, 1e-4);
    }
}

/* In point contacts the two models agree with the same accuracy as with upwind transport. They
 * differ because their splines differ at the ends of the grid. Only ten steps are compared: from
 * the fifteenth step on exits move outwards, and the exits of the reduced model lag by a node. */
static void so_does_a_point(void **state) {
    (void)state;
    for (int others = 0; others < (check_all() ? 2 : 1); others++) {
        march_as_the_full_model(&problems[POINT], false, 0.004 * others, 10, 1e-5, 2e-4);
        march_as_the_full_model(&problems[POINT], true, 0.004 * others, 10, 1e-5, 2e-4);
    }
    // With the open boundary the exit at Y = 0 moves in the third step. The full model then also
    // filters the pressure that this exit cuts off.
    march_as_the_full_model(&problems[OPEN_POINT], false, 0, 10, 1e-3, 3e-3);
    march_as_the_full_model(&problems[OPEN_POINT], true, 0, 10, 1e-3, 3e-3);
}

static void the_half_marches_as_the_whole(void **state) {
    (void)state;
    const problem *half = &problems[OPEN_POINT];
    problem whole = *half;
    marching one, all;

    whole.basis = mirrored_basis(&half->basis);
    marching_init(&one, half, false, true);
    marching_init(&all, &whole, false, true);
    for (size_t i = 1; i <= 20; i++) {
        const contact_frame frame = frame_after(&one, (double)i * STEP, 1);
        step_on(&one.last, &one.solver, &frame, STEP);
        step_on(&all.last, &all.solver, &frame, STEP);
        const contact_scalars *a = &one.last.scalars, *b = &all.last.scalars;
        check_close(a->central_film_thickness, b->central_film_thickness, 1e-9, 0);
        check_close(a->minimum_film_thickness, b->minimum_film_thickness, 1e-9, 0);
        check_close(one.last.effect, all.last.effect, 1e-6, 1e-12);
        assert_memory_equal(reduced_march_state(one.march, NULL).exits,
                            reduced_march_state(all.march, NULL).exits +
                                all.model.band.num_lines / 2,
                            one.model.band.num_lines * sizeof(size_t));
    }
    marching_free(&one);
    marching_free(&all);
    reduced_basis_free(&whole.basis);
}

static bool is_on_the_way(const ehd_grid *grid, size_t row) {
    const size_t k = grid_node_of_row(grid, row);

    return grid_x(grid, k) > -1 && grid_x(grid, k) < 0.1 && fabs(grid_y(grid, k)) < 0.1;
}

/* Checks the local error, which a film accumulates on its way to the centre. The error is evaluated
 * at nodes, not at rows: a model with only one row on this way must not report a much smaller error
 * than a model with all rows. */
static void check_error_of_few_rows(const problem *of) {
    const ehd_grid *grid = &of->basis.grid;
    size_t *rows = calloc(grid->num_inner, sizeof *rows), num_rows = 0, on_the_way = 0;
    marching all, few;
    double largest = 0;

    assert_non_null(rows);
    for (size_t r = 0; r < grid->num_inner; r++)
        if (!is_on_the_way(grid, r) || on_the_way++ == 0)
            rows[num_rows++] = grid_node_of_row(grid, r);
    assert_true(on_the_way > 5);
    marching_init(&all, of, false, true);
    const contact_frame start = frame_after(&all, 0, 1);
    ehd_contact contact = all.reference;
    marching_start_with(&few, &contact, &of->basis, rows, num_rows, &start);
    for (size_t i = 1; i <= 10; i++) {
        const contact_frame frame = frame_after(&all, (double)i * STEP, 1);
        step_on(&all.last, &all.solver, &frame, STEP);
        step_on(&few.last, &few.solver, &frame, STEP);
        assert_true(few.last.local_error >= 0.8 * all.last.local_error);
        // with the few stationary modes of a line, the film does not move with the fluid where no
        // row requires this, so the error may be larger
        assert_true(of == &problems[LINE] || few.last.local_error <= 1.25 * all.last.local_error);
        largest = fmax(largest, all.last.local_error);
    }
    assert_true(largest > 0);
    marching_free(&all);
    marching_free(&few);
    free(rows);
}

static void few_rows_tell_the_error_of_all(void **state) {
    (void)state;
    for (size_t p = 0; p < OPEN_POINT; p++) // not OPEN_POINT, whose exit moves too soon
        check_error_of_few_rows(&problems[p]);
}

/* The contact varies until the fluid has moved by 0.5, and meanwhile the few stationary modes have
 * errors. An error in the inlet changes the estimate for the centre only when its fluid arrives at
 * the centre, after a path of about 0.85. The estimate falls again when this fluid has left. */
static void what_is_indicated_comes_with_the_fluid(void **state) {
    (void)state;
    double before = 0, there = 0, after = 0;
    marching self;

    marching_init(&self, &problems[LINE], false, true);
    indicate_bounds(&self);
    assert_true(self.last.indicated > 0 && self.last.indicated < 1e-3);
    for (size_t i = 1; i <= 120; i++) {
        const contact_frame frame = frame_after(&self, (double)i * STEP, i <= 25 ? 0.3 : 0);
        step_on(&self.last, &self.solver, &frame, STEP);
        if (frame.path < 0.65) before = fmax(before, self.last.indicated);
        if (frame.path > 0.85 && frame.path < 1.5) there = fmax(there, self.last.indicated);
        if (frame.path > 2) after = fmax(after, self.last.indicated);
    }
    assert_true(there > 0.05);
    assert_true(before < 0.25 * there);
    assert_true(after < 0.25 * there);
    marching_free(&self);
}

/* After an upward jump of the load the pressure extends to the end of the grid, where the exit then
 * lies. The training has exits there too, so the step is trusted. */
static void an_exit_may_lie_at_the_end_of_the_grid(void **state) {
    (void)state;
    const double step = 1e-3;
    marching self;

    marching_init(&self, &problems[LINE], true, true);
    indicate_bounds(&self);
    contact_frame frame = frame_at(&contact_line, step, (double[]){1.1, 1, 1, 1}, NAN);
    frame.path = step;
    self.solver.restart(self.solver.self);
    step_on(&self.last, &self.solver, &frame, step);
    assert_true(self.last.scalars.exit_position > 1.9); // the grid ends at 2
    assert_string_equal(self.last.reason, "");
    assert_int_equal(self.last.status, EHD_OK);
    marching_free(&self);
}

static double film_in(const void *context, size_t node) {
    return ((const double *)context)[node];
}

/* A transient film may have its minimum in a dip upstream of the exit band. The depth of this dip
 * is computed from all nodes, not only from the needed nodes of the selected rows. */
static void a_dip_is_found_between_the_needed_nodes(void **state) {
    (void)state;
    enum { EVERY = 5, BEGIN = 30 };
    const problem *of = &problems[LINE];
    const ehd_grid *grid = &of->basis.grid;
    const contact_frame start = frame_at(&contact_line, 0, (double[]){1, 1, 1, 1}, NAN);
    const ehd_contact *contact = &of->training.contacts[STATE];
    double *pressure = calloc(grid->num_nodes, sizeof *pressure);
    double *film = calloc(grid->num_nodes, sizeof *film);
    size_t rows[FEW_ROWS], num_rows = 0, num_dips = 0, num_missed = 0, num_other = 0;
    marching self;

    assert_true(pressure && film);
    for (size_t k = 20; num_rows < FEW_ROWS && k<115; k += k> 85 ? 1 : EVERY)
        rows[num_rows++] = k;
    marching_start_with(&self, contact, &of->basis, rows, num_rows, &start);
    const size_t num = self.model.num_unknowns;
    double *z = calloc(num, sizeof *z);
    assert_non_null(z);
    for (size_t i = 0; i < TRAINED_STATES * TRAINED_STATES; i++) {
        // combinations of two trained solutions, some of them with dips
        const size_t a = i / TRAINED_STATES, b = i % TRAINED_STATES;
        const double *of_a = self.model.states.coordinates + a * num;
        const double *of_b = self.model.states.coordinates + b * num;
        reduced_state at = {.coordinates = z, .exit = self.model.states.exit[a]};
        for (size_t k = 0; k < num; k++)
            z[k] = 3 * of_a[k] - 2 * of_b[k];
        contact_scalars scalars = reduced_scalars(reduced_march_inner(self.march), &at, contact);
        fields_of(pressure, film, &at, &self.model, self.splines.fields.pressure);
        size_t lowest = BEGIN, deepest = BEGIN;
        double least = INFINITY; // smallest film of all dips, as in the full model
        for (size_t k = BEGIN; k < at.exit; k++) {
            if (film[k] < film[lowest]) lowest = k;
            if (film[k] > film[k - 1] || film[k] > film[k + 1]) continue;
            const double here = minimum_around(grid, k, film_in, film);
            if (!(here < least)) continue;
            least = here;
            deepest = k;
        }
        if (lowest == BEGIN || lowest + 2 >= self.model.band.lines[0].begin) continue;
        num_dips++;
        num_other += deepest != lowest;
        num_missed += fabs(scalars.minimum_film_thickness - least) > 1e-4 * fabs(least);
        reduced_find_dip(&scalars, reduced_march_inner(self.march), film_in, film);
        check_close(scalars.minimum_position, grid_x(grid, deepest), 0, 1e-12);
        check_close(scalars.minimum_film_thickness, least, 1e-9, 0);
    }
    // the minimum of a parabola through needed nodes is too inaccurate for these dips
    assert_true(num_dips > 10 && num_missed > 5);
    assert_true(num_other > 0); // the deepest dip is not always at the lowest node
    free(z);
    free(pressure);
    free(film);
    marching_free(&self);
}

/* The load starts outside of the trained range and returns to it. No step is trusted until the last
 * film that formed outside of the range has moved from the edge of the contact to the exit. */
static void a_doubtful_film_is_doubtful_until_it_has_left(void **state) {
    (void)state;
    enum { MIDDLE = 7 }; // training state with M = 15, L = 4
    const problem *of = &problems[LINE];
    ehd_contact contact = of->training.contacts[MIDDLE];
    double last_outside = 0, first_trusted = NAN, farthest = 0;
    marching self;

    contact.transport = TRANSPORT_PATH;
    contact.smoothing = 2 * contact.grid.step;
    const contact_frame start = frame_at(contact.kind, 0, (double[]){1.4, 1, 1, 1}, NAN);
    marching_start(&self, &contact, &of->basis, &start);
    assert_int_equal(self.last.status, EHD_UNTRUSTED); // M = 21, trained up to 20
    for (size_t i = 1; i <= 160; i++) {
        const double time = (double)i * STEP, load = 1.4 - 0.2 * fmin(time / 0.4, 1);
        contact_frame frame = frame_at(contact.kind, time, (double[]){load, 1, 1, 1}, NAN);
        frame.path = time;
        step_on(&self.last, &self.solver, &frame, STEP);
        if (15 * load > 20) {
            last_outside = time;
            farthest = frame.half_width * (1 + self.last.scalars.exit_position);
            assert_string_equal(self.last.reason,
                                "outside of the trained range of M and alpha p_H");
        }
        if (isnan(first_trusted) && self.last.status == EHD_OK) first_trusted = time;
        if (self.last.status && 15 * load <= 20)
            assert_string_equal(self.last.reason,
                                "a film that formed in a step that was not to be trusted");
    }
    assert_true(last_outside > 0 && farthest > 2);
    check_close(first_trusted, last_outside + farthest, 0, 1.01 * STEP);
    marching_free(&self);
}

/* Checks that a repeated step gives the same bits, also after an attempt with another length. Then
 * checks that a march that is restored into another object continues with the same bits. */
static void check_same_bits(const problem *of) {
    marching self, restored;
    march_step one, again;

    marching_init(&self, of, false, true);
    marching_init(&restored, of, false, true);
    indicate_bounds(&self);
    indicate_bounds(&restored);
    for (size_t i = 1; i <= 8; i++) {
        const contact_frame frame = frame_after(&self, (double)i * STEP, 0.3);
        step_on(&self.last, &self.solver, &frame, STEP);
    }
    const contact_frame near = frame_after(&self, 9 * STEP, 0.3),
                        far = frame_after(&self, 12 * STEP, 0.3);
    check_ok(self.solver.attempt(&one, self.solver.self, &near, STEP, &error));
    check_ok(self.solver.attempt(&again, self.solver.self, &far, 4 * STEP, &error));
    check_ok(self.solver.attempt(&again, self.solver.self, &near, STEP, &error));
    assert_memory_equal(&one.scalars, &again.scalars, sizeof one.scalars);
    check_close(one.local_error, again.local_error, 0, 0);
    check_close(one.effect, again.effect, 0, 0);
    check_close(one.indicated, again.indicated, 0, 0);

    double *saved = calloc(self.solver.saved_size(self.solver.self), sizeof *saved);
    assert_non_null(saved);
    self.solver.save(saved, self.solver.self);
    check_ok(restored.solver.restore(restored.solver.self, saved, &error));
    free(saved);
    for (size_t i = 9; i < 15; i++) {
        const contact_frame frame = frame_after(&self, (double)i * STEP, 0.3);
        step_on(&self.last, &self.solver, &frame, STEP);
        step_on(&restored.last, &restored.solver, &frame, STEP);
        assert_memory_equal(&self.last.scalars, &restored.last.scalars, sizeof one.scalars);
        check_close(self.last.local_error, restored.last.local_error, 0, 0);
        check_close(self.last.effect, restored.last.effect, 0, 0);
        assert_true(self.last.indicated > 0);
        check_close(self.last.indicated, restored.last.indicated, 0, 0);
        check_close(self.last.indicated_minimum, restored.last.indicated_minimum, 0, 0);
    }
    marching_free(&self);
    marching_free(&restored);
}

static void repeated_and_restored_steps_have_the_same_bits(void **state) {
    (void)state;
    for (size_t p = 0; p < NUM_PROBLEMS; p++)
        check_same_bits(&problems[p]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(constant_conditions_keep_the_stationary_state),
        cmocka_unit_test(a_tolerance_of_the_steps_saves_iterations),
        cmocka_unit_test(a_film_far_from_its_prediction_is_not_taken),
        cmocka_unit_test(full_rank_marches_as_the_full_model),
        cmocka_unit_test(so_does_a_point),
        cmocka_unit_test(the_half_marches_as_the_whole),
        cmocka_unit_test(few_rows_tell_the_error_of_all),
        cmocka_unit_test(what_is_indicated_comes_with_the_fluid),
        cmocka_unit_test(an_exit_may_lie_at_the_end_of_the_grid),
        cmocka_unit_test(a_dip_is_found_between_the_needed_nodes),
        cmocka_unit_test(a_doubtful_film_is_doubtful_until_it_has_left),
        cmocka_unit_test(repeated_and_restored_steps_have_the_same_bits),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
