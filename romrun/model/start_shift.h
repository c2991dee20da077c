/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes starts with a single spike (romrun/solve/README.md, Spikes). A weighted sum of
 * pressures whose spikes lie at different places has many small spikes. Here the pressures are
 * added along a coordinate that puts all spikes at the same place: 0 at X = 0, 1 at the spike, and
 * from there on in half widths.
 * Called by reduced_model.c when a model is completed, and by guess.c for each start. */
#ifndef EHD_START_SHIFT_H
#define EHD_START_SHIFT_H

#include "romrun/model/reduced_model.h"

/* Fills model->shift from the states and from the bases at the needed nodes. Point contacts and
 * independent bases have no shift: with an independent basis, the deflection would have to follow
 * the shifted pressure. EHD_MEMORY. */
ehd_status start_shift_build(reduced_model *model, ehd_error *error);

/* Changes the coordinates of a weighted sum of states. The new coordinates fit the sum with aligned
 * spikes, by least squares at the needed nodes. */
void start_shift_apply(
    // in and out:
    double *coordinates, // [num_pressure]
    // input:
    const reduced_model *model, const size_t *states, // [count]
    const double *weights,                            // [count], with sum 1
    size_t count);

#endif
