/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The moving frame of a contact that varies with time: everything is scaled by the current contact
 * size and Hertz pressure, time by the reference (Maier et al. 2015, eq. 6; README.md). */
#ifndef EHD_FRAME_H
#define EHD_FRAME_H

#include "common/physics/traction.h"
#include <stdbool.h>

/* What holds at one time, relative to the reference. */
typedef struct contact_frame {
    double time;  // T = u_ref t / a_ref
    double load;  // that scales the frame; the load itself where it is given
    double speed; // entrainment, of either sign
    double radius;
    double modulus;
    double approach;       // H0 that is given, in the reference frame; NaN: the load is given
    double half_width;     // a / a_ref
    double hertz_pressure; // p_H / p_H,ref
    double film_scale;     // (a^2 / R) / (a_ref^2 / R_ref)
    double path;           // int u/u_ref dT, how far the fluid has come, in reference half widths
} contact_frame;

/* `values`: load, speed, radius, modulus (VARY_… of scene.h) relative to the reference; `approach`
 * NaN where the load is given. The path is left at zero. */
contact_frame frame_at(const contact_kind *kind, double time, const double *values,
                       double approach);

/* Whether a frame may be one of frame_at: of what a file says. */
bool frame_is_valid(const contact_frame *frame);

/* The reference contact as it is in the frame: lambda, Hertz pressure, U, Moes numbers, closure.
 * Moes M, that of the same speed in either direction, grows beyond all bounds as it goes to zero and
 * is cut at 1e5. */
void frame_contact(
    // output:
    ehd_contact *contact,
    // input:
    const contact_frame *frame, const ehd_contact *reference);

/* Where a place X of frame `now` lies in frame `then`, per X, and what turns a film of `then` into
 * one of `now`: the physical place and film are the same. */
double frame_stretch(const contact_frame *now, const contact_frame *then);
double frame_film_ratio(const contact_frame *now, const contact_frame *then);

/* Where in frame `then`, behind its stretched place, the fluid was that is at a place of frame `now`:
 * X' = stretch X - shift, by the path in between. */
double frame_shift(const contact_frame *now, const contact_frame *then);

/* Returns the time in T in which the fluid moves by one step of the grid, at a dimensionless entrainment of at least 1. */
double frame_grid_step(const contact_frame *frame, const ehd_grid *grid);

/* Returns the shortest step in T that error control takes along the path: a quarter of frame_grid_step. Interpolation dominates
 * the error of shorter steps. Starts, events and other integrators may take them. */
double frame_shortest_step(const contact_frame *frame, const ehd_grid *grid);

/* Returns the path of a step in sixteenths of the grid's step, at most 1. Noise of the solution does not shrink with the step. The
 * filter, the error estimates, the rates and the load's forecast are multiplied by this share, so that noise adds up along the
 * path and not with the number of steps. */
double frame_step_share(const contact_frame *frame, double step, const ehd_grid *grid);

/* A frame scaled by another load. */
contact_frame frame_with_load(const contact_kind *kind, const contact_frame *frame, double load);

/* The frame that belongs to a load `ratio` times the one that scales this frame: where the approach
 * is given, a frame is scaled by an expected load, and `ratio` is the solution's. */
contact_frame frame_of_load(const contact_kind *kind, const contact_frame *frame, double ratio);

/* How fast a contact changes between two frames. */
typedef struct frame_rates {
    double all;  // |d ln a/dT| + |d(u/u_ref)/dT|
    double load; // |d ln a/dT|, by load, radius or modulus
} frame_rates;
frame_rates frame_rates_between(const contact_frame *now, const contact_frame *before);

/* A gap that closes behind the contact, where dh/dt outweighs u dh/dx: while the radius grows, behind
 * x = 2 R u/(dR/dt). There a second zone of pressure builds up. In the gap X^2/2 of a line without
 * deflection it begins at 2/3 of that place and falls as 1/X^2 (README.md, A gap that closes behind the
 * exit); on a point contact the zone is taken to be as wide as it is far away. */
typedef struct closing_gap {
    double begin;  // |X| from which on the gap closes, at least 1; INFINITY: it does not
    double load;   // of the zone behind, part of the whole load
    double beyond; // about what the zone lacks of it where the pressure is zero at `end`
} closing_gap;

/* Largest part of the load that a model may lack so and be trusted. Of a line at M = 3, L = 3, whose radius
 * grows to 3 in T = 40 while its speed falls from 0.05 to 0.005 of the reference, grids to X = 3, 4,
 * 8 and 12 lack 0.84, 0.66, 0.35 and 0.24 % by this at T = 38.5; against one to 24 the central film is
 * 0.05, 0.04, 0.02 and 0.01 % off, the minimum film 0.12, 0.09, 0.05 and 0.03 %. */
extern const double frame_most_cut_load;

/* Of two frames with steps between them and no jump. `end`: |X| of the grid's end downstream. */
closing_gap frame_closing_gap(const contact_frame *now, const contact_frame *before,
                              const ehd_contact *reference, double end);

/* Scalars in the constant reference frame from those of the current one; the load becomes relative
 * to the reference. */
contact_scalars frame_to_reference(const contact_scalars *current, const contact_frame *frame,
                                   const ehd_contact *reference);

/* Scalars in the current frame from those in the constant reference frame. */
contact_scalars frame_from_reference(const contact_scalars *scalars, const contact_frame *frame,
                                     const ehd_contact *reference);

/* Converts a traction from the current frame to the constant reference frame. Unlike frame_to_reference it needs the frame
 * alone. */
contact_traction frame_traction_to_reference(contact_traction current, const contact_frame *frame);

#endif
