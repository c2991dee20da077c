/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "snapgen/kept_states.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

ehd_status kept_states_init(kept_states *self, size_t num_nodes, double end_time,
                            ehd_error *error) {
    memset(self, 0, sizeof *self);
    self->num_nodes = num_nodes;
    self->end_time = end_time;
    for (size_t i = 0; i < KEPT_EXTREMES; i++)
        self->extremes[i] = -INFINITY;
    for (size_t i = 0; i < NUM_KEPT && num_nodes > 0; i++) {
        self->states[i].pressure = malloc(num_nodes * sizeof(double));
        self->states[i].film = malloc(num_nodes * sizeof(double));
        if (!self->states[i].pressure || !self->states[i].film) {
            kept_states_free(self);
            return ehd_fail(error, EHD_MEMORY, "trajectory: found no memory for its states");
        }
    }
    return EHD_OK;
}

void kept_states_free(kept_states *self) {
    for (size_t i = 0; i < NUM_KEPT; i++) {
        free(self->states[i].pressure);
        free(self->states[i].film);
        self->states[i].pressure = self->states[i].film = NULL;
    }
}

static void keep(kept_states *self, size_t place, const kept_state *state, const double *pressure,
                 const double *film) {
    kept_state *target = &self->states[place];
    double *own_pressure = target->pressure, *own_film = target->film;

    *target = *state;
    target->pressure = own_pressure;
    target->film = own_film;
    if (self->num_nodes == 0) return;
    memcpy(own_pressure, pressure, self->num_nodes * sizeof(double));
    memcpy(own_film, film, self->num_nodes * sizeof(double));
}

void kept_states_consider(kept_states *self, const march_step *step, const ehd_contact *reference,
                          size_t exit, const double *pressure, const double *film) {
    contact_frame frame = frame_of_load(reference->kind, &step->frame, step->scalars.load);
    ehd_contact contact;
    frame_contact(&contact, &frame, reference);
    const kept_state state = {.time = step->frame.time,
                              .rate = step->step > 0 ? frame_rate(&frame, &self->last) : 0,
                              .moes_M = contact.moes_M,
                              .moes_L = contact.moes_L,
                              .alpha_p_H = contact.alpha_p_H,
                              .hertz_pressure = contact.hertz_pressure,
                              .scalars = step->scalars,
                              .exit = exit,
                              .iterations = step->iterations,
                              .residual = step->residual};
    const double place = (double)exit;
    const double now[KEPT_EXTREMES] = {
        -state.moes_M, state.moes_M, -state.alpha_p_H, state.alpha_p_H, -place, place, state.rate};

    self->last = frame;
    while (self->num_times < KEPT_TIMES &&
           state.time >= self->end_time * (double)self->num_times / (KEPT_TIMES - 1) * (1 - 1e-12))
        keep(self, self->num_times++, &state, pressure, film);
    for (size_t i = 0; i < KEPT_EXTREMES; i++)
        if (now[i] > self->extremes[i]) {
            self->extremes[i] = now[i];
            keep(self, KEPT_TIMES + i, &state, pressure, film);
        }
}

void kept_states_complete(kept_states *self) {
    for (; self->num_times > 0 && self->num_times < KEPT_TIMES; self->num_times++) {
        const kept_state *last = &self->states[self->num_times - 1];
        keep(self, self->num_times, last, last->pressure, last->film);
    }
}
