/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Estimates errors of the films of a reduced model in a transient run (README.md, Error estimates
 * in time).
 * Called by romrun/online/reduced_march.c for each step.
 *
 * Carried errors: the fluid carries the error of a film that forms in the inlet through the
 * contact. Control nodes on the central grid line sample the residual; they take no part in the
 * solution. These residuals cause a field of errors of rho H, which enters with the fluid, is
 * carried along and grows on the way.
 *
 * Local errors: the residuals of the rows, and the residuals at nodes that a moving exit has
 * passed, change the films at once. A local error stays until the fluid has flowed from the lowest
 * film through the exit. */
#ifndef EHD_TIME_INDICATOR_H
#define EHD_TIME_INDICATOR_H

#include "common/physics/reynolds.h"
#include "common/time/film_errors.h"
#include "romrun/solve/reduced_solver.h"
#include "romrun/state/film_splines.h"
#include "romrun/trust/functionals.h"

/* Number of octaves of the distance from the lowest film to the exit. The last octave ends at two
 * half widths. */
enum { NUM_LENGTHS = 8 };

/* Local errors of H, sorted by the distance from the lowest film to the exit at the time when they
 * arose. All members are doubles, so that the struct can be saved. */
typedef struct local_errors {
    double length[NUM_LENGTHS]; // latest distance in the octave, half widths; 0: the octave has no
                                // errors yet
    double of_film[NUM_REDUCED_FILMS][NUM_LENGTHS];
} local_errors;

typedef struct time_indicator {
    const reduced_model *model;
    // numbers of control nodes. num_nodes: fixed nodes on the central grid line, ascending; the
    // first num_inlet of them lie in the inlet. num_at_exit: nodes around the exit, which follow
    // the fixed nodes
    size_t num_inlet, num_nodes, num_at_exit;
    size_t *node;               // [num_nodes + num_at_exit]
    size_t *row;                // [num_nodes + num_at_exit] the model's row at the node, or NO_NODE
    double *x;                  // [num_nodes]
    reynolds_stencil *stencils; // [num_nodes + num_at_exit] with indices in needed_node
    // needed nodes of all stencils; the first num_fixed belong to the fixed control nodes
    size_t num_fixed, num_needed, *needed_node;
    // [num_needed] index among the model's needed nodes, or NO_NODE
    size_t *among;
    size_t placed;           // exit around which the num_at_exit nodes lie; 0: no such nodes
    double *pressure, *film; // [num_needed] P and H of the attempted step
    double *fluid_memory;    // [NUM_FLUID_ARRAYS, num_needed]
    double *previous;        // [num_nodes + num_at_exit] weighted sums of rho H of previous
                             // states (reynolds_squeeze), set by the caller
    double *entrained;       // [num_nodes] d(rho H)/dX of the base (common/time/README.md, Along
                             // the path), set by the caller
    double *share;           // [num_inlet] fraction of a source of fluid that enters the contact
    reynolds_row *rows;      // [num_nodes + num_at_exit]
    double *residual;        // [num_nodes + num_at_exit] absolute value of the residual
    film_errors errors;      // bound of the carried errors, without the factor
    // local errors of the attempted step, and of the last accepted state
    local_errors local, kept_local;
    double entry; // X before which films form
    arena memory;
} time_indicator;

/* Initialises the indicator. Errors: EHD_MEMORY. */
ehd_status time_indicator_init(
    // output:
    time_indicator *self, // free with time_indicator_free
    // input:
    const reduced_model *model, ehd_error *error);
void time_indicator_free(time_indicator *self);

/* Places control nodes around the exit of a state. NULL: places no nodes, as at the stationary
 * start. */
void time_indicator_place(time_indicator *self, const reduced_state *state);

/* Evaluates the residuals of the last solution of `solver` at the control nodes. `state` is this
 * solution, after previous_film_prepare. `contact` has the entrainment of the rows. self->previous
 * is used only if rate > 0. */
void time_indicator_evaluate(
    // in and out:
    time_indicator *self,
    // input:
    const previous_film *state, const reduced_solver *solver, const ehd_contact *contact,
    double rate);

/* Carries the errors from the frame `then` to the frame `now` of the evaluated state. The residuals
 * in the inlet cause errors of the films that enter with the dimensionless `entrainment`. The
 * residuals inside of the contact add the errors of this time step, whose length is `step`. */
void time_indicator_carry(time_indicator *self, const contact_frame *then, const contact_frame *now,
                          double entrainment, double step);

/* Sets the errors of a stationary start, in which all films have entered already. */
void time_indicator_start(time_indicator *self, double entrainment);

/* Returns the estimated error of a film due to rows around the exit that the last least-squares
 * problem does not contain. There are two kinds of such rows:
 * - rows that the exit has passed after the Jacobian was computed;
 * - rows behind the exit whose residuals show that their nodes should have pressure.
 * `influence`, [rows of the model]: change of this film by an error of 1 in each row, at the last
 * evaluated solution. */
double time_indicator_at_exit(const time_indicator *self, const double *influence);

/* Computes the local errors of the attempted step: what remains of the errors of the last state,
 * plus `errors`, indexed by reduced_film, which the rows cause in this step. `then`: frame of the
 * last state; NULL: there is no last state. Errors leave with the fluid that was between the
 * minimum film and the exit when they arose. Errors that arose in the constriction are therefore
 * soon gone, even if the film is now lowest in a dip far upstream. */
void time_indicator_add_local(time_indicator *self, const double errors[NUM_REDUCED_FILMS],
                              const contact_scalars *scalars, const contact_frame *then,
                              const contact_frame *now);

/* Accept the errors of the attempted step (keep), or set all errors to zero (clear). */
void time_indicator_keep(time_indicator *self);
void time_indicator_clear(time_indicator *self);

/* Returns the sum of the local errors of a film. The result is at most the film's `thickness`. */
double time_indicator_local(const time_indicator *self, reduced_film film, double thickness);

/* Return the largest carried error of rho H: around the centre, and of films that arrive at X. */
double time_indicator_central(const time_indicator *self);
double time_indicator_arriving(const time_indicator *self, double x);

#endif
