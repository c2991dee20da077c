/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Integrates the motion of a mass on a contact, which is shaken near its resonance. The integrator
 * gives the contact the position of the mass (the approach H0) and gets the force. It solves each
 * step by several trials, and in each trial the contact starts from its last accepted state. */
#ifndef SHAKEN_MASS_H
#define SHAKEN_MASS_H

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

static const double PI = 3.14159265358979323846;

/* All quantities are dimensionless: time T = u t / a, position H0 = h R / a^2 (upwards), force w /
 * w_ref. A mass of m kg per metre becomes m u^2 / (R w_ref). With the numbers of scene.yml, 0.0138
 * is 24 kg/m, a steel roller of 31 mm radius. The compliance of the contact, for the approach at
 * approach_length, is 1.49 per unit of force. The mass on the contact therefore has a natural
 * period of 2 pi sqrt(0.0138 * 1.49) = 0.90. */
static const double MASS = 0.0138;

/* The excitation, over the reference force, has a period near the natural period. The force then
 * oscillates by 7.5 %, with beats. This is inside of the training: 12 %, periods of 1/2 to 2. */
static const double EXCITATION = 0.008;
static const double EXCITATION_PERIOD = 1;

/* A hundred steps in each period of the excitation. */
static const double STEP = 0.01;
enum { NUM_STEPS = 1200 };

/* Tolerance of a position. The film is about 1e-2. */
static const double TOLERANCE = 1e-8;
enum { MAX_TRIALS = 20 };

// ---- errors

/* An exit code (0: no error) and a message of one line. */
typedef struct failure {
    int code;
    char text[1200];
} failure;

enum { NOT_CONVERGED = 3, UNTRUSTED = 4, USAGE = 64, CANNOT_CREATE = 73, IO_FAILED = 74 };

__attribute__((format(printf, 3, 4))) static int fail(failure *self, int code, const char *format,
                                                      ...) {
    va_list arguments;

    va_start(arguments, format);
    vsnprintf(self->text, sizeof self->text, format, arguments);
    va_end(arguments);
    return self->code = code;
}

// ---- the contact

typedef struct reply {
    bool converged, trusted;
    char reason[200]; // why the state is not converged or not trusted, or ""
    double approach, force, film;
} reply;

/* The functions of a contact that the integrator calls. start and step return 0 or fail(). */
typedef struct force_element {
    void *self;
    /* Computes the stationary state under the reference load. */
    int (*start)(reply *now, void *self, failure *error);
    /* Computes the state one step after the last accepted state, with the mass at `approach`. */
    int (*step)(reply *now, void *self, double approach, double step, failure *error);
    void (*accept)(void *self);
} force_element;

// ---- the oscillator

/* mass x'' = force(x) - 1 - excitation */
typedef struct oscillator {
    double time, position, velocity, acceleration;
} oscillator;

static double acceleration(double force, double time) {
    return (force - 1 - EXCITATION * sin(2 * PI * time / EXCITATION_PERIOD)) / MASS;
}

/* Makes one step of the trapezoidal rule, x_1 = x_0 + h v_0 + h^2/4 (x''_0 + x''_1). The secant
 * method finds the position x_1 whose force satisfies this equation. */
static int oscillator_advance(oscillator *self, reply *now, size_t *num_trials,
                              const force_element *contact, failure *error) {
    double time = self->time + STEP, position, defect = 0, slope = 1;
    double drift = self->position + STEP * self->velocity;

    position = drift + STEP * STEP / 2 * self->acceleration;
    for (size_t trial = 0; trial < MAX_TRIALS; trial++) {
        int status = contact->step(now, contact->self, position, STEP, error);
        if (status) return status;
        if (!now->converged) break;
        double last_defect = defect, after = acceleration(now->force, time);
        double correction = defect / slope;
        (*num_trials)++;
        defect = position - drift - STEP * STEP / 4 * (self->acceleration + after);
        if (fabs(defect) < TOLERANCE) {
            contact->accept(contact->self);
            self->velocity += STEP / 2 * (self->acceleration + after);
            *self = (oscillator){time, position, self->velocity, after};
            return 0;
        }
        if (trial > 0) slope = (last_defect - defect) / correction;
        position -= defect / slope;
    }
    return fail(error, NOT_CONVERGED, "T = %.6g: found no equilibrium (%s), expected one", time,
                now->reason[0] ? now->reason : "too many trials");
}

// ---- a run

static double seconds(void) {
    struct timespec now;

    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

typedef struct trace {
    double time[NUM_STEPS + 1];
    reply states[NUM_STEPS + 1];
    size_t num_trials;
    double seconds;
} trace;

static int run(trace *self, const force_element *contact, failure *error) {
    oscillator body = {0};
    double started = seconds();
    int status = contact->start(&self->states[0], contact->self, error);

    self->num_trials = 0;
    self->time[0] = 0;
    if (!status && !self->states[0].converged)
        status = fail(error, NOT_CONVERGED, "start: found no stationary state (%s)",
                      self->states[0].reason);
    body.position = self->states[0].approach;
    for (size_t i = 1; i <= NUM_STEPS && !status; i++) {
        status = oscillator_advance(&body, &self->states[i], &self->num_trials, contact, error);
        self->time[i] = body.time;
    }
    self->seconds = seconds() - started;
    return status;
}

static int write_trace(const trace *self, const char *path, failure *error) {
    FILE *file = fopen(path, "w");

    if (!file) return fail(error, CANNOT_CREATE, "%s: %s", path, strerror(errno));
    fputs("time,approach,force,central_film_thickness\n", file);
    for (size_t i = 0; i <= NUM_STEPS; i++)
        fprintf(file, "%.17g,%.17g,%.17g,%.17g\n", self->time[i], self->states[i].approach,
                self->states[i].force, self->states[i].film);
    bool failed = ferror(file);
    if (fclose(file) || failed) return fail(error, IO_FAILED, "%s: %s", path, strerror(errno));
    return 0;
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

#endif
