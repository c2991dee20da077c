/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The online solver: Gauss-Newton on the weighted least squares of the selected rows, with a local
 * exit boundary (Maier et al. (2015), eqs. 28, 37-39). Its cost does not depend on the grid. */
#ifndef EHD_REDUCED_SOLVER_H
#define EHD_REDUCED_SOLVER_H

#include "common/physics/contact_place.h"
#include "common/physics/traction.h"
#include "romrun/model/reduced_model.h"
#include <stdbool.h>

/* Solves the least-squares problem of an iteration, step = argmin |matrix step + right|: the
 * model's weighted rows before the exit in their order, then the linear equations. Entry of
 * reduced_settings for other methods or weights in tests and research. EHD_NOT_CONVERGED: none. */
typedef ehd_status reduced_linear_solver(double *step, // out: [num_unknowns]
                                         void *context,
                                         const double *matrix, // [num_rows, num_unknowns]
                                         const double *right,  // [num_rows]
                                         size_t num_rows, size_t num_unknowns);

typedef struct reduced_settings {
    double tolerance; // relative change of the central film that another iteration would make; 1e-8
    size_t max_iterations; // 40
    // half widths between the lines of a point contact on which the exit is searched for, others
    // being interpolated (Maier et al. (2015), section 3.3); 0, the default: all lines, since
    // interpolation costs more iterations than it saves time
    double exit_spacing;
    bool exit_at_node; // always, as in time; false: where exit_is_within_node is not
    reduced_linear_solver *solve_linear; // NULL: least_squares_solve
    void *linear_context;
} reduced_settings;

/* Those that the comments above name. */
reduced_settings reduced_default_settings(void);

/* A reduced state: z = (a, d, H0) and the exit line (eq. 39). */
typedef struct reduced_state {
    double *coordinates; // [num_unknowns]
    size_t exit;         // column on the line where Y = 0; of a line contact a grid node
    size_t *exits;       // [num_lines] columns on all lines of the grid; NULL on a line contact
    // where the exit lies within a node: its distance from the node before `exit` in steps, 0 to
    // 1, in time as exit_place has it; NaN: at a node, or not known yet
    double exit_offset;
} reduced_state;

/* Memory for a state of a model, all zero. EHD_MEMORY. */
ehd_status reduced_state_init(reduced_state *state, const reduced_model *model, ehd_error *error);
void reduced_state_free(reduced_state *state);

/* Copies a state of the same model. */
void reduced_state_copy(reduced_state *target, const reduced_state *source,
                        const reduced_model *model);

/* Gets and sets the exit line, [num_lines]; at nodes. One outside of the model's band, as a training
 * solution without an exit has, is put to its nearest. */
const size_t *reduced_state_exits(const reduced_state *state);
void reduced_state_set_exits(reduced_state *state, const reduced_model *model, const size_t *exits);

typedef struct reduced_info {
    ehd_status status; // EHD_OK, EHD_NOT_CONVERGED or EHD_UNTRUSTED (exit not settled)
    size_t iterations;
    bool own_jacobian; // solved with own Jacobians, not with kept factors
    bool near_factors; // and, near the solution, with those of the last of them
    double residual;   // |D f| over the rows and the linear equations, at the last iteration
    contact_scalars scalars;
    double seconds, seconds_rows, seconds_linear, seconds_exit;
    const char *reason;
} reduced_info;

/* A state's values at the needed nodes; cut at a checkpoint, they are linear in the coordinates.
 * */
typedef struct reduced_values {
    size_t checkpoint; // of the exit (reduced_model_checkpoint)
    double *pressure;  // [num_needed] P, uncut
    double *cut;       // [rows of the cut table] the checkpoint's cut table times z
} reduced_values;

/* Memory for the values of a model's state, of no checkpoint yet. EHD_MEMORY. */
ehd_status reduced_values_init(reduced_values *values, const reduced_model *model,
                               ehd_error *error);
void reduced_values_free(reduced_values *values);

/* Called with D f and D J dz of every iteration, the snapshots of the row selection (section 3.2);
 * entries of rows behind the exit are zero. */
typedef ehd_status reduced_observer(void *context, const double *weighted_residual, // [num_rows]
                                    const double *weighted_step,                    // [num_rows]
                                    ehd_error *error);

/* Called at the end of a solution, with what became of it: iterations that ran away are larger than all
 * others together, and not to be kept. */
typedef ehd_status reduced_observer_end(void *context, const reduced_info *info, ehd_error *error);

/* The squeeze term: the time derivative of rho H is rate * rho H + previous. */
typedef struct reduced_squeeze {
    double rate;                                       // 1 / dimensionless time
    const double *previous;                            // [num_rows] at the model's rows
    double (*previous_at)(void *context, size_t node); // the same at a node of the band
    void *context;
    const reduced_values *start; // values of the start; NULL: not known
    const double *last;          // [num_needed] P of the last state, uncut; NULL: not known
} reduced_squeeze;

typedef struct reduced_solver reduced_solver;

/* Memory of one solver; the model must outlive it. One object a thread. EHD_MEMORY. */
ehd_status reduced_solver_create(
    // output:
    reduced_solver **solver, // free with reduced_solver_free
    // input:
    const reduced_model *model, const reduced_settings *settings, ehd_error *error);
reduced_solver *reduced_solver_free(reduced_solver *solver); // accepts and returns NULL

void reduced_solver_set_tolerance(reduced_solver *solver, double tolerance); // of reduced_settings

/* Lets an observer see every iteration of Gauss-Newton, without kept factors, and the end of each
 * solution; NULL: none. */
void reduced_solver_observe(reduced_solver *solver, reduced_observer *observer,
                            reduced_observer_end *end, void *context);

/* The model's rows in the least-squares problem of the present iteration, in their order. */
const size_t *reduced_system_rows(size_t *num_rows, const reduced_solver *solver);

/* Newton from the state given. Not converged is an outcome in info->status, not an error. */
ehd_status reduced_solve(
    // output:
    reduced_info *info,
    // in and out: start and solution
    reduced_state *state,
    // input:
    reduced_solver *solver, const ehd_contact *contact,
    const reduced_squeeze *squeeze, // NULL when stationary
    ehd_error *error);

/* Whether the exit of a state lies within the node before `exit`; X at which the pressure ends, at
 * Y = 0. */
bool reduced_exit_divides(const reduced_state *state, const reduced_model *model);
double reduced_exit_position(const reduced_state *state, const reduced_model *model);

/* Scalars of a state, solved or not. */
contact_scalars reduced_scalars(reduced_solver *solver, const reduced_state *state,
                                const ehd_contact *contact);

/* H of the present state at any node. */
typedef double film_function(const void *context, size_t node);

/* Where the film of a line's last solution has a dip before the band, in time: finds its minimum
 * with the films of the nodes between those needed, which `film` tells. */
void reduced_find_dip(
    // in and out:
    contact_scalars *scalars,
    // input:
    const reduced_solver *solver, film_function *film, const void *context);

/* Least and largest P of the last solution before its exit, at the needed nodes and in the band.
 * */
typedef struct reduced_pressures {
    double least, largest;
} reduced_pressures;

/* Whether a thinned flow is one for which the equations do not hold (reynolds_flow_doubt), at the
 * selected rows. */
bool reduced_doubts_flow(reduced_solver *solver, const reduced_state *state,
                         const ehd_contact *contact);

/* Takes a pressure into a range; one that is not a number stays. */
void reduced_pressures_include(reduced_pressures *range, double pressure);
reduced_pressures reduced_pressure_range(reduced_solver *solver, const reduced_state *state);

typedef enum reduced_film {
    REDUCED_CENTRAL_FILM,
    REDUCED_MINIMUM_FILM, // at the lowest needed node with pressure
    NUM_REDUCED_FILMS
} reduced_film;

/* How far a film of the last solution moves by what its last least squares left in the
 * rows, D f + D J dz: the root of the sum of the squares of what each row does, as if these had
 * nothing to do with each other. NaN: no node has pressure. */
double reduced_film_error(
    // output:
    double *influence, // [rows of the model] change of the film by an error of 1 in a weighted row;
                       // 0 where it was not part of the least squares; NULL: not wanted
    // in and out:
    reduced_solver *solver, reduced_film film);

/* How far other quantities of the last stationary solution move by that, and by residuals of other
 * rows: P at X = 0, the exit in half widths (NaN: exits are nodes), the load over the reference,
 * and the most that P and H move at the node of any row before the exit. */
typedef struct reduced_errors {
    double central_pressure, exit_position, load, pressure, film;
} reduced_errors;
reduced_errors reduced_other_errors(
    // in and out:
    reduced_solver *solver,
    // input:
    const reduced_state *state, const ehd_contact *contact,
    const double *added); // [rows of the model] squares of the residuals that count as one there

/* The same of P where it is largest at the node of a row; one quantity in place of all nodes'. */
double reduced_peak_error(
    // in and out:
    reduced_solver *solver,
    // input:
    const double *added); // as of reduced_other_errors

/* Values of a state and, identical to the last bit, of the last solution with `exit_at_node`. */
void reduced_values_of(reduced_values *values, const reduced_model *model,
                       const double *coordinates, const size_t *exit);
void reduced_last_values(reduced_values *values, const reduced_solver *solver);

/* Traction of a state of these scalars, of a model with a cubature. */
contact_traction reduced_traction(reduced_solver *solver, const reduced_state *state,
                                  const ehd_contact *contact, const contact_scalars *scalars);

/* How far the friction of the last stationary solution moves, over the reference load, by what
 * reduced_other_errors counts and, where exits are nodes, by one that is a node off; of a model
 * with a cubature. `contact`: its, with sliding of any kind. */
double reduced_friction_error(
    // in and out:
    reduced_solver *solver,
    // input:
    const reduced_state *state, const ehd_contact *contact,
    const double *added); // [rows of the model]

/* P, zero behind the exit, and H of the last solution at the needed nodes, [num_needed]. */
typedef struct reduced_needed {
    const double *pressure, *film;
} reduced_needed;
reduced_needed reduced_needed_fields(const reduced_solver *solver);

/* P and rho H of the last solution at the rows' nodes, [num_rows]; `mass` may be NULL. */
void reduced_row_values(double *pressure, double *mass, const reduced_solver *solver,
                        const ehd_contact *contact);

/* P at `count` nodes of the band from index `first` on, uncut. */
void reduced_band_pressure(double *pressure, const reduced_model *model, const double *coordinates,
                           size_t first, size_t count);

/* Keeps the factorised Jacobian at a state for later steps in time: reduced_solve with a squeeze
 * then iterates with it, and with own Jacobians only where that does not converge. Its limit
 * differs by the product of the remaining residual and the change of the Jacobian since. The
 * factors depend on the arguments alone, so that they can be reproduced. */
void reduced_keep_factors(reduced_solver *solver, const reduced_state *state,
                          const ehd_contact *contact, double rate);
void reduced_drop_factors(reduced_solver *solver);

/* Keeps those that the last solution ended with (info.near_factors). Returns the state at which
 * they were made, from which reduced_keep_factors makes the same ones; valid until the next
 * solution. */
const reduced_state *reduced_take_factors(reduced_solver *solver);

/* Start from the trained solutions: a quadratic fit through those nearest in (ln M, ln(1 + alpha
 * p_H)/2), an affine one where that would extrapolate, or the nearest solution where this would;
 * pressures are added spike upon spike (start_shift.h). Of several trained lubricants, those are
 * nearer that at the same Hertz pressure are as viscous and dense as the contact's, and the fit is
 * linear in these differences, as in that of how much the flow is thinned. */
void reduced_guess(reduced_state *state, const reduced_model *model, contact_place place);

/* Solves from reduced_guess and, where that does not converge, from each of the nearest trained
 * solutions, one after the other. Errors of reduced_solve; iterations and times are the sum. */
ehd_status reduced_solve_from_training(
    // output:
    reduced_info *info, reduced_state *state,
    // input:
    reduced_solver *solver, const reduced_model *model, const ehd_contact *contact,
    ehd_error *error);

/* Start from the nearest trained solution that is not this contact's own. */
void reduced_neighbour(reduced_state *state, const reduced_model *model, contact_place place);

/* What the full model's grid does to the films, interpolated in the same way between the trained
 * solutions of which it is known; NaN: of none, infinite: the grid is too coarse to tell. */
film_effects reduced_effects(const reduced_model *model, contact_place place);

#endif
