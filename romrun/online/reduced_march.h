/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Marches the reduced model in time: BDF2 steps in the moving frame, for march_run or for a
 * multibody code's own integrator (README.md, In time). The cost of a step does not depend on the
 * size of the grid.
 * Called by online_transient.c, parts_march.c, romrun/calibrate and snapgen/trajectory.c. */
#ifndef EHD_REDUCED_MARCH_H
#define EHD_REDUCED_MARCH_H

#include "common/time/bdf_march.h"
#include "romrun/online/frame_tangent.h"
#include "romrun/solve/reduced_solver.h"
#include "romrun/state/film_splines.h"

typedef struct reduced_march reduced_march;

/* Creates a march. All inputs must outlive it; threads may share model and splines. EHD_DATA:
 * transport or smoothing differ from the training's, or the discretisation is only for stationary
 * contacts. EHD_MEMORY. */
ehd_status reduced_march_create(
    // output:
    reduced_march **self, // free with reduced_march_free
    // input:
    const reduced_model *model, const film_splines *splines, const ehd_contact *reference,
    const reduced_settings *settings, ehd_error *error);
reduced_march *reduced_march_free(reduced_march *self); // accepts and returns NULL

/* Factors and floors of the error estimates, relative to the films. The estimate of the central
 * film is central * bounds.central + central_floor. The estimate of the minimum film is central *
 * bounds.arriving + minimum * bounds.arising + minimum_floor. `bounds`: the film_bounds below. */
typedef struct film_factors {
    double central, minimum;
    double central_floor, minimum_floor;
} film_factors;

/* Sets the factors with which each step estimates the errors of its films. NaN, the default: no
 * estimates. Call it before the start. */
void reduced_march_indicate(reduced_march *self, film_factors factors);

/* Bounds of the relative film errors of the last attempt, without the factors. The minimum film has
 * two bounds: of errors that arrive with the fluid (with the central film's factor), and of errors
 * that arise at the minimum (with their own factor). */
typedef struct film_bounds {
    double central, arriving, arising;
} film_bounds;
film_bounds reduced_march_bounds(const reduced_march *self);

/* Sets the error that steps may cause in the central film with transport along the path
 * (transient.tolerance). The iterations' tolerance is a fraction of this error. NaN, the default:
 * steps have the tolerance of the settings, which the start always has. */
void reduced_march_set_tolerance(reduced_march *self, double tolerance);

/* With transport along the path, lets accepted states be `passing` (bdf.h) if steps are short, for
 * example those of an external integrator. A march with its own histories (march.h) does not need
 * this. */
void reduced_march_allow_short_steps(reduced_march *self);

/* Returns the solver of the march, for an observer. */
reduced_solver *reduced_march_inner(reduced_march *self);

/* Returns the march as a solver for march_run. The start is the stationary solution or, at zero
 * speed, a fit through the trained states around it. */
march_solver reduced_march_solver(reduced_march *self);

/* Returns the smallest M of the training. */
double reduced_march_least_M(const reduced_march *self);

/* Returns the last accepted state and its frame. */
reduced_state reduced_march_state(const reduced_march *self, contact_frame *frame);

// ---- handing states from and to another model

/* Returns the march of BDF2 steps inside this march, for handing states over. Its reference contact
 * has the smoothing of the model. */
bdf_march *reduced_march_steps(reduced_march *self);

/* Returns the state `steps` before the next one: 1 is the last accepted state, 0 the last
 * attempt. */
reduced_state reduced_march_state_before(const reduced_march *self, size_t steps,
                                         contact_frame *frame);

/* Returns why a contact that has changed from frame `before` to frame `now` lies outside of the
 * trained range, or NULL. Both frames are scaled by the load of their solutions. */
const char *reduced_march_check_range(const reduced_march *self, const contact_frame *now,
                                      const contact_frame *before);

/* Returns trained_range_outside of a frame. */
double reduced_march_outside(const reduced_march *self, const contact_frame *frame);

/* After states were taken over: takes over the error estimates of their films, converted to this
 * model's factors. `from`: the march of these states; NULL: the full model, whose films have no
 * estimates. `change`, [NUM_ERROR_PLACES]: error of H caused by taking over the last state; this
 * error is added. */
void reduced_march_take_indicated(reduced_march *self, const reduced_march *from,
                                  const double *change);

/* Returns equations for conditions that differ a little from those of the last attempt, or of the
 * start if no attempt followed. Their state is reduced_march_state_before at 0; after a start, at
 * 1. */
frame_equations reduced_march_equations(reduced_march *self);

typedef struct reduced_march_effort {
    double seconds_rows, seconds_linear, seconds_exit;
    double seconds_previous; // time to carry previous states into the frame
    size_t iterations;
} reduced_march_effort;
reduced_march_effort reduced_march_effort_of(const reduced_march *self);

#endif
