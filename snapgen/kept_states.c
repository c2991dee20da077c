/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "snapgen/kept_states.h"

#include "common/physics/traction.h"

#include <math.h>
#include <string.h>

ehd_status kept_states_init(kept_states *self, size_t num_nodes, size_t num_lines, double end_time,
                            ehd_error *error) {
    arena *memory = &self->memory;

    *self = (kept_states){.num_nodes = num_nodes, .num_lines = num_lines, .end_time = end_time};
    for (size_t i = 0; i < KEPT_EXTREMES; i++)
        self->extremes[i] = -INFINITY;
    for (size_t i = 0; i < NUM_KEPT; i++) {
        kept_state *target = &self->states[i];
        if (num_lines > 0) target->exits = arena_array(memory, num_lines, sizeof *target->exits);
        if (num_nodes == 0) continue;
        target->pressure = arena_array(memory, num_nodes, sizeof(double));
        target->film = arena_array(memory, num_nodes, sizeof(double));
    }
    if (!memory->failed) return EHD_OK;
    kept_states_free(self);
    return ehd_no_memory(error, "trajectory");
}

void kept_states_free(kept_states *self) {
    arena_free(&self->memory);
}

static void keep(kept_states *self, size_t place, const kept_state *state, const double *pressure,
                 const double *film, const size_t *exits) {
    kept_state *target = &self->states[place], own = *target;

    *target = *state;
    target->pressure = own.pressure;
    target->film = own.film;
    target->exits = own.exits;
    if (self->num_nodes > 0) {
        memcpy(own.pressure, pressure, self->num_nodes * sizeof(double));
        memcpy(own.film, film, self->num_nodes * sizeof(double));
    }
    if (self->num_lines > 0) memcpy(own.exits, exits, self->num_lines * sizeof *own.exits);
}

void kept_states_consider(kept_states *self, const march_step *step, const ehd_contact *reference,
                          const double *pressure, const double *film, const size_t *exits) {
    contact_frame frame = frame_of_load(reference->kind, &step->frame, step->scalars.load);
    ehd_contact contact;
    frame_contact(&contact, &frame, reference);
    const frame_rates rates =
        step->step > 0 ? frame_rates_between(&frame, &self->last) : (frame_rates){0};
    self->load_rate = fmax(self->load_rate, rates.load);
    const kept_state state = {.time = step->frame.time,
                              .rate = rates.all,
                              .load_rate = self->load_rate,
                              .moes_M = contact.moes_M,
                              .moes_L = contact.moes_L,
                              .alpha_p_H = contact.alpha_p_H,
                              .thinning = traction_thinning(&contact),
                              .hertz_pressure = contact.hertz_pressure,
                              .rises =
                                  lubricant_rises_at(&contact.lubricant, contact.hertz_pressure),
                              .scalars = step->scalars,
                              .iterations = step->iterations,
                              .residual = step->residual};
    const double place = step->scalars.exit_position;
    const double now[KEPT_EXTREMES] = {
        -state.moes_M, state.moes_M, -state.alpha_p_H, state.alpha_p_H, -place, place, state.rate};

    self->last = frame;
    while (self->num_times < KEPT_TIMES &&
           state.time >= self->end_time * (double)self->num_times / (KEPT_TIMES - 1) * (1 - 1e-12))
        keep(self, self->num_times++, &state, pressure, film, exits);
    for (size_t i = 0; i < KEPT_EXTREMES; i++)
        if (now[i] > self->extremes[i]) {
            self->extremes[i] = now[i];
            keep(self, KEPT_TIMES + i, &state, pressure, film, exits);
        }
}

void kept_states_complete(kept_states *self) {
    for (; self->num_times > 0 && self->num_times < KEPT_TIMES; self->num_times++) {
        const kept_state *last = &self->states[self->num_times - 1];
        keep(self, self->num_times, last, last->pressure, last->film, last->exits);
    }
}
