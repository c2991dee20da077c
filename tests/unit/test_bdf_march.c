/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Saved states of a march (bdf_march.h). */
#include "common/time/bdf_march.h"
#include "tests/unit/check.h"

#include <math.h>
#include <string.h>

/* A march of a model whose states are two numbers. The model refuses a negative first number. */
typedef struct counter {
    bdf_march bdf;
    march_solver solver;
    contact_frame frames[NUM_BDF_PLACES];
    double states[NUM_BDF_PLACES][2];
    size_t num_prepared;
} counter;

static void save_state(double *target, const void *self, size_t place) {
    const counter *from = self;

    memcpy(target, from->states[place], sizeof from->states[place]);
}

static ehd_status restore_state(void *self, size_t place, const double *source, ehd_error *error) {
    counter *to = self;

    if (!(source[0] >= 0)) return ehd_fail(error, EHD_DATA, "found %g, expected 0", source[0]);
    memcpy(to->states[place], source, sizeof to->states[place]);
    return EHD_OK;
}

static void save_rest(double *front, double *behind, const void *self) {
    (void)front, (void)behind, (void)self;
}

static ehd_status restore_rest(void *self, const double *front, const double *behind,
                               ehd_error *error) {
    (void)self, (void)front, (void)behind, (void)error;
    return EHD_OK;
}

static void prepare(void *self, size_t place, double share) {
    counter *of = self;

    assert_true(share == 1);
    assert_in_range(place, 0, BDF_STATES - 1);
    of->num_prepared++;
}

static void nothing(void *self) {
    (void)self;
}

static const bdf_model passing_model = {.passes = true,
                                        .accept = nothing,
                                        .keep_errors = nothing,
                                        .prepare = prepare,
                                        .save = save_state,
                                        .restore = restore_state,
                                        .save_rest = save_rest,
                                        .restore_rest = restore_rest};

static ehd_contact reference; // transport is upwind
static arena memory;

static void take_step(counter *self, double time) {
    const size_t place = bdf_march_place(&self->bdf, 0);

    self->frames[place] = (contact_frame){.time = time,
                                          .load = 10 * time,
                                          .radius = 1,
                                          .modulus = 1,
                                          .half_width = 1,
                                          .hertz_pressure = 1,
                                          .film_scale = 1};
    self->states[place][0] = time;
    self->states[place][1] = -time;
    self->solver.accept(self->solver.self);
}

/* Creates a march that has taken `count` steps of length 1. Its state at time T is {T, -T}. */
static void after_steps(counter *self, int count) {
    *self = (counter){.bdf = {.model = &passing_model, .reference = &reference, .state_size = 2}};
    bdf_march_init(&self->bdf, 1, &memory);
    for (size_t i = 0; i < NUM_BDF_PLACES; i++)
        self->bdf.frame[i] = &self->frames[i];
    self->solver = bdf_march_solver(&self->bdf);
    for (int i = 1; i <= count; i++)
        take_step(self, i);
}

static void save(double *saved, const counter *self) {
    self->solver.save(saved, self->solver.self);
}

static ehd_status restore(counter *self, const double *saved, ehd_error *error) {
    return self->solver.restore(self->solver.self, saved, error);
}

static int free_memory(void **state) {
    (void)state;
    arena_free(&memory);
    return 0;
}

enum { SAVED = 2 + (BDF_STATES - 1) * (NUM_FRAME + 2) };

static void states_come_back_in_their_order(void **state) {
    (void)state;
    for (int count = 1; count <= BDF_PREVIOUS + 2; count++) {
        counter before, after;
        double saved[SAVED];
        ehd_error error;
        after_steps(&before, count);
        after_steps(&after, 0);
        assert_int_equal(before.solver.saved_size(before.solver.self), SAVED);
        save(saved, &before);
        assert_int_equal(restore(&after, saved, &error), EHD_OK);
        assert_int_equal(after.num_prepared, after.bdf.ring.num_previous);
        assert_int_equal(after.bdf.ring.num_previous, before.bdf.ring.num_previous);
        for (size_t i = 1; i <= after.bdf.ring.num_previous; i++) {
            size_t place = after.bdf.ring.place[i];
            check_close(after.bdf.ring.time[place], (double)count + 1 - (double)i, 0, 0);
            check_close(after.frames[place].load, 10 * after.bdf.ring.time[place], 0, 0);
            check_close(after.states[place][1], -after.bdf.ring.time[place], 0, 0);
        }
    }
}

static void a_passing_state_comes_back(void **state) {
    (void)state;
    static const bdf_model without = {.restore_rest = restore_rest};
    ehd_contact path = reference;
    counter before, after;
    double saved[SAVED];
    ehd_error error;
    after_steps(&before, 5);
    after_steps(&after, 2);
    path.transport = TRANSPORT_PATH;
    path.grid.step = 1; // half a grid step is longer than the time step of 1/4
    before.bdf.reference = &path;
    before.bdf.allows_short = true;
    take_step(&before, 5.25);
    before.bdf.reference = &reference;
    assert_true(before.bdf.ring.passing);
    save(saved, &before);
    assert_int_equal(restore(&after, saved, &error), EHD_OK);
    const double times[] = {5.25, 5, 4};
    for (size_t i = 0; i < 3; i++)
        check_close(after.states[bdf_ring_accepted(&after.bdf.ring, i + 1)][0], times[i], 0, 0);
    // a model that does not allow passing states (bdf.h) refuses a saved passing state
    after.bdf.model = &without;
    assert_int_equal(restore(&after, saved, &error), EHD_DATA);
    after.bdf.model = &passing_model;
    for (int i = 0; i < 2; i++) {
        saved[1] = i == 0 ? 0.5 : 1;
        if (i == 1) saved[0] = 2; // a passing state needs three previous states
        assert_int_equal(restore(&after, saved, &error), EHD_DATA);
        assert_int_equal(after.bdf.ring.num_previous, 0);
    }
}

static void numbers_that_are_no_states_are_refused(void **state) {
    const double counts[] = {0, -1, BDF_PREVIOUS + 1, 1.5, NAN, INFINITY};
    counter before, after;
    double saved[SAVED];
    ehd_error error;
    (void)state;

    after_steps(&before, BDF_PREVIOUS);
    save(saved, &before);
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        after_steps(&after, 2);
        saved[0] = counts[i];
        assert_int_equal(restore(&after, saved, &error), EHD_DATA);
        assert_int_equal(after.bdf.ring.num_previous, 0);
    }
}

static void a_state_that_is_refused_leaves_none(void **state) {
    counter before, after;
    double saved[SAVED];
    ehd_error error;
    (void)state;

    after_steps(&before, BDF_PREVIOUS);
    after_steps(&after, 2);
    save(saved, &before);
    saved[2 + NUM_FRAME + 2 + NUM_FRAME] = -1; // in the second state
    assert_int_equal(restore(&after, saved, &error), EHD_DATA);
    assert_int_equal(after.bdf.ring.num_previous, 0);
}

static void a_frame_that_is_none_is_refused(void **state) {
    counter before, after;
    double saved[SAVED];
    ehd_error error;
    (void)state;

    after_steps(&before, BDF_PREVIOUS);
    after_steps(&after, 2);
    before.frames[before.bdf.ring.place[2]].half_width = -1;
    save(saved, &before);
    assert_int_equal(restore(&after, saved, &error), EHD_DATA);
    assert_non_null(strstr(error.text, "half width -1"));
    assert_int_equal(after.bdf.ring.num_previous, 0);
}

static void states_that_are_not_in_order_are_refused(void **state) {
    counter before, after;
    double saved[SAVED];
    ehd_error error;
    (void)state;

    after_steps(&before, BDF_PREVIOUS);
    after_steps(&after, 2);
    before.frames[before.bdf.ring.place[2]].time = before.frames[before.bdf.ring.place[1]].time;
    save(saved, &before);
    assert_int_equal(restore(&after, saved, &error), EHD_DATA);
    assert_non_null(strstr(error.text, "expected a later one"));
    assert_int_equal(after.bdf.ring.num_previous, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(states_come_back_in_their_order),
        cmocka_unit_test(a_passing_state_comes_back),
        cmocka_unit_test(numbers_that_are_no_states_are_refused),
        cmocka_unit_test(a_state_that_is_refused_leaves_none),
        cmocka_unit_test(a_frame_that_is_none_is_refused),
        cmocka_unit_test(states_that_are_not_in_order_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, free_memory);
}
