/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/unit/marched.h"

#include "common/settings/scene_contact.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static ehd_status store(void *sink, const march_step *step, size_t index, ehd_error *error) {
    marched *self = sink;
    contact_scalars scalars = frame_to_reference(&step->scalars, &step->frame, &self->reference);

    assert_int_equal(index, self->count);
    assert_true(self->count < MARCHED_STEPS);
    assert_int_equal(step->status, EHD_OK);
    self->time[index] = step->frame.time;
    self->film[index] = scalars.central_film_thickness;
    self->least_film[index] = scalars.minimum_film_thickness;
    self->pressure[index] = scalars.central_pressure;
    self->approach[index] = scalars.rigid_approach;
    self->load[index] = scalars.load;
    self->exit[index] = scalars.exit_position;
    self->effect[index] = step->effect;
    self->effect_minimum[index] = step->effect_minimum;
    self->count++;
    return index > 0 && index == self->stop_at ? ehd_fail(error, EHD_INTERRUPTED, "stopped")
                                               : EHD_OK;
}

static scene scene_of(const char *contact, double moes_M, double moes_L, const char *density,
                      const char *grid, const char *transient) {
    char text[2048];
    scene of;
    ehd_error error = {""};

    snprintf(text, sizeof text,
             "contact: %s\nregime: transient\ntransport: upwind\nclosure: %s\nmoes: {M: %.17g, L: "
             "%.17g}\n"
             "lubricant: {viscosity: {law: barus, alpha: 2e-8}, density: {law: %s}}\n"
             "grid: {%s}\ntransient: {%s}\n",
             contact, strstr(transient, "approach:") ? "approach" : "load", moes_M, moes_L, density,
             grid, transient);
    if (scene_parse(&of, text, strlen(text), "s.yml", NULL, 0, &error)) fail_msg("%s", error.text);
    return of;
}

scene marched_scene(double moes_M, double moes_L, const char *density, double step,
                    const char *transient) {
    char grid[128];

    snprintf(grid, sizeof grid, "x_min: -4, x_max: 2, step: %.17g", step);
    return scene_of("line", moes_M, moes_L, density, grid, transient);
}

scene marched_point(const char *transient) {
    return scene_of("point", 20, 5, "dowson-higginson",
                    "x_min: -3, x_max: 1.5, step: 0.125, y_max: 2, half: true", transient);
}

void marched_begin(marched *self, const scene *of) {
    full_settings settings = full_default_settings();
    ehd_error error = {""};

    memset(self, 0, sizeof *self);
    self->scene = *of;
    settings.tolerance = 1e-12;
    settings.linear_tolerance = 1e-10;
    if (scene_contact(&self->reference, of, &error) ||
        histories_init(&self->histories, of, &error) ||
        surface_init(&self->surface, of, &self->reference, &error))
        fail_msg("%s", error.text);
    self->reference.surface = self->surface;
    if (full_march_create(&self->full, &self->reference, &settings, of->transient.start_film,
                          &error))
        fail_msg("%s", error.text);
    self->march = (march){.settings = march_settings_of(of, self->histories, of->approach),
                          .histories = self->histories,
                          .reference = &self->reference,
                          .solver = full_march_solver(self->full),
                          .store = store,
                          .sink = self};
    if (march_begin(&self->first, &self->march, &error)) fail_msg("%s", error.text);
    if (self->first.status) fail_msg("start: %s", self->first.reason);
    assert_int_equal(store(self, &self->first, 0, &error), EHD_OK);
}

void marched_on(marched *self) {
    ehd_error error = {""};
    ehd_status status = march_run(&self->outcome, &self->march, &error);

    if (status && !self->stop_at) fail_msg("status %d: %s", status, error.text);
}

void marched_end(marched *self) {
    full_march_free(self->full);
    histories_free(self->histories);
    surface_free(self->surface);
}

void marched_all(marched *self, const scene *of) {
    marched_begin(self, of);
    marched_on(self);
    if (self->outcome) fail_msg("%s", self->march.reason);
    check_close(self->time[self->count - 1], of->transient.end_time, 0, 0);
}

void marched_check_restored(marched *other, const marched *stopped, const double *saved,
                            const marched *whole) {
    const size_t from = stopped->count, bytes = (whole->count - from) * sizeof(double);
    ehd_error error = {""};

    marched_begin(other, &whole->scene);
    const march_solver *solver = &other->march.solver;
    if (solver->restore(solver->self, saved, &error)) fail_msg("%s", error.text);
    other->march.state = stopped->march.state;
    other->count = from;
    marched_on(other);
    assert_int_equal(other->count, whole->count);
    assert_memory_equal(other->time + from, whole->time + from, bytes);
    assert_memory_equal(other->film + from, whole->film + from, bytes);
    assert_memory_equal(other->approach + from, whole->approach + from, bytes);
    assert_memory_equal(other->exit + from, whole->exit + from, bytes);
    assert_memory_equal(other->effect + from, whole->effect + from, bytes);
    marched_end(other);
}

/* Returns the central film of a run at any time, by linear interpolation between its steps. */
static double film_between(const marched *self, double time) {
    size_t k = 1;

    while (k + 1 < self->count && self->time[k] < time)
        k++;
    double part = (time - self->time[k - 1]) / (self->time[k] - self->time[k - 1]);
    return self->film[k - 1] * (1 - part) + self->film[k] * part;
}

double marched_deviation(const marched *self, const marched *from) {
    double largest = 0;

    for (size_t k = 0; k < self->count; k++)
        largest = fmax(largest, fabs(self->film[k] / film_between(from, self->time[k]) - 1));
    return largest;
}
