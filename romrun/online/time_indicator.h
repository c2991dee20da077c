/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far the films of a reduced model in time may be off (romrun/README.md, In time it is carried).
 *
 * What a film misses of the equations where it is formed, in the inlet, goes through the contact with
 * the fluid. So control nodes, which take no part in the solution, sample the residual on the central
 * line; what it does to the film is a field of rho H that enters, is carried along and added to. */
#ifndef EHD_TIME_INDICATOR_H
#define EHD_TIME_INDICATOR_H

#include "common/physics/reynolds.h"
#include "romrun/online/film_errors.h"
#include "romrun/online/film_splines.h"
#include "romrun/online/reduced_solver.h"

typedef struct time_indicator {
    const reduced_model *model;
    // on the central line, those of the inlet first, ascending
    size_t num_inlet, num_nodes;
    size_t *node;
    double *x;                  // [num_nodes]
    reynolds_stencil *stencils; // [num_nodes] of indices in needed_node
    size_t num_needed, *needed_node;
    double *pressure, *film; // [num_needed] of the attempt
    double *fluid_memory;    // [NUM_FLUID_ARRAYS, num_needed]
    double *previous;        // [num_nodes] the caller's sums of previous rho H
    double *entrained;       // [num_nodes] the caller's
    double *share;           // [num_inlet] of a residual there, as a source of fluid, that enters
    reynolds_row *rows;      // [num_nodes]
    double *residual;        // [num_nodes] absolute value
    film_errors errors;      // bound, but for a factor
    double entry;            // X before which films are formed
    arena memory;
} time_indicator;

/* EHD_MEMORY. */
ehd_status time_indicator_init(
    // output:
    time_indicator *self, // free with time_indicator_free
    // input:
    const reduced_model *model, ehd_error *error);
void time_indicator_free(time_indicator *self);

/* Evaluates the residuals of a state that has been prepared (previous_film_prepare), for `contact`
 * with the entrainment of its rows; with self->previous where rate > 0. */
void time_indicator_evaluate(
    // in and out:
    time_indicator *self,
    // input:
    const previous_film *state, const ehd_contact *contact, double rate,
    const film_splines *splines);

/* Carries the errors to the frame of the state just evaluated, lets those of the inlet enter at a
 * dimensionless entrainment, and adds what the step leaves out of the films inside. */
void time_indicator_carry(time_indicator *self, const contact_frame *then, const contact_frame *now,
                          double entrainment, double step);

/* At the start, stationary: everything has entered so. */
void time_indicator_start(time_indicator *self, double entrainment);

/* Largest error of rho H around the centre, and of the films that arrive at X. */
double time_indicator_central(const time_indicator *self);
double time_indicator_arriving(const time_indicator *self, double x);

#endif
