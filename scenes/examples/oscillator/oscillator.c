/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A lubricated line contact as the force element of somebody else's integrator: a mass rests on it
 * and is shaken near its resonance.
 *
 *     oscillator SCENE.yml MODEL.h5 REDUCED.csv [--full FULL.csv]
 *
 * The integrator says where the mass is (the approach H0 of the contact) and gets the force back.
 * It solves each of its own steps by trials, all of which the contact takes from its last accepted
 * state. With --full the same is done with the full model, and the largest deviations are
 * printed. */
#include "common/output/grid_file.h"
#include "common/program/program.h"
#include "common/time/march.h"
#include "fullrun/full_march.h"
#include "romrun/online/online.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Everything is dimensionless: time T = u t / a, position H0 = h R / a^2 (upwards), force w /
 * w_ref. A mass of m kg per metre then counts as m u^2 / (R w_ref): 0.0138 stands for 24 kg/m with
 * the numbers of scene.yml, a roller of steel of 31 mm radius. Seen from approach_length, the
 * contact gives way by 1.49 a unit of force, so the mass on it would swing with a period of 2 pi
 * sqrt(0.0138 * 1.49) = 0.90. */
static const double MASS = 0.0138;

/* Shaken by 0.8 % at a period near its own, the force swings by 7.5 % and beats: inside of the 12 %
 * and of the periods of 1/2 to 2 that were trained. */
static const double EXCITATION = 0.008;
static const double EXCITATION_PERIOD = 1;

/* A hundred a period. */
static const double STEP = 0.01;
enum { NUM_STEPS = 1200 };

/* Of a position; the film is about 1e-2. */
static const double TOLERANCE = 1e-8;
enum { MAX_TRIALS = 20 };

// ---- the contact, reduced or full

typedef struct reply {
    ehd_status status;  // EHD_OK, EHD_NOT_CONVERGED or EHD_UNTRUSTED
    const char *reason; // why it is not EHD_OK, or ""
    double approach, force, film;
} reply;

/* What the integrator needs of a contact. */
typedef struct force_element {
    void *self;
    /* The stationary state under the reference load. */
    ehd_status (*start)(reply *now, void *self, ehd_error *error);
    /* The state a step after the last accepted one, with the mass at `approach`. */
    ehd_status (*step)(reply *now, void *self, double approach, double step, ehd_error *error);
    void (*accept)(void *self);
} force_element;

static reply reply_of(ehd_status status, const char *reason, const contact_scalars *scalars) {
    return (reply){status, reason, scalars->rigid_approach, scalars->load,
                   scalars->central_film_thickness};
}

static ehd_status reduced_start(reply *now, void *self, ehd_error *error) {
    const online_conditions conditions = {
        .load = 1, .approach = NAN, .speed = 1, .radius = 1, .modulus = 1};
    online_state state;
    ehd_status status = online_transient_start(&state, self, &conditions, error);

    if (!status) *now = reply_of(state.status, state.reason, &state.scalars);
    return status;
}

static ehd_status reduced_step(reply *now, void *self, double approach, double step,
                               ehd_error *error) {
    const online_conditions conditions = {
        .load = NAN, .approach = approach, .speed = 1, .radius = 1, .modulus = 1};
    online_state state;
    ehd_status status = online_step(&state, self, &conditions, step, error);

    if (!status) *now = reply_of(state.status, state.reason, &state.scalars);
    return status;
}

static void reduced_accept(void *self) {
    online_accept(self);
}

/* The full model has no such interface, but is marched in the same way. */
typedef struct full_element {
    march_solver solver;
    const ehd_contact *reference;
    double time, load, load_rate; // accepted
    march_step last;
} full_element;

static contact_frame full_frame(const full_element *self, double load, double approach,
                                double step) {
    const double values[NUM_VARY] = {
        [VARY_LOAD] = load, [VARY_SPEED] = 1, [VARY_RADIUS] = 1, [VARY_MODULUS] = 1};

    contact_frame frame = frame_at(self->reference->kind, self->time + step, values, approach);
    frame.path = frame.time; // of the fluid, at the reference speed
    return frame;
}

static reply full_reply(const full_element *self) {
    contact_scalars scalars =
        frame_to_reference(&self->last.scalars, &self->last.frame, self->reference);

    return reply_of(self->last.status, self->last.reason, &scalars);
}

static ehd_status full_start(reply *now, void *contact, ehd_error *error) {
    full_element *self = contact;
    contact_frame frame = full_frame(self, 1, NAN, 0);
    ehd_status status = self->solver.start(&self->last, self->solver.self, &frame, error);

    self->load = 1;
    if (!status) *now = full_reply(self);
    return status;
}

static ehd_status full_step(reply *now, void *contact, double approach, double step,
                            ehd_error *error) {
    full_element *self = contact;
    double load = march_expected_load(self->load, self->load_rate, step);
    contact_frame frame = full_frame(self, load, approach, step);
    ehd_status status = self->solver.attempt(&self->last, self->solver.self, &frame, step, error);

    self->last.frame = frame;
    self->last.step = step;
    if (!status) *now = full_reply(self);
    return status;
}

static void full_accept(void *contact) {
    full_element *self = contact;
    double load = full_reply(self).force;

    self->solver.accept(self->solver.self);
    self->load_rate = (load - self->load) / self->last.step;
    self->load = load;
    self->time = self->last.frame.time;
}

// ---- the oscillator

/* mass x'' = force(x) - 1 - excitation */
typedef struct oscillator {
    double time, position, velocity, acceleration;
} oscillator;

static double acceleration(double force, double time) {
    return (force - 1 - EXCITATION * sin(2 * M_PI * time / EXCITATION_PERIOD)) / MASS;
}

/* One step of the trapezoidal rule, x_1 = x_0 + h v_0 + h^2/4 (x''_0 + x''_1): secants for the
 * position whose force leads there. */
static ehd_status oscillator_advance(oscillator *self, reply *now, size_t *num_trials,
                                     const force_element *contact, ehd_error *error) {
    double time = self->time + STEP, position, defect = 0, slope = 1;
    double drift = self->position + STEP * self->velocity;

    position = drift + STEP * STEP / 2 * self->acceleration;
    for (size_t trial = 0; trial < MAX_TRIALS; trial++) {
        ehd_status status = contact->step(now, contact->self, position, STEP, error);
        if (status) return status;
        if (now->status == EHD_NOT_CONVERGED) break;
        double last_defect = defect, after = acceleration(now->force, time);
        double correction = defect / slope;
        (*num_trials)++;
        defect = position - drift - STEP * STEP / 4 * (self->acceleration + after);
        if (fabs(defect) < TOLERANCE) {
            contact->accept(contact->self);
            self->velocity += STEP / 2 * (self->acceleration + after);
            *self = (oscillator){time, position, self->velocity, after};
            return EHD_OK;
        }
        if (trial > 0) slope = (last_defect - defect) / correction;
        position -= defect / slope;
    }
    return ehd_fail(error, EHD_NOT_CONVERGED, "T = %.6g: found no equilibrium (%s), expected one",
                    time, now->reason[0] ? now->reason : "too many trials");
}

// ---- a run

typedef struct trace {
    double time[NUM_STEPS + 1];
    reply states[NUM_STEPS + 1];
    size_t num_trials;
    double seconds;
} trace;

static ehd_status run(trace *self, const force_element *contact, ehd_error *error) {
    oscillator body = {0};
    double started = program_seconds();
    ehd_status status = contact->start(&self->states[0], contact->self, error);

    self->num_trials = 0;
    self->time[0] = 0;
    if (!status && self->states[0].status == EHD_NOT_CONVERGED)
        status = ehd_fail(error, EHD_NOT_CONVERGED, "start: found no stationary state (%s)",
                          self->states[0].reason);
    body.position = self->states[0].approach;
    for (size_t i = 1; i <= NUM_STEPS && !status; i++) {
        status = oscillator_advance(&body, &self->states[i], &self->num_trials, contact, error);
        self->time[i] = body.time;
    }
    self->seconds = program_seconds() - started;
    return status;
}

static ehd_status write_trace(const trace *self, const char *path, ehd_error *error) {
    FILE *file = fopen(path, "w");

    if (!file) return ehd_fail(error, EHD_CANTCREATE, "%s: %s", path, strerror(errno));
    fputs("time,approach,force,central_film_thickness\n", file);
    for (size_t i = 0; i <= NUM_STEPS; i++)
        fprintf(file, "%.10g,%.10g,%.10g,%.10g\n", self->time[i], self->states[i].approach,
                self->states[i].force, self->states[i].film);
    bool failed = ferror(file);
    if (fclose(file) || failed) return ehd_fail(error, EHD_IO, "%s: %s", path, strerror(errno));
    return EHD_OK;
}

static void print_run(const char *name, const trace *self) {
    double least = INFINITY, most = -INFINITY;

    for (size_t i = 0; i <= NUM_STEPS; i++) {
        least = fmin(least, self->states[i].force);
        most = fmax(most, self->states[i].force);
    }
    printf("%s model: %d steps, %zu trials, %.2f s, %.2f ms a trial; force from %.4f to %.4f\n",
           name, NUM_STEPS, self->num_trials, self->seconds,
           1000 * self->seconds / (double)self->num_trials, least, most);
}

static ehd_status run_reduced(trace *self, const char *model_path, const ehd_contact *reference,
                              ehd_error *error) {
    online_model *model = NULL;
    online_transient *contact = NULL;
    ehd_status status = online_open(&model, model_path, NULL, error);

    if (!status) status = online_prepare_transient(model, error);
    if (!status) status = online_transient_create(&contact, model, reference, error);
    if (!status) {
        const force_element element = {contact, reduced_start, reduced_step, reduced_accept};
        status = run(self, &element, error);
    }
    online_transient_free(contact);
    online_close(model);
    return status;
}

static ehd_status run_full(trace *self, const ehd_contact *reference, ehd_error *error) {
    const full_settings settings = full_default_settings();
    full_march *in_time = NULL;
    ehd_status status = full_march_create(&in_time, reference, &settings, NAN, error);

    if (!status) {
        full_element contact = {.solver = full_march_solver(in_time), .reference = reference};
        const force_element element = {&contact, full_start, full_step, full_accept};
        status = run(self, &element, error);
    }
    full_march_free(in_time);
    return status;
}

// ---- comparison

static void print_deviations(const trace *reduced, const trace *full) {
    double force = 0, approach = 0, film = 0, least = INFINITY, most = -INFINITY;

    for (size_t i = 0; i <= NUM_STEPS; i++) {
        const reply *found = &reduced->states[i], *expected = &full->states[i];
        force = fmax(force, fabs(found->force - expected->force));
        approach = fmax(approach, fabs(found->approach - expected->approach));
        film = fmax(film, fabs(found->film / expected->film - 1));
        least = fmin(least, expected->approach);
        most = fmax(most, expected->approach);
    }
    printf("largest deviations: force %.2g %% of its mean, approach %.2g %% of its swing, "
           "central film %.2g %%\n",
           100 * force, 100 * approach / (most - least), 100 * film);
}

/* An answer that is not to be trusted is one all the same, but whoever uses it should know. */
static ehd_status check_trust(const trace *self, ehd_error *error) {
    for (size_t i = 0; i <= NUM_STEPS; i++)
        if (self->states[i].status == EHD_UNTRUSTED)
            return ehd_fail(error, EHD_UNTRUSTED, "found %s from T = %.4g on, expected none",
                            self->states[i].reason, self->time[i]);
    return EHD_OK;
}

static ehd_status oscillate(const char *scene_path, const char *model_path,
                            const char *reduced_path, const char *full_path, ehd_error *error) {
    static trace reduced, full;
    ehd_contact reference;
    const contact_kind *kind;
    ehd_grid grid; // of the model, and so of the full model that it is compared with
    scene given;
    ehd_status status = scene_read(&given, scene_path, NULL, 0, error);

    if (!status) status = scene_contact(&reference, &given, error);
    if (!status) status = grid_of_file(&grid, &kind, model_path, error);
    if (!status) contact_take_grid(&reference, &grid);
    if (!status) status = run_reduced(&reduced, model_path, &reference, error);
    if (!status) status = write_trace(&reduced, reduced_path, error);
    if (status) return status;
    print_run("reduced", &reduced);
    if (full_path) {
        status = run_full(&full, &reference, error);
        if (!status) status = write_trace(&full, full_path, error);
        if (status) return status;
        print_run("full", &full);
        print_deviations(&reduced, &full);
    }
    return check_trust(&reduced, error);
}

int main(int argc, char **argv) {
    bool with_full = argc == 6 && strcmp(argv[4], "--full") == 0;
    ehd_error error;

    if (argc != 4 && !with_full) {
        fputs("usage: oscillator SCENE.yml MODEL.h5 REDUCED.csv [--full FULL.csv]\n", stderr);
        return EHD_USAGE;
    }
    ehd_status status = oscillate(argv[1], argv[2], argv[3], with_full ? argv[5] : NULL, &error);
    if (status) fprintf(stderr, "oscillator: %s\n", error.text);
    return status;
}
