/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Marches the reduced model in time with BDF2 steps in the moving frame. march_run, or the
 * integrator of a multibody code, chooses the steps (README.md, In time). The cost of a step does
 * not depend on the size of the grid.
 * Called by online_transient.c, parts_march.c, romrun/calibrate and snapgen/trajectory.c. */
#ifndef EHD_REDUCED_MARCH_H
#define EHD_REDUCED_MARCH_H

#include "common/time/bdf_march.h"
#include "romrun/online/frame_tangent.h"
#include "romrun/solve/reduced_solver.h"
#include "romrun/state/film_splines.h"

typedef struct reduced_march reduced_march;

/* Creates a march. All inputs must outlive the march. Several threads may share the model and the
 * splines. EHD_DATA: transport or smoothing differ from the training, or the discretisation is only
 * for stationary contacts. EHD_MEMORY. */
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
 * two bounds. `arriving` is for errors that arrive with the fluid; its factor is that of the
 * central film. `arising` is for errors that arise at the minimum; its factor is that of the
 * minimum film. */
typedef struct film_bounds {
    double central, arriving, arising;
} film_bounds;
film_bounds reduced_march_bounds(const reduced_march *self);

/* Sets the error that the steps may cause in the central film, with transport along the path
 * (transient.tolerance). The tolerance of the iterations is then a fraction of this error. NaN, the
 * default: the iterations of steps have the tolerance of the settings given to
 * reduced_march_create. The start always has this tolerance. */
void reduced_march_set_tolerance(reduced_march *self, double tolerance);

/* Allows time steps in which the fluid moves by much less than a grid step, for example steps of an
 * external integrator. With transport along the path, accepted states may then be `passing`
 * (bdf.h): the next step does not begin at a passing state but at an earlier state. march_run
 * (march.h) does not need this call. */
void reduced_march_allow_short_steps(reduced_march *self);

/* Returns the solver inside the march, for example to set an observer. */
reduced_solver *reduced_march_inner(reduced_march *self);

/* Returns the march as a solver for march_run. The start is the stationary solution. At zero speed
 * the start is a fit through the neighbouring trained states. */
march_solver reduced_march_solver(reduced_march *self);

/* Returns the smallest M of the training. */
double reduced_march_least_M(const reduced_march *self);

/* Returns the last accepted state and its frame. */
reduced_state reduced_march_state(const reduced_march *self, contact_frame *frame);

// ---- handing states from and to another model

/* Returns the march of BDF2 steps inside this march, with which states are handed over. Its
 * reference contact has the smoothing of the model. */
bdf_march *reduced_march_steps(reduced_march *self);

/* Returns a state. `steps`: 0 for the last attempt, 1 for the last accepted state, and so on. */
reduced_state reduced_march_state_before(const reduced_march *self, size_t steps,
                                         contact_frame *frame);

/* Returns why a contact that has changed from frame `before` to frame `now` lies outside of the
 * trained range, or NULL. Both frames are scaled by the load of their solutions. */
const char *reduced_march_check_range(const reduced_march *self, const contact_frame *now,
                                      const contact_frame *before);

/* Returns trained_range_outside for the contact in a frame. */
double reduced_march_outside(const reduced_march *self, const contact_frame *frame);

/* Takes over the error estimates of the films from another march, after the states of that march
 * were taken over. Converts the estimates to the error factors of this model. `from`: the other
 * march; NULL: the states are from the full model, whose films have no estimates. `change`,
 * [NUM_ERROR_PLACES]: error of H that taking over the last state has caused. This error is added to
 * the estimates. */
void reduced_march_take_indicated(reduced_march *self, const reduced_march *from,
                                  const double *change);

/* Returns the equations of the last attempt or, if no attempt followed, of the start. The equations
 * can be evaluated in frames that differ a little from the frame of the attempt. Their solution is
 * reduced_march_state_before with `steps` = 0; after a start, with `steps` = 1. */
frame_equations reduced_march_equations(reduced_march *self);

#endif
