/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loss and return of a contact. In the solver of this test, the load follows from the approach. */
#include "common/settings/scene_contact.h"
#include "common/time/apart.h"
#include "tests/unit/check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double STIFFNESS = 2, TOUCHING = 0.1, LIGHTEST = 0.005;

/* A linear spring. Beyond the touching approach its load is negative. */
typedef struct spring {
    double state, attempted; // approaches
    double speed_of_loss;    // the load is zero if bodies recede faster; 0: no limit
    bool fails;
    size_t num_starts;
} spring;

static spring inner;
static ehd_contact reference;
static apart_march contact;
static march_solver solver;
static ehd_error error;

static double load_at(double approach) {
    return LIGHTEST + STIFFNESS * (TOUCHING - approach);
}

static void solve(march_step *outcome, const contact_frame *frame, double load) {
    const contact_scalars scalars = {.load = load / frame->load,
                                     .central_film_thickness = 0.05,
                                     .minimum_film_thickness = 0.04,
                                     .rigid_approach = frame->approach / frame->film_scale};
    *outcome = (march_step){.reason = "", .frame = *frame, .scalars = scalars};
}

static ehd_status attempt(march_step *outcome, void *self, const contact_frame *frame, double step,
                          ehd_error *cause) {
    spring *of = self;
    const bool by_load = isnan(frame->approach);
    const double rate = (frame->approach - of->state) / step;
    (void)cause;
    of->attempted = frame->approach;
    solve(outcome, frame, by_load ? frame->load : load_at(frame->approach));
    if (of->speed_of_loss > 0 && rate > of->speed_of_loss) outcome->scalars.load = 0;
    if (of->fails) outcome->status = EHD_NOT_CONVERGED;
    return EHD_OK;
}

static void accept(void *self) {
    spring *of = self;
    of->state = of->attempted;
}

static void restart(void *self) {
    (void)self;
}

static ehd_status start(march_step *outcome, void *self, const contact_frame *frame,
                        ehd_error *cause) {
    spring *of = self;
    (void)cause;
    const bool by_load = isnan(frame->approach);
    solve(outcome, frame, by_load ? frame->load : load_at(frame->approach));
    of->state = frame->approach;
    of->num_starts++;
    if (of->fails) outcome->status = EHD_NOT_CONVERGED;
    return EHD_OK;
}

static ehd_status touching(double *approach, double *load, void *self, const contact_frame *frame,
                           ehd_error *cause) {
    (void)self, (void)cause;
    check_close(frame->load, 1, 0, 0);
    *approach = TOUCHING;
    *load = LIGHTEST;
    return EHD_OK;
}

static size_t saved_size(const void *self) {
    (void)self;
    return 1;
}

static void save(double *saved, const void *self) {
    const spring *of = self;
    *saved = of->state;
}

static ehd_status restore(void *self, const double *saved, ehd_error *cause) {
    spring *of = self;
    (void)cause;
    of->state = *saved;
    return EHD_OK;
}

static void set_up_contact(const char *closure, const char *history, scene *given) {
    char text[1024];
    snprintf(text, sizeof text,
             "contact: line\nregime: transient\nmoes: {M: 20, L: 5}\nclosure: %s\n"
             "lubricant: {viscosity: {law: barus, alpha: 1e-8}}\ntransient: {end_time: 8%s}\n",
             closure, history);
    if (scene_parse(given, text, strlen(text), "s.yml", NULL, 0, &error) ||
        scene_contact(&reference, given, &error))
        fail_msg("%s", error.text);
    inner = (spring){0};
    const march_solver of = {.self = &inner,
                             .attempt = attempt,
                             .accept = accept,
                             .restart = restart,
                             .start = start,
                             .touching = touching,
                             .saved_size = saved_size,
                             .save = save,
                             .restore = restore};
    apart_init(&contact, of, &reference, INFINITY);
    solver = apart_solver(&contact);
}

static contact_frame frame_of(double time, double load, double approach) {
    return frame_at(reference.kind, time, (double[]){load, 1, 1, 1}, approach);
}

static march_step step_to(double time, double load, double approach) {
    const contact_frame frame = frame_of(time, load, approach);
    march_step step;
    assert_int_equal(solver.attempt(&step, solver.self, &frame, 0.1, &error), EHD_OK);
    if (step.status != EHD_NOT_CONVERGED) solver.accept(solver.self);
    return step;
}

static march_step begin(double load, double approach) {
    const contact_frame frame = frame_of(0, load, approach);
    march_step step;
    assert_int_equal(solver.start(&step, solver.self, &frame, &error), EHD_OK);
    return step;
}

// ---- tests

typedef struct counted {
    size_t contacts;
    bool apart;
} counted;

static ehd_status count(void *sink, const march_step *step, size_t index, ehd_error *cause) {
    counted *self = sink;
    (void)index, (void)cause;
    if (self->apart && !step->apart) self->contacts++;
    self->apart = step->apart;
    return EHD_OK;
}

/* The approach is a cosine, and the bodies touch only during a fifth of each of eight periods.
 * Checks that the march finds the contact in each period. */
static void no_contact_is_missed(void **state) {
    (void)state;
    scene given;
    set_up_contact("approach",
                   ", approach: {law: sine, mean: 1, amplitude: 1.1, period: 1, phase: 1.5708}",
                   &given);
    ehd_histories *histories;
    assert_int_equal(histories_init(&histories, &given, &error), EHD_OK);
    counted sink = {0};
    march_step first;
    march run = {.settings = march_settings_of(&given, histories, 1),
                 .histories = histories,
                 .reference = &reference,
                 .store = count,
                 .sink = &sink};
    contact.longest_step = run.settings.first_step;
    run.solver = apart_solver(&contact);
    assert_int_equal(march_begin(&first, &run, &error), EHD_OK);
    assert_true(first.apart);
    sink.apart = true;
    ehd_status outcome;
    assert_int_equal(march_run(&outcome, &run, &error), EHD_OK);
    if (outcome) fail_msg("%s", run.reason);
    assert_int_equal(sink.contacts, 8);
    histories_free(histories);
}

/* If the bodies separate fast, the pressure vanishes. The solver finds the pressure again once the
 * approach is constant and close enough to carry load. */
static void a_contact_below_touching_is_found_again(void **state) {
    (void)state;
    scene given;
    set_up_contact("approach", "", &given);
    inner.speed_of_loss = 1;
    assert_false(begin(1, -0.5).apart);
    const march_step lost = step_to(0.1, 1, -0.2);
    assert_true(lost.apart);
    check_close(lost.scalars.load, 0, 0, 0);
    assert_int_equal(lost.status, EHD_UNTRUSTED); // stationary: 60 % of the load at this approach
    const march_step found = step_to(0.2, 1, -0.2);
    assert_true(found.begins && !found.apart);
    check_close(found.scalars.load * found.frame.load, load_at(-0.2), 1e-12, 0);
    assert_false(step_to(0.3, 1, -0.21).begins);
}

/* Bodies whose undeformed surfaces overlap cannot be apart for long. */
static void overlapping_bodies_touch_while_they_recede(void **state) {
    (void)state;
    scene given;
    set_up_contact("approach", "", &given);
    inner.speed_of_loss = 1;
    begin(1, -0.5);
    assert_true(step_to(0.1, 1, -0.2).apart);
    const march_step found = step_to(0.2, 1, -0.19);
    assert_true(found.begins && !found.apart);
    check_close(found.scalars.load * found.frame.load, load_at(-0.19), 1e-12, 0);
    // bodies whose undeformed surfaces do not overlap stay apart while they recede
    set_up_contact("approach", "", &given);
    inner.speed_of_loss = 1;
    begin(1, -0.5);
    assert_true(step_to(0.1, 1, 0.02).apart);
    assert_true(step_to(0.2, 1, 0.03).apart);
}

/* Bodies without surface speed also touch, but their film is unknown and not trusted. */
static void bodies_touch_at_rest(void **state) {
    (void)state;
    for (int i = 0; i < 2; i++) {
        scene given;
        set_up_contact("approach", "", &given);
        begin(1, 3);
        contact_frame frame = frame_of(0.1, 1, -0.3);
        const double path = frame.path;
        frame.speed = i;
        march_step step;
        assert_int_equal(solver.attempt(&step, solver.self, &frame, 0.1, &error), EHD_OK);
        assert_true(step.begins && !step.apart);
        check_close(step.scalars.load * step.frame.load, load_at(-0.3), 1e-12, 0);
        assert_int_equal(step.status, i == 0 ? EHD_UNTRUSTED : EHD_OK);
        assert_true(step.frame.speed == i);
        // the result is not trusted until the fluid has carried the unknown film out of the contact
        solver.accept(solver.self);
        const double width = step.frame.half_width;
        double saved[64];
        assert_true(solver.saved_size(solver.self) <= 64);
        solver.save(saved, solver.self);
        for (int k = 0; k < 3; k++) {
            frame.path = path + (k == 2 ? 1.1 : 0.9) * width;
            if (k == 1) assert_int_equal(solver.restore(solver.self, saved, &error), EHD_OK);
            assert_int_equal(solver.attempt(&step, solver.self, &frame, 0.1, &error), EHD_OK);
            solver.accept(solver.self);
            assert_int_equal(step.status, i == 0 && k < 2 ? EHD_UNTRUSTED : EHD_OK);
        }
    }
}

/* A load that is not positive separates the bodies even if they do not recede. */
static void a_load_that_is_not_positive_parts_bodies(void **state) {
    (void)state;
    scene given;
    set_up_contact("approach", "", &given);
    begin(1, -0.5);
    inner.speed_of_loss = 1e-300; // the load is lost as soon as bodies recede
    assert_false(step_to(0.1, 1, -0.5).apart);
    inner.state = -1;
    assert_true(step_to(0.2, 1, -0.5).apart);
}

static void a_step_that_fails_is_no_lost_contact(void **state) {
    (void)state;
    scene given;
    set_up_contact("approach", "", &given);
    begin(1, -0.5);
    inner.fails = true;
    assert_int_equal(step_to(0.1, 1, 0).status, EHD_NOT_CONVERGED); // below the touching approach
    assert_int_equal(step_to(0.1, 1, -0.6).status, EHD_NOT_CONVERGED); // approaching bodies
    assert_true(step_to(0.1, 1, 0.2).apart);
    set_up_contact("load", "", &given);
    begin(1, NAN);
    inner.fails = true;
    assert_int_equal(step_to(0.1, 0.5, NAN).status, EHD_NOT_CONVERGED);
    assert_int_equal(step_to(0.1, 0.009, NAN).status,
                     EHD_NOT_CONVERGED); // the lightest load is smaller than this load
    const march_step lost = step_to(0.1, 0.004, NAN);
    assert_true(lost.apart && lost.status == EHD_OK);
    assert_true(isnan(lost.scalars.central_film_thickness));
    inner.fails = false;
    assert_true(step_to(0.2, 0.004, NAN).apart);
    assert_true(step_to(0.3, 0.006, NAN).begins);
}

static void steps_in_which_bodies_part_or_touch_are_short(void **state) {
    (void)state;
    scene given;
    set_up_contact("approach", "", &given);
    begin(1, -0.5);
    contact.longest_step = 0.09; // the time steps are 0.1 long
    assert_int_equal(step_to(0.1, 1, 0.2).status, EHD_NOT_CONVERGED);
    contact.longest_step = 0.1 * (1 - 1e-12); // equals the time step but for round-off
    assert_true(step_to(0.1, 1, 0.2).apart);
    contact.longest_step = 0.09;
    assert_int_equal(step_to(0.2, 1, 0).status, EHD_NOT_CONVERGED);
    contact.longest_step = INFINITY;
    assert_true(step_to(0.2, 1, 0).begins);

    // steps to a load of 0 must also be short
    set_up_contact("load", "", &given);
    begin(1, NAN);
    contact.longest_step = 0.09;
    assert_int_equal(step_to(0.1, 0, NAN).status, EHD_NOT_CONVERGED);
    contact.longest_step = 0.1;
    assert_true(step_to(0.1, 0, NAN).apart);
}

/* The state of the solver is saved together with the state of the bodies. If a start fails, the
 * bodies stay apart. */
static void a_state_apart_is_saved(void **state) {
    (void)state;
    scene given;
    double saved[32], again[32];
    set_up_contact("approach", "", &given);
    begin(1, -0.5);
    assert_true(step_to(0.1, 1, 1).apart);
    assert_true(solver.saved_size(solver.self) <= 32);
    solver.save(saved, solver.self);
    const size_t last = solver.saved_size(solver.self) - 1;
    check_close(saved[last], -0.5, 0, 0);
    inner.fails = true;
    assert_int_equal(step_to(0.2, 1, 0).status, EHD_NOT_CONVERGED);
    assert_true(step_to(0.2, 1, 0.9).apart);
    inner.fails = false;
    check_close(inner.state, 0, 0, 0); // the failed start left this state
    assert_int_equal(solver.restore(solver.self, saved, &error), EHD_OK);
    check_close(inner.state, -0.5, 0, 0);
    solver.save(again, solver.self);
    assert_memory_equal(again, saved, (last + 1) * sizeof *saved);
    assert_true(step_to(0.2, 1, 0).begins);
    saved[0] = 2;
    assert_int_equal(solver.restore(solver.self, saved, &error), EHD_DATA);
    assert_non_null(strstr(error.text, "found approach 1 and apart = 2"));
}

/* If the bodies are far apart, no start of the contact is tried. */
static void a_start_far_apart_costs_nothing(void **state) {
    (void)state;
    scene given;
    set_up_contact("approach", "", &given);
    assert_true(begin(1, 100).apart);
    assert_int_equal(inner.num_starts, 0);
    assert_false(begin(1, 0).apart);
    assert_int_equal(inner.num_starts, 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_contact_is_missed),
        cmocka_unit_test(a_contact_below_touching_is_found_again),
        cmocka_unit_test(overlapping_bodies_touch_while_they_recede),
        cmocka_unit_test(bodies_touch_at_rest),
        cmocka_unit_test(a_load_that_is_not_positive_parts_bodies),
        cmocka_unit_test(a_step_that_fails_is_no_lost_contact),
        cmocka_unit_test(steps_in_which_bodies_part_or_touch_are_short),
        cmocka_unit_test(a_state_apart_is_saved),
        cmocka_unit_test(a_start_far_apart_costs_nothing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
