/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Time steps of the library, for programs whose integrators use contacts as force elements. */
#include "common/time/path_filter.h"
#include "fullrun/full_march.h"
#include "podbuild/bases.h"
#include "romrun/online/online.h"
#include "tests/unit/allocation.h"
#include "tests/unit/check.h"
#include "tests/unit/folder.h"
#include "tests/unit/foreign.h"
#include "tests/unit/random.h"
#include "tests/unit/reduced_problem.h"

#include <math.h>
#include <pthread.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A contact whose load varies by 10 %. The step is a power of two, so that all points in time are
 * exact. */
static const char scene_of_training[] =
    "contact: line\nregime: transient\nmoes: {M: 12, L: 4}\n"
    "lubricant: {viscosity: {law: barus, alpha: 2e-8}, density: {law: dowson-higginson}}\n"
    "transient: {end_time: 2, fixed_step: 0.015625, load: {law: sine, amplitude: 0.1, period: "
    "1}}\n";
static const double STEP = 0.015625;
// with transport along the path the first steps are shorter, so there are a few more states
enum { NUM_STEPS = 128, MOST_STATES = NUM_STEPS + 8 };

static size_t num_modes; // number of pressure modes and of deformation modes
static scene given;
static ehd_contact reference;
static ehd_histories *histories;
static online_model *models[2];                               // coupled, independent
static double full_exit[MOST_STATES], full_time[MOST_STATES]; // from the training
static size_t num_states;
static ehd_error error;

#define check_ok(call) assert_string_equal(((call) == EHD_OK) ? "" : error.text, "")

// ---- the model: trained on one trajectory

typedef struct training {
    full_march *march;
    solved_state states[MOST_STATES];
    frame_rates rates[MOST_STATES];
    double *pressure; // [MOST_STATES, num_nodes]
    contact_frame last;
} training;

static ehd_status keep_step(void *sink, const march_step *step, size_t index, ehd_error *ignored) {
    training *self = sink;
    const full_state *state = full_march_state(self->march, NULL);
    const size_t num_nodes = reference.grid.num_nodes;
    double *pressure = self->pressure + index * num_nodes;
    ehd_contact contact;
    (void)ignored;

    frame_contact(&contact, &step->frame, &reference);
    memcpy(pressure, state->pressure, num_nodes * sizeof *pressure);
    self->states[index] =
        (solved_state){.pressure = pressure,
                       .rigid_approach = state->rigid_approach,
                       .moes_M = contact.moes_M,
                       .alpha_p_H = contact.alpha_p_H,
                       .central_film_thickness = step->scalars.central_film_thickness,
                       .rises = lubricant_rises_at(&contact.lubricant, contact.hertz_pressure)};
    if (index) self->rates[index] = frame_rates_between(&step->frame, &self->last);
    full_time[index] = step->frame.time;
    full_exit[index] = frame_to_reference(&step->scalars, &step->frame, &reference).exit_position;
    num_states = index + 1;
    self->last = step->frame;
    return EHD_OK;
}

static void training_init(training *self) {
    const full_settings settings = full_default_settings();

    memset(self, 0, sizeof *self);
    self->pressure = calloc(MOST_STATES * reference.grid.num_nodes, sizeof(double));
    check_ok(full_march_create(&self->march, &reference, &settings, NAN, &error));
}

/* Gathers the states of all steps. Only the first state is stationary. */
static void training_gather(snapshot_set *set, const training *self) {
    check_ok(snapshot_set_gather(set, self->states, num_states, reference.kind, &reference.grid,
                                 &error));
    reduced_states *states = &set->sources->states;
    set->carriage = path_carriage(&reference);
    for (size_t s = 0; s < num_states; s++) {
        states->stationary[s] = s == 0;
        states->rate[s] = self->rates[s].all;
        states->load_rate[s] = self->rates[s].load;
    }
}

static void training_run(training *self) {
    march run = {.histories = histories,
                 .settings = march_settings_of(&given, histories, NAN),
                 .reference = &reference,
                 .solver = full_march_solver(self->march),
                 .store = keep_step,
                 .sink = self};
    march_step first;
    ehd_status outcome;

    check_ok(march_begin(&first, &run, &error));
    check_ok(keep_step(self, &first, 0, &error));
    check_ok(march_run(&outcome, &run, &error));
    assert_int_equal(outcome, EHD_OK);
    assert_in_range((size_t)run.state.num_steps, NUM_STEPS, MOST_STATES - 1);
}

/* Writes a model with all rows, and opens it. */
static online_model *make_model(snapshot_set *set, deformation_kind kind, const char *path) {
    const bases_settings settings = {
        .pressure.num_modes = num_modes, .deformation.num_modes = num_modes, .kind = kind};
    reduced_basis basis;
    pod_basis pressure, deformation;
    online_model *opened;

    check_ok(bases_build(&basis, &pressure, &deformation, set, &settings, NULL, NULL, &error));
    whole_model_write(&basis, path);
    check_ok(online_open(&opened, path, NULL, &error));
    reduced_basis_free(&basis);
    pod_free(&pressure);
    pod_free(&deformation);
    return opened;
}

/* Trains both models with the setting `transport`, on a grid with the given step. */
static int set_up(void **state, const char *transport, double step, size_t modes) {
    training self;
    snapshot_set set;
    char path[128], text[1024];

    if (make_folder(state)) return -1;
    num_modes = modes;
    snprintf(path, sizeof path, "%s/model.h5", folder);
    snprintf(text, sizeof text, "%stransport: %s\ngrid: {x_min: -4, x_max: 2, step: %g}\n",
             scene_of_training, transport, step);
    check_ok(scene_parse(&given, text, strlen(text), "scene", NULL, 0, &error));
    given.approach_length = 10;
    check_ok(scene_contact(&reference, &given, &error));
    check_ok(histories_init(&histories, &given, &error));
    training_init(&self);
    training_run(&self);
    training_gather(&set, &self);
    models[0] = make_model(&set, DEFORMATION_COUPLED, path);
    check_ok(online_prepare_transient(models[0], &error)); // before the file is replaced
    models[1] = make_model(&set, DEFORMATION_INDEPENDENT, path);
    check_ok(online_prepare_transient(models[1], &error));
    full_march_free(self.march);
    snapshot_set_close(&set);
    free(self.pressure);
    return 0;
}

static int set_up_path(void **state) {
    return set_up(state, "path", 0.015625, 70);
}

static int set_up_upwind(void **state) {
    return set_up(state, "upwind", 0.05, 40);
}

static int tear_down(void **state) {
    online_close(models[0]);
    online_close(models[1]);
    histories_free(histories);
    return remove_folder(state);
}

// ---- helpers

static online_transient *create(const online_model *model) {
    online_transient *contact;

    check_ok(online_transient_create(&contact, model, &reference, &error));
    online_transient_allow_short_steps(contact);
    return contact;
}

/* Returns the conditions of the training at a time, with a given load. */
static online_conditions conditions_at(double time) {
    double values[NUM_VARY];

    histories_at(values, histories, time);
    return (online_conditions){.load = values[VARY_LOAD],
                               .approach = NAN,
                               .speed = values[VARY_SPEED],
                               .radius = values[VARY_RADIUS],
                               .modulus = values[VARY_MODULUS]};
}

static online_state start(online_transient *contact) {
    const online_conditions conditions = conditions_at(0);
    online_state state;

    check_ok(online_transient_start(&state, contact, &conditions, &error));
    assert_string_equal(state.reason, "");
    assert_int_equal(state.status, EHD_OK);
    return state;
}

/* Makes a step along the history without accepting it. */
static online_state step_from(online_transient *contact, double time, double step) {
    const online_conditions conditions = conditions_at(time + step);
    online_state state;

    check_ok(online_step(&state, contact, &conditions, step, &error));
    return state;
}

/* Makes accepted steps along the history; states[i] is the result of step first + i. */
static void go(online_state *states, online_transient *contact, size_t first, size_t count) {
    for (size_t i = 0; i < count; i++) {
        states[i] = step_from(contact, (double)(first + i) * STEP, STEP);
        assert_string_equal(states[i].reason, "");
        assert_int_equal(states[i].status, EHD_OK);
        online_accept(contact);
    }
}

static void check_same(const online_state *found, const online_state *expected) {
    const double numbers[2][10] = {
        {found->time, found->scalars.central_film_thickness, found->scalars.minimum_film_thickness,
         found->scalars.central_pressure, found->scalars.rigid_approach,
         found->scalars.exit_position, found->scalars.load, found->half_width, found->local_error,
         found->residual},
        {expected->time, expected->scalars.central_film_thickness,
         expected->scalars.minimum_film_thickness, expected->scalars.central_pressure,
         expected->scalars.rigid_approach, expected->scalars.exit_position, expected->scalars.load,
         expected->half_width, expected->local_error, expected->residual}};

    check_close_array(numbers[0], numbers[1], 10, 0, 0);
    assert_int_equal(found->status, expected->status);
    assert_string_equal(found->reason, expected->reason);
    assert_int_equal(found->iterations, expected->iterations);
}

static void check_all_same(const online_state *found, const online_state *expected, size_t count) {
    for (size_t i = 0; i < count; i++)
        check_same(&found[i], &expected[i]);
}

static bool is_path(void) {
    return reference.transport == TRANSPORT_PATH;
}

#define for_both_models for (size_t m = 0; m < 2; m++)

// ---- steps

/* In every step the exit lies between two nodes, at the exit of the full model. If exits could only
 * lie at nodes, they would jump and be wrong by up to one grid step. */
static void the_exit_moves_as_in_the_full_model(void **unused) {
    (void)unused;
    const double near = is_path() ? 0.1 : 0.03; // in grid steps
    for_both_models {
        online_transient *contact = create(models[m]);
        online_state state = start(contact);
        check_close(state.scalars.exit_position, full_exit[0], 0, 0.01 * reference.grid.step);
        for (size_t i = 1; i < num_states; i++) {
            state = step_from(contact, full_time[i - 1], full_time[i] - full_time[i - 1]);
            online_accept(contact);
            check_close(state.scalars.exit_position, full_exit[i], 0, near * reference.grid.step);
        }
        online_transient_free(contact);
    }
}

static void a_constant_contact_stays(void **unused) {
    (void)unused;
    for_both_models {
        online_transient *contact = create(models[m]);
        const online_conditions conditions = conditions_at(0);
        online_state first = start(contact), state = first;
        check_close(first.time, 0, 0, 0);
        check_close(first.scalars.load, 1, 1e-6, 0);
        for (int i = 1; i <= 20; i++) {
            check_ok(online_step(&state, contact, &conditions, 0.25, &error));
            assert_string_equal(state.reason, "");
            online_accept(contact);
            check_close(state.time, 0.25 * i, 0, 0);
        }
        check_close(state.scalars.central_film_thickness, first.scalars.central_film_thickness,
                    1e-6, 0);
        check_close(state.scalars.rigid_approach, first.scalars.rigid_approach, 1e-6, 0);
        online_transient_free(contact);
    }
}

static void a_step_can_be_repeated(void **unused) {
    (void)unused;
    const size_t before = 10, count = 20; // after 10 steps a Jacobian of an earlier step is in use
    for_both_models {
        online_transient *straight = create(models[m]), *repeating = create(models[m]);
        online_state expected[20], first, again;
        start(straight);
        start(repeating);
        go(expected, straight, 0, before);
        go(expected, repeating, 0, before);
        go(expected, straight, before, count);
        for (size_t i = 0; i < count; i++) {
            double time = (double)(before + i) * STEP;
            first = step_from(repeating, time, STEP);
            again = step_from(repeating, time, STEP);
            check_same(&first, &expected[i]);
            check_same(&again, &expected[i]);
            step_from(repeating, time, 3 * STEP); // rejected
            again = step_from(repeating, time, STEP);
            check_same(&again, &expected[i]);
            online_accept(repeating);
        }
        online_transient_free(straight);
        online_transient_free(repeating);
    }
}

// ---- steps of any lengths

/* Returns the conditions of the training, with its sinusoidal load. With `by_approach` the approach
 * is given instead, and varies about as much as under this load. */
static online_conditions conditions_of(double time, bool by_approach, double approach) {
    online_conditions conditions = conditions_at(time);

    if (!by_approach) return conditions;
    conditions.approach = approach - 0.1 * (conditions.load - 1);
    conditions.load = NAN;
    return conditions;
}

typedef struct any_steps {
    online_transient *contact;
    bool by_approach;
    double approach, time;
    double *saved;
    size_t num_rejected, num_parts;    // totals over all steps
    double most_central, most_minimum; // largest differences from the films of small steps
} any_steps;

static online_state any_step(any_steps *self, double time, double step) {
    const online_conditions at = conditions_of(time + step, self->by_approach, self->approach);
    online_state state;

    check_ok(online_step(&state, self->contact, &at, step, &error));
    return state;
}

/* Makes small equal steps from the saved state, and then restores the saved state. *state is the
 * result of the last small step. Returns false if a step does not converge, as one of 300,000 steps
 * of length 1e-9 did. */
static bool goes_in_small_steps(any_steps *self, online_state *state, double step, size_t parts) {
    const double part = step / (double)parts;
    bool converged = true;

    for (size_t i = 0; i < parts && converged; i++) {
        *state = any_step(self, self->time + (double)i * part, part);
        converged = state->status != EHD_NOT_CONVERGED;
        if (converged) online_accept(self->contact);
    }
    check_ok(online_restore(self->contact, self->saved, &error));
    return converged;
}

/* Differences of the films, relative to the central film. */
typedef struct differences {
    double central, minimum;
} differences;

static differences differences_of(const online_state *found, const online_state *expected) {
    const contact_scalars *a = &found->scalars, *b = &expected->scalars;
    const double central = b->central_film_thickness;

    return (differences){fabs(a->central_film_thickness - central) / central,
                         fabs(a->minimum_film_thickness - b->minimum_film_thickness) / central};
}

static double off(const online_state *found, const online_state *expected) {
    const differences of = differences_of(found, expected);

    return fmax(of.central, of.minimum);
}

/* Makes a step of random length, 1e-9 to 1 times the period of the load. Tries shorter steps until
 * the local error is below the tolerance, like an integrator. Compares the result with the result
 * of small steps over the same time. */
static void take_any_step(any_steps *self, uint64_t *seed, double tolerance) {
    const double shortest = 1e-9, most_parts = 16;
    double step = pow(shortest, random_next(seed));

    online_save(self->saved, self->contact);
    for (;;) {
        const online_state state = any_step(self, self->time, step);
        if (state.status != EHD_NOT_CONVERGED && state.local_error <= tolerance) {
            size_t parts = (size_t)fmax(fmin(floor(step / shortest), most_parts), 1);
            online_state expected = {0};
            while (!goes_in_small_steps(self, &expected, step, parts))
                parts--;
            self->num_parts += parts;
            const online_state again = any_step(self, self->time, step);
            check_same(&again, &state);
            const differences of = differences_of(&state, &expected);
            self->most_central = fmax(self->most_central, of.central);
            self->most_minimum = fmax(self->most_minimum, of.minimum);
            // the tolerance is meant for the central film; in 50,000 steps with transport along the
            // path the largest error of the minimum film was 5.0e-3
            if (of.central > tolerance || of.minimum > (is_path() ? 6 : 1) * tolerance)
                fail_msg(
                    "T = %g: found a step of %g off by %.3g and %.3g with a local error of %.3g",
                    self->time, step, of.central, of.minimum, state.local_error);
            online_accept(self->contact);
            self->time = state.time;
            return;
        }
        self->num_rejected++;
        if (step == shortest)
            fail_msg("T = %g: found a step of %g rejected (%s, local error %.3g)", self->time, step,
                     state.reason, state.local_error);
        step = fmax((0.1 + 0.8 * random_next(seed)) * step, shortest);
    }
}

/* Steps of random lengths have nearly the same results as several small steps. Some steps are
 * rejected and repeated. The environment variable ANY_STEPS sets the number of steps. */
static void steps_may_have_any_lengths(void **unused) {
    (void)unused;
    const char *asked = getenv("ANY_STEPS");
    const size_t count = asked ? strtoul(asked, NULL, 10) : check_all() ? 200 : 60;
    const double tolerance = 1e-3;

    for (int by_approach = 0; by_approach < 2; by_approach++) {
        any_steps self = {.contact = create(models[0]), .by_approach = by_approach};
        uint64_t seed = 1;
        const online_state first = start(self.contact);
        self.approach = first.scalars.rigid_approach;
        self.saved = malloc(online_saved_size(self.contact) * sizeof(double));
        assert_non_null(self.saved);
        for (size_t i = 0; i < count; i++)
            take_any_step(&self, &seed, tolerance);
        print_message(
            "%zu steps to T = %.3g, %zu rejected, central film at most %.2g, minimum film "
            "%.2g off %zu small ones\n",
            count, self.time, self.num_rejected, self.most_central, self.most_minimum,
            self.num_parts);
        assert_true(self.num_parts > 10 * count);
        free(self.saved);
        online_transient_free(self.contact);
    }
}

/* An integrator that locates an event may take a step of 1e-7. The next step has the same result
 * with and without this short step. */
static void a_short_step_leaves_the_next_one_as_it_is(void **unused) {
    (void)unused;
    // right after the start the state after a very short step is not skipped (bdf_ring_accept), and
    // the least squares leave a larger error
    const double near = is_path() ? 1e-4 : 1e-6;
    for_both_models {
        online_state states[10];
        online_transient *contact = create(models[m]);
        start(contact);
        const online_state at_rest = step_from(contact, 0, STEP);
        for (int i = 0; i < 2; i++) {
            step_from(contact, (double)i * 1e-9, 1e-9);
            online_accept(contact);
        }
        const online_state behind = step_from(contact, 2e-9, STEP);
        assert_int_not_equal(behind.status, EHD_NOT_CONVERGED);
        assert_true(off(&behind, &at_rest) < near);
        start(contact);
        go(states, contact, 0, 10);
        const online_state without = step_from(contact, 10 * STEP, STEP);
        step_from(contact, 10 * STEP, 1e-7);
        online_accept(contact);
        const online_state with = step_from(contact, 10 * STEP + 1e-7, STEP);
        assert_int_not_equal(with.status, EHD_NOT_CONVERGED);
        assert_true(off(&with, &without) < 1e-6);
        online_transient_free(contact);
    }
}

// ---- a contact that is lost and regained

static online_state at_approach(online_transient *contact, double approach, double step) {
    const online_conditions at = {
        .load = NAN, .approach = approach, .speed = 1, .radius = 1, .modulus = 1};
    online_state state;

    if (step > 0)
        check_ok(online_step(&state, contact, &at, step, &error));
    else
        check_ok(online_transient_start(&state, contact, &at, &error));
    return state;
}

/* The bodies start apart, touch and part again, four times. A repeated step gives the same result,
 * also from a saved state in another object. */
static void a_contact_is_lost_and_regained(void **unused) {
    (void)unused;
    const double step = 0.02, stroke = 1, middle = -0.6;
    for_both_models {
        online_transient *contact = create(models[m]), *other = create(models[m]);
        const online_state near = at_approach(contact, 0.02, 0);
        online_state state = at_approach(contact, middle + 5, 0);
        double *saved = malloc(online_saved_size(contact) * sizeof(double));
        size_t num_lost = 0, num_found = 0;
        assert_non_null(saved);
        check_close(near.scalars.load, 0, 0, 0);
        assert_int_equal(near.status, EHD_UNTRUSTED);
        check_close(state.scalars.load, 0, 0, 0);
        assert_int_equal(state.status, EHD_OK);
        check_close(state.scalars.central_film_thickness, middle + 5, 1e-14, 0);
        double before = 0;
        for (int i = 0; i <= 200; i++) {
            const double approach = middle + stroke * cos(2 * M_PI * i / 50);
            state = at_approach(contact, approach, step);
            assert_int_not_equal(state.status, EHD_NOT_CONVERGED);
            assert_true(state.scalars.load >= 0);
            assert_true(state.scalars.load > 0 ? online_transient_peak(contact) > 0
                                               : online_transient_peak(contact) == 0);
            const online_state again = at_approach(contact, approach, step);
            check_same(&again, &state);
            num_found += i > 0 && before == 0 && state.scalars.load > 0;
            num_lost += i > 0 && before > 0 && state.scalars.load == 0;
            online_save(saved, contact);
            check_ok(online_restore(other, saved, &error));
            const online_state elsewhere = at_approach(other, approach, step);
            check_same(&elsewhere, &state);
            online_accept(contact);
            before = state.scalars.load;
        }
        assert_int_equal(num_found, 4);
        assert_int_equal(num_lost, 4);
        free(saved);
        online_transient_free(contact);
        online_transient_free(other);
    }
}

/* If bodies that are apart reach a given approach in one step, the result has the load that belongs
 * to this approach. In this step the solver first solves the lightest contact of the training,
 * which may itself be untrusted. At the speed zero the load is the same, but the result is
 * untrusted. */
static void bodies_touch_at_the_approach_that_is_given(void **unused) {
    (void)unused;
    for_both_models {
        online_transient *contact = create(models[m]);
        for (double load = 0.92; load < 1.1; load += 0.04)
            for (double speed = 0; speed <= 1; speed++) {
                online_conditions at = {
                    .load = load, .approach = NAN, .speed = 1, .radius = 1, .modulus = 1};
                online_state state;
                check_ok(online_transient_start(&state, contact, &at, &error));
                const double approach = state.scalars.rigid_approach;
                at_approach(contact, 4, 0);
                at = (online_conditions){
                    .load = NAN, .approach = approach, .speed = speed, .radius = 1, .modulus = 1};
                check_ok(online_step(&state, contact, &at, STEP, &error));
                check_close(state.scalars.load, load, 1e-3, 0);
                check_close(state.scalars.rigid_approach, approach, 1e-6, 0);
                assert_int_equal(state.status, speed == 0 ? EHD_UNTRUSTED : EHD_OK);
                online_accept(contact);
                const double path = online_attempt_frame(contact).path;
                at.approach -= 1e-3;
                check_ok(online_step(&state, contact, &at, STEP, &error));
                assert_int_not_equal(state.status, EHD_NOT_CONVERGED);
                if (speed == 0) assert_int_equal(state.status, EHD_UNTRUSTED);
                assert_true(state.scalars.load > 0.9 * load);
                check_close(online_attempt_frame(contact).path - path, speed * STEP, 1e-12, 1e-15);
            }
        online_transient_free(contact);
    }
}

/* Without a load the bodies are apart, and their gap is unknown. Under a load they touch again. */
static void without_a_load_there_is_no_contact(void **unused) {
    (void)unused;
    for_both_models {
        online_transient *contact = create(models[m]);
        online_state states[2];
        start(contact);
        for (int i = 0; i < 2; i++) {
            const double load = i == 0 ? 0 : 1;
            const online_conditions at = {load, NAN, 1, 1, 1};
            check_ok(online_step(&states[i], contact, &at, STEP, &error));
            assert_int_equal(states[i].status, EHD_OK);
            check_close(states[i].scalars.load, load, 1e-9, 1e-12);
            online_accept(contact);
        }
        assert_true(isnan(states[0].scalars.central_film_thickness));
        const online_state anew = start(contact);
        check_close(states[1].scalars.central_film_thickness, anew.scalars.central_film_thickness,
                    1e-12, 0);
        online_transient_free(contact);
    }
}

/* A mass that falls on the contact and is thrown back. It is about as large as the mass in
 * scenes/examples/oscillator. Units: the unit of T for times, the unit of H0 for lengths, and the
 * reference load for forces. */
typedef struct bouncing {
    online_transient *contact;
    double position, velocity, force;
} bouncing;

static const double BOUNCING_MASS = 0.0138, BOUNCING_WEIGHT = 0.3;

/* Makes a step of the trapezoidal rule without accepting it. The secant method finds the position
 * at which the equation of motion holds with the contact's force. */
static bool find_position(online_state *state, const bouncing *self, double step) {
    const double half = step * step / (4 * BOUNCING_MASS), near = 1e-10;
    const double drift =
        self->position + step * self->velocity + half * (self->force - 2 * BOUNCING_WEIGHT);
    double position = drift + half * self->force, correction = 0, defect = 0, slope = 1;

    for (int trial = 0; trial < 30; trial++) {
        const double before = defect;
        *state = at_approach(self->contact, position, step);
        if (state->status == EHD_NOT_CONVERGED) return false;
        defect = position - drift - half * state->scalars.load;
        if (fabs(defect) < near) {
            state->scalars.rigid_approach = position; // least squares leave an error of 1e-9
            return true;
        }
        if (trial > 0) slope = (before - defect) / correction;
        if (!(fabs(slope) > 0.05)) slope = 1; // the force jumps between the positions
        correction = defect / slope;
        position -= correction;
    }
    return false;
}

/* Makes a step of 0.01, halved until it converges; returns the impulse. */
static double bounce_on(bouncing *self) {
    double step = 0.01;
    online_state state;

    while (!find_position(&state, self, step)) {
        step /= 2;
        assert_true(step > 1e-6);
    }
    assert_true(state.scalars.load >= 0);
    const double impulse = step * ((self->force + state.scalars.load) / 2 - BOUNCING_WEIGHT);
    online_accept(self->contact);
    self->velocity = 2 * (state.scalars.rigid_approach - self->position) / step - self->velocity;
    self->position = state.scalars.rigid_approach;
    self->force = state.scalars.load;
    return impulse;
}

/* From the start of each fall to the loss of the contact, the momentum changes by the impulse of
 * the reported force and of the weight. The momentum follows from positions of the mass. The
 * environment variable BOUNCES sets the number of falls. */
static void a_bouncing_mass_gets_the_impulse_of_the_force(void **unused) {
    (void)unused;
    const char *asked = getenv("BOUNCES");
    const size_t count = asked ? strtoul(asked, NULL, 10) : 10;
    bouncing self = {.contact = create(models[0])};
    uint64_t seed = 1;
    double worst = 0, largest = 0;

    for (size_t i = 0; i < count; i++) {
        double impulse = 0, sum = 0;
        self.position =
            0.05 + 0.15 * random_next(&seed); // closer bodies could touch under a light load
        self.velocity = self.force = 0;
        check_close(at_approach(self.contact, self.position, 0).scalars.load, 0, 0, 0);
        for (bool was = false; self.force > 0 || !was; was = was || self.force > 0) {
            impulse += bounce_on(&self);
            largest = fmax(largest, self.force);
            sum += 1;
            assert_true(sum < 10000);
        }
        const double momentum = BOUNCING_MASS * self.velocity;
        assert_true(self.velocity > 0);
        worst = fmax(worst, fabs(momentum - impulse) / momentum);
    }
    print_message("%zu bounces, forces to %.3g, momentum and impulse %.2g apart at most\n", count,
                  largest, worst);
    assert_true(worst < 1e-6);
    online_transient_free(self.contact);
}

// ---- derivatives

static const double CHANGE = 3e-4;
enum { BY_GIVEN, BY_SPEED, BY_RADIUS, BY_MODULUS, NUM_BY };

static online_conditions changed(online_conditions at, int by, double change) {
    if (by == BY_GIVEN && isnan(at.approach)) at.load += change;
    if (by == BY_GIVEN && !isnan(at.approach)) at.approach += change;
    if (by == BY_SPEED) at.speed += change;
    if (by == BY_RADIUS) at.radius += change;
    if (by == BY_MODULUS) at.modulus += change;
    return at;
}

/* Repeats a step with a changed condition and returns the central differences. */
static contact_scalars difference(online_transient *contact, online_conditions at, int by) {
    online_state sides[2];
    contact_scalars found = {.load = 0};

    for (int i = 0; i < 2; i++) {
        const online_conditions beside = changed(at, by, i ? CHANGE : -CHANGE);
        check_ok(online_step(&sides[i], contact, &beside, STEP, &error));
        assert_int_not_equal(sides[i].status, EHD_NOT_CONVERGED);
    }
    const double *before = (const double *)&sides[0].scalars;
    const double *behind = (const double *)&sides[1].scalars;
    for (size_t k = 0; k < sizeof found / sizeof(double); k++)
        ((double *)&found)[k] = (behind[k] - before[k]) / (2 * CHANGE);
    return found;
}

static online_derivatives differentiate(online_transient *contact, online_direction direction) {
    online_derivatives found;

    check_ok(online_transient_differentiate(&found, contact, &direction, &error));
    return found;
}

/* Compares derivatives with finite differences. The differences contain errors of the iterations,
 * and sometimes the exit passes a node. */
static void check_tangent(online_transient *contact, const online_conditions *at) {
    const bool by_load = isnan(at->approach);
    const online_direction held = {by_load ? 0 : NAN, by_load ? NAN : 0, 0, 0, 0};
    online_derivatives found[NUM_BY];
    online_state state;

    check_ok(online_step(&state, contact, at, STEP, &error));
    for (int by = 0; by < NUM_BY; by++)
        found[by] = differentiate(contact, changed(held, by, 1));
    const online_direction other = {by_load ? NAN : 1, by_load ? 1 : NAN, 0, 0, 0};
    const contact_scalars turned = differentiate(contact, other).scalars;
    const contact_scalars *own = &found[BY_GIVEN].scalars;
    if (by_load)
        check_close(turned.load, 1 / own->rigid_approach, 1e-8, 0);
    else
        check_close(turned.rigid_approach, 1 / own->load, 1e-8, 0);
    for (int by = 0; by < NUM_BY; by++) {
        const contact_scalars expected = difference(contact, *at, by), *f = &found[by].scalars;
        const double near = 1e-3, noise = 1e-5;
        check_close(f->central_film_thickness, expected.central_film_thickness, near, noise);
        check_close(f->minimum_film_thickness, expected.minimum_film_thickness, near, noise);
        check_close(f->central_pressure, expected.central_pressure, near, noise);
        check_close(f->rigid_approach, expected.rigid_approach, near, noise);
        check_close(f->exit_position, expected.exit_position, (is_path() ? 20 : 3) * near, noise);
        check_close(f->load, expected.load, near, noise);
    }
}

static void the_tangent_of_a_step_is_that_of_repeating_it(void **unused) {
    (void)unused;
    static online_state states[10];
    for_both_models {
        online_transient *contact = create(models[m]);
        start(contact);
        go(states, contact, 0, 10);
        online_conditions at = conditions_at(11 * STEP);
        check_tangent(contact, &at);
        at.approach = states[9].scalars.rigid_approach - 0.01;
        at.load = NAN;
        check_tangent(contact, &at);
        online_transient_free(contact);
    }
}

static void derivatives_leave_the_contact_as_it_is(void **unused) {
    (void)unused;
    const online_direction direction = {.load = 1, .approach = NAN, .speed = 1};
    for_both_models {
        online_transient *straight = create(models[m]), *asked = create(models[m]);
        online_state expected[20], found;
        start(straight);
        start(asked);
        differentiate(asked, direction);
        go(expected, straight, 0, 20);
        for (size_t i = 0; i < 20; i++) {
            found = step_from(asked, (double)i * STEP, STEP);
            differentiate(asked, direction);
            online_accept(asked);
            check_same(&found, &expected[i]);
        }
        online_derivatives none;
        assert_int_equal(online_transient_differentiate(&none, asked, &direction, &error),
                         EHD_INTERNAL);
        online_transient_free(straight);
        online_transient_free(asked);
    }
}

/* Checks stiffness and damping. Under a small and slow oscillation sin wT of the load, the approach
 * oscillates by A sin wT + w B cos wT. At the maximum of the load this is A. When the load passes
 * its mean, rising or falling, it is +w B or -w B. BDF2 has an error of 0.2 %. */
static void the_stationary_response_is_that_to_a_slow_swing(void **unused) {
    (void)unused;
    enum { A_QUARTER = 20, NUM = 8 * A_QUARTER };
    const double swing = 0.01, period = 80, step = period / (4 * A_QUARTER);
    const double frequency = 2 * M_PI / period;
    for_both_models {
        online_transient *contact = create(models[m]);
        online_response response;
        double approach[NUM + 1];
        start(contact);
        check_ok(online_transient_respond(&response, contact, &error));
        for (int i = 1; i <= NUM; i++) {
            online_conditions at = conditions_at(0);
            online_state state;
            at.load = 1 + swing * sin(frequency * i * step);
            check_ok(online_step(&state, contact, &at, step, &error));
            assert_int_not_equal(state.status, EHD_NOT_CONVERGED);
            online_accept(contact);
            approach[i] = state.scalars.rigid_approach;
        }
        const double top = approach[5 * A_QUARTER], bottom = approach[7 * A_QUARTER];
        const double A = (top - bottom) / (2 * swing);
        const double B =
            (approach[8 * A_QUARTER] - approach[6 * A_QUARTER]) / (2 * swing * frequency);
        check_close(response.stiffness, -1 / A, 1e-3, 0);
        check_close(response.damping, B / (A * A), 5e-3, 0);
        // the bound of the error of the damping is small because the model was trained on transient
        // runs
        assert_true(response.damping_bound < 1e-3 * response.damping);
        online_transient_free(contact);
    }
}

/* Accepting twice, or without a step, has no effect. */
static void a_step_counts_once(void **unused) {
    (void)unused;
    online_transient *once = create(models[0]), *often = create(models[0]);
    online_state expected, found;

    start(once);
    start(often);
    online_accept(often);
    for (size_t i = 0; i < 5; i++) {
        go(&expected, once, i, 1);
        go(&found, often, i, 1);
        online_accept(often);
        check_same(&found, &expected);
    }
    online_transient_free(once);
    online_transient_free(often);
}

static void after_a_jump_the_past_does_not_count(void **unused) {
    (void)unused;
    online_transient *contact = create(models[0]);
    online_state states[10], state;

    start(contact);
    go(states, contact, 0, 10);
    assert_true(states[9].local_error > 0);
    state = step_from(contact, 10 * STEP, STEP);
    assert_true(state.local_error > 0);
    online_restart(contact);
    state = step_from(contact, 10 * STEP, STEP);
    check_close(state.local_error, 0, 0, 0); // an estimate needs more than one previous state
    online_transient_free(contact);
}

static void fields_are_those_of_the_accepted_state(void **unused) {
    (void)unused;
    const ehd_grid *grid = &reference.grid;
    double *pressure = malloc(2 * grid->num_nodes * sizeof *pressure),
           *film = pressure + grid->num_nodes;
    const size_t centre = (size_t)lround(4 / grid->step) + 1; // X = 0

    assert_non_null(pressure);
    check_close(grid_x(grid, centre), 0, 0, 1e-12);
    for_both_models {
        online_transient *contact = create(models[m]);
        online_state states[10];
        double load = 0;
        start(contact);
        go(states, contact, 0, 10);
        step_from(contact, 10 * STEP, 4 * STEP); // not accepted
        check_ok(online_transient_fields(pressure, film, contact, &error));
        const online_state *last = &states[9];
        double width = last->half_width, film_scale = width * width; // the radius is 1
        for (size_t k = 0; k < grid->num_nodes; k++)
            load += pressure[k] * grid->step;
        check_close(load / reference.kind->load * width * width, last->scalars.load, 1e-9, 0);
        // also with an independent basis the film contains the deflection that the pressure causes,
        // not the sum of the deformation modes
        check_close(film[centre] * film_scale, last->scalars.central_film_thickness,
                    m == 0 ? 1e-9 : 1e-6, 0);
        // p_H / p_H,ref = load / half width
        check_close(pressure[centre] * conditions_at(10 * STEP).load / width,
                    last->scalars.central_pressure, 1e-9, 0);
        online_transient_free(contact);
    }
    free(pressure);
}

// ---- saving

static void a_saved_state_goes_on_to_the_bit(void **unused) {
    (void)unused;
    const size_t before = 12, count = 20;
    for_both_models {
        online_transient *one = create(models[m]), *other = create(models[m]);
        double *saved = calloc(online_saved_size(one), sizeof *saved);
        online_state expected[20], found[20];
        assert_non_null(saved);
        assert_int_equal(online_saved_size(other), online_saved_size(one));
        start(one);
        go(expected, one, 0, before);
        online_save(saved, one);
        go(expected, one, before, count);
        // restore the state into the same object, which has made more steps
        check_ok(online_restore(one, saved, &error));
        go(found, one, before, count);
        check_all_same(found, expected, count);
        // restore the state into a new object, which then makes a step that is not accepted
        check_ok(online_restore(other, saved, &error));
        step_from(other, (double)before * STEP, 2 * STEP);
        go(found, other, before, count);
        check_all_same(found, expected, count);
        // a state that is restored and saved again is equal
        check_ok(online_restore(one, saved, &error));
        double *again = calloc(online_saved_size(one), sizeof *again);
        assert_non_null(again);
        step_from(one, (double)before * STEP, STEP);
        online_save(again, one);
        assert_memory_equal(again, saved, online_saved_size(one) * sizeof *saved);
        free(again);
        free(saved);
        online_transient_free(one);
        online_transient_free(other);
    }
}

/* A state can be saved and restored after each of the first steps, when the solver renews its kept
 * factors of the Jacobian, and after steps shorter than the grid step. */
static void any_state_can_be_saved(void **unused) {
    (void)unused;
    for_both_models {
        online_transient *one = create(models[m]), *other = create(models[m]);
        double *saved = calloc(online_saved_size(one), sizeof *saved);
        online_state expected, found;
        assert_non_null(saved);
        start(one);
        for (size_t i = 0; i < 40; i++) {
            online_save(saved, one);
            check_ok(online_restore(other, saved, &error));
            go(&expected, one, i, 1);
            go(&found, other, i, 1);
            check_same(&found, &expected);
        }
        // after a short step, and then after a jump
        double time = 40 * STEP;
        for (size_t i = 0; i < 8; i++) {
            const double step = i < 6 ? 1e-4 : STEP;
            online_save(saved, one);
            check_ok(online_restore(other, saved, &error));
            if (i == 6) online_restart(one);
            if (i == 6) online_restart(other);
            expected = step_from(one, time, step);
            found = step_from(other, time, step);
            check_same(&found, &expected);
            online_accept(one);
            time += step;
        }
        free(saved);
        online_transient_free(one);
        online_transient_free(other);
    }
}

static void no_state_is_refused(void **unused) {
    (void)unused;
    online_transient *contact = create(models[0]);
    size_t size = online_saved_size(contact);
    double *saved = calloc(size, sizeof *saved), *wrong = calloc(size, sizeof *wrong);
    const online_conditions conditions = conditions_at(STEP);
    online_state states[5], state;

    assert_non_null(saved);
    assert_non_null(wrong);
    assert_int_equal(online_restore(contact, wrong, &error), EHD_DATA);
    start(contact);
    go(states, contact, 0, 5);
    online_save(saved, contact);
    for (size_t i = 0; i < 4; i++) { // time, load, rate of the load, number of states
        memcpy(wrong, saved, size * sizeof *saved);
        wrong[i] = NAN;
        assert_int_equal(online_restore(contact, wrong, &error), EHD_DATA);
        assert_non_null(strstr(error.text, "saved state: found"));
        // no step can be made after a state was restored only in part
        assert_int_equal(online_step(&state, contact, &conditions, STEP, &error), EHD_INTERNAL);
    }
    check_ok(online_restore(contact, saved, &error));
    go(states, contact, 5, 1);
    free(saved);
    free(wrong);
    online_transient_free(contact);
}

// ---- threads

enum { THREAD_STEPS = 60 };

typedef struct element {
    online_transient *contact;
    size_t first; // step of the history at which the element starts
    online_state states[THREAD_STEPS];
} element;

/* Makes steps in a thread, without cmocka's checks, which are not thread-safe. */
static void *run_element(void *argument) {
    element *self = argument;
    ehd_error own = {""};

    for (size_t i = 0; i <= THREAD_STEPS; i++) {
        double time = (double)(self->first + i) * STEP;
        const online_conditions conditions = conditions_at(time);
        online_state state;
        if (i == 0 && online_transient_start(&state, self->contact, &conditions, &own)) break;
        if (i == 0) continue;
        if (online_step(&self->states[i - 1], self->contact, &conditions, STEP, &own)) break;
        online_accept(self->contact);
    }
    return NULL;
}

static void two_threads_agree_with_one(void **unused) {
    (void)unused;
    for_both_models {
        static element alone[2], beside[2];
        pthread_t threads[2];
        memset(alone, 0, sizeof alone);
        memset(beside, 0, sizeof beside);
        for (size_t i = 0; i < 2; i++) {
            alone[i].first = beside[i].first = 7 * i;
            alone[i].contact = create(models[m]);
            beside[i].contact = create(models[m]);
        }
        for (size_t i = 0; i < 2; i++)
            run_element(&alone[i]);
        for (size_t i = 0; i < 2; i++)
            assert_int_equal(pthread_create(&threads[i], NULL, run_element, &beside[i]), 0);
        for (size_t i = 0; i < 2; i++)
            assert_int_equal(pthread_join(threads[i], NULL), 0);
        for (size_t i = 0; i < 2; i++) {
            check_close(alone[i].states[THREAD_STEPS - 1].time, THREAD_STEPS * STEP, 0, 0);
            check_all_same(beside[i].states, alone[i].states, THREAD_STEPS);
            online_transient_free(alone[i].contact);
            online_transient_free(beside[i].contact);
        }
    }
}

// ---- comparison with march_run

typedef struct march_trace {
    march_step steps[MOST_STATES];
    size_t count;
} march_trace;

static ehd_status trace_step(void *sink, const march_step *step, size_t index, ehd_error *ignored) {
    march_trace *self = sink;
    (void)index, (void)ignored;

    self->steps[self->count++] = *step;
    return EHD_OK;
}

static void march_run_takes_the_same_steps(void **unused) {
    (void)unused;
    for_both_models {
        static march_trace trace;
        online_transient *by_hand = create(models[m]), *marching = create(models[m]);
        march run = {.histories = histories,
                     .settings = march_settings_of(&given, histories, NAN),
                     .reference = &reference,
                     .solver = online_march(marching),
                     .store = trace_step,
                     .sink = &trace};
        march_step first;
        online_state state = start(by_hand);
        ehd_status outcome;
        trace.count = 0;
        check_ok(march_begin(&first, &run, &error));
        check_ok(march_run(&outcome, &run, &error));
        assert_in_range(trace.count, NUM_STEPS, MOST_STATES - 1);
        check_close(state.scalars.central_film_thickness, first.scalars.central_film_thickness, 0,
                    0);
        for (size_t i = 0; i < trace.count; i++) {
            const march_step *step = &trace.steps[i];
            state = step_from(by_hand, state.time, step->step);
            online_accept(by_hand);
            contact_scalars expected = frame_to_reference(&step->scalars, &step->frame, &reference);
            check_close(state.time, step->frame.time, 0, 0);
            check_close(state.scalars.central_film_thickness, expected.central_film_thickness, 0,
                        0);
            check_close(state.scalars.rigid_approach, expected.rigid_approach, 0, 0);
            check_close(state.scalars.load, expected.load, 0, 0);
            if (!is_path()) // with transport along the path the march may enlarge this error
                check_close(state.local_error, step->local_error, 0, 0);
            assert_int_equal(state.iterations, step->iterations);
        }
        online_transient_free(by_hand);
        online_transient_free(marching);
    }
}

// ---- approach and force

/* Makes steps with given approaches, which are the results of a run under a given load. The loads
 * must be the loads of that run. `known`: the load is also given, to scale the frames. */
static void follow_approach(const online_state *by_load, online_transient *contact, bool known,
                            double tolerance) {
    const size_t before = known ? 0 : 10; // steps after which the load's rate is known
    online_state states[10];

    start(contact);
    go(states, contact, 0, before);
    for (size_t i = before; i < NUM_STEPS; i++) {
        const online_state *expected = &by_load[i];
        online_conditions conditions = conditions_at(expected->time);
        conditions.load = known ? conditions.load : NAN;
        conditions.approach = expected->scalars.rigid_approach;
        check_ok(online_step(&states[0], contact, &conditions, STEP, &error));
        assert_string_equal(states[0].reason, "");
        online_accept(contact);
        check_close(states[0].scalars.rigid_approach, conditions.approach, 1e-7, 0);
        check_close(states[0].scalars.load, expected->scalars.load, tolerance, 0);
        check_close(states[0].scalars.central_film_thickness,
                    expected->scalars.central_film_thickness, tolerance, 0);
    }
}

/* Checks that the approaches of a run give its loads back. If no load is given with the approach,
 * the contact scales its frames by a predicted load. On this coarse grid the result then differs a
 * little more. */
static void the_approach_gives_the_load_back(void **unused) {
    (void)unused;
    for_both_models {
        static online_state by_load[NUM_STEPS];
        online_transient *contact = create(models[m]);
        start(contact);
        go(by_load, contact, 0, NUM_STEPS);
        follow_approach(by_load, contact, true, 1e-5);
        follow_approach(by_load, contact, false, 3e-4);
        online_transient_free(contact);
    }
}

static void a_start_from_an_approach_finds_its_load(void **unused) {
    (void)unused;
    size_t num_found = 0;
    for_both_models {
        online_transient *contact = create(models[m]);
        for (double load = 0.6; load < 4; load *= 1.05) {
            online_conditions conditions = {
                .load = load, .approach = NAN, .speed = 1, .radius = 1, .modulus = 1};
            online_state by_load, by_approach;
            check_ok(online_transient_start(&by_load, contact, &conditions, &error));
            if (by_load.status == EHD_NOT_CONVERGED) continue; // far from any trained load
            conditions.load = NAN;
            conditions.approach = by_load.scalars.rigid_approach;
            check_ok(online_transient_start(&by_approach, contact, &conditions, &error));
            assert_int_not_equal(by_approach.status, EHD_NOT_CONVERGED);
            // the least-squares problems of the two starts have different closures, so their errors
            // differ, and they differ more outside of the training
            const double near = fabs(load - 1) < 0.1 ? 1e-6 : load > 0.8 && load < 1.6 ? 1e-4 : 0.1;
            check_close(by_approach.scalars.load, load, near, 0);
            check_close(by_approach.half_width, sqrt(load), near, 0);
            check_close(by_approach.scalars.central_film_thickness,
                        by_load.scalars.central_film_thickness, near, 0);
            num_found++;
        }
        online_transient_free(contact);
    }
    assert_true(num_found > 20);
}

// ---- refused or untrusted inputs

static void conditions_out_of_range_are_refused(void **unused) {
    (void)unused;
    const struct {
        online_conditions conditions;
        double step;
        const char *words;
    } cases[] = {
        {{-1, NAN, 1, 1, 1}, STEP, "load: found -1, expected a number of at least 0"},
        {{NAN, NAN, 1, 1, 1}, STEP, "load: found nan, expected"},
        {{INFINITY, NAN, 1, 1, 1}, STEP, "load: found inf, expected"},
        {{0, -0.5, 1, 1, 1}, STEP, "load: found 0, expected a number above 0"},
        {{1, INFINITY, 1, 1, 1}, STEP, "approach: found inf, expected a finite number"},
        {{1, NAN, -1e-9, 1, 1}, STEP, "speed: found -1e-09, expected a number of at least 0"},
        {{1, NAN, NAN, 1, 1}, STEP, "speed: found nan, expected"},
        {{1, NAN, 1, 0, 1}, STEP, "radius: found 0, expected a number above 0"},
        {{1, NAN, 1, 1, 0}, STEP, "modulus: found 0, expected a number above 0"},
        {{1, NAN, 1, 1, 1}, 0, "step: found 0, expected a number above 0"},
        {{1, NAN, 1, 1, 1}, -STEP, "step: found -0.015625, expected"},
        {{1, NAN, 1, 1, 1}, NAN, "step: found nan, expected"},
        {{1, NAN, 1, 1, 1}, INFINITY, "step: found inf, expected"},
    };
    online_transient *contact = create(models[0]), *undisturbed = create(models[0]);
    online_state expected, found;

    start(contact);
    start(undisturbed);
    go(&found, contact, 0, 1);
    go(&expected, undisturbed, 0, 1);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        ehd_status status =
            online_step(&found, contact, &cases[i].conditions, cases[i].step, &error);
        if (status != EHD_DATA || !strstr(error.text, cases[i].words) || strchr(error.text, '\n'))
            fail_msg("found %d \"%s\", expected \"%s\"", (int)status, error.text, cases[i].words);
        if (cases[i].step == STEP)
            assert_int_equal(online_transient_start(&found, contact, &cases[i].conditions, &error),
                             EHD_DATA);
        online_accept(contact); // no step to accept
    }
    go(&found, contact, 1, 1);
    go(&expected, undisturbed, 1, 1);
    check_same(&found, &expected);
    online_transient_free(contact);
    online_transient_free(undisturbed);
}

static void calls_out_of_order_are_refused(void **unused) {
    (void)unused;
    char path[128];
    online_model *unprepared;
    online_transient *contact;
    ehd_contact other = reference;
    const online_conditions conditions = conditions_at(STEP);
    online_state state;

    snprintf(path, sizeof path, "%s/model.h5", folder);
    check_ok(online_open(&unprepared, path, NULL, &error));
    assert_int_equal(online_transient_create(&contact, unprepared, &reference, &error),
                     EHD_INTERNAL);
    assert_null(contact);
    assert_non_null(strstr(error.text, "expected online_prepare_transient before"));
    online_close(unprepared);
    other.grid.step *= 2;
    assert_int_equal(online_transient_create(&contact, models[0], &other, &error), EHD_DATA);
    assert_null(contact);
    contact = create(models[0]);
    assert_int_equal(online_step(&state, contact, &conditions, STEP, &error), EHD_INTERNAL);
    assert_non_null(strstr(error.text, "expected online_transient_start"));
    assert_null(online_transient_free(contact));
    assert_null(online_transient_free(NULL));
}

static void what_was_not_trained_is_not_trusted(void **unused) {
    (void)unused;
    const struct {
        online_conditions conditions;
        double step;
    } cases[] = {{{1.2, NAN, 1, 1, 1}, 0.5},    // load
                 {{1, NAN, 1.1, 1, 1}, 0.5},    // speed
                 {{1.05, NAN, 1, 1, 1}, 0.01}}; // rate
    for_both_models for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        online_transient *contact = create(models[m]);
        online_state state;
        start(contact);
        check_ok(online_step(&state, contact, &cases[i].conditions, cases[i].step, &error));
        assert_int_equal(state.status, EHD_UNTRUSTED);
        assert_true(strlen(state.reason) > 0);
        online_transient_free(contact);
    }
}

/* Changes the load at the rate `rate` for a short time. In each step the fluid moves far less than
 * a grid step. The second contact gets the approaches that result for the first contact. Returns
 * the results of the last steps. */
static void change_load(online_state last[2], online_transient *const contacts[2], double rate) {
    const double step = 1e-4;

    for (int i = 0; i < 2; i++)
        start(contacts[i]);
    for (int k = 1; k <= 60; k++)
        for (int i = 0; i < 2; i++) {
            online_conditions at = {1 + rate * k * step, NAN, 1, 1, 1};
            if (i == 1) at.load = NAN;
            if (i == 1) at.approach = last[0].scalars.rigid_approach;
            check_ok(online_step(&last[i], contacts[i], &at, step, &error));
            assert_int_not_equal(last[i].status, EHD_NOT_CONVERGED);
            online_accept(contacts[i]);
        }
}

/* The rate at which a load changes is checked in steps of any length. */
static void fast_changes_in_short_steps_are_not_trusted(void **unused) {
    (void)unused;
    for_both_models {
        online_transient *contacts[] = {create(models[m]), create(models[m])};
        online_state last[2];
        change_load(last, contacts, 1.5);
        for (int i = 0; i < 2; i++)
            assert_non_null(strstr(last[i].reason, "changes faster than any in training"));
        change_load(last, contacts, 0.1);
        assert_int_equal(last[0].status, EHD_OK);
        assert_int_equal(last[1].status, EHD_OK);
        for (int i = 0; i < 2; i++)
            online_transient_free(contacts[i]);
    }
}

// ---- memory

static void a_step_allocates_nothing(void **unused) {
    (void)unused;
    for_both_models {
        online_transient *contact = create(models[m]);
        double *saved = malloc(online_saved_size(contact) * sizeof *saved);
        online_state states[30];
        assert_non_null(saved);
        allocation_fail_at(0);
        start(contact);
        go(states, contact, 0, 30);
        online_save(saved, contact);
        check_ok(online_restore(contact, saved, &error));
        online_restart(contact);
        assert_false(allocation_failed());
        free(saved);
        online_transient_free(contact);
    }
}

/* HDF5, FFTW and GSL may end the process, so no call for a contact may use these libraries. */
static void a_prepared_model_calls_no_library_that_may_end_the_process(void **unused) {
    (void)unused;
    const size_t num_nodes = reference.grid.num_nodes;
    double *pressure = malloc(2 * num_nodes * sizeof *pressure);

    assert_non_null(pressure);
    for_both_models {
        online_state states[30];
        foreign_forbid();
        online_transient *contact = create(models[m]);
        double *saved = malloc(online_saved_size(contact) * sizeof *saved);
        assert_non_null(saved);
        start(contact);
        go(states, contact, 0, 30);
        online_save(saved, contact);
        check_ok(online_restore(contact, saved, &error));
        online_restart(contact);
        go(states, contact, 30, 2);
        check_ok(online_transient_fields(pressure, pressure + num_nodes, contact, &error));
        online_transient_free(contact);
        foreign_allow();
        free(saved);
    }
    free(pressure);
}

static void memory_may_fail(void **unused) {
    (void)unused;
    online_transient *contact = NULL;
    ehd_status status;
    size_t call = 0;

    do {
        allocation_fail_at(call);
        status = online_transient_create(&contact, models[0], &reference, &error);
        if (!allocation_failed()) break;
        assert_int_equal(status, EHD_MEMORY);
        assert_null(contact);
    } while (call++ < 1000);
    assert_int_equal(status, EHD_OK);
    assert_true(call > 10);
    online_transient_free(contact);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_exit_moves_as_in_the_full_model),
        cmocka_unit_test(a_constant_contact_stays),
        cmocka_unit_test(a_step_can_be_repeated),
        cmocka_unit_test(a_short_step_leaves_the_next_one_as_it_is),
        cmocka_unit_test(steps_may_have_any_lengths),
        cmocka_unit_test(a_contact_is_lost_and_regained),
        cmocka_unit_test(bodies_touch_at_the_approach_that_is_given),
        cmocka_unit_test(without_a_load_there_is_no_contact),
        cmocka_unit_test(a_bouncing_mass_gets_the_impulse_of_the_force),
        cmocka_unit_test(the_tangent_of_a_step_is_that_of_repeating_it),
        cmocka_unit_test(derivatives_leave_the_contact_as_it_is),
        cmocka_unit_test(a_step_counts_once),
        cmocka_unit_test(after_a_jump_the_past_does_not_count),
        cmocka_unit_test(fields_are_those_of_the_accepted_state),
        cmocka_unit_test(a_saved_state_goes_on_to_the_bit),
        cmocka_unit_test(any_state_can_be_saved),
        cmocka_unit_test(no_state_is_refused),
        cmocka_unit_test(two_threads_agree_with_one),
        cmocka_unit_test(march_run_takes_the_same_steps),
        cmocka_unit_test(the_approach_gives_the_load_back),
        cmocka_unit_test(conditions_out_of_range_are_refused),
        cmocka_unit_test(calls_out_of_order_are_refused),
        cmocka_unit_test(what_was_not_trained_is_not_trusted),
        cmocka_unit_test(fast_changes_in_short_steps_are_not_trusted),
        cmocka_unit_test(a_step_allocates_nothing),
        cmocka_unit_test(a_prepared_model_calls_no_library_that_may_end_the_process),
        cmocka_unit_test(memory_may_fail),
    };

    // these tests are about stationary contacts, which do not depend on the transport
    const struct CMUnitTest of_upwind[] = {
        cmocka_unit_test(the_stationary_response_is_that_to_a_slow_swing),
        cmocka_unit_test(a_start_from_an_approach_finds_its_load),
    };

    return cmocka_run_group_tests_name("along the path", tests, set_up_path, tear_down) +
           cmocka_run_group_tests_name("upwind", tests, set_up_upwind, tear_down) +
           cmocka_run_group_tests_name("stationary", of_upwind, set_up_upwind, tear_down);
}
