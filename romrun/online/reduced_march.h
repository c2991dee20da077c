/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The reduced model in time: BDF2 steps in the moving frame, for march_run or for a multibody
 * code's own integrator. The cost of a step does not depend on the size of the grid. */
#ifndef EHD_REDUCED_MARCH_H
#define EHD_REDUCED_MARCH_H

#include "common/time/march.h"
#include "romrun/online/film_splines.h"
#include "romrun/online/frame_tangent.h"
#include "romrun/online/reduced_solver.h"

typedef struct reduced_march reduced_march;

/* All inputs must outlive it; threads may share model and splines. EHD_MEMORY. */
ehd_status reduced_march_create(
    // output:
    reduced_march **self, // free with reduced_march_free
    // input:
    const reduced_model *model, const film_splines *splines, const ehd_contact *reference,
    const reduced_settings *settings, ehd_error *error);
reduced_march *reduced_march_free(reduced_march *self); // accepts and returns NULL

/* Factors and floors of the error estimates, relative to the films. The estimate of the central film is
 * central * bounds.central + central_floor, and that of the minimum film is
 * central * bounds.arriving + minimum * bounds.arising + minimum_floor, with film_bounds below. */
typedef struct film_factors {
    double central, minimum;
    double central_floor, minimum_floor;
} film_factors;

/* Has each step indicate how far its films are off. NaN, the default: it does not, and how fast
 * the contact changes is held against its training. Before the start. */
void reduced_march_indicate(reduced_march *self, film_factors factors);

/* What is indicated of the last attempt, but for the factors: relative deviations of the central
 * film, and of the minimum film what has come with the fluid, which has the central film's factor,
 * and what arises at it, which has its own. */
typedef struct film_bounds {
    double central, arriving, arising;
} film_bounds;
film_bounds reduced_march_bounds(const reduced_march *self);

/* What the steps may do to the central film along the path (transient.tolerance), of which iterations
 * leave a part; NaN, the default: they have the tolerance of the settings, as the start has. */
void reduced_march_set_tolerance(reduced_march *self, double tolerance);

/* Lets accepted states of films along the path be passing (bdf.h) where steps are short, as those of another integrator may be.
 * A march of its own histories (march.h) does not need it. */
void reduced_march_allow_short_steps(reduced_march *self);

/* The solver of the march, for an observer. */
reduced_solver *reduced_march_inner(reduced_march *self);

/* As a solver for march_run. The start is the stationary solution, or where the speed is zero a
 * fit through the trained states around. */
march_solver reduced_march_solver(reduced_march *self);

/* M of the lightest contact of the training. */
double reduced_march_least_M(const reduced_march *self);

/* The last accepted state, and its frame. */
reduced_state reduced_march_state(const reduced_march *self, contact_frame *frame);

// ---- from and to another solver of the same reference and grid, which goes on where this one
// stopped

/* The contact at all factors 1, with what it has from the model. */
const ehd_contact *reduced_march_reference(const reduced_march *self);

/* How many accepted states a step looks at. */
size_t reduced_march_num_states(const reduced_march *self);

/* The accepted state so many steps before the next one, 1 being the last; 0: the last attempt. */
reduced_state reduced_march_state_before(const reduced_march *self, size_t steps,
                                         contact_frame *frame);

/* Along the path: the state that others are told from (common/time/README.md). */
reduced_state reduced_march_base(const reduced_march *self, contact_frame *frame);

/* P and H of a state at all nodes, [num_nodes], and its H0. */
void reduced_march_fields_of(double *pressure, double *film, double *rigid_approach,
                             const reduced_march *self, const reduced_state *state);

/* Why a contact that has come from one frame to another, both scaled by the load of their
 * solutions, lies outside of the trained range, or NULL. */
const char *reduced_march_check_range(const reduced_march *self, const contact_frame *now,
                                      const contact_frame *before);

/* trained_range_outside of a frame. */
double reduced_march_outside(const reduced_march *self, const contact_frame *frame);

/* The frame of the last accepted state, scaled by the load of its solution. */
contact_frame reduced_march_load_frame(const reduced_march *self);

/* A state on the grid that this solver takes over: the nearest pressure that its modes have, with a
 * film as thick in the mean. */
typedef struct handed_state {
    const double *pressure, *film; // [num_nodes]
    double rigid_approach;
    const size_t *exits; // [num_lines] columns
    contact_frame frame;
} handed_state;

/* Takes an accepted state, at `steps` from 1 to BDF_PREVIOUS in ascending order; those taken so
 * far count. Along the path the base has to be taken before. `load_frame`: the last one's, scaled
 * by the load of its solution. EHD_MEMORY. */
ehd_status reduced_march_take(reduced_march *self, size_t steps, const handed_state *state,
                              const contact_frame *load_frame, ehd_error *error);

/* Along the path: the state that others are told from. EHD_MEMORY. */
ehd_status reduced_march_take_base(reduced_march *self, const handed_state *state,
                                   ehd_error *error);

/* Errors of rho H that the film of the last accepted state has taken up along the path,
 * [NUM_ERROR_PLACES] (film_errors.h). */
const double *reduced_march_errors(const reduced_march *self);
void reduced_march_take_errors(reduced_march *self, const double *errors);

/* From the march whose states were taken, NULL: from the full model, of which nothing is indicated: what is
 * indicated of their films, by this model's factors, and in addition `change`, [NUM_ERROR_PLACES], the
 * error of H that taking has made of the last one. */
void reduced_march_take_indicated(reduced_march *self, const reduced_march *from,
                                  const double *change);

/* The equations that conditions beside those of the last attempt would have had, or of the start where
 * that came last; the state is that of reduced_march_state_before at 0, of the start at 1. */
frame_equations reduced_march_equations(reduced_march *self);

/* Effort so far. */
typedef struct reduced_march_effort {
    double seconds, seconds_rows, seconds_linear, seconds_exit;
    double seconds_previous; // carrying previous states over
    size_t iterations;
} reduced_march_effort;
reduced_march_effort reduced_march_effort_of(const reduced_march *self);

#endif
