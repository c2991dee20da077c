/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes the trajectories of a plan that gives only bounds for the factors of load, speed, radius
 * and modulus, and no histories (schemas/plan.md, Histories). */
#ifndef EHD_DEFAULT_HISTORIES_H
#define EHD_DEFAULT_HISTORIES_H

#include "common/settings/scene_source.h"

#include <stdbool.h>

/* Bounds of the factors, and the kinds of histories. */
typedef struct default_histories {
    size_t num_quantities;
    int quantity[NUM_VARY]; // VARY_LOAD, ...
    double low[NUM_VARY], high[NUM_VARY];
    bool chosen;   // whether the plan gives the kinds; false: sines and ramps of all quantities,
                   // and steps of the speed
    bool kinds[3]; // sine, ramp, step
    place where;
} default_histories;

/* Reads `histories` of a group. Returns EHD_DATA for bad values. */
ehd_status default_histories_read(default_histories *self, const tree_node *node, const char *path,
                                  ehd_error *error);

/* Returns the number of trajectories; 0 without any quantity. */
size_t default_histories_count(const default_histories *self);

/* Replaces all histories of a scene by the histories of trajectory `number`. The run ends at T =
 * 2.5 unless an override gives the end. Returns EHD_DATA for a bad value, for a regime other than
 * transient, and for an override of a history. */
ehd_status default_histories_apply(const default_histories *self, size_t number,
                                   scene_source *source, ehd_error *error);

/* Writes the histories of trajectory `number`: "load ramp, speed sine". */
void default_histories_show(const default_histories *self, size_t number, char *shown, size_t size);

#endif
