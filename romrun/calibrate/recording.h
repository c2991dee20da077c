/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Trajectories of the full model, recorded for a reduced model to repeat with the same steps. */
#ifndef EHD_RECORDING_H
#define EHD_RECORDING_H

#include "common/program/program.h"
#include "common/time/march.h"
#include "common/training/training_set.h"
#include "romrun/online/trained_range.h"
#include <stdbool.h>
#include <stddef.h>

/* An accepted step. */
typedef struct recorded_step {
    contact_frame frame;      // solved in
    contact_frame load_frame; // scaled by the load of the solution
    double step;              // 0 at the start
    bool jump;                // conditions jump after it
    contact_scalars scalars;  // in the reference frame
} recorded_step;

typedef struct recording {
    const ehd_contact *reference;
    recorded_step *steps; // [num_steps], the first is the start
    size_t num_steps, room;
    char reason[MARCH_REASON]; // why it did not reach its end, or ""
} recording;

void recording_free(recording *self);

/* Runs the trajectories of a set with the full model. One that does not reach its end gets a
 * warning and a reason. EHD_INTERRUPTED, EHD_MEMORY, errors of reading histories. */
ehd_status recordings_make(
    // output:
    recording *recordings, // [set->num_trajectories], zero before; free each with recording_free
    // input:
    const program *caller, const training_set *set, size_t num_workers, ehd_error *error);

/* Why a step lies outside of a model's trained range in M and alpha p_H, or NULL. */
const char *recording_check(const recording *self, const trained_range *range);

#endif
