/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Transforms previous states of the full model to the current moving frame (Maier et al. (2015),
 * eq. 15; common/time/README.md), at fixed places or along the path of the fluid. Cubic splines
 * interpolate along the lines of the grid and, on a point contact, from line to line.
 * Called by full_march.c for each time step. */
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
    spline **deflection; // [num_lines] splines of film minus gap, along each line
    spline **pressure;   // [num_lines] splines of the pressure; NULL: incompressible lubricant
    double *filtered;    // [num_nodes] change of the film that the path filter causes
    double *beyond;      // [nodes of carrier->wide] deflection without H0; beyond[0] is NaN until
                         // the array is computed
} previous_state;

/* Memory for transforming states to the current frame. */
typedef struct previous_carrier {
    ehd_contact reference;
    double *nodes;           // [width of the grid] X of the nodes on a line
    double *values;          // [num_nodes] scratch
    double *film, *pressure; // [num_inner] fields of a state, in the current frame
    double *along;           // [lines, inner_x] field interpolated only along the lines: at X of
                             // the current frame, but Y of the state's frame
    size_t num_across;       // number of lines of the full grid (grid_whole), with boundary lines
    // [num_across]. lines: Y of the lines of the full grid; across_values: scratch
    double *lines, *across_values;
    spline *across;             // spline across the lines; NULL on a line contact
    spline **errors;            // [lines] scratch of previous_errors
    ehd_grid wide;              // the grid with a margin around it
    size_t margin, side;        // columns and lines added at each end (half grid: lines at one end)
    ehd_deflection *deflection; // on the wide grid
    arena memory;               // memory of all arrays
    // for transport along the path:
    path_filter filter;         // filter of the difference between a state and the base
    const previous_state *base; // initial state, which stays at fixed X; NULL: not set yet
    double *base_film;          // [num_nodes] film of the base minus heights of a surface at rest
    double base_until;          // T at which the entrainment first reverses. The base is
                                // used only before this time
} previous_carrier;

/* Allocates the memory for states on the reference's grid. Free with previous_carrier_free.
 * Errors: EHD_MEMORY; EHD_DATA: the filter is too many grid steps long. */
ehd_status previous_carrier_init(previous_carrier *self, const ehd_contact *reference,
                                 ehd_error *error);
void previous_carrier_free(previous_carrier *self);

/* Allocates a state on the reference's grid. Free it with previous_free. Error: EHD_MEMORY. */
ehd_status previous_init(previous_state *self, const ehd_contact *reference, ehd_error *error);
void previous_free(previous_state *self);

/* Returns the bytes of a carrier and of num_states states. */
double previous_bytes(const ehd_contact *reference, size_t num_states);

/* Prepares and sets the base, the initial state of the march. Only the difference of a state from
 * the base is carried along the path of the fluid. The Reynolds rows contain the entrainment of the
 * base (common/time/README.md, Along the path). The caller owns the base. */
void previous_set_base(previous_carrier *self, previous_state *base);

/* Returns the base for a state in a frame; NULL from the first reversal of the entrainment on. */
const previous_state *previous_base(const previous_carrier *self, const contact_frame *frame);

/* Ends the use of the base if the entrainment of this frame is opposite to the entrainment of the
 * base. Must be called with the frame of each accepted state. */
void previous_watch_base(previous_carrier *self, const contact_frame *frame);

/* Computes a state's splines. With transport along the path, film and pressure are filtered first:
 * the fraction `share` (0 … 1) of the change that the filter causes is applied. */
void previous_prepare(previous_state *self, double share, previous_carrier *carrier);

/* Interpolates rho H of a previous state at the inner nodes of frame `now`. With transport along
 * the path, interpolates at the places where the fluid of these nodes was at the time of the
 * previous state. If the contact has grown or fluid comes from outside, some places lie beyond the
 * state's grid. At these places P is taken as zero, and the film is computed from gap and
 * deflection. */
void previous_mass(
    // output:
    double *mass, // [num_inner]
    // input:
    const previous_state *self, const contact_frame *now, previous_carrier *carrier);

/* Carries errors of rho H along with the fluid, from the nodes of frame `then` to the inner nodes
 * of frame `now`. The errors are zero where the fluid comes from beyond the grid. */
void previous_errors(
    // output:
    double *carried, // [num_inner]
    // input:
    const double *errors, // [num_nodes]
    const contact_frame *then, const contact_frame *now, previous_carrier *carrier);

#endif
