/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The trajectories that a plan trains where it says between which factors load, speed, radius and
 * modulus vary, and not how (schemas/plan.md, Histories). */
#ifndef EHD_DEFAULT_HISTORIES_H
#define EHD_DEFAULT_HISTORIES_H

#include "common/settings/scene_source.h"

#include <stdbool.h>

/* Bounds of the factors, and which kinds of histories. */
typedef struct default_histories {
    size_t num_quantities;
    int quantity[NUM_VARY]; // VARY_LOAD, ...
    double low[NUM_VARY], high[NUM_VARY];
    bool chosen;   // the kinds are; else sines, ramps and the steps of the speed
    bool kinds[3]; // sine, ramp, step
    place where;
} default_histories;

/* Reads `histories` of a group. EHD_DATA. */
ehd_status default_histories_read(default_histories *self, const tree_node *node, const char *path,
                                  ehd_error *error);

/* How many trajectories these are: 0 without any quantity. */
size_t default_histories_count(const default_histories *self);

/* Has a scene vary as one of them, and nothing else of it; it ends at T = 2.5 unless an override
 * says when. EHD_DATA: a bad value, or an override of what varies. */
ehd_status default_histories_apply(const default_histories *self, size_t number,
                                   scene_source *source, ehd_error *error);

/* "load ramp, speed sine" */
void default_histories_show(const default_histories *self, size_t number, char *shown, size_t size);

#endif
