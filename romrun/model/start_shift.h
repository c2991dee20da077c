/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Starts whose spikes lie where the contact's should. A weighted sum of pressures whose spikes lie
 * at different places has as many small ones. Here the pressures are added along a coordinate in
 * which the spikes lie at the same place: 0 at X = 0, 1 at the spike, and from there on in half
 * widths. */
#ifndef EHD_START_SHIFT_H
#define EHD_START_SHIFT_H

#include "romrun/model/reduced_model.h"

/* Fills model->shift from the states and the bases at the needed nodes. Point contacts have none, nor
 * has an independent basis, whose deflection would have to follow. EHD_MEMORY. */
ehd_status start_shift_build(reduced_model *model, ehd_error *error);

/* Changes the coordinates of a weighted sum of states to those of the sum along the coordinate
 * above, by least squares at the needed nodes. */
void start_shift_apply(
    // in and out:
    double *coordinates, // [num_pressure]
    // input:
    const reduced_model *model, const size_t *states, // [count]
    const double *weights,                            // [count] of sum 1
    size_t count);

#endif
