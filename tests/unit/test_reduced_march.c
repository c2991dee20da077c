/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The reduced march of a point contact, whose exit is a line. */
#include "fullrun/full_march.h"
#include "tests/unit/marching.h"
#include "tests/unit/reduced_problem.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STATE = 6 }; // training state with which a march starts

static const double STEP = 0.01;

static trained training; // 33 by 17 nodes, which are half of a grid
static reduced_basis basis, whole_basis;
static ehd_error error;

#define check_ok(call)                                                                             \
    if (call) fail_msg("%s", error.text)

static int set_up(void **state) {
    (void)state;
    trained_init_point(&training, true, "open");
    trained_basis(&basis, &training, DEFORMATION_COUPLED, 0, 0);
    whole_basis = mirrored_basis(&basis);
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    reduced_basis_free(&basis);
    reduced_basis_free(&whole_basis);
    trained_free(&training);
    return 0;
}

/* Returns a basis with a mode for every node. Its exits may lie farther downstream than in
 * training. */
static reduced_basis nodes_basis(void) {
    reduced_basis nodes = identity_basis(&training.set, DEFORMATION_COUPLED, basis.weight);
    size_t last = grid_width(&nodes.grid) - 2, inner = grid_lines(&nodes.grid) - 1;

    for (size_t l = 0; l < inner; l++)
        nodes.states.exit[l] = last;
    return nodes;
}

static contact_frame frame_under(double load, double time) {
    return frame_at(&contact_point, time, (double[]){load, 1, 1, 1}, NAN);
}

/* Starts under the load of the reference. */
static void marching_init(marching *self, const reduced_basis *of) {
    const contact_frame frame = frame_under(1, 0);

    marching_start(self, &training.contacts[STATE], of, &frame);
    assert_int_equal(self->last.status, EHD_OK);
}

/* Makes an accepted step, which may be untrusted: the training has only stationary contacts. */
static void step_to(marching *self, double load, double time) {
    const contact_frame frame = frame_under(load, time);

    check_ok(self->solver.attempt(&self->last, self->solver.self, &frame, STEP, &error));
    assert_int_not_equal(self->last.status, EHD_NOT_CONVERGED);
    self->solver.accept(self->solver.self);
}

static double load_at(double time) {
    return 1 + 0.1 * sin(2 * M_PI * time / 0.5);
}

static void march_steps(marching *self, size_t from, size_t to) {
    for (size_t i = from; i <= to; i++)
        step_to(self, load_at((double)i * STEP), (double)i * STEP);
}

static void check_same_exits(const marching *a, const marching *b) {
    const reduced_state one = reduced_march_state(a->march, NULL),
                        other = reduced_march_state(b->march, NULL);

    assert_memory_equal(one.exits, other.exits, a->model.band.num_lines * sizeof *one.exits);
}

// ---- tests

static void constant_conditions_keep_the_stationary_state(void **state) {
    (void)state;
    marching self;

    marching_init(&self, &basis);
    for (size_t i = 1; i < 8; i++) {
        step_to(&self, 1, (double)i * STEP);
        const reduced_state now = reduced_march_state(self.march, NULL);
        assert_memory_equal(now.exits, basis.states.exit + STATE * basis.states.num_lines,
                            basis.states.num_lines * sizeof *now.exits);
        check_close(self.last.scalars.central_film_thickness,
                    training.states->central_film_thickness[STATE], 1e-9, 0);
        check_close(self.last.scalars.load, 1, 1e-9, 0);
        assert_string_equal(self.last.reason, "");
    }
    marching_free(&self);
}

/* If every node has a mode, a step equals a step of the full model with the same history and exits.
 * Under a load of 1.05 instead of 1.04 an exit differs by one node, but the films differ by less
 * than the noise of both models. */
static void a_step_of_full_rank_is_one_of_the_full_model(void **state) {
    (void)state;
    reduced_basis nodes = nodes_basis();
    const ehd_grid *grid = &nodes.grid;
    const contact_frame now = frame_under(1.04, STEP);
    full_settings settings = full_default_settings();
    double *previous = calloc(grid->num_inner + 2 * grid->num_nodes, sizeof *previous);
    double *pressure = previous + grid->num_inner, *film = pressure + grid->num_nodes;
    full_solver *solver;
    full_state full;
    full_info info;
    film_carrier carrier;
    previous_film first;
    ehd_contact contact;
    marching self;

    marching_init(&self, &nodes);
    check_ok(film_carrier_init(&carrier, &self.model, &self.splines, &self.reference, &error));
    check_ok(previous_film_init(&first, &carrier, &error));
    const reduced_state start = reduced_march_state(self.march, &first.frame);
    memcpy(first.state.coordinates, start.coordinates, self.model.num_unknowns * sizeof(double));
    reduced_state_set_exits(&first.state, &self.model, start.exits);
    previous_film_prepare(&first);
    fields_of(pressure, film, &start, &self.model, nodes.pressure);
    for (size_t r = 0; r < grid->num_inner; r++)
        previous[r] = previous_film_mass(&first, grid_node_of_row(grid, r), &now) / -STEP;
    settings.tolerance = 1e-12;
    settings.linear_tolerance = 1e-10;
    check_ok(full_solver_create(&solver, &contact_point, grid, &settings, &error));
    check_ok(full_state_init(&full, grid, &error));
    memcpy(full.pressure, pressure, grid->num_nodes * sizeof *pressure);
    full.rigid_approach = start.coordinates[self.model.num_unknowns - 1];
    full_state_set_zone(&full, grid, start.exit);
    frame_contact(&contact, &now, &self.reference);
    const reynolds_squeeze squeeze = {1 / STEP, previous};
    check_ok(full_solve(&info, &full, solver, &contact, &squeeze, &error));
    assert_string_equal(info.reason, "");

    step_to(&self, 1.04, STEP);
    const reduced_state after = reduced_march_state(self.march, NULL);
    fields_of(pressure, film, &after, &self.model, nodes.pressure);
    check_close_array(pressure, full.pressure, grid->num_nodes, 0, 1e-8);
    check_close_array(film, full.film, grid->num_nodes, 0, 1e-8);
    full_state_free(&full);
    full_solver_free(solver);
    previous_film_free(&first);
    film_carrier_free(&carrier);
    marching_free(&self);
    reduced_basis_free(&nodes);
    free(previous);
}

/* A reduced model with a mode for every node gives nearly the same results as the full model. They
 * differ only because the splines of the two models differ at the ends of the grid. */
static void full_rank_marches_as_the_full_model(void **state) {
    (void)state;
    reduced_basis nodes = nodes_basis();
    const full_settings settings = full_default_settings();
    const contact_frame start = frame_under(1, 0);
    full_march *full;
    march_step step;
    marching self;

    marching_init(&self, &nodes);
    check_ok(full_march_create(&full, &self.reference, &settings, NAN, &error));
    march_solver solver = full_march_solver(full);
    check_ok(solver.start(&step, solver.self, &start, &error));
    for (size_t i = 1; i <= 6; i++) {
        const double time = (double)i * STEP;
        const contact_frame frame = frame_under(load_at(time), time);
        check_ok(solver.attempt(&step, solver.self, &frame, STEP, &error));
        assert_int_not_equal(step.status, EHD_NOT_CONVERGED);
        solver.accept(solver.self);
        step_to(&self, load_at(time), time);
        check_close(self.last.scalars.central_film_thickness, step.scalars.central_film_thickness,
                    2e-5, 0);
        check_close(self.last.scalars.minimum_film_thickness, step.scalars.minimum_film_thickness,
                    2e-5, 0);
        check_close(self.last.scalars.rigid_approach, step.scalars.rigid_approach, 2e-5, 0);
    }
    full_march_free(full);
    marching_free(&self);
    reduced_basis_free(&nodes);
}

/* A reduced model can represent only one zone of pressure on a grid line. It therefore reports a
 * second zone that builds up behind the exit. */
static void a_gap_that_closes_behind_the_exit_is_told(void **state) {
    (void)state;
    reduced_basis nodes = nodes_basis();
    marching self;

    for (int grows = 0; grows < 2; grows++) {
        marching_init(&self, &nodes);
        for (size_t i = 1; i <= 2; i++) {
            const double time = (double)i * STEP, radius = 1 + (grows ? 2 : -2) * time;
            const contact_frame frame =
                frame_at(self.reference.kind, time, (double[]){1, 1, radius, 1}, NAN);
            check_ok(self.solver.attempt(&self.last, self.solver.self, &frame, STEP, &error));
            assert_int_not_equal(self.last.status, EHD_NOT_CONVERGED);
            self.solver.accept(self.solver.self);
            const bool told = strstr(self.last.reason, "a second zone of pressure");
            assert_true(told == (grows && i > 1)); // not in step 1, which may follow a jump
        }
        marching_free(&self);
    }
    reduced_basis_free(&nodes);
}

/* Compares the films of two bases over 20 steps. `also`, if not NULL, is called after each step. */
static void check_march_alike(const reduced_basis *first, const reduced_basis *second,
                              double central, double minimum,
                              void (*also)(const marching *, const marching *)) {
    marching one, other;

    marching_init(&one, first);
    marching_init(&other, second);
    for (size_t i = 1; i <= 20; i++) {
        march_steps(&one, i, i);
        march_steps(&other, i, i);
        check_close(one.last.scalars.central_film_thickness,
                    other.last.scalars.central_film_thickness, central, 0);
        check_close(one.last.scalars.minimum_film_thickness,
                    other.last.scalars.minimum_film_thickness, minimum, 0);
        if (also) also(&one, &other);
    }
    marching_free(&one);
    marching_free(&other);
}

/* The frame grows and shrinks, so some previous places lie outside of the grid. The results of the
 * two bases differ, because stationary modes do not represent changing contacts exactly. */
static void an_independent_basis_marches_as_the_coupled_one(void **state) {
    (void)state;
    reduced_basis own_films;

    trained_basis(&own_films, &training, DEFORMATION_INDEPENDENT, 0, 0);
    // The films of the two bases differ from those of the full model by 8e-3 and 2e-3. With zero
    // pressure at the boundary both differences are 1e-3.
    check_march_alike(&own_films, &basis, 1.2e-2, 1e-2, NULL);
    reduced_basis_free(&own_films);
}

/* Checks that the exits are the same on the half grid and on the second half of the whole grid. */
static void check_half_of_exits(const marching *half, const marching *whole) {
    const size_t *exits = reduced_march_state(half->march, NULL).exits;
    const size_t *both = reduced_march_state(whole->march, NULL).exits;

    assert_memory_equal(exits, both + whole->model.band.num_lines / 2,
                        half->model.band.num_lines * sizeof *exits);
}

static void the_half_marches_as_the_whole(void **state) {
    (void)state;
    check_march_alike(&basis, &whole_basis, 1e-9, 1e-9, check_half_of_exits);
}

static void a_restored_march_goes_on_as_the_saved_one(void **state) {
    (void)state;
    marching saved, restored;

    marching_init(&saved, &basis);
    marching_init(&restored, &basis);
    march_steps(&saved, 1, 9);
    march_steps(&restored, 1, 3);
    size_t size = saved.solver.saved_size(saved.solver.self);
    double *slots = calloc(2 * size, sizeof *slots);
    assert_non_null(slots);
    saved.solver.save(slots, saved.solver.self);
    check_ok(restored.solver.restore(restored.solver.self, slots, &error));
    restored.solver.save(slots + size, restored.solver.self);
    assert_memory_equal(slots, slots + size, size * sizeof *slots);
    march_steps(&saved, 10, 20);
    march_steps(&restored, 10, 20);
    assert_memory_equal(&saved.last.scalars, &restored.last.scalars, sizeof saved.last.scalars);
    check_same_exits(&saved, &restored);
    free(slots);
    marching_free(&saved);
    marching_free(&restored);
}

static void saved_exits_outside_of_the_band_are_refused(void **state) {
    (void)state;
    marching self;

    marching_init(&self, &basis);
    size_t size = self.solver.saved_size(self.solver.self);
    size_t num_lines = self.model.band.num_lines,
           first = 2 + sizeof(contact_frame) / sizeof(double);
    double *slots = calloc(size, sizeof *slots);
    assert_non_null(slots);
    self.solver.save(slots, self.solver.self);
    for (size_t l = 0; l < num_lines; l++) {
        double kept = slots[first + l];
        const double outside[] = {(double)self.model.band.lines[l].min_exit - 1,
                                  (double)self.model.band.lines[l].max_exit + 1, NAN};
        for (size_t i = 0; i < sizeof outside / sizeof *outside; i++) {
            slots[first + l] = outside[i];
            assert_int_equal(self.solver.restore(self.solver.self, slots, &error), EHD_DATA);
        }
        slots[first + l] = kept;
    }
    check_ok(self.solver.restore(self.solver.self, slots, &error));
    free(slots);
    marching_free(&self);
}

/* A model must be used with the transport and smoothing of its training. */
static void another_carriage_is_refused(void **state) {
    reduced_basis nodes = nodes_basis();
    reduced_march *created;
    marching self;
    (void)state;

    marching_init(&self, &nodes);
    self.reference.transport = TRANSPORT_PATH;
    assert_int_equal(reduced_march_create(&created, &self.model, &self.splines, &self.reference,
                                          &strict_settings, &error),
                     EHD_DATA);
    assert_null(created);
    assert_non_null(strstr(
        error.text, "this model was trained on stationary contacts; train with `histories`"));
    self.model.states.stationary[0] = false;
    assert_int_equal(reduced_march_create(&created, &self.model, &self.splines, &self.reference,
                                          &strict_settings, &error),
                     EHD_DATA);
    assert_string_equal(error.text,
                        "transport: found path, expected upwind, as in the model's training");
    self.model.carriage = (ehd_carriage){TRANSPORT_PATH, 0.2};
    self.reference.smoothing = 0.1;
    assert_int_equal(reduced_march_create(&created, &self.model, &self.splines, &self.reference,
                                          &strict_settings, &error),
                     EHD_DATA);
    assert_string_equal(error.text,
                        "transient.smoothing: found 0.1, expected 0.2, as in the model's training");
    self.reference.smoothing = NAN; // NaN: the smoothing of the training
    check_ok(reduced_march_create(&created, &self.model, &self.splines, &self.reference,
                                  &strict_settings, &error));
    reduced_march_free(created);
    marching_free(&self);
    reduced_basis_free(&nodes);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_gap_that_closes_behind_the_exit_is_told),
        cmocka_unit_test(another_carriage_is_refused),
        cmocka_unit_test(constant_conditions_keep_the_stationary_state),
        cmocka_unit_test(a_step_of_full_rank_is_one_of_the_full_model),
        cmocka_unit_test(full_rank_marches_as_the_full_model),
        cmocka_unit_test(an_independent_basis_marches_as_the_coupled_one),
        cmocka_unit_test(the_half_marches_as_the_whole),
        cmocka_unit_test(a_restored_march_goes_on_as_the_saved_one),
        cmocka_unit_test(saved_exits_outside_of_the_band_are_refused),
    };

    return cmocka_run_group_tests(tests, set_up, tear_down);
}
