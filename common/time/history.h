/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Histories: how load, speed, radius, modulus and approach vary in time, as a scene says. */
#ifndef EHD_HISTORY_H
#define EHD_HISTORY_H

#include "common/program/status.h"
#include "common/settings/scene.h"
#include <stdbool.h>

/* Read-only once it is made, so that threads can share it. */
typedef struct ehd_histories ehd_histories;

/* Reads tables and checks all histories on 0 <= T <= end_time of a valid scene; those of a
 * stationary scene are constant. EHD_DATA or EHD_NOINPUT: a table that is missing, unreadable, too
 * short, not finite, not increasing in time or does not cover the time; radius or modulus not above 0
 * somewhere, load below 0, or speed below 0 where films are not carried along their paths. EHD_MEMORY.
 * Reads HDF5, so only one at a time (artefact.h). */
ehd_status histories_init(
    // output:
    ehd_histories **self, // free with histories_free; NULL after a failure
    // input:
    const scene *given, ehd_error *error);

/* The same for a reduced model, which is trained on one direction: EHD_DATA also where the speed, or
 * that of the start, is below 0. */
ehd_status histories_init_forward(
    // output:
    ehd_histories **self,
    // input:
    const scene *given, ehd_error *error);

/* Like histories_init_forward, but EHD_DATA also where the load is 0, because training has no lost contacts. */
ehd_status histories_init_training(
    // output:
    ehd_histories **self,
    // input:
    const scene *given, ehd_error *error);

/* Whether the speed or that of the start is below 0 somewhere. */
bool histories_reverse(const ehd_histories *self);

/* Accepts and returns NULL. */
ehd_histories *histories_free(ehd_histories *self);

/* Factors on the reference values at T = `time`. Continuous from the left: at a jump still the
 * value before it, so that a time step that ends there does not see it. */
void histories_at(
    // output:
    double value[NUM_VARY], // by VARY_LOAD, …
    // input:
    const ehd_histories *self, double time);

/* Speed whose stationary film is the start: that of the history unless the scene says another. */
double histories_start_speed(const ehd_histories *self);

/* Integral of the speed from T = 0 to `time`: the path of the fluid, in reference half widths. */
double histories_path(const ehd_histories *self, double time);

/* The first time after `time` at which some history has a kink or jumps, INFINITY if none does. */
double histories_next_kink(
    // input:
    const ehd_histories *self, double time,
    // output:
    bool *jump); // whether some history jumps there

/* The shortest time scale of all, for a sensible first step: a period / 2 pi, the duration of a
 * ramp or the smallest distance of a table's times; INFINITY when nothing varies smoothly. */
double histories_shortest_time(const ehd_histories *self);

#endif
