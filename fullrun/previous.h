/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Previous states of the full model, carried over into the current frame (Maier et al. (2015),
 * eq. 15; common/time/README.md) by cubic splines along the grid's lines and, of a point contact,
 * from line to line; at fixed places, or along the path of the fluid. */
#ifndef EHD_PREVIOUS_H
#define EHD_PREVIOUS_H

#include "common/algebra/spline.h"
#include "common/program/arena.h"
#include "common/time/frame.h"
#include "common/time/path_filter.h"
#include "fullrun/full_solver.h"

typedef struct previous_state {
    contact_frame frame;
    full_state state;
    size_t num_lines;
    spline **deflection; // [num_lines] film without gap, along each line
    spline **pressure;   // NULL when incompressible: rho H is then the film
    double share;        // of the filter that the splines have had (frame_step_share)
    double *filtered;    // [num_nodes] what that changed of the film
    double *beyond; // [num_nodes of the carrier's wide grid] deflection without H0; the first one
                    // is NaN while it is not known
} previous_state;

/* Memory for carrying states over. */
typedef struct previous_carrier {
    ehd_contact reference;
    double *nodes;           // [width of the grid] X along a line
    double *values;          // [num_nodes] scratch
    double *film, *pressure; // [num_inner] of a state, in the current frame
    double *along;           // [lines, inner_x] with X in the current frame and Y in the state's
    size_t num_across;       // lines of the whole grid with its boundary
    double *lines, *across_values; // [num_across] their Y, and scratch
    spline *across;                // NULL on a line contact
    spline **errors;               // [lines] of previous_errors
    ehd_grid wide;                 // the grid, with `margin` columns and `side` lines around it
    size_t margin, side;           // (of a half grid lines on the one side)
    ehd_deflection *deflection;    // on the wide grid
    arena memory;                  // of all arrays
    // along the path:
    path_filter filter;         // of what differs from the start
    const previous_state *base; // the start, which is carried at fixed places; NULL: none yet
    double *base_film;          // [num_nodes] its film without a surface that rests
    double base_until;          // T from which on none is: where the entrainment first reversed
} previous_carrier;

/* EHD_MEMORY. */
ehd_status previous_carrier_init(previous_carrier *self, const ehd_contact *reference,
                                 ehd_error *error);
void previous_carrier_free(previous_carrier *self);

/* Memory and splines for a state on the reference's grid. EHD_MEMORY. */
ehd_status previous_init(previous_state *self, const ehd_contact *reference, ehd_error *error);
void previous_free(previous_state *self);

/* Bytes of a carrier and of num_states states. */
double previous_bytes(const ehd_contact *reference, size_t num_states);

/* States are carried along the path of the fluid, but for what they have in common with `base`, which
 * the caller keeps and has prepared: that the rows carry (common/time/README.md). `until`: the time
 * up to which they do, INFINITY where that is not known. */
void previous_set_base(previous_carrier *self, const previous_state *base, double until);

/* The base of a state in a frame: NULL from the first reversal of the entrainment on. */
const previous_state *previous_base(const previous_carrier *self, const contact_frame *frame);

/* A state in this frame is accepted: with one of the other direction the base is done with. */
void previous_watch_base(previous_carrier *self, const contact_frame *frame);

/* Makes the splines of a state that is set. Along the path its film and pressure are filtered. */
void previous_prepare(previous_state *self, previous_carrier *carrier);

/* Makes the splines of a prepared state again with another share of the filter. */
void previous_filter(previous_state *self, double share, previous_carrier *carrier);

/* rho H of a previous state at the inner nodes of frame `now`, or where the fluid was that is there
 * now. Beyond the state's grid, where a contact that has grown has nodes and where fluid comes from,
 * P is zero and gap and deflection are evaluated. */
void previous_mass(
    // output:
    double *mass, // [num_inner]
    // input:
    const previous_state *self, const contact_frame *now, previous_carrier *carrier);

/* Carries errors of rho H along with the fluid: from the nodes of frame `then` to the inner nodes of frame `now`; zero where the
 * fluid comes from beyond the grid. */
void previous_errors(
    // output:
    double *carried, // [num_inner]
    // input:
    const double *errors, // [num_nodes]
    const contact_frame *then, const contact_frame *now, previous_carrier *carrier);

#endif
