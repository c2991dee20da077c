/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A march with two reduced models, one for light and one for heavy loads. Here both models have a
 * mode for every node and are equal, so a change of the model must not change the result. */
#include "romrun/online/parts_march.h"
#include "tests/unit/marching.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { NUM_STEPS = 64, LOW = 0, HIGH = 1 };

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

/* Returns a basis with a mode for every node. Its trained range is the range of the training, with
 * all loads multiplied by the factor `load`. */
static reduced_basis part_basis(const trained *of, deformation_kind kind, const double *weight,
                                double load) {
    reduced_basis nodes = marching_nodes(of, kind, weight);

    for (size_t s = 0; s < nodes.states.num_states; s++) {
        nodes.states.moes_M[s] *= load;
        nodes.states.alpha_p_H[s] *= sqrt(load);
        const ehd_lubricant *lubricant = &of->contacts[s].lubricant;
        nodes.states.rises[s] =
            lubricant_rises_at(lubricant, nodes.states.alpha_p_H[s] / lubricant->alpha);
    }
    return nodes;
}

/* A march with two parts, or with one part for all loads, and the results of each step. A part is a
 * reduced model for a part of the range of loads. */
typedef struct run {
    reduced_basis bases[2];
    marching parts[2];
    size_t num_parts;
    parts_march *march;
    march_solver solver;
    double film[NUM_STEPS + 1], least_film[NUM_STEPS + 1], exit[NUM_STEPS + 1];
    size_t part[NUM_STEPS + 1];
} run;

static contact_frame frame_at_step(const run *self, double i) {
    const double load = 1 + 0.15 * sin(2 * M_PI * i * STEP);
    contact_frame frame =
        frame_at(self->parts[0].reference.kind, i * STEP, (double[]){load, 1, 1, 1}, NAN);

    frame.path = frame.time;
    return frame;
}

static void keep(run *self, const march_step *step, size_t i) {
    const contact_scalars scalars =
        frame_to_reference(&step->scalars, &step->frame, &self->parts[0].reference);

    assert_string_equal(step->reason, "");
    assert_int_equal(step->status, EHD_OK);
    self->film[i] = scalars.central_film_thickness;
    self->least_film[i] = scalars.minimum_film_thickness;
    self->exit[i] = scalars.exit_position;
    self->part[i] = parts_march_attempted(self->march);
}

/* Starts a run of a contact with M = 12. The training covers M = 8 to 20. The low part covers M = 5
 * to 12.4, and the high part M = 11.2 to 28. */
static void run_init(run *self, const trained *of, deformation_kind kind, const double *weight,
                     size_t num_parts, bool path) {
    const double loads[] = {0.62, 1.4};
    ehd_contact contact = marching_contact(of, 12, path);
    reduced_march *marches[2];
    march_step first;

    memset(self, 0, sizeof *self);
    contact.approach_length = far_approach_length;
    self->parts[0].reference = contact;
    const contact_frame frame = frame_at_step(self, 0);
    for (size_t p = 0; p < num_parts; p++) {
        self->bases[p] = part_basis(of, kind, weight, num_parts > 1 ? loads[p] : 1);
        marching_start(&self->parts[p], &contact, &self->bases[p], &frame);
        marches[p] = self->parts[p].march;
        self->parts[p].march = NULL;
    }
    self->num_parts = num_parts;
    check_ok(parts_march_create(&self->march, marches, num_parts, &error));
    self->solver = parts_march_solver(self->march);
    check_ok(self->solver.start(&first, self->solver.self, &frame, &error));
    keep(self, &first, 0);
}

static void run_free(run *self) {
    parts_march_free(self->march);
    for (size_t p = 0; p < self->num_parts; p++) {
        marching_free(&self->parts[p]);
        reduced_basis_free(&self->bases[p]);
    }
}

/* Makes the steps `from` … `to`. */
static void go_on(run *self, size_t from, size_t to) {
    for (size_t i = from; i <= to; i++) {
        const contact_frame frame = frame_at_step(self, (double)i);
        march_step step = {.status = EHD_OK};
        if (i == 31) self->solver.restart(self->solver.self);
        check_ok(self->solver.attempt(&step, self->solver.self, &frame, STEP, &error));
        keep(self, &step, i);
        self->solver.accept(self->solver.self);
        assert_int_equal(parts_march_accepted(self->march), self->part[i]);
    }
}

static void check_parts(const trained *of, deformation_kind kind, const double *weight, bool path,
                        double of_film, double of_least) {
    run *both = malloc(sizeof *both), *one = malloc(sizeof *one);

    run_init(both, of, kind, weight, 2, path);
    run_init(one, of, kind, weight, 1, path);
    go_on(both, 1, NUM_STEPS);
    go_on(one, 1, NUM_STEPS);
    check_close_array(both->film, one->film, NUM_STEPS + 1, of_film, 0);
    check_close_array(both->least_film, one->least_film, NUM_STEPS + 1, of_least, 0);
    check_close_array(both->exit, one->exit, NUM_STEPS + 1, of_film, 0);
    // The start lies well inside the range of the high part, so the run starts with this part.
    // While the load is in both ranges, the run keeps the part that it has.
    assert_int_equal(both->part[0], HIGH);
    assert_int_equal(both->part[13], HIGH);
    assert_int_equal(both->part[26], HIGH); // load 0.98
    assert_int_equal(both->part[38], LOW);
    assert_int_equal(both->part[50], LOW); // load 1
    assert_int_equal(both->part[NUM_STEPS], HIGH);
    assert_int_equal(parts_march_num_handed(both->march), 2);
    assert_int_equal(parts_march_num_handed(one->march), 0);
    run_free(both);
    run_free(one);
    free(both);
    free(one);
}

// ---- tests

static void parts_of_one_model_are_that_model(void **state) {
    (void)state;
    for (int path = 0; path < 2; path++) {
        check_parts(&trained_on.line, DEFORMATION_COUPLED, trained_on.bases[1].weight, path, 1e-8,
                    1e-8);
        check_parts(&trained_on.line, DEFORMATION_INDEPENDENT, trained_on.bases[0].weight, path,
                    1e-8, 1e-8);
    }
}

/* The runs with two parts and with one part start from different trained states, so exits on outer
 * lines sometimes differ by one grid step, 1/8. After 64 time steps the central film differs by
 * 9e-4. The minimum film lies at these exits and differs by up to 1 %. */
static void of_a_point_contact(void **state) {
    (void)state;
    check_parts(&trained_on.point, DEFORMATION_COUPLED, trained_on.point_basis.weight, true, 2e-3,
                2e-2);
}

/* An attempt that is not accepted does not change the following steps, not even if another part
 * made this attempt. */
static void attempts_that_are_not_accepted(void **state) {
    (void)state;
    run *plain = malloc(sizeof *plain), *tried = malloc(sizeof *tried);

    run_init(plain, &trained_on.line, DEFORMATION_COUPLED, trained_on.bases[1].weight, 2, true);
    run_init(tried, &trained_on.line, DEFORMATION_COUPLED, trained_on.bases[1].weight, 2, true);
    for (size_t i = 1; i <= NUM_STEPS; i++) {
        const contact_frame ahead = frame_at_step(tried, (double)i + 4);
        march_step step = {.status = EHD_OK};
        for (int again = 0; again < 2; again++)
            check_ok(tried->solver.attempt(&step, tried->solver.self, &ahead, 5 * STEP, &error));
        go_on(tried, i, i);
    }
    go_on(plain, 1, NUM_STEPS);
    assert_true(parts_march_num_handed(tried->march) > parts_march_num_handed(plain->march));
    assert_memory_equal(tried->part, plain->part, sizeof plain->part);
    check_close_array(tried->film, plain->film, NUM_STEPS + 1, 1e-8, 0);
    run_free(plain);
    run_free(tried);
    free(plain);
    free(tried);
}

/* A march saved after any step and restored into another object continues with the same bits. */
static void saved_and_restored(void **state) {
    (void)state;
    run *whole = malloc(sizeof *whole), *other = malloc(sizeof *other);

    run_init(whole, &trained_on.line, DEFORMATION_COUPLED, trained_on.bases[1].weight, 2, true);
    const size_t size = whole->solver.saved_size(whole->solver.self);
    double *saved = malloc((NUM_STEPS + 1) * size * sizeof *saved);
    for (size_t i = 0; i <= NUM_STEPS; i++) {
        if (i > 0) go_on(whole, i, i);
        whole->solver.save(saved + i * size, whole->solver.self);
        assert_true(saved[i * size] == (double)whole->part[i]);
    }
    for (size_t i = 0; i < NUM_STEPS; i += 3) {
        run_init(other, &trained_on.line, DEFORMATION_COUPLED, trained_on.bases[1].weight, 2, true);
        check_ok(other->solver.restore(other->solver.self, saved + i * size, &error));
        go_on(other, i + 1, NUM_STEPS);
        const size_t left = (NUM_STEPS - i) * sizeof(double);
        assert_memory_equal(other->film + i + 1, whole->film + i + 1, left);
        assert_memory_equal(other->least_film + i + 1, whole->least_film + i + 1, left);
        assert_memory_equal(other->exit + i + 1, whole->exit + i + 1, left);
        run_free(other);
    }
    run_init(other, &trained_on.line, DEFORMATION_COUPLED, trained_on.bases[1].weight, 2, true);
    for (size_t i = 0; i < 4; i++) {
        saved[0] = ((double[]){2, -1, NAN, 0.5})[i];
        assert_int_equal(other->solver.restore(other->solver.self, saved, &error), EHD_DATA);
        assert_non_null(strstr(error.text, "expected a whole number below 2"));
    }
    run_free(other);
    run_free(whole);
    free(saved);
    free(whole);
    free(other);
}

/* Returns a frame one step after the start. If `approach` is not NaN, the approach is given and the
 * load is a prediction. */
static contact_frame frame_of(const run *self, double load, double approach) {
    contact_frame frame =
        frame_at(self->parts[0].reference.kind, STEP, (double[]){load, 1, 1, 1}, approach);

    frame.path = frame.time;
    return frame;
}

/* With a given approach the part is chosen for a predicted load. If the resulting load lies only in
 * the range of the other part, the other part makes the step. */
static void by_the_load_that_an_approach_leads_to(void **state) {
    (void)state;
    const double light = 0.9, guess = 0.95; // `light`: only the low range; `guess`: both
    run *self = malloc(sizeof *self);
    march_step step = {.status = EHD_OK};

    run_init(self, &trained_on.line, DEFORMATION_COUPLED, trained_on.bases[1].weight, 2, true);
    const march_solver *solver = &self->solver;
    contact_frame frame = frame_of(self, light, NAN);
    check_ok(solver->attempt(&step, solver->self, &frame, STEP, &error));
    double approach =
        frame_to_reference(&step.scalars, &frame, &self->parts[0].reference).rigid_approach;
    assert_int_equal(parts_march_accepted(self->march), HIGH);

    frame = frame_of(self, guess, NAN);
    check_ok(solver->attempt(&step, solver->self, &frame, STEP, &error));
    assert_int_equal(parts_march_attempted(self->march), HIGH);
    frame = frame_of(self, guess, approach);
    check_ok(solver->attempt(&step, solver->self, &frame, STEP, &error));
    assert_string_equal(step.reason, "");
    assert_int_equal(parts_march_attempted(self->march), LOW);
    check_close(step.scalars.load * guess, light, 0, 1e-3);

    // a start chooses the part in the same way
    frame = frame_of(self, light, NAN);
    check_ok(solver->start(&step, solver->self, &frame, &error));
    approach = frame_to_reference(&step.scalars, &frame, &self->parts[0].reference).rigid_approach;
    frame = frame_of(self, 1, approach);
    check_ok(solver->start(&step, solver->self, &frame, &error));
    assert_string_equal(step.reason, "");
    assert_int_equal(parts_march_accepted(self->march), LOW);
    check_close(step.frame.load, light, 0, 1e-3);
    run_free(self);
    free(self);
}

/* The modes of the next part cannot represent the last pressure exactly. This error would change
 * the whole film. The approach is therefore changed so that the mean film, weighted by the
 * pressure, stays the same. */
static void a_handed_film_is_as_thick_in_the_mean(void **state) {
    (void)state;
    const ehd_contact contact = marching_contact(&trained_on.line, 12, true);
    const size_t num_nodes = contact.grid.num_nodes;
    marching all, few;
    run at = {0};
    at.parts[0].reference = contact;
    const contact_frame frame = frame_at_step(&at, 0);
    reduced_basis nodes =
        part_basis(&trained_on.line, DEFORMATION_COUPLED, trained_on.bases[1].weight, 1);
    double sum = 0, weight = 0;
    hand_over work;

    check_ok(hand_over_init(&work, &contact.grid, &error));
    marching_start(&all, &contact, &nodes, &frame);
    marching_start(&few, &contact, &trained_on.bases[1], &frame);
    check_ok(bdf_march_take_over(reduced_march_steps(few.march), reduced_march_steps(all.march),
                                 false, &work, &error));
    const handed_state *from = &work.given, *to = &work.taken; // the last state
    for (size_t k = 0; k < num_nodes; k++) {
        const double pressure = fmax(from->pressure[k], 0);
        weight += pressure;
        sum += pressure * (to->film[k] - from->film[k]);
    }
    assert_true(fabs(to->rigid_approach - from->rigid_approach) > 1e-7);
    check_close(sum / weight, 0, 0, 1e-13);
    hand_over_free(&work);
    reduced_basis_free(&nodes);
    marching_free(&all);
    marching_free(&few);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parts_of_one_model_are_that_model),
        cmocka_unit_test(of_a_point_contact),
        cmocka_unit_test(attempts_that_are_not_accepted),
        cmocka_unit_test(saved_and_restored),
        cmocka_unit_test(by_the_load_that_an_approach_leads_to),
        cmocka_unit_test(a_handed_film_is_as_thick_in_the_mean),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
