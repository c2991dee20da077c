/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Estimates errors of the films of a reduced model in time (README.md, Error estimates in time).
 * Called by romrun/online/reduced_march.c for each step.
 *
 * An error of a film that forms in the inlet goes through the contact with the fluid. Control nodes
 * on the central grid line sample the residual; they take no part in the solution. The effect on
 * the film is a field of errors of rho H that enters, is carried along and grows on the way.
 *
 * The residuals of the rows, and those at nodes that a moving exit has passed, change the films at
 * once. This error stays until the fluid has gone from the lowest film through the exit. */
#ifndef EHD_TIME_INDICATOR_H
#define EHD_TIME_INDICATOR_H

#include "common/physics/reynolds.h"
#include "common/time/film_errors.h"
#include "romrun/solve/reduced_solver.h"
#include "romrun/state/film_splines.h"
#include "romrun/trust/functionals.h"

/* Octaves of the distance from the lowest film to the exit, up to two half widths. */
enum { NUM_LENGTHS = 8 };

/* Errors of H, sorted by their distance to the exit when they arose. All members are doubles, so
 * that the struct can be saved. */
typedef struct local_errors {
    double length[NUM_LENGTHS]; // latest distance in the octave, half widths
    double of_film[NUM_REDUCED_FILMS][NUM_LENGTHS];
} local_errors;

typedef struct time_indicator {
    const reduced_model *model;
    // numbers of control nodes. num_inlet: in the inlet. num_nodes: on the central grid line,
    // ascending, those of the inlet first. num_at_exit: around the exit; these nodes come last
    size_t num_inlet, num_nodes, num_at_exit;
    size_t *node;               // [num_nodes + num_at_exit]
    size_t *row;                // [num_nodes + num_at_exit] the model's row at the node, or NO_NODE
    double *x;                  // [num_nodes]
    reynolds_stencil *stencils; // [num_nodes + num_at_exit] with indices in needed_node
    // needed nodes of all stencils; the first num_fixed belong to the nodes on the central line
    size_t num_fixed, num_needed, *needed_node;
    // [num_needed] index among the model's needed nodes, or NO_NODE
    size_t *among;
    size_t placed;           // exit around which the num_at_exit nodes lie; 0: none
    double *pressure, *film; // [num_needed] P and H of the attempt
    double *fluid_memory;    // [NUM_FLUID_ARRAYS, num_needed]
    double *previous;        // [num_nodes + num_at_exit] sums of previous rho H, set by the caller
    double *entrained;       // [num_nodes] d(rho H)/dX of the base, set by the caller
    double *share;           // [num_inlet] fraction of the node's fluid source that enters the
                             // contact
    reynolds_row *rows;      // [num_nodes + num_at_exit]
    double *residual;        // [num_nodes + num_at_exit] absolute value of the residual
    film_errors errors;      // bound of the carried errors, without the factor
    // errors caused by residuals of rows: of the attempt, and of the last accepted state
    local_errors local, kept_local;
    double entry; // X up to which films form
    arena memory;
} time_indicator;

/* Initialises the indicator. Errors: EHD_MEMORY. */
ehd_status time_indicator_init(
    // output:
    time_indicator *self, // free with time_indicator_free
    // input:
    const reduced_model *model, ehd_error *error);
void time_indicator_free(time_indicator *self);

/* Places control nodes around the exit of a state. NULL: no nodes, as at the stationary start. */
void time_indicator_place(time_indicator *self, const reduced_state *state);

/* Evaluates the residuals of the last solution of a solver. Its state has been prepared
 * (previous_film_prepare). `contact` has the entrainment of the rows. Uses self->previous if rate >
 * 0. */
void time_indicator_evaluate(
    // in and out:
    time_indicator *self,
    // input:
    const previous_film *state, const reduced_solver *solver, const ehd_contact *contact,
    double rate, const film_splines *splines);

/* Carries the errors to the frame of the evaluated state. Errors of the inlet enter with the
 * dimensionless `entrainment`. The residuals inside of the contact add the errors of this step. */
void time_indicator_carry(time_indicator *self, const contact_frame *then, const contact_frame *now,
                          double entrainment, double step);

/* Sets the errors of a stationary start, in which all films have entered already. */
void time_indicator_start(time_indicator *self, double entrainment);

/* Returns the change of a film by rows around the exit that the least squares do not include: rows
 * that the exit has passed since the Jacobian was made, and rows behind the exit whose nodes should
 * have pressure. `influence`, [rows of the model]: influence of the rows on this film, for the last
 * evaluated solution. */
double time_indicator_at_exit(const time_indicator *self, const double *influence);

/* Adds `errors`, indexed by reduced_film, that rows cause in the films of the attempt. Adds them to
 * what remains of the errors of the last state, in frame `then` (NULL: there is no last state). The
 * errors leave with the fluid between minimum and exit. Errors that arose in the constriction are
 * therefore soon gone, even if the film is lowest in a dip far upstream. */
void time_indicator_add_local(time_indicator *self, const double errors[NUM_REDUCED_FILMS],
                              const contact_scalars *scalars, const contact_frame *then,
                              const contact_frame *now);

/* Accept the attempt, and set all errors to zero. */
void time_indicator_keep(time_indicator *self);
void time_indicator_clear(time_indicator *self);

/* Returns the sum of the local errors of a film, at most its thickness. */
double time_indicator_local(const time_indicator *self, reduced_film film, double thickness);

/* Return the largest error of rho H around the centre, and the largest error of the films that
 * arrive at X. */
double time_indicator_central(const time_indicator *self);
double time_indicator_arriving(const time_indicator *self, double x);

#endif
