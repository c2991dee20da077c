/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chooses the states of a trajectory that are stored uncompressed: the states at regular times
 * (KEPT_TIMES equally spaced points in time), and the states at which a quantity that limits the
 * trained range is extreme. The number of these states does not depend on the number of time steps.
 * All other states are only stored in compressed form (README.md, Training).
 * Called by trajectory.c for each step. */
#ifndef EHD_KEPT_STATES_H
#define EHD_KEPT_STATES_H

#include "common/physics/traction.h"
#include "common/program/arena.h"
#include "common/time/march.h"

enum {
    KEPT_TIMES = 64,
    KEPT_EXTREMES = 7, // smallest and largest M, alpha p_H, exit; largest rate
    NUM_KEPT = KEPT_TIMES + KEPT_EXTREMES
};

typedef struct kept_state {
    double time;
    double rate;      // rate of change of the contact (member `all` of frame_rates)
    double load_rate; // largest rate of the load on the trajectory so far
    double moes_M, moes_L, alpha_p_H, hertz_pressure;
    flow_thinning thinning;
    lubricant_rises rises;
    contact_scalars scalars; // in the current frame
    size_t iterations;
    double residual;
    double *pressure, *film; // [num_nodes], NULL if no fields are kept
    size_t *exits;           // [num_lines] as in reduced_state_exits, NULL if none are kept
} kept_state;

typedef struct kept_states {
    size_t num_nodes; // nodes of the fields; 0: no fields are kept
    size_t num_lines; // lines of the exits; 0: no exits are kept
    double end_time;
    size_t num_times; // number of regular times reached so far
    double extremes[KEPT_EXTREMES];
    double load_rate;            // largest rate of the load so far
    contact_frame last;          // frame of the last step
    kept_state states[NUM_KEPT]; // the first one is the start
    arena memory;
} kept_states;

/* Allocates memory for the kept states of a trajectory up to end_time (T). EHD_MEMORY. */
ehd_status kept_states_init(kept_states *self, size_t num_nodes, size_t num_lines, double end_time,
                            ehd_error *error); // free with kept_states_free
void kept_states_free(kept_states *self);

/* Keeps the state of an accepted step if the step reaches a regular time, or if a quantity has a
 * new extreme value. Steps come in order of time. Arrays that are not kept may be NULL. */
void kept_states_consider(kept_states *self, const march_step *step, const ehd_contact *reference,
                          const double *pressure, const double *film, const size_t *exits);

/* For the regular times that a march did not reach, stores the state of the last regular time that
 * it reached. */
void kept_states_complete(kept_states *self);

#endif
