/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The online solver: Gauss-Newton on the weighted least squares of the selected rows, with a local
 * exit boundary (Maier et al. (2015), eqs. 28, 37-39). Its cost does not depend on the grid. */
#ifndef EHD_REDUCED_SOLVER_H
#define EHD_REDUCED_SOLVER_H

#include "common/physics/contact_place.h"
#include "common/physics/traction.h"
#include "romrun/model/reduced_model.h"
#include <stdbool.h>

/* Solves the least-squares problem of an iteration, step = argmin |matrix step + right|. The rows
 * are the model's weighted rows before the exit in their order, then the linear equations. Tests
 * and research enter other methods or weights in reduced_settings. EHD_NOT_CONVERGED: there is no
 * solution. */
typedef ehd_status reduced_linear_solver(double *step, // out: [num_unknowns]
                                         void *context,
                                         const double *matrix, // [num_rows, num_unknowns]
                                         const double *right,  // [num_rows]
                                         size_t num_rows, size_t num_unknowns);

typedef struct reduced_settings {
    // the iteration ends when another one would change the central film by a smaller relative
    // amount; default 1e-8
    double tolerance;
    size_t max_iterations; // default 40
    // half widths between the lines of a point contact on which the exit is searched for. The exits
    // of the other lines are interpolated (Maier et al. (2015), section 3.3). 0, the default: all
    // lines, since interpolation costs more iterations than it saves time.
    double exit_spacing;
    bool exit_at_node; // true: at a node, as in time; false: only where exit_is_within_node is
                       // false
    reduced_linear_solver *solve_linear; // NULL: least_squares_solve
    void *linear_context;
} reduced_settings;

/* Returns the default settings, which the comments above name. */
reduced_settings reduced_default_settings(void);

/* A reduced state: z = (a, d, H0) and the exit line (eq. 39). */
typedef struct reduced_state {
    double *coordinates; // [num_unknowns]
    size_t exit;         // column on the line Y = 0; for a line contact a grid node
    size_t *exits;       // [num_lines] columns on all lines of the grid; NULL on a line contact
    // distance of the exit from the node before `exit`, in steps, 0 to 1, if it lies within a node;
    // in time as in exit_place. NaN: it lies at a node, or is not known yet.
    double exit_offset;
} reduced_state;

/* Allocates a state of a model, with all coordinates zero. Errors: EHD_MEMORY. */
ehd_status reduced_state_init(reduced_state *state, const reduced_model *model, ehd_error *error);
void reduced_state_free(reduced_state *state);

/* Copies a state of the same model. */
void reduced_state_copy(reduced_state *target, const reduced_state *source,
                        const reduced_model *model);

/* Return and set the exit line, [num_lines], at nodes. An exit outside of the model's band, as in a
 * training solution without an exit, is moved to the nearest column of the band. */
const size_t *reduced_state_exits(const reduced_state *state);
void reduced_state_set_exits(reduced_state *state, const reduced_model *model, const size_t *exits);

typedef struct reduced_info {
    ehd_status status; // EHD_OK, EHD_NOT_CONVERGED or EHD_UNTRUSTED (exit not settled)
    size_t iterations;
    bool own_jacobian; // solved with new Jacobians, not with the factors kept before
    bool near_factors; // near the solution it used the factors of the last new Jacobian
    double residual;   // |D f| of the rows and the linear equations, at the last iteration
    contact_scalars scalars;
    double seconds, seconds_rows, seconds_linear, seconds_exit;
    const char *reason;
} reduced_info;

/* Values of a state at the needed nodes. At one checkpoint they are linear in the coordinates. */
typedef struct reduced_values {
    size_t checkpoint; // checkpoint of the exit (reduced_model_checkpoint)
    double *pressure;  // [num_needed] P, uncut
    double *cut;       // [rows of the cut table] the checkpoint's cut table times z
} reduced_values;

/* Allocates values of a model's state, with no checkpoint yet. Errors: EHD_MEMORY. */
ehd_status reduced_values_init(reduced_values *values, const reduced_model *model,
                               ehd_error *error);
void reduced_values_free(reduced_values *values);

/* Receives D f and D J dz of every iteration, the snapshots of the row selection (section 3.2).
 * Entries of rows behind the exit are zero. */
typedef ehd_status reduced_observer(void *context, const double *weighted_residual, // [num_rows]
                                    const double *weighted_step,                    // [num_rows]
                                    ehd_error *error);

/* Receives the outcome at the end of a solution. The values of a diverged iteration are larger than
 * all others together and should not be kept. */
typedef ehd_status reduced_observer_end(void *context, const reduced_info *info, ehd_error *error);

/* The squeeze term: the time derivative of rho H is rate * rho H + previous. */
typedef struct reduced_squeeze {
    double rate;                                       // 1 / dimensionless time
    const double *previous;                            // [num_rows] at the model's rows
    double (*previous_at)(void *context, size_t node); // returns `previous` at a node of the band
    void *context;
    const reduced_values *start; // values of the state at the start; NULL: not known
    const double *last;          // [num_needed] P of the last state, uncut; NULL: not known
} reduced_squeeze;

typedef struct reduced_solver reduced_solver;

/* Creates a solver, one object per thread. The model must outlive it. Errors: EHD_MEMORY. */
ehd_status reduced_solver_create(
    // output:
    reduced_solver **solver, // free with reduced_solver_free
    // input:
    const reduced_model *model, const reduced_settings *settings, ehd_error *error);
reduced_solver *reduced_solver_free(reduced_solver *solver); // accepts and returns NULL

/* Sets the tolerance of reduced_settings. */
void reduced_solver_set_tolerance(reduced_solver *solver, double tolerance);

/* Sets an observer of every Gauss-Newton iteration and of the end of each solution; NULL: none.
 * With an observer the solver does not use kept factors. */
void reduced_solver_observe(reduced_solver *solver, reduced_observer *observer,
                            reduced_observer_end *end, void *context);

/* Returns the model's rows in the least-squares problem of the present iteration, in their
 * order. */
const size_t *reduced_system_rows(size_t *num_rows, const reduced_solver *solver);

/* Solves by Gauss-Newton iteration from the given state. info->status reports an iteration that
 * does not converge; this is not an error. */
ehd_status reduced_solve(
    // output:
    reduced_info *info,
    // in and out: start and solution
    reduced_state *state,
    // input:
    reduced_solver *solver, const ehd_contact *contact,
    const reduced_squeeze *squeeze, // NULL when stationary
    ehd_error *error);

/* Check whether the exit of a state lies within the node before `exit`, and return X at which the
 * pressure ends, at Y = 0. */
bool reduced_exit_divides(const reduced_state *state, const reduced_model *model);
double reduced_exit_position(const reduced_state *state, const reduced_model *model);

/* Returns the scalars of a state, solved or not. */
contact_scalars reduced_scalars(reduced_solver *solver, const reduced_state *state,
                                const ehd_contact *contact);

/* Returns H of the present state at any node. */
typedef double film_function(const void *context, size_t node);

/* Corrects the minimum film of a line's last solution in time if the film has a dip before the
 * band. It finds the minimum with the films of the nodes between the needed ones, which `film`
 * returns. */
void reduced_find_dip(
    // in and out:
    contact_scalars *scalars,
    // input:
    const reduced_solver *solver, film_function *film, const void *context);

/* Least and largest P of the last solution before its exit, at the needed nodes and in the band. */
typedef struct reduced_pressures {
    double least, largest;
} reduced_pressures;

/* Checks whether the equations of a thinned flow do not hold at the selected rows
 * (reynolds_flow_doubt). */
bool reduced_doubts_flow(reduced_solver *solver, const reduced_state *state,
                         const ehd_contact *contact);

/* Extends a range by a pressure; a NaN replaces both limits and stays. reduced_pressure_range
 * returns the range of the last solution. */
void reduced_pressures_include(reduced_pressures *range, double pressure);
reduced_pressures reduced_pressure_range(reduced_solver *solver, const reduced_state *state);

typedef enum reduced_film {
    REDUCED_CENTRAL_FILM,
    REDUCED_MINIMUM_FILM, // at the lowest needed node with pressure
    NUM_REDUCED_FILMS
} reduced_film;

/* Returns how far the residual that the last least squares leave, D f + D J dz, moves a film of the
 * last solution. The rows are taken as independent: the result is the root of the sum of the
 * squares of their effects. NaN: no node has pressure. */
double reduced_film_error(
    // output:
    double *influence, // [rows of the model] change of the film by an error of 1 in a weighted row;
                       // 0 for rows outside of the least squares. NULL: not wanted.
    // in and out:
    reduced_solver *solver, reduced_film film);

/* Effects of the residual that the last least squares leave, and of residuals of other rows, on
 * other quantities of the last stationary solution: P at X = 0, the exit in half widths (NaN: exits
 * are nodes), the load over the reference, and the largest change of P and H at the node of any row
 * before the exit. */
typedef struct reduced_errors {
    double central_pressure, exit_position, load, pressure, film;
} reduced_errors;
reduced_errors reduced_other_errors(
    // in and out:
    reduced_solver *solver,
    // input:
    const reduced_state *state, const ehd_contact *contact,
    const double *added); // [rows of the model] squares of other residuals, counted in this row

/* Returns the effect of these residuals on P at the row's node where P is largest. It costs one
 * quantity in place of one per node. */
double reduced_peak_error(
    // in and out:
    reduced_solver *solver,
    // input:
    const double *added); // see reduced_other_errors

/* Compute the values of a state, and of the last solution. With `exit_at_node` both are identical
 * to the last bit. */
void reduced_values_of(reduced_values *values, const reduced_model *model,
                       const double *coordinates, const size_t *exit);
void reduced_last_values(reduced_values *values, const reduced_solver *solver);

/* Returns the traction of a state with these scalars. The model has a cubature. */
contact_traction reduced_traction(reduced_solver *solver, const reduced_state *state,
                                  const ehd_contact *contact, const contact_scalars *scalars);

/* Returns how far the friction of the last stationary solution moves, over the reference load, by
 * the residuals that reduced_other_errors counts. Where exits are nodes, it adds the effect of an
 * exit that is a node off. The model has a cubature. `contact`: the contact of the solution, with
 * sliding of any kind. */
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

/* Write P and rho H of the last solution at the rows' nodes, [num_rows]; `mass` may be NULL. */
void reduced_row_values(double *pressure, double *mass, const reduced_solver *solver,
                        const ehd_contact *contact);

/* Computes P, uncut, at `count` nodes of the band from index `first` on. */
void reduced_band_pressure(double *pressure, const reduced_model *model, const double *coordinates,
                           size_t first, size_t count);

/* Keeps the factorised Jacobian at a state for later steps in time. With a squeeze term
 * reduced_solve then iterates with it, and with own Jacobians only if that does not converge. The
 * result differs by the product of the remaining residual and the change of the Jacobian since
 * then. The factors depend on the arguments alone, so they can be reproduced. */
void reduced_keep_factors(reduced_solver *solver, const reduced_state *state,
                          const ehd_contact *contact, double rate);
void reduced_drop_factors(reduced_solver *solver);

/* Keeps the factors with which the last solution ended (info.near_factors). Returns the state at
 * which they were made, from which reduced_keep_factors makes the same factors. It is valid until
 * the next solution. */
const reduced_state *reduced_take_factors(reduced_solver *solver);

/* Sets a start from the trained solutions nearest in (ln M, ln(1 + alpha p_H)/2): a quadratic fit,
 * an affine fit if the quadratic one would extrapolate, or the nearest solution if the affine one
 * would. Pressures are added spike upon spike (start_shift.h). Lubricants are compared at the same
 * Hertz pressure: states whose lubricant is as viscous and dense as the contact's are nearer. The
 * fit is linear in these differences, and in the difference of the thinning. */
void reduced_guess(reduced_state *state, const reduced_model *model, contact_place place);

/* Solves from reduced_guess. If that does not converge, it starts from each of the nearest
 * trained solutions, one after the other. Iterations and times are the sum. Errors: those of
 * reduced_solve. */
ehd_status reduced_solve_from_training(
    // output:
    reduced_info *info, reduced_state *state,
    // input:
    reduced_solver *solver, const reduced_model *model, const ehd_contact *contact,
    ehd_error *error);

/* Sets a start: the nearest trained solution that is not this contact's own. */
void reduced_neighbour(reduced_state *state, const reduced_model *model, contact_place place);

/* Returns error estimates of the films due to the full model's grid, interpolated like the starts
 * between the trained solutions with known estimates. NaN: no solution has one. Infinite: the grid
 * is too coarse for an estimate. */
film_effects reduced_effects(const reduced_model *model, contact_place place);

#endif
