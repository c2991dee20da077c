/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/time/saved_ring.h"
#include "tests/unit/check.h"

#include <math.h>
#include <string.h>

/* A solver whose states are two numbers, and which refuses negative ones. */
typedef struct counter {
    bdf_ring ring;
    contact_frame frames[BDF_STATES];
    double states[BDF_STATES][2];
} counter;

static void save_state(double *target, contact_frame *frame, const void *self, size_t place) {
    const counter *from = self;

    *frame = from->frames[place];
    memcpy(target, from->states[place], sizeof from->states[place]);
}

static ehd_status restore_state(void *self, size_t place, const contact_frame *frame,
                                const double *source, ehd_error *error) {
    counter *to = self;

    if (!(source[0] >= 0)) return ehd_fail(error, EHD_DATA, "found %g, expected 0", source[0]);
    to->frames[place] = *frame;
    memcpy(to->states[place], source, sizeof to->states[place]);
    return EHD_OK;
}

static const saved_states states = {
    .num_states = BDF_STATES - 1, .size = 2, .save = save_state, .restore = restore_state};

static void take_step(counter *self, double time, double least) {
    const size_t place = self->ring.place[0];

    self->frames[place] = (contact_frame){.time = time,
                                          .load = 10 * time,
                                          .radius = 1,
                                          .modulus = 1,
                                          .half_width = 1,
                                          .hertz_pressure = 1,
                                          .film_scale = 1};
    self->states[place][0] = time;
    self->states[place][1] = -time;
    bdf_ring_accept(&self->ring, time, least);
}

/* Returns a solver after `count` steps; the state of time T is {T, -T}. */
static counter after_steps(int count) {
    counter self = {.ring = bdf_ring_empty()};

    for (int i = 1; i <= count; i++)
        take_step(&self, i, 0);
    return self;
}

enum { SAVED = 2 + (BDF_STATES - 1) * (NUM_FRAME + 2) };

static void states_come_back_in_their_order(void **state) {
    (void)state;
    assert_int_equal(ring_saved_size(&states), SAVED);
    for (int count = 1; count <= BDF_PREVIOUS + 2; count++) {
        counter before = after_steps(count), after = {.ring = bdf_ring_empty()};
        double saved[SAVED];
        ehd_error error;
        ring_save(saved, &before.ring, &states, &before);
        assert_int_equal(ring_restore(&after.ring, &after, saved, &states, &error), EHD_OK);
        assert_int_equal(after.ring.num_previous, before.ring.num_previous);
        for (size_t i = 1; i <= after.ring.num_previous; i++) {
            size_t place = after.ring.place[i];
            check_close(after.ring.time[place], (double)count + 1 - (double)i, 0, 0);
            check_close(after.frames[place].load, 10 * after.ring.time[place], 0, 0);
            check_close(after.states[place][1], -after.ring.time[place], 0, 0);
        }
    }
}

static void a_passing_state_comes_back(void **state) {
    (void)state;
    counter before = after_steps(5), after = after_steps(2);
    double saved[SAVED];
    ehd_error error;
    take_step(&before, 5.25, 0.5);
    assert_true(before.ring.passing);
    ring_save(saved, &before.ring, &states, &before);
    assert_int_equal(ring_restore(&after.ring, &after, saved, &states, &error), EHD_OK);
    const double times[] = {5.25, 5, 4};
    for (size_t i = 0; i < 3; i++)
        check_close(after.states[bdf_ring_accepted(&after.ring, i + 1)][0], times[i], 0, 0);
    // a ring without room for a passing state refuses it
    saved_states without = states;
    without.num_states = BDF_PREVIOUS;
    assert_int_equal(ring_restore(&after.ring, &after, saved, &without, &error), EHD_DATA);
    for (int i = 0; i < 2; i++) {
        saved[1] = i == 0 ? 0.5 : 1;
        if (i == 1) saved[0] = 2; // a passing state needs more than two others
        assert_int_equal(ring_restore(&after.ring, &after, saved, &states, &error), EHD_DATA);
        assert_int_equal(after.ring.num_previous, 0);
    }
}

static void numbers_that_are_no_states_are_refused(void **state) {
    const double counts[] = {0, -1, BDF_PREVIOUS + 1, 1.5, NAN, INFINITY};
    counter before = after_steps(BDF_PREVIOUS);
    double saved[SAVED];
    ehd_error error;
    (void)state;

    ring_save(saved, &before.ring, &states, &before);
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        counter after = after_steps(2);
        saved[0] = counts[i];
        assert_int_equal(ring_restore(&after.ring, &after, saved, &states, &error), EHD_DATA);
        assert_int_equal(after.ring.num_previous, 0);
    }
}

static void a_state_that_is_refused_leaves_none(void **state) {
    counter before = after_steps(BDF_PREVIOUS), after = after_steps(2);
    double saved[SAVED];
    ehd_error error;
    (void)state;

    ring_save(saved, &before.ring, &states, &before);
    saved[2 + NUM_FRAME + 2 + NUM_FRAME] = -1; // in the second state
    assert_int_equal(ring_restore(&after.ring, &after, saved, &states, &error), EHD_DATA);
    assert_int_equal(after.ring.num_previous, 0);
}

static void a_frame_that_is_none_is_refused(void **state) {
    counter before = after_steps(BDF_PREVIOUS), after = after_steps(2);
    double saved[SAVED];
    ehd_error error;
    (void)state;

    before.frames[before.ring.place[2]].half_width = -1;
    ring_save(saved, &before.ring, &states, &before);
    assert_int_equal(ring_restore(&after.ring, &after, saved, &states, &error), EHD_DATA);
    assert_non_null(strstr(error.text, "half width -1"));
    assert_int_equal(after.ring.num_previous, 0);
}

static void states_that_are_not_in_order_are_refused(void **state) {
    counter before = after_steps(BDF_PREVIOUS), after = after_steps(2);
    double saved[SAVED];
    ehd_error error;
    (void)state;

    before.frames[before.ring.place[2]].time = before.frames[before.ring.place[1]].time;
    ring_save(saved, &before.ring, &states, &before);
    assert_int_equal(ring_restore(&after.ring, &after, saved, &states, &error), EHD_DATA);
    assert_non_null(strstr(error.text, "expected a later one"));
    assert_int_equal(after.ring.num_previous, 0);
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
    return cmocka_run_group_tests(tests, NULL, NULL);
}
