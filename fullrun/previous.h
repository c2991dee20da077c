/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Carries previous states of the full model over into the current frame (Maier et al. (2015), eq.
 * 15; common/time/README.md), at fixed places or along the path of the fluid. Cubic splines
 * interpolate along the lines of the grid and, on a point contact, from line to line.
 * Called by full_march.c for each step. */
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
    spline **pressure;   // NULL if incompressible: rho H is then the film
    double *filtered;    // [num_nodes] change of the film by the filter
    double *beyond; // [num_nodes of the carrier's wide grid] deflection without H0; the first one
                    // is NaN until all are computed
} previous_state;

/* Memory for carrying states over. */
typedef struct previous_carrier {
    ehd_contact reference;
    double *nodes;           // [width of the grid] X along a line
    double *values;          // [num_nodes] scratch
    double *film, *pressure; // [num_inner] fields of a state, in the current frame
    double *along;     // [lines, inner_x] at X of the current frame and Y of the state's frame
    size_t num_across; // lines of the whole grid with its boundary
    double *lines, *across_values; // [num_across] Y of these lines, and scratch
    spline *across;                // across the lines; NULL on a line contact
    spline **errors;               // [lines] scratch of previous_errors
    ehd_grid wide;       // the grid with `margin` more columns and `side` more lines at each end
    size_t margin, side; // (half grid: lines at one end only)
    ehd_deflection *deflection; // on the wide grid
    arena memory;               // of all arrays
    // for transport along the path:
    path_filter filter;         // of the difference from the start
    const previous_state *base; // the start, which is carried at fixed places; NULL: none yet
    double *base_film;          // [num_nodes] film of the base without a surface at rest
    double base_until;          // T at which the entrainment first reverses; the base's use ends
} previous_carrier;

/* Allocates the memory for states on the reference's grid. Free with previous_carrier_free.
 * Errors: EHD_MEMORY; EHD_DATA: a filter of too many steps. */
ehd_status previous_carrier_init(previous_carrier *self, const ehd_contact *reference,
                                 ehd_error *error);
void previous_carrier_free(previous_carrier *self);

/* Allocates memory and splines for a state on the reference's grid. Free with
 * previous_free. EHD_MEMORY. */
ehd_status previous_init(previous_state *self, const ehd_contact *reference, ehd_error *error);
void previous_free(previous_state *self);

/* Returns the bytes of a carrier and of num_states states. */
double previous_bytes(const ehd_contact *reference, size_t num_states);

/* Sets the base. Only the difference of a state from the base is carried along the path of the
 * fluid; the rows contain the base (common/time/README.md, Along the path). The caller keeps and
 * prepares the base. `until` is the time T up to which it is used, INFINITY if that is not
 * known. */
void previous_set_base(previous_carrier *self, const previous_state *base, double until);

/* Returns the base for a state in a frame, or NULL from the first reversal
 * of the entrainment on. */
const previous_state *previous_base(const previous_carrier *self, const contact_frame *frame);

/* Ends the use of the base if a state that is accepted in this frame has the
 * opposite entrainment. */
void previous_watch_base(previous_carrier *self, const contact_frame *frame);

/* Computes the splines of a state. With transport along the path, filters its film and pressure
 * first. */
void previous_prepare(previous_state *self, previous_carrier *carrier);

/* Computes the splines of a prepared state again, with the fraction `share` of the filter (0 …
 * 1). */
void previous_filter(previous_state *self, double share, previous_carrier *carrier);

/* Interpolates rho H of a previous state at the inner nodes of frame `now`. With transport along
 * the path, it interpolates at the places where the fluid of these nodes was. If the contact has
 * grown or fluid comes from outside, some places lie beyond the state's grid. There P is zero, and
 * gap and deflection are evaluated. */
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
