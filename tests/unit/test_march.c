/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The march through time, with a solver whose solution is known. The film y of this solver follows
 * the load: dy/dT = (load - y) / delay. This equation is discretised like a contact. */
#include "common/program/program.h"
#include "common/time/bdf.h"
#include "common/time/march.h"
#include "tests/unit/check.h"
#include "tests/unit/folder.h"
#include "tests/unit/sample.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>

enum { MOST_STEPS = 20000 };

/* The solver, the faults that a test can cause in it, and counts of its calls. */
typedef struct follower {
    double delay, first_value;
    // true: the right-hand side is the load of the history; false: it is zero, so y = exp(-T/delay)
    bool by_history;
    bdf_ring ring;
    double value[BDF_PREVIOUS + 1];
    double load_of_start;
    // faults that a test can set
    double fails_after;  // no step beyond this time converges
    size_t fails_at;     // number of the attempt that does not converge
    size_t untrusted_at; // number of the attempt that is not trusted
    // increase of the error estimate of the minimum film from attempt to attempt; 0: it stays 0
    double indicated_after;
    double noise;           // part of the local error that does not depend on the step's length
    double taken_up;        // error along the path that each step reports
    double longest_step;    // longer steps exceed the tolerance; 0: no limit
    double hardest_step;    // longer steps do not converge; 0: no limit
    ehd_status breaks_with; // if set, attempts that fail return an error with this status
    // numbers of calls
    size_t num_attempts, num_accepted, num_restarts;
    double least_step; // shortest step that was tried
    double restart_time[8];
} follower;

static double *value_before(follower *self, size_t steps) {
    return &self->value[self->ring.place[steps]];
}

static ehd_status attempt(march_step *outcome, void *solver, const contact_frame *frame,
                          double step, ehd_error *error) {
    follower *self = solver;
    bdf_formula formula = bdf_ring_formula(&self->ring, step);
    double goal = self->by_history ? frame->load : 0, sum = 0, prediction = 0;

    for (size_t i = 0; i < self->ring.num_previous; i++) {
        sum += formula.weight[i] * *value_before(self, i + 1);
        prediction += formula.predictor[i] * *value_before(self, i + 1);
    }
    double value = (goal / self->delay - sum) / (formula.rate + 1 / self->delay);
    *value_before(self, 0) = value;
    self->ring.time[self->ring.place[0]] = frame->time;
    *outcome = (march_step){.reason = "",
                            .frame = *frame,
                            .scalars = {.central_film_thickness = value, .load = 1},
                            .formula = formula,
                            .local_error = formula.error * fabs(value - prediction),
                            .iterations = 3};
    if (formula.error > 0) outcome->local_error += self->noise;
    outcome->taken_up = self->taken_up;
    outcome->indicated_minimum = self->indicated_after * (double)self->num_attempts;
    outcome->indicated = outcome->indicated_minimum / 2;
    if (self->longest_step > 0 && step > self->longest_step) outcome->local_error = 1;
    self->least_step = fmin(self->least_step, step);
    self->num_attempts++;
    if (self->num_attempts == self->untrusted_at) {
        outcome->status = EHD_UNTRUSTED;
        outcome->reason = "a strange value";
    }
    if (frame->time > self->fails_after || self->num_attempts == self->fails_at ||
        (self->hardest_step > 0 && step > self->hardest_step)) {
        if (self->breaks_with) return ehd_fail(error, self->breaks_with, "follower: broken");
        outcome->status = EHD_NOT_CONVERGED;
        outcome->reason = "no will";
        *value_before(self, 0) = NAN;
    }
    return EHD_OK;
}

static void accept(void *solver) {
    follower *self = solver;
    assert_true(isfinite(*value_before(self, 0)));
    bdf_ring_accept(&self->ring, self->ring.time[self->ring.place[0]], 0);
    self->num_accepted++;
}

static void restart(void *solver) {
    follower *self = solver;
    if (self->num_restarts < 8)
        self->restart_time[self->num_restarts] = self->ring.time[self->ring.place[1]];
    self->num_restarts++;
    bdf_ring_restart(&self->ring);
}

/* The start function of the solver. If the approach is given, a test can set the resulting load,
 * which then differs from the expected load. */
static ehd_status start(march_step *outcome, void *solver, const contact_frame *frame,
                        ehd_error *error) {
    follower *self = solver;
    (void)error;
    *outcome = (march_step){.reason = "",
                            .frame = *frame,
                            .scalars = {.central_film_thickness = self->first_value,
                                        .rigid_approach = -0.6,
                                        .load = self->load_of_start}};
    bdf_ring_keep(&self->ring, 0);
    *value_before(self, 0) = self->first_value;
    self->ring.time[self->ring.place[0]] = frame->time;
    accept(self);
    return EHD_OK;
}

// ---- a run

typedef struct run {
    follower follower;
    march march;
    ehd_histories *histories;
    size_t count;
    double time[MOST_STEPS], step[MOST_STEPS], value[MOST_STEPS], local_error[MOST_STEPS];
    contact_frame last;
    size_t stop_at;        // index of the entry that cannot be stored
    ehd_status stops_with; // status of that failure
} run;

static ehd_status store(void *sink, const march_step *step, size_t index, ehd_error *error) {
    run *self = sink;

    assert_int_equal(index, self->count);
    assert_true(self->count < MOST_STEPS);
    self->time[index] = step->frame.time;
    self->step[index] = step->step;
    self->value[index] = step->scalars.central_film_thickness;
    self->local_error[index] = step->local_error;
    self->last = step->frame;
    self->count++;
    if (index == self->stop_at && self->stops_with)
        return ehd_fail(error, self->stops_with, "sink: full");
    return EHD_OK;
}

static scene scene_of(const char *transient) {
    char text[1024];
    scene of;
    ehd_error error = {""};

    snprintf(
        text, sizeof text,
        "contact: line\nregime: transient\ntransport: upwind\nmoes: {M: 12, L: 12}\nclosure: %s\n"
        "lubricant: {viscosity: {law: barus, alpha: 1e-8}}\ntransient: {%s}\n",
        strstr(transient, "approach") ? "approach" : "load", transient);
    if (scene_parse(&of, text, strlen(text), "s.yml", NULL, 0, &error)) fail_msg("%s", error.text);
    return of;
}

static void run_begin(run *self, const char *transient) {
    scene of = scene_of(transient);
    ehd_error error = {""};
    march_step first;

    memset(self, 0, sizeof *self);
    self->follower = (follower){.delay = 1,
                                .first_value = 1,
                                .by_history = true,
                                .ring = bdf_ring_empty(),
                                .load_of_start = 1,
                                .least_step = INFINITY,
                                .fails_after = INFINITY};
    if (histories_init(&self->histories, &of, &error)) fail_msg("%s", error.text);
    static const ehd_contact line = {.kind = &contact_line, .approach_length = 1};
    self->march = (march){.settings = march_settings_of(&of, self->histories, of.approach),
                          .histories = self->histories,
                          .reference = &line,
                          .solver = {.self = &self->follower,
                                     .attempt = attempt,
                                     .accept = accept,
                                     .restart = restart,
                                     .start = start},
                          .store = store,
                          .sink = self};
    assert_int_equal(march_begin(&first, &self->march, &error), EHD_OK);
    assert_int_equal(first.status, EHD_OK);
    assert_int_equal(store(self, &first, 0, &error), EHD_OK);
}

static ehd_status run_on(run *self) {
    ehd_error error = {""};
    ehd_status outcome = EHD_INTERNAL, status = march_run(&outcome, &self->march, &error);

    if (status) fail_msg("status %d: %s", status, error.text);
    return outcome;
}

static void run_end(run *self) {
    histories_free(self->histories);
}

static double last_of(const run *self, const double *values) {
    return values[self->count - 1];
}

/* Runs without a load, so that the film decays from 1: y = exp(-T). */
static void run_decay(run *self, const char *transient) {
    run_begin(self, transient);
    self->follower.by_history = false;
    assert_int_equal(run_on(self), EHD_OK);
}

static double largest_decay_error(const run *self) {
    double largest = 0;
    for (size_t i = 0; i < self->count; i++)
        largest = fmax(largest, fabs(self->value[i] - exp(-self->time[i])));
    return largest;
}

static run first, second; // too large for the stack

// ---- accuracy

static void fixed_steps_are_of_second_order(void **state) {
    (void)state;
    static const char *const transients[] = {"end_time: 2, fixed_step: 0.02",
                                             "end_time: 2, fixed_step: 0.01",
                                             "end_time: 2, fixed_step: 0.005"};
    double error[3];
    for (int i = 0; i < 3; i++) {
        run_decay(&first, transients[i]);
        error[i] = fabs(last_of(&first, first.value) - exp(-2));
        assert_int_equal(first.count, 1 + 100 * (1 << i));
        assert_int_equal(first.follower.num_attempts, 100 * (1 << i));
        for (size_t k = 0; k < first.count; k++) // times are exact multiples
            check_close(first.time[k], (double)k * first.march.settings.fixed_step, 1e-15, 0);
        run_end(&first);
    }
    check_close(log2(error[0] / error[1]), 2, 0, 0.05);
    check_close(log2(error[1] / error[2]), 2, 0, 0.05);
}

/* The error of the result is proportional to the tolerance to the power 2/3. */
static void tolerance_controls_the_error(void **state) {
    (void)state;
    static const char *const transients[] = {"end_time: 3, tolerance: 1e-2",
                                             "end_time: 3, tolerance: 1e-4",
                                             "end_time: 3, tolerance: 1e-6"};
    double error[3];
    size_t count[3];
    for (int i = 0; i < 3; i++) {
        run_decay(&first, transients[i]);
        error[i] = largest_decay_error(&first);
        count[i] = first.count;
        assert_true(first.march.state.num_rejected < 0.02 * (double)first.count + 1);
        check_close(last_of(&first, first.time), 3, 0, 0);
        run_end(&first);
    }
    assert_true(error[0] < 1e-2 && error[1] < 1e-4 * 5 && error[2] < 1e-5 * 5);
    check_close(log10(error[0] / error[1]), 4. / 3, 0, 0.5);
    check_close(log10(error[1] / error[2]), 4. / 3, 0, 0.3);
    check_close(log10((double)count[2] / (double)count[1]), 2. / 3, 0, 0.15);
}

/* Every accepted step has a local error below the tolerance, and the largest error is close to the
 * tolerance. Some steps that are too long are tried and repeated. */
static void accepted_steps_keep_the_tolerance(void **state) {
    (void)state;
    static const char *const transients[] = {
        "end_time: 4, tolerance: 1e-3, load: {law: sine, amplitude: 0.5, period: 0.5}",
        "end_time: 40, tolerance: 1e-4, load: {law: ramp, from: 1, to: 2, start: 20, duration: "
        "0.1}"};
    for (size_t i = 0; i < 2; i++) {
        double largest = 0;
        run_begin(&first, transients[i]);
        first.follower.delay = 0.02;
        assert_int_equal(run_on(&first), EHD_OK);
        for (size_t k = 1; k < first.count; k++)
            largest = fmax(largest, first.local_error[k]);
        assert_true(largest <= first.march.settings.tolerance);
        assert_true(largest > 0.7 * first.march.settings.tolerance);
        assert_true(first.march.state.num_rejected > 5);
        run_end(&first);
    }
}

/* The last step is not a small remainder: it is at least about half as long as the step before
 * it. */
static void last_step_is_no_sliver(void **state) {
    (void)state;
    for (int i = 0; i < 20; i++) {
        char transient[64];
        snprintf(transient, sizeof transient, "end_time: %g, tolerance: 1e-3", 2 + 0.05 * i);
        run_decay(&first, transient);
        check_close(last_of(&first, first.time), 2 + 0.05 * i, 1e-15, 0);
        assert_true(first.step[first.count - 1] > 0.49 * first.step[first.count - 2]);
        run_end(&first);
    }
}

static void steps_grow_by_two_at_most(void **state) {
    (void)state;
    run_decay(&first, "end_time: 200, tolerance: 1e-3, load: {law: ramp, from: 1, to: 2, "
                      "start: 50, duration: 1}");
    double longest = 0;
    for (size_t k = 1; k < first.count; k++) {
        check_close(first.time[k] - first.time[k - 1], first.step[k], 1e-9, 0);
        assert_true(first.step[k] > 0);
        if (k > 1) assert_true(first.step[k] <= 2 * (1 + 1e-9) * first.step[k - 1]);
        longest = fmax(longest, first.step[k]);
    }
    assert_true(longest > 100 * first.step[1]); // steps are long once nothing changes any more
    assert_true(first.march.state.num_steps < 400);
    run_end(&first);
}

/* The load rises fast after a long rest. Long steps are rejected, so steps become short again. */
static void pulse_is_followed(void **state) {
    (void)state;
    run_begin(&first, "end_time: 40, tolerance: 1e-3, load: {law: ramp, from: 1, to: 2, "
                      "start: 20, duration: 0.1}");
    first.follower.delay = 0.02;
    assert_int_equal(run_on(&first), EHD_OK);
    for (size_t k = 0; k < first.count; k++) {
        double t = first.time[k] - 20, d = 0.02;
        double exact = t <= 0     ? 1
                       : t <= 0.1 ? 1 + 10 * (t - d * (1 - exp(-t / d)))
                                  : 2 - 10 * d * (1 - exp(-0.1 / d)) * exp(-(t - 0.1) / d);
        check_close(first.value[k], exact, 0, 2e-3);
    }
    assert_true(first.march.state.num_rejected > 0);
    assert_int_equal(first.follower.num_attempts,
                     first.march.state.num_steps + first.march.state.num_rejected);
    assert_int_equal(first.march.state.num_iterations, 3 * first.follower.num_attempts);
    run_end(&first);
}

// ---- events

static size_t entries_at(const run *self, double time) {
    size_t count = 0;
    for (size_t k = 0; k < self->count; k++)
        count += self->time[k] == time;
    return count;
}

static const char ramps[] = "load: {law: ramp, from: 1, to: 2, start: 0.3, duration: 0.5}, "
                            "speed: {law: ramp, from: 1, to: 0, start: 0.55, duration: 1}";

static void kinks_are_hit_exactly(void **state) {
    char adaptive[256], fixed[256];
    (void)state;
    snprintf(adaptive, sizeof adaptive, "end_time: 1.7, tolerance: 1e-3, %s", ramps);
    snprintf(fixed, sizeof fixed, "end_time: 1.7, fixed_step: 0.08, %s", ramps);
    for (int i = 0; i < 2; i++) {
        run_begin(&first, i ? fixed : adaptive);
        assert_int_equal(run_on(&first), EHD_OK);
        assert_int_equal(entries_at(&first, 0.3), 1);
        assert_int_equal(entries_at(&first, 0.3 + 0.5), 1);
        assert_int_equal(entries_at(&first, 0.55), 1);
        assert_int_equal(entries_at(&first, 1.55), 1);
        assert_int_equal(entries_at(&first, 1.7), 1);
        assert_int_equal(first.follower.num_restarts, 0);
        run_end(&first);
    }
}

/* After a kink that lies between two multiples of the fixed step, the march returns to the
 * multiples. */
static void fixed_steps_fall_back_on_multiples(void **state) {
    (void)state;
    run_begin(&first, "end_time: 1, fixed_step: 0.08, "
                      "load: {law: ramp, from: 1, to: 2, start: 0.3, duration: 5}");
    assert_int_equal(run_on(&first), EHD_OK);
    for (int k = 0; k <= 12; k++)
        assert_int_equal(entries_at(&first, k * 0.08), 1);
    assert_int_equal(entries_at(&first, 0.3), 1);
    assert_int_equal(entries_at(&first, 1), 1);
    assert_int_equal(first.count, 13 + 2);
    run_end(&first);
}

/* Runs as if `steps_before` fixed steps had been made before. */
static void run_late(run *self, double step, double steps_before, double end_time,
                     const char *history) {
    char transient[256];
    double time = steps_before * step;

    snprintf(transient, sizeof transient, "end_time: %.17g, fixed_step: %.17g, %s", end_time, step,
             history);
    run_begin(self, transient);
    self->march.state.time = time;
    self->follower.ring.time[self->follower.ring.place[1]] = time;
    assert_int_equal(run_on(self), EHD_OK);
}

/* Points in time stay multiples of the fixed step after many steps, also if a double cannot
 * represent the step exactly. */
static void fixed_steps_go_on_late_in_time(void **state) {
    static const struct {
        double step, steps_before;
    } cases[] = {{0.005, 26214404},  {0.001, 32768005}, {0.3, 3},    {0.1, 123456789},
                 {0.007, 999999937}, {0.3, 1e9},        {1e-9, 1e9}, {1. / 3, 4e11}};
    const size_t num_steps = 1000;
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double step = cases[i].step, before = cases[i].steps_before;
        run_late(&first, step, before, (before + (double)num_steps) * step,
                 "load: {law: constant}");
        assert_int_equal(first.count, 1 + num_steps);
        for (size_t k = 1; k <= num_steps; k++)
            check_close(first.time[k], (before + (double)k) * step, 0, 0);
        run_end(&first);
    }
}

/* A kink after many fixed steps adds one step. */
static void fixed_steps_fall_back_late_in_time(void **state) {
    (void)state;
    run_late(&first, 0.005, 26214404, 26214604 * 0.005,
             "load: {law: ramp, from: 1, to: 2, start: 131072.0312, duration: 1e3}");
    assert_int_equal(first.count, 1 + 200 + 1);
    assert_int_equal(entries_at(&first, 131072.0312), 1);
    for (int k = 1; k <= 200; k++)
        assert_int_equal(entries_at(&first, (26214404. + k) * 0.005), 1);
    run_end(&first);
}

/* If two points in time differ only by round-off, the march must make no step from one to the
 * other. Because of round-off 3 * 0.3 and 0.7 + 0.2 are less than 0.9, which is the end or a
 * multiple of the step. */
static void times_that_differ_by_rounding_are_one(void **state) {
    static const char *const transients[] = {
        "end_time: 0.9, fixed_step: 0.3",
        "end_time: 1.2, fixed_step: 0.3, load: {law: ramp, from: 1, to: 2, start: 0.9, duration: "
        "9}",
        "end_time: 0.9, fixed_step: 0.1, load: {law: ramp, to: 2, start: 0.7, duration: 0.2}"};
    const size_t num_steps[] = {3, 4, 9};
    (void)state;
    for (size_t i = 0; i < 3; i++) {
        run_begin(&first, transients[i]);
        assert_int_equal(run_on(&first), EHD_OK);
        assert_int_equal(first.count, 1 + num_steps[i]);
        assert_int_equal(entries_at(&first, first.march.settings.end_time), 1);
        run_end(&first);
    }
}

/* Runs with transport along the path and a linear table of the load at the times k/30, written with
 * `digits` digits. Checks that the rounding of these times causes no additional steps. */
static void run_thirtieths(int digits) {
    static const ehd_contact line = {.kind = &contact_line,
                                     .approach_length = 1,
                                     .transport = TRANSPORT_PATH,
                                     .grid = {.step = 0.01}};
    FILE *table = fopen("thirtieths.csv", "w");

    assert_non_null(table);
    fprintf(table, "T,F\n");
    for (int k = 0; k <= 31; k++)
        fprintf(table, "%.*g,%d\n", digits, k / 30., 2 + k % 2);
    fclose(table);
    run_begin(&first, "end_time: 1, fixed_step: 0.03333333333333333, load: {law: table, "
                      "file: thirtieths.csv, column: F, interpolation: linear}");
    first.march.reference = &line;
    assert_int_equal(run_on(&first), EHD_OK);
    assert_int_equal(first.count, 1 + 30);
    run_end(&first);
}

static void rounded_kinks_make_no_slivers(void **state) {
    enter_folder(state);
    run_thirtieths(17);
    run_thirtieths(9);
    leave_folder(state);
}

/* Runs with thousands of kinks from T = 0.1 on. `distance` is the time from kink to kink. In spite
 * of the short steps, the march must not report a standstill. */
static void run_many_kinks(double distance, size_t num_kinks, ehd_transport transport) {
    const ehd_contact line = {.kind = &contact_line,
                              .approach_length = 1,
                              .transport = transport,
                              .grid = {.step = 0.01}};
    FILE *table = fopen("kinks.csv", "w");

    assert_non_null(table);
    fprintf(table, "T,F\n0,1\n");
    for (size_t k = 0; k < num_kinks; k++)
        fprintf(table, "%.12g,%zu\n", 0.1 + distance * (double)k, 2 + k % 2);
    fprintf(table, "4,1\n");
    fclose(table);
    run_begin(&first, "end_time: 4, fixed_step: 0.01, load: {law: table, file: kinks.csv, column: "
                      "F, interpolation: linear}");
    first.march.reference = &line;
    assert_int_equal(run_on(&first), EHD_OK);
    assert_true(first.count > num_kinks);
    check_close(last_of(&first, first.time), 4, 0, 0);
    run_end(&first);
}

static void many_kinks_are_no_standstill(void **state) {
    enter_folder(state);
    run_many_kinks(1e-6, 4000, TRANSPORT_PATH);
    run_many_kinks(5e-5, 8000, TRANSPORT_UPWIND);
    leave_folder(state);
}

/* Kinks, multiples of the step and the end count as one point in time if they are closer together
 * than a thousandth of the step. */
static void times_closer_than_a_thousandth_of_the_step_are_one(void **state) {
    static const struct {
        double start, other; // starts of the ramps of load and speed
        size_t num_steps;
    } cases[] = {{0.30009, 0.30009, 10},   {0.29991, 0.30009, 10},     {0.30011, 9, 11},
                 {0.29989, 9, 11},         {0.35, 0.35004, 11},        {0.35, 0.3502, 12},
                 {0.99992, 0.999951, 10},  {1.0 - 1e-12, 9, 10},       {1e-12, 0.00009, 10},
                 {0.4500000001, 0.45, 11}, {0.75, 0.7499999999999, 11}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char transient[256];
        snprintf(transient, sizeof transient,
                 "end_time: 1, fixed_step: 0.1, load: {law: ramp, to: 2, start: %.17g, duration: "
                 "9}, speed: {law: ramp, to: 2, start: %.17g, duration: 9}",
                 cases[i].start, cases[i].other);
        run_begin(&first, transient);
        assert_int_equal(run_on(&first), EHD_OK);
        assert_int_equal(first.count, 1 + cases[i].num_steps);
        for (int k = 0; k <= 10; k++)
            assert_int_equal(entries_at(&first, k * 0.1), 1);
        run_end(&first);
    }
    // with error control no step is much shorter than the first
    for (int i = 0; i < 2; i++) {
        run_begin(&first, i ? "end_time: 1, tolerance: 1e-3, load: {law: ramp, to: 2, start: 0.5, "
                              "duration: 9}, speed: {law: ramp, to: 2, start: 0.500000001, "
                              "duration: 9}"
                            : "end_time: 1, tolerance: 1e-3, load: {law: ramp, to: 2, start: 1e-9, "
                              "duration: 9}, speed: {law: ramp, to: 2, start: 0.9999999999, "
                              "duration: 9}");
        assert_int_equal(run_on(&first), EHD_OK);
        for (size_t k = 1; k < first.count; k++)
            assert_true(first.step[k] > 0.1 * first.march.settings.first_step);
        check_close(last_of(&first, first.time), 1, 0, 0);
        run_end(&first);
    }
}

/* Two jumps, one just before and one just after a multiple of the step, count as one jump that
 * follows the multiple. A jump just before the end, where round-off may have put it, has no
 * effect. */
static void jumps_beside_multiples_are_one(void **state) {
    (void)state;
    run_begin(&first, "end_time: 1, fixed_step: 0.1, load: {law: step, to: 1.5, at: 0.299999999}, "
                      "speed: {law: step, to: 2, at: 0.3000000001}");
    assert_int_equal(run_on(&first), EHD_OK);
    assert_int_equal(first.follower.num_restarts, 1);
    assert_int_equal(first.count, 11);
    assert_int_equal(entries_at(&first, 3 * 0.1), 1);
    check_close(first.value[3], 1, 1e-12, 0);
    check_close(first.value[4], (1 + 0.1 * 1.5) / 1.1, 1e-12, 0); // implicit Euler
    check_close(first.last.path, 0.3 + 2 * 0.7, 1e-9, 0);
    run_end(&first);

    run_begin(&first, "end_time: 1, fixed_step: 0.1, load: {law: step, to: 1.5, at: 0.9999999}");
    assert_int_equal(run_on(&first), EHD_OK);
    assert_int_equal(first.count, 11);
    for (size_t k = 0; k < first.count; k++)
        check_close(first.value[k], 1, 1e-12, 0);
    check_close(first.last.load, 1, 0, 0);
    run_end(&first);
}

/* After a jump the solver drops its previous states, and the next step is as short as the first
 * step of the run. */
static void jump_restarts(void **state) {
    (void)state;
    run_begin(&first, "end_time: 20, tolerance: 1e-3, load: {law: step, to: 1.5, at: 10}");
    assert_int_equal(run_on(&first), EHD_OK);
    size_t k = 0;
    assert_int_equal(first.follower.num_restarts, 1);
    check_close(first.follower.restart_time[0], 10, 0, 0);
    while (first.time[k] < 10)
        k++;
    check_close(first.time[k], 10, 0, 0);
    check_close(first.value[k], 1, 1e-12, 0); // the value before the jump
    check_close(first.step[k + 1], first.march.settings.first_step, 1e-9, 0);
    for (; k < first.count; k++)
        check_close(first.value[k], 1.5 - 0.5 * exp(10 - first.time[k]), 0, 2e-3);
    run_end(&first);
}

static void jump_and_fixed_steps(void **state) {
    (void)state;
    run_begin(&first, "end_time: 1, fixed_step: 0.1, load: {law: step, to: 1.5, at: 0.25}");
    assert_int_equal(run_on(&first), EHD_OK);
    assert_int_equal(first.follower.num_restarts, 1);
    check_close(first.follower.restart_time[0], 0.25, 0, 0);
    assert_int_equal(first.count, 11 + 1);
    run_end(&first);
}

static void jump_at_the_end(void **state) {
    (void)state;
    run_begin(&first, "end_time: 1, tolerance: 1e-3, load: {law: step, to: 1.5, at: 1}");
    assert_int_equal(run_on(&first), EHD_OK);
    for (size_t k = 0; k < first.count; k++)
        check_close(first.value[k], 1, 1e-12, 0);
    run_end(&first);
}

static void jump_at_the_start(void **state) {
    (void)state;
    run_begin(&first, "end_time: 1, tolerance: 1e-3, load: {law: step, to: 1.5, at: 0}");
    assert_int_equal(run_on(&first), EHD_OK);
    for (size_t k = 0; k < first.count; k++)
        check_close(first.value[k], 1.5 - 0.5 * exp(-first.time[k]), 0, 2e-3);
    run_end(&first);
}

// ---- failing attempts

/* A step that does not converge is repeated with a shorter length, from the same states. */
static void failed_step_is_taken_again(void **state) {
    (void)state;
    run_begin(&first, "end_time: 1, fixed_step: 0.1");
    first.follower.by_history = false;
    first.follower.fails_at = 4;
    assert_int_equal(run_on(&first), EHD_OK);
    check_close(first.march.state.num_rejected, 1, 0, 0);
    check_close(first.time[4], 0.325, 1e-12, 0); // 0.3 plus a quarter of the step
    for (int k = 0; k <= 10; k++)
        assert_int_equal(entries_at(&first, k * 0.1), 1);
    assert_true(largest_decay_error(&first) < 1e-2);
    run_end(&first);
}

static void step_size_underflows(void **state) {
    static const char *const transients[] = {"end_time: 1, tolerance: 1e-3",
                                             "end_time: 1, fixed_step: 0.05"};
    (void)state;
    for (int i = 0; i < 2; i++) {
        run_begin(&first, transients[i]);
        first.follower.by_history = false;
        first.follower.fails_after = 0.52;
        assert_int_equal(run_on(&first), EHD_NOT_CONVERGED);
        assert_non_null(strstr(first.march.reason, "no will"));
        // the march ends because steps are too short or too many
        assert_true(strstr(first.march.reason, "expected above") ||
                    strstr(first.march.reason, "expected them to get further"));
        assert_null(strchr(first.march.reason, '\n'));
        assert_true(first.march.state.time <= 0.52 && first.march.state.time > 0.51);
        // the results before the failure are stored
        check_close(last_of(&first, first.time), first.march.state.time, 0, 0);
        check_close(last_of(&first, first.value), exp(-first.march.state.time), 0, 1e-2);
        run_end(&first);
    }
}

/* Steps below the round-off of the time are not tried, even if the first step was as short. */
static void step_size_ends_above_rounding(void **state) {
    (void)state;
    for (int i = 0; i < 2; i++) {
        run_begin(&first, "end_time: 2, tolerance: 1e-3, load: {law: step, to: 1.5, at: 1}");
        first.march.settings.first_step = 1e-13;
        first.march.state.step = 0.1;
        if (i == 0)
            first.follower.fails_after = 0.7; // before the jump
        else
            first.march.settings.tolerance = 1e-9; // many attempts, with ever shorter steps
        if (i == 1) first.follower.fails_after = 1;
        assert_int_equal(run_on(&first), EHD_NOT_CONVERGED);
        assert_non_null(strstr(first.march.reason, "found a step size of "));
        assert_non_null(strstr(first.march.reason, ", expected above "));
        assert_null(strstr(first.march.reason, "size of 0.0e+00"));
        for (size_t k = 1; k < first.count; k++)
            assert_true(first.step[k] > 0 && first.time[k] > first.time[k - 1]);
        assert_true(first.follower.least_step > 0);
        run_end(&first);
    }
}

/* No step can meet this tolerance, so every step is rejected because of its local error. */
static void noise_underflows(void **state) {
    (void)state;
    run_begin(&first, "end_time: 1, tolerance: 1e-3");
    first.march.settings.tolerance = 1e-30;
    first.follower.by_history = false;
    assert_int_equal(run_on(&first), EHD_NOT_CONVERGED);
    assert_non_null(strstr(first.march.reason, "local error"));
    run_end(&first);
}

/* If a shorter step does not reduce the error, the march takes this error as noise and accepts it.
 * It accepts noise of 10 tolerances, but not of 40 tolerances (PASSAGE in march.c). */
static void steps_stand_above_noise(void **state) {
    (void)state;
    run_begin(&second, "end_time: 1, tolerance: 1e-3");
    assert_int_equal(run_on(&second), EHD_OK);
    run_begin(&first, "end_time: 1, tolerance: 1e-3");
    first.follower.noise = 10 * first.march.settings.tolerance;
    assert_int_equal(run_on(&first), EHD_OK);
    assert_true(first.march.state.num_rejected > 0 &&
                first.follower.num_attempts < 20 * second.follower.num_attempts);
    run_end(&first);
    run_end(&second);

    run_begin(&first, "end_time: 1, tolerance: 1e-3");
    first.follower.noise = 40 * first.march.settings.tolerance;
    assert_int_equal(run_on(&first), EHD_NOT_CONVERGED);
    assert_non_null(strstr(first.march.reason, "local error"));
    run_end(&first);
}

/* With transport along the path, the shortest step is a quarter of the grid step. If the error is
 * too large, the march continues with steps of this length. It does not try a longer step before
 * each of them. */
static void steps_along_the_path_stay_at_the_shortest(void **state) {
    (void)state;
    static const ehd_contact line = {.kind = &contact_line,
                                     .approach_length = 1,
                                     .transport = TRANSPORT_PATH,
                                     .grid = {.step = 0.2}};

    run_begin(&first, "end_time: 3, tolerance: 1e-3");
    first.march.reference = &line;
    first.follower.noise = 40 * first.march.settings.tolerance;
    assert_int_equal(run_on(&first), EHD_OK);
    for (size_t i = 1; i < first.count; i++)
        assert_true(first.step[i] <= 0.05 / 0.9);
    assert_true(first.march.state.num_steps < 75 && first.march.state.num_rejected <= 2);
    run_end(&first);
}

/* If the errors along the path exceed eight tolerances, steps become shorter. If these errors reach
 * 32 tolerances, the local error of each step is multiplied by four. The local error is of third
 * order in the step, so the number of steps is 4^(1/3) times as large. With upwind transport the
 * errors along the path have no effect. */
static void what_films_have_taken_up_shortens_steps(void **state) {
    (void)state;
    static const double tolerances[] = {0, 7.9, 32, 32};
    double num_steps[4];
    static ehd_contact line = {.kind = &contact_line, .approach_length = 1, .grid = {.step = 1e-6}};

    for (size_t i = 0; i < 4; i++) {
        run_begin(&first,
                  "end_time: 40, tolerance: 1e-4, load: {law: sine, amplitude: 0.5, period: 1}");
        line.transport = i < 3 ? TRANSPORT_PATH : TRANSPORT_UPWIND;
        first.march.reference = &line;
        first.follower.delay = 0.02;
        first.follower.taken_up = tolerances[i] * first.march.settings.tolerance;
        assert_int_equal(run_on(&first), EHD_OK);
        num_steps[i] = (double)first.march.state.num_steps;
        for (size_t k = 1; k < first.count; k++)
            assert_true(first.local_error[k] <= first.march.settings.tolerance);
        run_end(&first);
    }
    check_close(num_steps[1], num_steps[0], 0, 0);
    check_close(num_steps[2] / num_steps[0], pow(4, 1. / 3), 0.05, 0);
    // with upwind transport the lengths of steps follow from an error of a different order
    check_close(num_steps[3], num_steps[0], 0.15, 0);
}

/* With transport along the path, the first step after a jump is as short as steps may be. The first
 * step of the run is longer. */
static void the_step_after_a_jump_along_the_path_is_short(void **state) {
    (void)state;
    static const ehd_contact line = {.kind = &contact_line,
                                     .approach_length = 1,
                                     .transport = TRANSPORT_PATH,
                                     .grid = {.step = 0.004}};
    size_t k = 0;

    run_begin(&first, "end_time: 1, tolerance: 1e-3, load: {law: step, to: 1.5, at: 0.5}");
    first.march.reference = &line;
    assert_true(first.march.settings.first_step > 0.004);
    assert_int_equal(run_on(&first), EHD_OK);
    check_close(first.step[1], first.march.settings.first_step, 1e-9, 0);
    while (first.time[k] < 0.5)
        k++;
    check_close(first.step[k + 1], 0.001, 1e-9, 0);
    run_end(&first);
}

/* A march whose accepted steps are too short to reach the end is stopped. */
static void crawling_ends(void **state) {
    (void)state;
    run_begin(&first, "end_time: 1, tolerance: 1e-3");
    first.follower.longest_step = 1e-7;
    assert_int_equal(run_on(&first), EHD_NOT_CONVERGED);
    assert_non_null(strstr(first.march.reason, "last one rejected: local error), "
                                               "expected them to get further"));
    assert_true(first.follower.num_attempts <= 200 && first.march.state.time > 0);
    run_end(&first);

    // only steps far shorter than the fixed step converge
    run_begin(&first, "end_time: 1, fixed_step: 0.01");
    first.follower.hardest_step = 1e-6;
    assert_int_equal(run_on(&first), EHD_NOT_CONVERGED);
    assert_non_null(strstr(first.march.reason, "expected them to get further"));
    assert_true(first.follower.num_attempts < MOST_STEPS && first.march.state.time > 0);
    run_end(&first);
    // if the fixed step itself is short, the march reaches the end
    run_begin(&first, "end_time: 1e-5, fixed_step: 2e-9");
    assert_int_equal(run_on(&first), EHD_OK);
    run_end(&first);
}

static void errors_end_the_march(void **state) {
    (void)state;
    ehd_error error = {""};
    ehd_status outcome;
    run_begin(&first, "end_time: 1, fixed_step: 0.1");
    first.follower.fails_at = 5;
    first.follower.breaks_with = EHD_MEMORY;
    assert_int_equal(march_run(&outcome, &first.march, &error), EHD_MEMORY);
    assert_string_equal(error.text, "follower: broken");
    assert_int_equal(first.count, 5);
    run_end(&first);

    run_begin(&first, "end_time: 1, fixed_step: 0.1");
    first.stop_at = 3;
    first.stops_with = EHD_IO;
    assert_int_equal(march_run(&outcome, &first.march, &error), EHD_IO);
    assert_string_equal(error.text, "sink: full");
    assert_int_equal(first.count, 4);
    run_end(&first);
}

static void first_untrusted_step_is_kept(void **state) {
    (void)state;
    run_begin(&first, "end_time: 1, fixed_step: 0.1");
    assert_true(isnan(first.march.state.untrusted_since) != 0);
    first.follower.untrusted_at = 3;
    assert_int_equal(run_on(&first), EHD_OK);
    check_close(first.march.state.untrusted_since, 0.3, 1e-12, 0);
    assert_string_equal(first.march.untrusted, "a strange value");
    assert_int_equal(first.count, 11);
    run_end(&first);
}

// ---- continuing

/* A march that is stopped anywhere and continued from its saved march_state gives the same bits. */
static void march_goes_on_from_its_state(void **state) {
    static const char transient[] =
        "end_time: 3, tolerance: 1e-4, load: {law: sine, amplitude: 0.2, "
        "period: 0.7}";
    (void)state;
    run_begin(&first, transient);
    assert_int_equal(run_on(&first), EHD_OK);
    for (size_t stop = 1; stop < first.count; stop += first.count / 7) {
        ehd_error error = {""};
        ehd_status outcome;
        run_begin(&second, transient);
        second.stop_at = stop;
        second.stops_with = EHD_INTERRUPTED;
        assert_int_equal(march_run(&outcome, &second.march, &error), EHD_INTERRUPTED);
        march_state kept = second.march.state;
        memset(&second.march.state, 0xff, sizeof kept);
        second.march.state = kept;
        second.stops_with = EHD_OK;
        assert_int_equal(run_on(&second), EHD_OK);
        assert_int_equal(second.count, first.count);
        assert_memory_equal(second.time, first.time, first.count * sizeof(double));
        assert_memory_equal(second.value, first.value, first.count * sizeof(double));
        run_end(&second);
    }
    run_end(&first);
}

static void signal_interrupts(void **state) {
    (void)state;
    ehd_error error = {""};
    ehd_status outcome;
    char *arguments[] = {"march", "scene", NULL};
    const program_options options = {.min_arguments = 1, .max_arguments = 1};
    program self;

    program_start(&self, 2, arguments, &options);
    run_begin(&first, "end_time: 1, fixed_step: 0.1");
    raise(SIGINT);
    assert_int_equal(march_run(&outcome, &first.march, &error), EHD_INTERRUPTED);
    assert_int_equal(first.count, 1);
    run_end(&first);
    program_finish(&self, EHD_OK, &error);
}

// ---- approach

/* With a given approach the load is a result. The approach at the start is the reference approach.
 * Frames are scaled by a predicted load. */
static void approach_scales_by_the_load(void **state) {
    (void)state;
    run_begin(&first, "end_time: 1, fixed_step: 0.1, approach: {law: ramp, from: 1, to: 2, "
                      "start: 0, duration: 1}");
    check_close(first.march.settings.reference_approach, -0.6, 0, 0);
    assert_int_equal(run_on(&first), EHD_OK);
    check_close(first.last.approach, -1.2, 1e-13, 0);
    check_close(first.last.load, 1, 1e-12, 0);
    run_end(&first);
    run_begin(&first, "end_time: 1, fixed_step: 0.1, load: {law: sine, amplitude: 0.1, period: 1}");
    assert_true(isnan(first.last.approach) != 0);
    run_end(&first);
}

static void forecast_of_the_load_is_bounded(void **state) {
    (void)state;
    const ehd_grid grid = {.step = 0.04};
    load_forecast of = {.load = 3, .scale = 2.9, .rate = 0.5};
    check_close(load_forecast_scale(&of, 0.2, &grid), 3.1, 1e-15, 0);
    of.rate = 100;
    check_close(load_forecast_scale(&of, 1, &grid), 6, 0, 0);
    of.rate = -100;
    check_close(load_forecast_scale(&of, 1, &grid), 1.5, 0, 0);
    // the rate during a last step of 1e-3 is used for a limited time only
    of = (load_forecast){.load = 3, .scale = 2.9, .rate = 1, .last_step = 1e-3};
    check_close(load_forecast_scale(&of, 1, &grid), 3 + bdf_most_growth * 1e-3, 1e-15, 0);
    // a short step leaves the scale almost as it was
    check_close(load_forecast_scale(&of, 1e-3, &grid), 2.9 + 0.4 * 0.101, 1e-14, 0);
    check_close(load_forecast_scale(&of, 1e-12, &grid), 2.9, 1e-10, 0);
}

/* A step is untrusted if the error estimate of the central or of the minimum film exceeds the
 * accuracy. */
static void indicated_deviations_are_held_against_the_accuracy(void **state) {
    (void)state;
    const double accuracy[] = {1, 0.0035, 0};

    for (size_t i = 0; i < 3; i++) {
        run_begin(&first, "end_time: 1, fixed_step: 0.1");
        first.follower.indicated_after = 1e-3;
        first.march.settings.accuracy = accuracy[i];
        assert_int_equal(run_on(&first), EHD_OK);
        if (i == 1) {
            check_close(first.march.state.untrusted_since, 0.5, 1e-12, 0);
            assert_string_equal(
                first.march.untrusted,
                "an indicated deviation of 0.004 of the minimum film, more than 0.0035");
        } else {
            assert_true(isnan(first.march.state.untrusted_since) != 0);
        }
        run_end(&first);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fixed_steps_are_of_second_order),
        cmocka_unit_test(tolerance_controls_the_error),
        cmocka_unit_test(accepted_steps_keep_the_tolerance),
        cmocka_unit_test(last_step_is_no_sliver),
        cmocka_unit_test(steps_grow_by_two_at_most),
        cmocka_unit_test(pulse_is_followed),
        cmocka_unit_test(kinks_are_hit_exactly),
        cmocka_unit_test(fixed_steps_fall_back_on_multiples),
        cmocka_unit_test(fixed_steps_go_on_late_in_time),
        cmocka_unit_test(fixed_steps_fall_back_late_in_time),
        cmocka_unit_test(times_that_differ_by_rounding_are_one),
        cmocka_unit_test(rounded_kinks_make_no_slivers),
        cmocka_unit_test(many_kinks_are_no_standstill),
        cmocka_unit_test(times_closer_than_a_thousandth_of_the_step_are_one),
        cmocka_unit_test(jumps_beside_multiples_are_one),
        cmocka_unit_test(jump_restarts),
        cmocka_unit_test(jump_and_fixed_steps),
        cmocka_unit_test(jump_at_the_end),
        cmocka_unit_test(jump_at_the_start),
        cmocka_unit_test(failed_step_is_taken_again),
        cmocka_unit_test(step_size_underflows),
        cmocka_unit_test(step_size_ends_above_rounding),
        cmocka_unit_test(noise_underflows),
        cmocka_unit_test(steps_stand_above_noise),
        cmocka_unit_test(steps_along_the_path_stay_at_the_shortest),
        cmocka_unit_test(what_films_have_taken_up_shortens_steps),
        cmocka_unit_test(the_step_after_a_jump_along_the_path_is_short),
        cmocka_unit_test(crawling_ends),
        cmocka_unit_test(errors_end_the_march),
        cmocka_unit_test(first_untrusted_step_is_kept),
        cmocka_unit_test(indicated_deviations_are_held_against_the_accuracy),
        cmocka_unit_test(march_goes_on_from_its_state),
        cmocka_unit_test(approach_scales_by_the_load),
        cmocka_unit_test(forecast_of_the_load_is_bounded),
        cmocka_unit_test(signal_interrupts), // last, because the process stays interrupted
    };
    return cmocka_run_group_tests_name("march", tests, NULL, NULL);
}
