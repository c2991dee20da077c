/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solves a contact with the reduced model: Gauss-Newton on the weighted least squares of the
 * selected rows, with an exit line that each iteration may move (Maier et al. (2015), eqs. 28,
 * 37-39). The cost does not depend on the grid.
 * Called by guess.c and romrun/online, by snapgen, and by podbuild/test_weight.c. */
#ifndef EHD_REDUCED_SOLVER_H
#define EHD_REDUCED_SOLVER_H

#include "common/physics/traction.h"
#include "common/program/solve_seconds.h"
#include "romrun/state/reduced_state.h"
#include <stdbool.h>

/* Solves the least-squares problem of an iteration, step = argmin |matrix step + right|. The matrix
 * has the weighted rows before the exit in the model's order, then the linear equations (projected
 * elasticity and closure). Tests and research programs may set a function with another method or
 * other weights in reduced_settings. EHD_NOT_CONVERGED: there is no solution. */
typedef ehd_status reduced_linear_solver(double *step, // out: [num_unknowns]
                                         void *context,
                                         const double *matrix, // [num_rows, num_unknowns]
                                         const double *right,  // [num_rows]
                                         size_t num_rows, size_t num_unknowns);

typedef struct reduced_settings {
    // the iteration ends when another iteration would change the central film by less than this
    // fraction; default 1e-8
    double tolerance;
    size_t max_iterations; // default 40
    // In a point contact the exit is searched for on grid lines at this distance from each other,
    // half widths. The exits of the other lines are interpolated (Maier et al. (2015), section
    // 3.3). 0, the default: all lines are searched, since interpolation needs more iterations and
    // saves no time.
    double exit_spacing;
    bool exit_at_node; // true: each exit is a node, as in transient runs; false: an exit may lie
                       // between nodes (exit_is_within_node)
    reduced_linear_solver *solve_linear; // NULL: least_squares_solve
    void *linear_context;
} reduced_settings;

/* The default settings, named in the comments above. */
extern const reduced_settings reduced_defaults;

typedef struct reduced_info {
    ehd_status status; // EHD_OK, EHD_NOT_CONVERGED or EHD_UNTRUSTED (exit not settled)
    size_t iterations;
    bool own_jacobian; // true: new Jacobians were computed; false: kept factors sufficed
    bool near_factors; // true: the last iterations used the factors of one new Jacobian
    double residual;   // |D f| of the rows and the linear equations, at the last iteration
    contact_scalars scalars;
    solve_seconds seconds;
    const char *reason;
} reduced_info;

/* Receives the weighted residual D f and the weighted step D J dz of every iteration. These are the
 * snapshots of the row selection (Maier et al. (2015), section 3.2). Entries of rows behind the
 * exit are zero. */
typedef ehd_status reduced_observer(void *context, const double *weighted_residual, // [num_rows]
                                    const double *weighted_step,                    // [num_rows]
                                    ehd_error *error);

/* Receives the outcome at the end of a solution. The values that the observer received from a
 * diverged iteration are larger than those of all other solutions together. Do not keep them. */
typedef ehd_status reduced_observer_end(void *context, const reduced_info *info, ehd_error *error);

/* The squeeze term: the time derivative of rho H is rate * rho H + previous. */
typedef struct reduced_squeeze {
    double rate;                                       // 1 / dimensionless time
    const double *previous;                            // [num_rows] at the model's rows
    double (*previous_at)(void *context, size_t node); // returns `previous` at a node of the band
    void *context;
    const reduced_values *start; // values of the initial state; NULL: these values are not known
    // [num_needed] P of the state of the previous time step, not set to zero behind the exit; NULL:
    // these pressures are not known
    const double *last;
} reduced_squeeze;

typedef struct reduced_solver reduced_solver;

/* Creates a solver. Each thread needs its own solver. The model must outlive the solver. Errors:
 * EHD_MEMORY. */
ehd_status reduced_solver_create(
    // output:
    reduced_solver **solver, // free with reduced_solver_free
    // input:
    const reduced_model *model, const reduced_settings *settings, ehd_error *error);
reduced_solver *reduced_solver_free(reduced_solver *solver); // accepts and returns NULL

/* Sets the tolerance of reduced_settings. */
void reduced_solver_set_tolerance(reduced_solver *solver, double tolerance);

/* Sets an observer of every Gauss-Newton iteration and of the end of each solution; NULL: no
 * observer. With an observer the solver does not use kept factors. */
void reduced_solver_observe(reduced_solver *solver, reduced_observer *observer,
                            reduced_observer_end *end, void *context);

/* Returns the model's rows in the present least-squares problem, in the order of the problem. */
const size_t *reduced_system_rows(size_t *num_rows, const reduced_solver *solver);

/* Solves by Gauss-Newton iteration from the given state. If the iteration does not converge, the
 * function returns EHD_OK and sets info->status to EHD_NOT_CONVERGED. */
ehd_status reduced_solve(
    // output:
    reduced_info *info,
    // in and out: initial state, then the solution
    reduced_state *state,
    // input:
    reduced_solver *solver, const ehd_contact *contact,
    const reduced_squeeze *squeeze, // NULL when stationary
    ehd_error *error);

/* Returns the scalars of a state. The state need not be a solution. */
contact_scalars reduced_scalars(reduced_solver *solver, const reduced_state *state,
                                const ehd_contact *contact);

/* Corrects the minimum film of the last solution of a transient line contact if the film has a dip
 * before the band. `film` returns H at the nodes between the needed nodes. */
void reduced_find_dip(
    // in and out:
    contact_scalars *scalars,
    // input:
    const reduced_solver *solver, film_function *film, const void *context);

/* Checks whether the equations of a thinned flow are too inaccurate at the selected rows
 * (reynolds_flow_doubt). */
bool reduced_doubts_flow(reduced_solver *solver, const reduced_state *state,
                         const ehd_contact *contact);

/* Returns the least and largest P of the last solution. */
reduced_pressures reduced_pressure_range(reduced_solver *solver, const reduced_state *state);

/* Returns the traction of a state, whose scalars are `scalars`. The model must have a cubature. */
contact_traction reduced_traction(reduced_solver *solver, const reduced_state *state,
                                  const ehd_contact *contact, const contact_scalars *scalars);

/* Copies the values of the last solution at the needed nodes. With `exit_at_node` the result is
 * bit-identical to the result of reduced_values_of. */
void reduced_last_values(reduced_values *values, const reduced_solver *solver);

/* P (zero behind the exit) and H of the last solution at the needed nodes, [num_needed]. */
typedef struct reduced_needed {
    const double *pressure, *film;
} reduced_needed;
reduced_needed reduced_needed_fields(const reduced_solver *solver);

/* Writes P and rho H of the last solution at the rows' nodes, [num_rows]; `mass` may be NULL. */
void reduced_row_values(double *pressure, double *mass, const reduced_solver *solver,
                        const ehd_contact *contact);

/* Factorises the Jacobian at a state and keeps the factors for later time steps. With a squeeze
 * term, reduced_solve then iterates with the kept factors first, and computes new Jacobians only if
 * that iteration fails. The kept factors change the result by the product of the remaining residual
 * and the change of the Jacobian. The factors depend on the arguments alone, so the same factors
 * can be computed again. */
void reduced_keep_factors(reduced_solver *solver, const reduced_state *state,
                          const ehd_contact *contact, double rate);
void reduced_drop_factors(reduced_solver *solver);

/* Keeps the factors with which the last solution ended (info.near_factors). Returns the state at
 * which their Jacobian was evaluated. From this state, reduced_keep_factors computes the same
 * factors. The state is valid until the next solution. */
const reduced_state *reduced_take_factors(reduced_solver *solver);

#endif
