/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the histories of a scene: load, speed, radius, modulus and approach as functions of
 * time (README.md, Histories; sine: eq. 41 of Maier et al. 2015).
 * Called by march.c for each time, by time_grid.c, and by fullrun/formulas.c. */
#ifndef EHD_HISTORY_H
#define EHD_HISTORY_H

#include "common/program/status.h"
#include "common/settings/scene.h"
#include <stdbool.h>

/* Histories are read-only once they are made, so that threads can share them. */
typedef struct ehd_histories ehd_histories;

/* Reads the tables of a valid scene, converts their units to T and to factors, and checks all
 * histories on 0 <= T <= end_time. The histories
 * of a stationary scene are constant. EHD_DATA or EHD_NOINPUT: a table is missing, unreadable, too
 * short, not finite, not increasing in time, or does not cover the time. EHD_DATA: radius or
 * modulus is not above 0 somewhere, the load is below 0, or the speed is below 0 and `transport` is
 * not `path`. EHD_MEMORY. Reads HDF5, so only one call at a time (artefact.h). */
ehd_status histories_init(
    // output:
    ehd_histories **self, // free with histories_free; NULL after a failure
    // input:
    const scene *given, ehd_error *error);

/* Reads histories like histories_init, for a reduced model, which is trained for one direction of
 * entrainment. Also returns EHD_DATA if the speed or the speed of the start is below 0. */
ehd_status histories_init_forward(
    // output:
    ehd_histories **self,
    // input:
    const scene *given, ehd_error *error);

/* Reads histories like histories_init_forward. Also returns EHD_DATA if the load is 0, because no
 * reduced model is trained on bodies that are apart. */
ehd_status histories_init_training(
    // output:
    ehd_histories **self,
    // input:
    const scene *given, ehd_error *error);

/* Checks whether the speed is below 0 at any time, or the speed of the start is below 0. */
bool histories_reverse(const ehd_histories *self);

/* Returns the name of a table without units in a scene in SI units, or NULL. Its values were taken
 * as factors, or its times as T. */
const char *histories_without_unit(const ehd_histories *self);

/* Checks whether a table has its times in seconds. */
bool histories_in_seconds(const ehd_histories *self);

/* Frees `self`, which may be NULL. Returns NULL. */
ehd_histories *histories_free(ehd_histories *self);

/* Computes the factors on the reference values at T = `time`. The factors are continuous from the
 * left: at a jump they still have the value before the jump. A time step that ends at a jump
 * therefore does not contain the jump. */
void histories_at(
    // output:
    double value[NUM_VARY], // indexed by VARY_LOAD, …
    // input:
    const ehd_histories *self, double time);

/* Returns the speed of the stationary film from which the march starts. It is the speed of the
 * history at T = 0, unless the scene gives transient.start_speed. */
double histories_start_speed(const ehd_histories *self);

/* Returns the integral of the speed from T = 0 to `time`: the path of the fluid, in reference half
 * widths. */
double histories_path(const ehd_histories *self, double time);

/* Returns the first time after `time` at which some history has a kink or jumps. INFINITY: there is
 * no such time. */
double histories_next_kink(
    // input:
    const ehd_histories *self, double time,
    // output:
    bool *jump); // whether some history jumps at this time

/* Returns the shortest time scale of all histories, for the length of the first step: a period
 * divided by 2 pi, the duration of a ramp, or the smallest interval between the times of a table.
 * INFINITY: all histories are constant or only jump. */
double histories_shortest_time(const ehd_histories *self);

/* Returns the shortest time scale of the histories that have no kinks, such as sines and splines.
 * All other histories are monotone between kinks, and a step ends at each kink. INFINITY: all
 * histories are constant or have kinks. */
double histories_smooth_time(const ehd_histories *self);

#endif
