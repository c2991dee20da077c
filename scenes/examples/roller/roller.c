/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Simulates a roller that carries a slide over the oblique joint of two rails. The second rail is a
 * little higher. The roller is divided into slices, and each slice is a lubricated line contact.
 * Slide and roller are rigid, so height and tilt of the slide give the approach of each slice; the
 * contact gives the force. Several threads solve all contacts in each trial of a step of the slide.
 * Of ehdrom only the installed library is needed.
 *
 *     roller SCENE.yml MODEL OUT.csv [THREADS] */
#include <ehdrom.h>

#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

// ---- the machine, SI

enum { NUM_SLICES = 8 };
static const double LENGTH = 0.02;    // length of the roller
static const double LOAD = 6000;      // load on the roller
static const double SPEED = 0.8;      // speed of the slide
static const double MASS = 2.5;       // mass of the slide that this roller carries
static const double INERTIA = 7.5e-4; // moment of inertia for tilt about the direction of motion
static const double RAIL_STEP = 1e-6; // height of the second rail above the first one
static const double RAMP = 0.4e-3;    // length over which the track rises at the joint
static const double SKEW = 0.1;       // tangent of the angle of the joint
static const double BEFORE = 1.5e-3;  // the motion starts at this distance before the joint
static const double BEHIND = 4.5e-3;  // and ends at this distance behind the joint

// ---- the integrator

static const double POSITION_ERROR = 2e-11; // m, allowed error of the positions in a step
static const double FILM_ERROR = 1e-3;      // allowed relative error of the central film in a step
static const double EQUILIBRIUM = 1e-14;    // m, tolerance of the positions in the trials of a step
enum { MAX_TRIALS = 12, MAX_THREADS = 64 };

enum { NOT_CONVERGED = 3, UNTRUSTED = 4, USAGE = 64, CANNOT_CREATE = 73, IO_FAILED = 74 };

/* Returns the position of slice k along the roller, from its middle. */
static double place(int k) {
    return LENGTH * ((k + 0.5) / NUM_SLICES - 0.5);
}

static double track(double travel, double across) {
    const double part = fmin(fmax((travel - SKEW * across) / RAMP, 0), 1);

    return RAIL_STEP * part * part * (3 - 2 * part);
}

// ---- the contacts

typedef struct crew crew;

/* The data of a thread. */
typedef struct hand {
    crew *of;
    int number;
    pthread_t thread;
} hand;

/* The contacts, and the threads that solve them. */
struct crew {
    ehdrom_model *model;
    ehdrom_contact *contacts[NUM_SLICES];
    ehdrom_conditions conditions[NUM_SLICES];
    ehdrom_result results[NUM_SLICES];
    double step;
    // each thread makes the steps of its share of the contacts; thread 0 is the main thread
    int num_threads;
    hand hands[MAX_THREADS];
    ehdrom_status statuses[MAX_THREADS];
    pthread_barrier_t begin, end;
    int over;
};

static void step_share(crew *self, int number) {
    const int first = NUM_SLICES * number / self->num_threads;
    const int last = NUM_SLICES * (number + 1) / self->num_threads;

    self->statuses[number] =
        ehdrom_step_many(self->contacts + first, self->conditions + first, self->step,
                         self->results + first, (size_t)(last - first));
}

static void *work(void *argument) {
    const hand *self = argument;

    for (;;) {
        pthread_barrier_wait(&self->of->begin);
        if (self->of->over) return NULL;
        step_share(self->of, self->number);
        pthread_barrier_wait(&self->of->end);
    }
}

/* Makes a step of all contacts from the last accepted state. Returns the worst status. */
static ehdrom_status step_all(crew *self, double step) {
    ehdrom_status worst = EHDROM_OK;

    self->step = step;
    pthread_barrier_wait(&self->begin);
    step_share(self, 0);
    pthread_barrier_wait(&self->end);
    for (int i = 0; i < self->num_threads; i++)
        if (self->statuses[i] > worst) worst = self->statuses[i];
    return worst;
}

/* Prints the message of the first contact with this status. Returns the status. */
static ehdrom_status tell(const crew *self, ehdrom_status status) {
    for (int k = 0; k < NUM_SLICES; k++)
        if (self->results[k].status == status) {
            fprintf(stderr, "roller: slice %d: %s\n", k, ehdrom_contact_error(self->contacts[k]));
            return status;
        }
    fputs("roller: found no place where the slices carry the slide, expected one\n", stderr);
    return status;
}

/* Finds the stationary state of a contact under its share of the load, and starts there with the
 * approach given, as in all later steps. */
static ehdrom_status start_contact(crew *self, int k, const char *scene) {
    ehdrom_conditions conditions = EHDROM_CONDITIONS_INIT;
    ehdrom_contact *contact = self->contacts[k];
    ehdrom_status status = ehdrom_contact_read(contact, scene);

    conditions.given = EHDROM_LOAD;
    conditions.load = LOAD / LENGTH;
    self->results[k] = (ehdrom_result)EHDROM_RESULT_INIT;
    self->conditions[k] = (ehdrom_conditions)EHDROM_CONDITIONS_INIT;
    self->conditions[k].given = EHDROM_APPROACH;
    if (!status) status = ehdrom_start(contact, &conditions, &self->results[k]);
    self->conditions[k].approach = self->results[k].approach;
    if (!EHDROM_FAILED(status) && status != EHDROM_NOT_CONVERGED)
        status = ehdrom_start(contact, &self->conditions[k], &self->results[k]);
    if (EHDROM_FAILED(status)) self->results[k].status = status;
    return status;
}

static ehdrom_status open_contacts(crew *self, const char *scene, const char *path) {
    ehdrom_status status = ehdrom_model_open(&self->model, path, NULL);

    if (status) {
        fprintf(stderr, "roller: %s\n", ehdrom_model_error(self->model));
        return status;
    }
    for (int k = 0; k < NUM_SLICES; k++) {
        status = ehdrom_contact_create(&self->contacts[k], self->model);
        if (!status) status = start_contact(self, k, scene);
        if (EHDROM_FAILED(status) || status == EHDROM_NOT_CONVERGED) return tell(self, status);
    }
    return EHDROM_OK;
}

static void begin_threads(crew *self, int count) {
    self->num_threads = count;
    pthread_barrier_init(&self->begin, NULL, (unsigned)count);
    pthread_barrier_init(&self->end, NULL, (unsigned)count);
    for (int i = 1; i < count; i++) {
        self->hands[i] = (hand){.of = self, .number = i};
        if (pthread_create(&self->hands[i].thread, NULL, work, &self->hands[i])) abort();
    }
}

static void close_crew(crew *self) {
    if (self->num_threads > 0) {
        self->over = 1;
        pthread_barrier_wait(&self->begin);
    }
    for (int i = 1; i < self->num_threads; i++)
        pthread_join(self->hands[i].thread, NULL);
    for (int k = 0; k < NUM_SLICES; k++)
        ehdrom_contact_free(self->contacts[k]);
    ehdrom_model_close(self->model);
}

// ---- the slide

/* Height above the initial position, and tilt. */
enum { HEIGHT, TILT, NUM_POSITIONS };

typedef struct slide {
    double time, step, shortest; // s; length of the next step; least step due to film errors
    double position[NUM_POSITIONS], velocity[NUM_POSITIONS], acceleration[NUM_POSITIONS];
    double rest; // initial approach of the contacts, m
    double load; // initial force of the contacts, N: LOAD except for the error of the least squares
    double stiffness[NUM_SLICES]; // N/m^2, of each slice, from its last two trials
    size_t num_steps, num_trials, num_rejected, num_untrusted;
} slide;

static double force_of(const crew *contacts) {
    double force = 0;

    for (int k = 0; k < NUM_SLICES; k++)
        force += contacts->results[k].load * LENGTH / NUM_SLICES;
    return force;
}

/* Computes the accelerations that the forces of the slices cause. */
static void accelerate(double acceleration[NUM_POSITIONS], const crew *contacts,
                       const slide *self) {
    double moment = 0;

    for (int k = 0; k < NUM_SLICES; k++)
        moment += contacts->results[k].load * LENGTH / NUM_SLICES * place(k);
    acceleration[HEIGHT] = (force_of(contacts) - self->load) / MASS;
    acceleration[TILT] = moment / INERTIA;
}

/* Solves all contacts for a position of the slide at the end of a step. `learn`: also computes the
 * stiffness of each slice from this trial and the trial before. Returns the worst status. */
static ehdrom_status try_there(crew *contacts, slide *self, double step,
                               const double position[NUM_POSITIONS], int learn) {
    double approach[NUM_SLICES], load[NUM_SLICES];
    const double travel = SPEED * (self->time + step) - BEFORE;

    for (int k = 0; k < NUM_SLICES; k++) {
        approach[k] = contacts->conditions[k].approach;
        load[k] = contacts->results[k].load;
        contacts->conditions[k].approach =
            self->rest + position[HEIGHT] + position[TILT] * place(k) - track(travel, place(k));
    }
    const ehdrom_status status = step_all(contacts, step);
    self->num_trials++;
    if (EHDROM_FAILED(status) || status == EHDROM_NOT_CONVERGED) return status;
    for (int k = 0; k < NUM_SLICES && learn; k++) {
        const double moved = contacts->conditions[k].approach - approach[k];
        const double found = (load[k] - contacts->results[k].load) / moved;
        if (fabs(moved) > EQUILIBRIUM && found > 0) self->stiffness[k] = found;
    }
    return status;
}

/* Makes a Newton step for height and tilt, with the slices as springs. */
static void correct(double position[NUM_POSITIONS], const double defect[NUM_POSITIONS],
                    const slide *self, double step) {
    const double part = step * step / 4 * LENGTH / NUM_SLICES;
    double a = 1, b = 0, c = 0, d = 1; // the matrix by rows

    for (int k = 0; k < NUM_SLICES; k++) {
        const double spring = part * self->stiffness[k], z = place(k);
        a += spring / MASS;
        b += spring * z / MASS;
        c += spring * z / INERTIA;
        d += spring * z * z / INERTIA;
    }
    position[HEIGHT] -= (d * defect[HEIGHT] - b * defect[TILT]) / (a * d - b * c);
    position[TILT] -= (a * defect[TILT] - c * defect[HEIGHT]) / (a * d - b * c);
}

/* Tries a step of the trapezoidal rule, x_1 = x_0 + h v_0 + h^2/4 (a_0 + a_1). All trials start
 * from the last accepted state of the contacts. Returns EHDROM_NOT_CONVERGED if a shorter step is
 * needed. */
static ehdrom_status try_step(double position[NUM_POSITIONS], double acceleration[NUM_POSITIONS],
                              slide *self, crew *contacts, double step) {
    double drift[NUM_POSITIONS], defect[NUM_POSITIONS];

    for (int i = 0; i < NUM_POSITIONS; i++) {
        drift[i] = self->position[i] + step * self->velocity[i];
        position[i] = drift[i] + step * step / 2 * self->acceleration[i];
    }
    for (int trial = 0; trial < MAX_TRIALS; trial++) {
        const ehdrom_status status = try_there(contacts, self, step, position, trial > 0);
        if (EHDROM_FAILED(status) || status == EHDROM_NOT_CONVERGED) return status;
        accelerate(acceleration, contacts, self);
        for (int i = 0; i < NUM_POSITIONS; i++)
            defect[i] = position[i] - drift[i] -
                        step * step / 4 * (self->acceleration[i] + acceleration[i]);
        if (fabs(defect[HEIGHT]) + LENGTH * fabs(defect[TILT]) < EQUILIBRIUM) return EHDROM_OK;
        correct(position, defect, self, step);
    }
    return EHDROM_NOT_CONVERGED;
}

/* Returns the largest estimated error of a step, of positions and films, over the allowed error.
 * The error of the positions is a third of their difference from the prediction. Steps below
 * `shortest` do not consider the films: the fluid hardly moves, and the remaining error is noise of
 * the grid, which a shorter step does not reduce. */
static double error_of(const crew *contacts, const slide *self,
                       const double acceleration[NUM_POSITIONS], double step) {
    const double off = step * step / 12 *
                       (fabs(acceleration[HEIGHT] - self->acceleration[HEIGHT]) +
                        LENGTH / 2 * fabs(acceleration[TILT] - self->acceleration[TILT]));
    double most = off / POSITION_ERROR;

    for (int k = 0; k < NUM_SLICES && step > self->shortest; k++)
        most = fmax(most, contacts->results[k].local_error / FILM_ERROR);
    return most;
}

static void accept(slide *self, crew *contacts, const double position[NUM_POSITIONS],
                   const double acceleration[NUM_POSITIONS], double step) {
    int trusted = 1;

    for (int k = 0; k < NUM_SLICES; k++)
        trusted = trusted && contacts->results[k].trusted;
    // now, because the next call with these contacts replaces the message
    if (!trusted && self->num_untrusted++ == 0) tell(contacts, EHDROM_UNTRUSTED);
    for (int k = 0; k < NUM_SLICES; k++)
        ehdrom_accept(contacts->contacts[k]);
    for (int i = 0; i < NUM_POSITIONS; i++) {
        self->velocity[i] += step / 2 * (self->acceleration[i] + acceleration[i]);
        self->position[i] = position[i];
        self->acceleration[i] = acceleration[i];
    }
    self->time += step;
    self->num_steps++;
}

/* Makes one step. If its error is too large, tries a shorter one. */
static ehdrom_status advance(slide *self, crew *contacts) {
    double position[NUM_POSITIONS], acceleration[NUM_POSITIONS] = {0};

    for (;;) {
        const double step = self->step;
        ehdrom_status status = try_step(position, acceleration, self, contacts, step);
        if (EHDROM_FAILED(status)) return tell(contacts, status);
        const double error = status ? 64 : error_of(contacts, self, acceleration, step);
        self->step *= fmin(fmax(0.9 / cbrt(error), 0.25), 2);
        if (error <= 1) {
            accept(self, contacts, position, acceleration, step);
            return EHDROM_OK;
        }
        self->num_rejected++;
        if (!(self->step > self->shortest / 1000)) return tell(contacts, EHDROM_NOT_CONVERGED);
    }
}

/* Starts at rest. The first stiffness of all slices is that of a contact at rest. */
static ehdrom_status begin(slide *self, crew *contacts) {
    ehdrom_contact *contact = contacts->contacts[0];
    ehdrom_scales scales = EHDROM_SCALES_INIT;
    ehdrom_response response = EHDROM_RESPONSE_INIT;
    ehdrom_status status = ehdrom_contact_scales(contact, &scales);

    if (!status) status = ehdrom_respond(contact, &response);
    if (status) fprintf(stderr, "roller: %s\n", ehdrom_contact_error(contact));
    *self = (slide){.rest = contacts->conditions[0].approach,
                    .load = force_of(contacts),
                    .step = scales.time / 100,
                    .shortest = scales.time / 100};
    for (int k = 0; k < NUM_SLICES; k++)
        self->stiffness[k] = response.stiffness;
    return status;
}

// ---- a run

static void write_state(FILE *file, const slide *self, const crew *contacts) {
    double film = INFINITY, pressure = 0;

    for (int k = 0; k < NUM_SLICES; k++) {
        film = fmin(film, contacts->results[k].minimum_film_thickness);
        pressure = fmax(pressure, contacts->results[k].peak_pressure);
    }
    fprintf(file, "%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g", self->time, SPEED * self->time - BEFORE,
            self->position[HEIGHT], self->position[TILT], film, pressure, self->step);
    for (int k = 0; k < NUM_SLICES; k++)
        fprintf(file, ",%.9g", contacts->results[k].load);
    fputc('\n', file);
}

static double seconds(void) {
    struct timespec now;

    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int roll(crew *contacts, FILE *file) {
    slide body;
    const double started = seconds(), end = (BEFORE + BEHIND) / SPEED;
    ehdrom_status status = begin(&body, contacts);

    fputs("time,travel,height,tilt,minimum_film_thickness,peak_pressure,step", file);
    for (int k = 0; k < NUM_SLICES; k++)
        fprintf(file, ",load_%d", k);
    fputc('\n', file);
    if (!status) write_state(file, &body, contacts);
    while (!status && body.time < end) {
        status = advance(&body, contacts);
        if (!status) write_state(file, &body, contacts);
    }
    const double spent = seconds() - started;
    printf("%zu steps, %zu repeated, %zu trials of %d contacts with %d threads: %.2f s, %.0f "
           "contacts a second; %zu steps not to be trusted\n",
           body.num_steps, body.num_rejected, body.num_trials, NUM_SLICES, contacts->num_threads,
           spent, (double)(NUM_SLICES * body.num_trials) / spent, body.num_untrusted);
    return !status && body.num_untrusted > 0 ? UNTRUSTED : status;
}

int main(int argc, char **argv) {
    static crew contacts;
    const int count = argc > 4 ? atoi(argv[4]) : 1;

    if (argc < 4 || argc > 5 || count < 1 || count > MAX_THREADS) {
        fputs("usage: roller SCENE.yml MODEL OUT.csv [THREADS]\n", stderr);
        return USAGE;
    }
    int status = open_contacts(&contacts, argv[1], argv[2]);
    if (!status) {
        FILE *file = fopen(argv[3], "w");
        if (!file) {
            fprintf(stderr, "roller: %s: %s\n", argv[3], strerror(errno));
            status = CANNOT_CREATE;
        } else {
            begin_threads(&contacts, count);
            status = roll(&contacts, file);
            if (fclose(file) && !status) status = IO_FAILED;
        }
    }
    close_crew(&contacts);
    return status;
}
