/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the moving frame of a contact that varies with time. All quantities are scaled by the
 * current contact size and Hertz pressure. Only time is scaled by the reference (Maier et al. 2015,
 * eq. 6; README.md, The moving frame).
 * Called by march.c for each time, and by the full and the reduced model to carry states from frame
 * to frame. */
#ifndef EHD_FRAME_H
#define EHD_FRAME_H

#include "common/physics/traction.h"
#include <stdbool.h>

/* Conditions and scales of the contact at one time, relative to the reference. */
typedef struct contact_frame {
    double time;  // T = u_ref t / a_ref
    double load;  // load that scales the frame: the given load, or an estimate of the load
    double speed; // entrainment, positive or negative
    double radius;
    double modulus;
    double approach;       // given H0, in the reference frame; NaN: the load is given
    double half_width;     // a / a_ref
    double hertz_pressure; // p_H / p_H,ref
    double film_scale;     // (a^2 / R) / (a_ref^2 / R_ref)
    double path;           // path of the fluid, int u/u_ref dT, in reference half widths
} contact_frame;

/* Number of doubles in a frame. All members of a frame are doubles. */
enum { NUM_FRAME = sizeof(contact_frame) / sizeof(double) };
_Static_assert(sizeof(contact_frame) == NUM_FRAME * sizeof(double), "a frame is doubles alone");

/* Returns the frame at a time. `values` are load, speed, radius and modulus (VARY_… of scene.h)
 * relative to the reference. `approach` is NaN if the load is given. The path is left at zero. */
contact_frame frame_at(const contact_kind *kind, double time, const double *values,
                       double approach);

/* Checks whether a frame that was read from a file may be a result of frame_at. */
bool frame_is_valid(const contact_frame *frame);

/* Sets the contact in the frame from the reference contact: lambda, Hertz pressure, U, Moes
 * numbers, closure. Moes M is the same for both directions of a speed. It would grow without bound
 * as the speed goes to zero, so it is limited to 1e5. */
void frame_contact(
    // output:
    ehd_contact *contact,
    // input:
    const contact_frame *frame, const ehd_contact *reference);

/* Returns the ratio of X in frame `then` to X in frame `now`, for the same physical place. */
double frame_stretch(const contact_frame *now, const contact_frame *then);
/* Returns the largest relative growth of the half width from one step to the next for which films
 * of previous states are known beyond the grid: the growth under 2.25 times the load. The half
 * width of a line contact then grows by 0.5, that of a point contact by 0.31. */
double frame_most_growth(const contact_kind *kind, const contact_shape *shape);
/* Returns the ratio of the film in frame `now` to the film in frame `then`, for the same physical
 * film. */
double frame_film_ratio(const contact_frame *now, const contact_frame *then);

/* Returns the shift of the fluid between two frames, computed from the path that the fluid has
 * travelled. The fluid that is at X in frame `now` was at X' = stretch X - shift in frame `then`,
 * with stretch from frame_stretch. */
double frame_shift(const contact_frame *now, const contact_frame *then);

/* Returns the time, in units of T, in which the fluid moves by one grid step. The dimensionless
 * entrainment is taken as at least 1. */
double frame_grid_step(const contact_frame *frame, const ehd_grid *grid);

/* Returns the shortest time step, in units of T, that error control takes with transport along the
 * path: a quarter of frame_grid_step. Interpolation dominates the error of shorter steps. Starts,
 * events and other integrators may take shorter steps. */
double frame_shortest_step(const contact_frame *frame, const ehd_grid *grid);

/* Returns the ratio of the path of the fluid in a time step to a sixteenth of the grid step, at
 * most 1. Noise of the solution does not shrink with the time step. The filter, the inlet error
 * estimate, the rates of the load and the load forecast are multiplied by this ratio, so that noise
 * adds up along the path and not with the number of steps. */
double frame_step_share(const contact_frame *frame, double step, const ehd_grid *grid);

/* Returns the frame scaled by another load. */
contact_frame frame_with_load(const contact_kind *kind, const contact_frame *frame, double load);

/* Returns the frame of a load that is `ratio` times the load that scales this frame. If the
 * approach is given, a frame is scaled by an expected load, and `ratio` follows from the
 * solution. */
contact_frame frame_of_load(const contact_kind *kind, const contact_frame *frame, double ratio);

/* Rates of change of a contact between two frames. */
typedef struct frame_rates {
    double all;  // |d ln a/dT| + |d(u/u_ref)/dT|
    double load; // |d ln a/dT|; load, radius and modulus change a
} frame_rates;
/* Returns the mean rates between two frames; 0 for two frames of the same time. */
frame_rates frame_rates_between(const contact_frame *now, const contact_frame *before);

/* A gap that closes behind the contact, where |dh/dt| is larger than u dh/dx. While the radius
 * grows, this region lies behind x = 2 R u/(dR/dt). A second zone of pressure builds up in this
 * region. In the gap X^2/2 of a line contact without deflection, the zone begins at 2/3 of this x,
 * and the pressure in the zone falls as 1/X^2 (README.md, A gap that closes behind the exit). On a
 * point contact the width of the zone is taken as twice its distance from the centre. */
typedef struct closing_gap {
    double begin; // |X| behind which the gap closes, at least 1; INFINITY: the gap does not close
    double load;  // load of the second zone, relative to the whole load
    // estimate of the load that is missing because the pressure is zero at `end`, relative to the
    // whole load
    double beyond;
} closing_gap;

/* Estimates the closing gap from two frames at different times, without a jump between them. `end`
 * is |X| of the downstream end of the grid. */
closing_gap frame_closing_gap(const contact_frame *now, const contact_frame *before,
                              const ehd_contact *reference, double end);

/* Converts scalars from the current frame to the constant reference frame. The load is then
 * relative to the reference load. */
contact_scalars frame_to_reference(const contact_scalars *current, const contact_frame *frame,
                                   const ehd_contact *reference);

/* Converts scalars from the constant reference frame to the current frame. */
contact_scalars frame_from_reference(const contact_scalars *scalars, const contact_frame *frame,
                                     const ehd_contact *reference);

/* Converts a traction from the current frame to the constant reference frame. */
contact_traction frame_traction_to_reference(contact_traction current, const contact_frame *frame);

#endif
