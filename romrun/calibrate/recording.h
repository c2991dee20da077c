/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Records trajectories of the full model. A reduced model then repeats them with the same time
 * steps (README.md, Calibration and the accuracy dial).
 * Called by validation.c and calibration.c. */
#ifndef EHD_RECORDING_H
#define EHD_RECORDING_H

#include "common/program/program.h"
#include "common/time/march.h"
#include "common/training/training_set.h"
#include "romrun/trust/trained_range.h"
#include <stdbool.h>
#include <stddef.h>

/* An accepted time step. */
typedef struct recorded_step {
    contact_frame frame;      // frame of the solution
    contact_frame load_frame; // frame scaled by the load of the solution
    double step;              // length of the time step; 0 at the start
    bool jump;                // true: the conditions jump after this step
    contact_scalars scalars;  // scalars in the reference frame
} recorded_step;

typedef struct recording {
    const ehd_contact *reference;
    recorded_step *steps; // [num_steps]; the first one is the start
    size_t num_steps, room;
    char reason[MARCH_REASON]; // why the march did not reach its end, or ""
} recording;

void recording_free(recording *self);

/* Runs the trajectories of a set with the full model. If a march does not reach its end, prints
 * a warning and stores the reason. Errors: EHD_INTERRUPTED, EHD_MEMORY, errors of reading
 * histories. */
ehd_status recordings_make(
    // output:
    recording *recordings, // [set->num_trajectories], must be zero before the call; free each
                           // element with recording_free
    // input:
    const program *caller, const training_set *set, size_t num_workers, ehd_error *error);

/* Returns the reason why a step lies outside of the trained range; NULL: all steps lie inside. */
const char *recording_check(const recording *self, const trained_range *range);

#endif
