/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs the oscillator with the full model, and prints the deviations of the reduced model. The full
 * model is not in the library, so this program is built against the sources.
 *
 *     full SCENE.yml MODEL.h5 FULL.csv REDUCED.csv
 *
 * The full model uses the grid of MODEL.h5. */
#include "common/output/grid_file.h"
#include "common/settings/scene_contact.h"
#include "common/time/march.h"
#include "fullrun/full_march.h"

#include "shaken_mass.h"

static int pass(failure *error, ehd_status status, const ehd_error *of) {
    return status ? fail(error, (int)status, "%s", of->text) : 0;
}

/* The full model as a force element. The library has no functions for it, but its steps are made in
 * the same way. */
typedef struct full_element {
    march_solver solver;
    const ehd_contact *reference;
    double time;            // of the last accepted state
    load_forecast forecast; // predicts the load that scales the frames
    march_step last;
} full_element;

static contact_frame full_frame(const full_element *self, double load, double approach,
                                double step) {
    const double values[NUM_VARY] = {
        [VARY_LOAD] = load, [VARY_SPEED] = 1, [VARY_RADIUS] = 1, [VARY_MODULUS] = 1};

    contact_frame frame = frame_at(self->reference->kind, self->time + step, values, approach);
    frame.path = frame.time; // distance that the fluid has moved, at the reference speed
    return frame;
}

static reply full_reply(const full_element *self) {
    contact_scalars scalars =
        frame_to_reference(&self->last.scalars, &self->last.frame, self->reference);

    reply now = {.converged = self->last.status != EHD_NOT_CONVERGED,
                 .trusted = self->last.status == EHD_OK,
                 .approach = scalars.rigid_approach,
                 .force = scalars.load,
                 .film = scalars.central_film_thickness};

    snprintf(now.reason, sizeof now.reason, "%s", self->last.reason);
    return now;
}

static int full_start(reply *now, void *contact, failure *error) {
    ehd_error own = {""};
    full_element *self = contact;
    contact_frame frame = full_frame(self, 1, NAN, 0);
    ehd_status status = self->solver.start(&self->last, self->solver.self, &frame, &own);

    if (!status) load_forecast_start(&self->forecast, &self->last);
    if (!status) *now = full_reply(self);
    return pass(error, status, &own);
}

static int full_step(reply *now, void *contact, double approach, double step, failure *error) {
    ehd_error own = {""};
    full_element *self = contact;
    double load = load_forecast_scale(&self->forecast, step, &self->reference->grid);
    contact_frame frame = full_frame(self, load, approach, step);
    ehd_status status = self->solver.attempt(&self->last, self->solver.self, &frame, step, &own);

    self->last.frame = frame;
    self->last.step = step;
    if (!status) *now = full_reply(self);
    return pass(error, status, &own);
}

static void full_accept(void *contact) {
    full_element *self = contact;

    self->solver.accept(self->solver.self);
    load_forecast_accept(&self->forecast, &self->last);
    self->time = self->last.frame.time;
}

static int full_run(trace *self, const ehd_contact *reference, failure *error) {
    const full_settings settings = full_default_settings();
    full_march *in_time = NULL;
    ehd_error own = {""};
    int status = pass(error, full_march_create(&in_time, reference, &settings, NAN, &own), &own);

    if (!status) {
        full_element contact = {.solver = full_march_solver(in_time), .reference = reference};
        const force_element element = {&contact, full_start, full_step, full_accept};
        status = run(self, &element, error);
    }
    full_march_free(in_time);
    return status;
}

// ---- comparison

static int read_trace(trace *self, const char *path, failure *error) {
    FILE *file = fopen(path, "r");
    size_t count = 0;
    bool good = file && fscanf(file, "%*[^\n]") == 0;

    for (; good && count <= NUM_STEPS; count++) {
        reply *state = &self->states[count];
        good = fscanf(file, "%lf,%lf,%lf,%lf", &self->time[count], &state->approach, &state->force,
                      &state->film) == 4;
    }
    if (file) fclose(file);
    return good ? 0
                : fail(error, EHD_NOINPUT, "%s: found %zu states, expected %d", path, count,
                       NUM_STEPS + 1);
}

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

static int compare(char **paths, failure *error) {
    static trace reduced, full;
    ehd_contact reference;
    const contact_kind *kind;
    ehd_grid grid;
    ehd_error own = {""};
    scene given;
    ehd_status found = scene_read(&given, paths[0], NULL, 0, &own);

    if (!found) found = scene_contact(&reference, &given, &own);
    if (!found) found = grid_of_file(&grid, &kind, paths[1], &own);
    if (!found) contact_take_grid(&reference, &grid);
    int status = pass(error, found, &own);
    if (!status) status = read_trace(&reduced, paths[3], error);
    if (!status) status = full_run(&full, &reference, error);
    if (!status) status = write_trace(&full, paths[2], error);
    if (status) return status;
    print_run("full", &full);
    print_deviations(&reduced, &full);
    return 0;
}

int main(int argc, char **argv) {
    failure error = {0};

    if (argc != 5) {
        fputs("usage: full SCENE.yml MODEL.h5 FULL.csv REDUCED.csv\n", stderr);
        return USAGE;
    }
    const int status = compare(argv + 1, &error);
    if (status) fprintf(stderr, "full: %s\n", error.text);
    return status;
}
