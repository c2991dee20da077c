/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes initial states with a single pressure spike (romrun/solve/README.md, Spikes). A weighted
 * sum of pressures whose spikes lie at different places has many small spikes. Here the pressures
 * are added along a coordinate in which all spikes lie at the same place. Between X = 0 and the
 * spike, the coordinate is X divided by the X of the spike. Behind the spike it is 1 plus the
 * distance from the spike in half widths.
 * Called by reduced_model.c when a model is completed, and by guess.c for each initial state. */
#ifndef EHD_START_SHIFT_H
#define EHD_START_SHIFT_H

#include "romrun/model/reduced_model.h"

/* Fills model->shift from the states and from the bases at the needed nodes. Point contacts and
 * independent bases have no shift: with an independent basis, the deflection would have to follow
 * the shifted pressure. Errors: EHD_MEMORY. */
ehd_status start_shift_build(reduced_model *model, ehd_error *error);

/* Changes the coordinates of the pressure modes in a weighted sum of training states. With the new
 * coordinates the pressure fits the sum with aligned spikes, by least squares at the needed
 * nodes. */
void start_shift_apply(
    // in and out:
    double *coordinates, // [num_pressure]
    // input:
    const reduced_model *model, const size_t *states, // [count]
    const double *weights,                            // [count], with sum 1
    size_t count);

#endif
