/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far the films of a reduced model in time may be off (README.md, Indicated deviation in
 * time).
 *
 * What a film misses of the equations where it is formed, in the inlet, goes through the contact
 * with the fluid. So control nodes, which take no part in the solution, sample the residual on the
 * central line; what it does to the film is a field of rho H that enters, is carried along and
 * added to.
 *
 * What the rows are left with, and those that an exit has passed while it moved, changes the films
 * at once, and stays until the fluid has gone from where the film is lowest through the exit. */
#ifndef EHD_TIME_INDICATOR_H
#define EHD_TIME_INDICATOR_H

#include "common/physics/reynolds.h"
#include "romrun/online/film_errors.h"
#include "romrun/online/film_splines.h"
#include "romrun/online/reduced_solver.h"

/* Octaves of distances from the lowest film to the exit, up to two half widths. */
enum { NUM_LENGTHS = 8 };

/* Errors of H that arose where the exit was so far away: doubles alone. */
typedef struct local_errors {
    double length[NUM_LENGTHS]; // the last of the octave, half widths
    double of_film[NUM_REDUCED_FILMS][NUM_LENGTHS];
} local_errors;

typedef struct time_indicator {
    const reduced_model *model;
    // on the central line, those of the inlet first, ascending; behind them those around the exit
    size_t num_inlet, num_nodes, num_at_exit;
    size_t *node;               // [num_nodes + num_at_exit]
    size_t *row;                // [num_nodes + num_at_exit] the model's row there, or NO_NODE
    double *x;                  // [num_nodes]
    reynolds_stencil *stencils; // [num_nodes + num_at_exit] of indices in needed_node
    size_t num_fixed, num_needed, *needed_node; // the fixed ones are of the num_nodes
    size_t *among;                              // [num_needed] index among the model's, or NO_NODE
    size_t placed;                              // exit that the others are around; 0: none
    double *pressure, *film;                    // [num_needed] of the attempt
    double *fluid_memory;                       // [NUM_FLUID_ARRAYS, num_needed]
    double *previous;   // [num_nodes + num_at_exit] the caller's sums of previous rho H
    double *entrained;  // [num_nodes] the caller's
    double *share;      // [num_inlet] of a residual there, as a source of fluid, that enters
    reynolds_row *rows; // [num_nodes + num_at_exit]
    double *residual;   // [num_nodes + num_at_exit] absolute value
    film_errors errors; // bound, but for a factor
    // what rows leave, of the attempt and of the last accepted state
    local_errors local, kept_local;
    double entry; // X before which films are formed
    arena memory;
} time_indicator;

/* EHD_MEMORY. */
ehd_status time_indicator_init(
    // output:
    time_indicator *self, // free with time_indicator_free
    // input:
    const reduced_model *model, ehd_error *error);
void time_indicator_free(time_indicator *self);

/* Puts control nodes around the exit of a state; NULL: none, as at the stationary start. */
void time_indicator_place(time_indicator *self, const reduced_state *state);

/* Evaluates the residuals of a state that has been prepared (previous_film_prepare), the last solution
 * of a solver, for `contact` with the entrainment of its rows; with self->previous where rate > 0. */
void time_indicator_evaluate(
    // in and out:
    time_indicator *self,
    // input:
    const previous_film *state, const reduced_solver *solver, const ehd_contact *contact,
    double rate, const film_splines *splines);

/* Carries the errors to the frame of the state just evaluated, lets those of the inlet enter at a
 * dimensionless entrainment, and adds what the step leaves out of the films inside. */
void time_indicator_carry(time_indicator *self, const contact_frame *then, const contact_frame *now,
                          double entrainment, double step);

/* At the start, stationary: everything has entered so. */
void time_indicator_start(time_indicator *self, double entrainment);

/* What the rows around the exit that least squares have not solved do to a film, of whose
 * `influence`, [rows of the model], the last evaluation's solution is: those that an exit has
 * passed since the Jacobian was made, and those behind it that should have pressure. */
double time_indicator_at_exit(const time_indicator *self, const double *influence);

/* What rows do to the films of the attempt, by reduced_film, with what is left of it from the last
 * state `then`; NULL: there is none. It leaves with the fluid between the minimum and the exit: what arose
 * in the constriction is soon gone, also while the film is lowest in a dip far before it. */
void time_indicator_add_local(time_indicator *self, const double errors[NUM_REDUCED_FILMS],
                              const contact_scalars *scalars, const contact_frame *then,
                              const contact_frame *now);

/* The attempt is accepted; or films have no errors. */
void time_indicator_keep(time_indicator *self);
void time_indicator_clear(time_indicator *self);

/* All of it of a film, at most its thickness. */
double time_indicator_local(const time_indicator *self, reduced_film film, double thickness);

/* Largest error of rho H around the centre, and of the films that arrive at X. */
double time_indicator_central(const time_indicator *self);
double time_indicator_arriving(const time_indicator *self, double x);

#endif
