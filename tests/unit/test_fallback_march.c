/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Marches in which the reduced and the full model take steps in turn. With a mode for every node
 * both models are equal, so a change of the model must not change the result. */
#include "romrun/calibrate/fallback_march.h"
#include "tests/unit/marching.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { NUM_STEPS = 64 };

static const double STEP = 0.02;

static marching_trainings trained_on;
static ehd_error error;

#define check_ok(call)                                                                             \
    if (call) fail_msg("%s", error.text)

static int set_up(void **state) {
    (void)state;
    marching_trainings_init(&trained_on);
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    marching_trainings_free(&trained_on);
    return 0;
}

/* A march and its results at each step. If `both` is NULL, the full model runs alone. */
typedef struct run {
    marching reduced;
    parts_march *parts; // its only part is the march of `reduced`
    fallback_march *both;
    full_march *full;
    march_solver solver;
    double phase;
    double film[NUM_STEPS + 1], least_film[NUM_STEPS + 1], exit[NUM_STEPS + 1];
    double effect[NUM_STEPS + 1];
    bool by_full_model[NUM_STEPS + 1];
} run;

/* Returns a load that leaves the trained range, comes back and leaves the range again. With a phase
 * of pi/2 the load starts outside of the range. */
static double load_at(size_t i, double phase) {
    return 1 + 0.15 * sin(2 * M_PI * (double)i * STEP + phase);
}

static contact_frame frame_at_step(const run *self, size_t i) {
    contact_frame frame = frame_at(self->reduced.reference.kind, (double)i * STEP,
                                   (double[]){load_at(i, self->phase), 1, 1, 1}, NAN);

    frame.path = frame.time;
    return frame;
}

static void keep(run *self, const march_step *step, size_t i) {
    const contact_scalars scalars =
        frame_to_reference(&step->scalars, &step->frame, &self->reduced.reference);

    assert_string_equal(step->reason, "");
    assert_int_equal(step->status, EHD_OK);
    self->film[i] = scalars.central_film_thickness;
    self->least_film[i] = scalars.minimum_film_thickness;
    self->exit[i] = scalars.exit_position;
    self->effect[i] = step->effect;
    self->by_full_model[i] = step->by_full_model;
}

static void run_init(run *self, const ehd_contact *contact, const reduced_basis *basis,
                     bool with_reduced, double accuracy, double phase) {
    full_settings settings = full_default_settings();
    march_step first;
    memset(self, 0, sizeof *self);
    self->reduced.reference = *contact;
    self->phase = phase;
    const contact_frame frame = frame_at_step(self, 0);

    marching_start(&self->reduced, contact, basis, &frame);
    if (with_reduced) {
        check_ok(parts_march_create(&self->parts, &self->reduced.march, 1, &error));
        self->reduced.march = NULL;
        check_ok(fallback_march_create(&self->both, self->parts, NAN, accuracy, NULL, &error));
        self->solver = fallback_march_solver(self->both);
    } else {
        check_ok(full_march_create(&self->full, reduced_march_steps(self->reduced.march)->reference,
                                   &settings, NAN, &error));
        self->solver = full_march_solver(self->full);
    }
    check_ok(self->solver.start(&first, self->solver.self, &frame, &error));
    keep(self, &first, 0);
}

static void run_free(run *self) {
    fallback_march_free(self->both);
    parts_march_free(self->parts);
    full_march_free(self->full);
    marching_free(&self->reduced);
}

/* Takes the steps `from` … `to`. */
static void go_on(run *self, size_t from, size_t to) {
    for (size_t i = from; i <= to; i++) {
        const contact_frame frame = frame_at_step(self, i);
        march_step step = {.status = EHD_OK};
        if (i == 12 || i == 31) self->solver.restart(self->solver.self);
        check_ok(self->solver.attempt(&step, self->solver.self, &frame, STEP, &error));
        step.frame = frame;
        keep(self, &step, i);
        self->solver.accept(self->solver.self);
    }
}

static size_t count_full(const run *self) {
    size_t count = 0;

    for (size_t i = 0; i <= NUM_STEPS; i++)
        count += self->by_full_model[i];
    return count;
}

/* Checks that the films of both models in turn equal the films of the full model alone. */
static void check_turns(const ehd_contact *contact, const reduced_basis *basis, double tolerance) {
    run *both = malloc(sizeof *both), *full = malloc(sizeof *full);

    run_init(full, contact, basis, false, 0, 0);
    go_on(full, 1, NUM_STEPS);
    run_init(both, contact, basis, true, 1e-2, 0);
    go_on(both, 1, NUM_STEPS);
    const size_t num_full = count_full(both);
    assert_in_range(num_full, 8, NUM_STEPS - 25);
    assert_false(both->by_full_model[0]);
    assert_false(both->by_full_model[2]);
    assert_true(both->by_full_model[12]); // the largest load
    assert_false(both->by_full_model[40]);
    assert_true(both->by_full_model[NUM_STEPS]);
    check_close_array(both->film, full->film, NUM_STEPS + 1, tolerance, 0);
    if (contact->transport == TRANSPORT_PATH && contact->kind->dimensions == 1) {
        // the reduced model later reports the errors that the full model accumulated
        check_close(both->effect[36], full->effect[36], 0.15, 0);
        check_close_array(both->effect + 60, full->effect + 60, NUM_STEPS - 59, 0.15, 0);
    }
    check_close_array(both->least_film, full->least_film, NUM_STEPS + 1, 10 * tolerance, 0);
    const time_run_share share = fallback_march_share(both->both);
    assert_int_equal(share.full_steps, num_full);
    assert_non_null(strstr(share.reason, "trained range"));
    assert_true(share.since > 0 && share.since < 0.25);
    assert_true(share.seconds_full > 0 && share.seconds_reduced > 0);
    run_free(both);
    run_free(full);
    free(both);
    free(full);
}

static void in_turn_they_are_the_full_model(void **state) {
    (void)state;
    for (int path = 0; path < 2; path++) {
        reduced_basis nodes =
            marching_nodes(&trained_on.line, DEFORMATION_COUPLED, trained_on.bases[1].weight);
        const ehd_contact contact = marching_contact(&trained_on.line, 18.5, path);
        check_turns(&contact, &nodes, 1e-5);
        reduced_basis_free(&nodes);
    }
}

static void with_modes_of_the_deflection_too(void **state) {
    (void)state;
    reduced_basis nodes =
        marching_nodes(&trained_on.line, DEFORMATION_INDEPENDENT, trained_on.bases[0].weight);
    const ehd_contact contact = marching_contact(&trained_on.line, 18.5, true);

    check_turns(&contact, &nodes, 1e-5);
    reduced_basis_free(&nodes);
}

static void of_a_point_contact(void **state) {
    (void)state;
    reduced_basis nodes =
        marching_nodes(&trained_on.point, DEFORMATION_COUPLED, trained_on.point_basis.weight);
    const ehd_contact contact = marching_contact(&trained_on.point, 18.5, true);

    check_turns(&contact, &nodes, 1e-4);
    reduced_basis_free(&nodes);
}

/* A march that is saved after steps of either model and restored continues with the same bits. */
static void saved_and_restored(void **state) {
    (void)state;
    reduced_basis nodes =
        marching_nodes(&trained_on.line, DEFORMATION_COUPLED, trained_on.bases[1].weight);
    const ehd_contact contact = marching_contact(&trained_on.line, 18.5, true);
    run *whole = malloc(sizeof *whole), *other = malloc(sizeof *other);

    run_init(whole, &contact, &nodes, true, 1e-2, 0);
    const size_t size = whole->solver.saved_size(whole->solver.self);
    double *saved = malloc((NUM_STEPS + 1) * size * sizeof *saved);
    for (size_t i = 0; i <= NUM_STEPS; i++) {
        if (i > 0) go_on(whole, i, i);
        whole->solver.save(saved + i * size, whole->solver.self);
    }
    for (size_t i = 0; i < NUM_STEPS; i += 3) {
        run_init(other, &contact, &nodes, true, 1e-2, 0);
        check_ok(other->solver.restore(other->solver.self, saved + i * size, &error));
        go_on(other, i + 1, NUM_STEPS);
        const size_t bytes = (NUM_STEPS - i) * sizeof(double);
        assert_memory_equal(other->film + i + 1, whole->film + i + 1, bytes);
        assert_memory_equal(other->least_film + i + 1, whole->least_film + i + 1, bytes);
        assert_memory_equal(other->exit + i + 1, whole->exit + i + 1, bytes);
        assert_memory_equal(other->effect + i + 1, whole->effect + i + 1, bytes);
        assert_memory_equal(other->by_full_model + i + 1, whole->by_full_model + i + 1,
                            (NUM_STEPS - i) * sizeof(bool));
        const time_run_share share = fallback_march_share(other->both);
        assert_int_equal(share.full_steps, count_full(whole));
        assert_non_null(strstr(share.reason, "trained range"));
        run_free(other);
    }
    saved[0] = 1; // marks a step by the full model, whose states are missing
    saved[1] = 0;
    run_init(other, &contact, &nodes, true, 1e-2, 0);
    assert_int_equal(other->solver.restore(other->solver.self, saved, &error), EHD_DATA);
    run_free(other);
    run_free(whole);
    free(saved);
    free(whole);
    free(other);
    reduced_basis_free(&nodes);
}

/* The full model computes a start outside of the training; the reduced model takes over later. */
static void a_start_by_the_full_model(void **state) {
    (void)state;
    reduced_basis nodes =
        marching_nodes(&trained_on.line, DEFORMATION_COUPLED, trained_on.bases[1].weight);
    const ehd_contact contact = marching_contact(&trained_on.line, 18.5, true);
    run *both = malloc(sizeof *both), *full = malloc(sizeof *full);

    run_init(full, &contact, &nodes, false, 0, M_PI / 2);
    go_on(full, 1, NUM_STEPS);
    run_init(both, &contact, &nodes, true, 1e-2, M_PI / 2);
    go_on(both, 1, NUM_STEPS);
    assert_true(both->by_full_model[0]);
    assert_false(both->by_full_model[NUM_STEPS]);
    check_close_array(both->film, full->film, NUM_STEPS + 1, 1e-5, 0);
    check_close(fallback_march_share(both->both).since, 0, 0, 0);
    run_free(both);
    run_free(full);
    free(both);
    free(full);
    reduced_basis_free(&nodes);
}

/* The reduced model takes over only after films that its basis cannot represent have left the
 * contact. Twelve modes represent the transient film with errors of 4 to 15 % of the central film.
 * These errors meet the first accuracy of the test, but not the second. */
static void the_film_has_to_leave_before(void **state) {
    (void)state;
    reduced_basis few;
    trained_basis(&few, &trained_on.line, DEFORMATION_COUPLED, 12, 0);
    for (size_t s = 0; s < few.states.num_states; s++)
        few.states.rate[s] = few.states.load_rate[s] = 1000;
    const ehd_contact contact = marching_contact(&trained_on.line, 18.5, true);
    run *both = malloc(sizeof *both);

    run_init(both, &contact, &few, true, 1, 0);
    go_on(both, 1, NUM_STEPS);
    assert_true(both->by_full_model[12]);
    assert_false(both->by_full_model[40]);
    run_free(both);
    run_init(both, &contact, &few, true, 0.3, 0);
    go_on(both, 1, NUM_STEPS);
    assert_true(both->by_full_model[12]);
    assert_true(both->by_full_model[40]);
    run_free(both);
    free(both);
    reduced_basis_free(&few);
}

/* If the reduced model does not converge, the full model takes over at once, with the same time
 * step. The reduced model is then tried ever more rarely. */
static void where_the_reduced_model_does_not_converge(void **state) {
    (void)state;
    reduced_basis nodes =
        marching_nodes(&trained_on.line, DEFORMATION_COUPLED, trained_on.bases[1].weight);
    const ehd_contact contact = marching_contact(&trained_on.line, 14, true);
    run *both = malloc(sizeof *both);
    size_t tries = 0;

    run_init(both, &contact, &nodes, true, 1e-2, 0);
    const march_solver parts = parts_march_solver(both->parts);
    go_on(both, 1, 3);
    for (size_t k = 0; k < both->reduced.model.rows.num_rows; k++)
        both->reduced.model.rows.weight[k] = NAN;
    for (size_t i = 4; i <= NUM_STEPS; i++) {
        // time of all attempts by the reduced model so far
        const double before = parts.seconds(parts.self).rows;
        go_on(both, i, i);
        tries += parts.seconds(parts.self).rows > before;
        assert_true(both->by_full_model[i]);
    }
    assert_false(both->by_full_model[3]);
    assert_int_equal(fallback_march_share(both->both).full_steps, NUM_STEPS - 3);
    // the reduced model is tried after 0, 1, 3, 7, … full steps in the trained range
    assert_in_range(tries, 3, 7);
    run_free(both);
    free(both);
    reduced_basis_free(&nodes);
}

/* While rejected attempts have cost more iterations than the accepted steps, the full model takes
 * the steps. The steps of the full model count as accepted steps. */
static void iterations_in_vain_are_limited(void **state) {
    (void)state;
    reduced_basis nodes =
        marching_nodes(&trained_on.line, DEFORMATION_COUPLED, trained_on.bases[1].weight);
    const ehd_contact contact = marching_contact(&trained_on.line, 18.5, true);
    run *both = malloc(sizeof *both);
    march_step step = {.status = EHD_OK};
    size_t spent = 0, returned = 14;

    run_init(both, &contact, &nodes, true, 1e-2, M_PI);
    go_on(both, 1, 10);
    assert_false(both->by_full_model[10]);
    const contact_frame frame = frame_at_step(both, 11);
    while (!step.by_full_model && spent < 1000) {
        check_ok(both->solver.attempt(&step, both->solver.self, &frame, STEP, &error));
        spent += step.iterations;
    }
    assert_in_range(spent, 10, 100); // 10 steps take one or two iterations each
    check_ok(both->solver.attempt(&step, both->solver.self, &frame, STEP, &error));
    assert_true(step.by_full_model);
    both->solver.accept(both->solver.self);
    go_on(both, 12, NUM_STEPS);
    assert_true(both->by_full_model[12] && both->by_full_model[13]);
    while (returned < NUM_STEPS && both->by_full_model[returned])
        returned++;
    assert_in_range(returned, 14, NUM_STEPS - 1);
    run_free(both);
    free(both);
    reduced_basis_free(&nodes);
}

/* Starts a march of the line contact with twelve modes, whose error estimates use the given
 * factors. */
static void begin_indicating(run *self, reduced_basis *few, double accuracy, film_factors factors) {
    trained_basis(few, &trained_on.line, DEFORMATION_COUPLED, 12, 0);
    for (size_t s = 0; s < few->states.num_states; s++)
        few->states.rate[s] = few->states.load_rate[s] = 1000;
    const ehd_contact contact = marching_contact(&trained_on.line, 18.5, true);
    run_init(self, &contact, few, true, accuracy, 0);
    reduced_march_indicate(parts_march_part(self->parts, 0), factors);
}

/* The error of a reduced step would remain in the film that the full model takes over. The full
 * model therefore takes the steps whose error estimate exceeds a tenth of the accuracy. */
static void steps_are_given_up_before_they_are_wrong(void **state) {
    (void)state;
    for (int i = 0; i < 2; i++) {
        reduced_basis few;
        run *both = malloc(sizeof *both);
        begin_indicating(both, &few, 1, (film_factors){1e-9, 1e-9, 0, i ? 0.09 : 0.11});
        go_on(both, 1, 2);
        assert_int_equal(both->by_full_model[1], !i);
        assert_int_equal(both->by_full_model[2], !i);
        run_free(both);
        free(both);
        reduced_basis_free(&few);
    }
}

/* When the reduced model takes over, the film of the full model is projected onto its modes. The
 * change of the film is part of the error estimate of the next reduced steps. */
static void what_a_return_changes_is_indicated(void **state) {
    (void)state;
    reduced_basis few;
    run *both = malloc(sizeof *both);
    size_t returned = 0;

    begin_indicating(both, &few, 1, (film_factors){1e-9, 1e-9, 0, 0});
    for (size_t i = 1; i <= NUM_STEPS && !returned; i++) {
        const contact_frame frame = frame_at_step(both, i);
        march_step step = {.status = EHD_OK};
        check_ok(both->solver.attempt(&step, both->solver.self, &frame, STEP, &error));
        both->solver.accept(both->solver.self);
        if (i == 1) assert_true(step.indicated < 1e-6);
        if (both->by_full_model[i - 1] && !step.by_full_model) {
            returned = i;
            assert_true(step.indicated > 1e-4 && step.indicated < 0.1);
        }
        both->by_full_model[i] = step.by_full_model;
    }
    assert_true(returned > 0);
    run_free(both);
    free(both);
    reduced_basis_free(&few);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(in_turn_they_are_the_full_model),
        cmocka_unit_test(with_modes_of_the_deflection_too),
        cmocka_unit_test(of_a_point_contact),
        cmocka_unit_test(saved_and_restored),
        cmocka_unit_test(a_start_by_the_full_model),
        cmocka_unit_test(the_film_has_to_leave_before),
        cmocka_unit_test(where_the_reduced_model_does_not_converge),
        cmocka_unit_test(iterations_in_vain_are_limited),
        cmocka_unit_test(steps_are_given_up_before_they_are_wrong),
        cmocka_unit_test(what_a_return_changes_is_indicated),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
