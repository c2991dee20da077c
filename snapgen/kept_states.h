/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The few states of a trajectory that are kept as such, however many steps it has: at regular
 * times, and where a quantity that limits the trained range is extreme. All others live on in
 * compressed form. */
#ifndef EHD_KEPT_STATES_H
#define EHD_KEPT_STATES_H

#include "common/physics/traction.h"
#include "common/time/march.h"
#include <stdbool.h>

enum {
    KEPT_TIMES = 64,
    KEPT_EXTREMES = 7, // smallest and largest M, alpha p_H, exit; largest rate
    NUM_KEPT = KEPT_TIMES + KEPT_EXTREMES
};

typedef struct kept_state {
    double time;
    double rate;      // of change of the contact, of all (frame_rates)
    double load_rate; // largest of the load on the trajectory so far
    double moes_M, moes_L, alpha_p_H, hertz_pressure;
    flow_thinning thinning;
    lubricant_rises rises;
    contact_scalars scalars; // in the current frame
    size_t iterations;
    double residual;
    double *pressure, *film; // [num_nodes], NULL where no fields are kept
    size_t *exits;           // [num_lines] as reduced_states have them, NULL where none are kept
} kept_state;

typedef struct kept_states {
    size_t num_nodes; // of the fields; 0: none are kept
    size_t num_lines; // of the exits; 0: none are kept
    double end_time;
    size_t num_times; // regular ones so far
    double extremes[KEPT_EXTREMES];
    double load_rate; // largest so far
    contact_frame last;
    kept_state states[NUM_KEPT]; // the first one is the start
} kept_states;

/* Memory for the states of a trajectory that are kept, up to end_time (T). EHD_MEMORY. */
ehd_status kept_states_init(kept_states *self, size_t num_nodes, size_t num_lines, double end_time,
                            ehd_error *error); // free with kept_states_free
void kept_states_free(kept_states *self);

/* Looks at an accepted step, in order of time. What is not kept may be NULL. */
void kept_states_consider(kept_states *self, const march_step *step, const ehd_contact *reference,
                          const double *pressure, const double *film, const size_t *exits);

/* Fills the places that a march of few steps left empty with its last state. */
void kept_states_complete(kept_states *self);

#endif
