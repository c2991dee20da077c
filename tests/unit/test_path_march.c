/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The reduced march of a line contact along the path of the fluid. */
#include "fullrun/full_march.h"
#include "tests/unit/marching.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STATE = 6 }; // of the training, with which a march starts

static const double STEP = 0.02;

static trained training; // 121 nodes
static reduced_basis basis, nodes;
static ehd_error error;

#define check_ok(call)                                                                             \
    if (call) fail_msg("%s", error.text)

static int set_up(void **state) {
    (void)state;
    trained_init_accurate(&training, 0.05);
    trained_basis(&basis, &training, DEFORMATION_COUPLED, 0, 0);
    nodes = identity_basis(&training.set, DEFORMATION_COUPLED, basis.weight);
    nodes.states.exit[0] = grid_width(&nodes.grid) - 2;
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    reduced_basis_free(&basis);
    reduced_basis_free(&nodes);
    trained_free(&training);
    return 0;
}

/* Load and speed swing, so that a step's path does; T counts from where both are 1. */
static contact_frame frame_after(double time, double swing) {
    const double phase = 2 * M_PI * time / 0.5;
    contact_frame frame =
        frame_at(&contact_line, time,
                 (double[]){1 + 0.1 * swing * sin(phase), 1 + 0.3 * swing * sin(phase), 1, 1}, NAN);

    frame.path = time + 0.3 * swing * (1 - cos(phase)) * 0.5 / (2 * M_PI);
    return frame;
}

static void marching_init(marching *self, const reduced_basis *of, bool compressible) {
    const contact_frame frame = frame_after(0, 1);
    ehd_contact contact = training.contacts[STATE];

    contact.transport = TRANSPORT_PATH;
    contact.smoothing = 0.1;
    if (!compressible) contact.lubricant.density = NULL;
    marching_start(self, &contact, of, &frame);
    assert_int_not_equal(self->last.status, EHD_NOT_CONVERGED);
}

static void step_on(march_step *last, const march_solver *solver, const contact_frame *frame,
                    double step) {
    check_ok(solver->attempt(last, solver->self, frame, step, &error));
    if (last->status == EHD_NOT_CONVERGED) fail_msg("%s", last->reason);
    solver->accept(solver->self);
}

static void constant_conditions_keep_the_stationary_state(void **state) {
    (void)state;
    marching self;

    marching_init(&self, &basis, true);
    const double film = self.last.scalars.central_film_thickness;
    for (size_t i = 1; i < 30; i++) {
        const contact_frame frame = frame_after((double)i * STEP, 0);
        step_on(&self.last, &self.solver, &frame, STEP);
        check_close(self.last.scalars.central_film_thickness, film, 1e-6, 0);
    }
    marching_free(&self);
}

/* With every node as a mode of its own, steps are those of the full model: nearly, since the full
 * one also filters what is left of pressures that an exit cuts, and products of filtered fields. The
 * film is told to a hundredth of what it changes by. */
static void full_rank_marches_as_the_full_model(void **state) {
    (void)state;
    for (int compressible = 0; compressible < 2; compressible++) {
        const full_settings settings = full_default_settings();
        const contact_frame start = frame_after(0, 1);
        full_march *full;
        march_step step;
        marching self;
        double least = INFINITY, most = 0;

        marching_init(&self, &nodes, compressible);
        check_ok(full_march_create(&full, &self.reference, &settings, NAN, &error));
        march_solver solver = full_march_solver(full);
        check_ok(solver.start(&step, solver.self, &start, &error));
        for (size_t i = 1; i <= 60; i++) {
            const contact_frame frame = frame_after((double)i * STEP, 1);
            step_on(&step, &solver, &frame, STEP);
            step_on(&self.last, &self.solver, &frame, STEP);
            const double film = step.scalars.central_film_thickness;
            check_close(self.last.scalars.central_film_thickness, film, 1e-6, 0);
            check_close(self.last.scalars.minimum_film_thickness,
                        step.scalars.minimum_film_thickness, 1e-4, 0);
            // on so coarse a grid the reduced model looks at four nodes less before the exit
            assert_true(self.last.local_error <= 1.1 * step.local_error);
            assert_true(self.last.local_error >= 0.2 * step.local_error);
            least = fmin(least, film);
            most = fmax(most, film);
        }
        assert_true(most > 1.05 * least);
        full_march_free(full);
        marching_free(&self);
    }
}

/* A step repeated, or taken after one of another length, and a march restored into another object
 * have the same bits. */
static void repeated_and_restored_steps_have_the_same_bits(void **state) {
    (void)state;
    marching self, restored;
    march_step one, again;

    marching_init(&self, &basis, true);
    marching_init(&restored, &basis, true);
    for (size_t i = 1; i <= 8; i++) {
        const contact_frame frame = frame_after((double)i * STEP, 0.3);
        step_on(&self.last, &self.solver, &frame, STEP);
    }
    const contact_frame near = frame_after(9 * STEP, 0.3), far = frame_after(12 * STEP, 0.3);
    check_ok(self.solver.attempt(&one, self.solver.self, &near, STEP, &error));
    check_ok(self.solver.attempt(&again, self.solver.self, &far, 4 * STEP, &error));
    check_ok(self.solver.attempt(&again, self.solver.self, &near, STEP, &error));
    assert_memory_equal(&one.scalars, &again.scalars, sizeof one.scalars);
    check_close(one.local_error, again.local_error, 0, 0);

    double *saved = calloc(self.solver.saved_size(self.solver.self), sizeof *saved);
    assert_non_null(saved);
    self.solver.save(saved, self.solver.self);
    check_ok(restored.solver.restore(restored.solver.self, saved, &error));
    free(saved);
    for (size_t i = 9; i < 15; i++) {
        const contact_frame frame = frame_after((double)i * STEP, 0.3);
        step_on(&self.last, &self.solver, &frame, STEP);
        step_on(&restored.last, &restored.solver, &frame, STEP);
        assert_memory_equal(&self.last.scalars, &restored.last.scalars, sizeof one.scalars);
        check_close(self.last.local_error, restored.last.local_error, 0, 0);
    }
    marching_free(&self);
    marching_free(&restored);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(constant_conditions_keep_the_stationary_state),
        cmocka_unit_test(full_rank_marches_as_the_full_model),
        cmocka_unit_test(repeated_and_restored_steps_have_the_same_bits),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
