/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The online solver: Gauss-Newton on the weighted least squares of the selected rows, with a local exit
 * boundary (paper, eqs. 28, 37-39). Nothing in here is of the size of the grid. */
#ifndef EHD_REDUCED_SOLVER_H
#define EHD_REDUCED_SOLVER_H

#include "romrun/model/reduced_model.h"
#include <stdbool.h>

/* Solves the least-squares problem of an iteration, step = argmin |matrix step + right|: the model's rows before the
 * exit in their order, weighted, then the linear equations. Entry of reduced_settings, so that tests and research can
 * put another method or other weights in. EHD_NOT_CONVERGED: no solution. */
typedef ehd_status reduced_linear_solver(double *step, // out: [num_unknowns]
                                         void *context,
                                         const double *matrix, // [num_rows, num_unknowns]
                                         const double *right,  // [num_rows]
                                         size_t num_rows, size_t num_unknowns);

typedef struct reduced_settings {
    double tolerance; // relative change of the central film that another iteration would make; 1e-8
    size_t max_iterations; // 40
    // half widths between the lines of a point contact on which the exit is looked for, with the lines in between
    // interpolated (paper, section 3.3); 0, as set, all lines: it takes more iterations than it saves time
    double exit_spacing;
    reduced_linear_solver *solve_linear; // NULL: least_squares_solve
    void *linear_context;
} reduced_settings;

reduced_settings reduced_default_settings(void);

/* A reduced state: z = (a, d, H0) and the exit line (eq. 39). */
typedef struct reduced_state {
    double *coordinates; // [num_unknowns]
    size_t exit;         // column on the line where Y = 0; of a line contact a grid node
    size_t *exits;       // [num_lines] columns on all lines of the grid; NULL on a line contact
} reduced_state;

/* Memory for a state of a model, all zero. EHD_MEMORY. */
ehd_status reduced_state_init(reduced_state *state, const reduced_model *model, ehd_error *error);
void reduced_state_free(reduced_state *state);

/* Both of the same model. */
void reduced_state_copy(reduced_state *target, const reduced_state *source,
                        const reduced_model *model);

/* Its exit line, [num_lines], and a new one. */
const size_t *reduced_state_exits(const reduced_state *state);
void reduced_state_set_exits(reduced_state *state, const reduced_model *model, const size_t *exits);

typedef struct reduced_info {
    ehd_status status; // EHD_OK, EHD_NOT_CONVERGED or EHD_UNTRUSTED (exit not settled)
    size_t iterations;
    bool own_jacobian; // made one, because there were no kept factors or they did not do
    double residual;   // |D f| over the rows and the linear equations, at the last iteration
    contact_scalars scalars;
    double seconds, seconds_rows, seconds_linear, seconds_exit;
    const char *reason;
} reduced_info;

/* What a state is at the needed nodes; linear in the coordinates, since the exit enters by its checkpoint
 * only. */
typedef struct reduced_values {
    size_t checkpoint; // of the exit (reduced_model_checkpoint)
    double *pressure;  // [num_needed] P, uncut
    double *cut;       // [num_cut] the checkpoint's cut table times z
} reduced_values;

ehd_status reduced_values_init(reduced_values *values, const reduced_model *model,
                               ehd_error *error); // EHD_MEMORY
void reduced_values_free(reduced_values *values);

/* Called with the weighted residual D f and the weighted product J dz of every iteration (row
 * selection's snapshots, section 3.2); entries of rows behind the exit are zero. */
typedef ehd_status reduced_observer(void *context, const double *weighted_residual, // [num_rows]
                                    const double *weighted_step,                    // [num_rows]
                                    ehd_error *error);

/* How the film of earlier states enters: the time derivative of rho H is rate * rho H + earlier. */
typedef struct reduced_squeeze {
    double rate;                                      // 1 / dimensionless time
    const double *earlier;                            // [num_rows] at the model's rows
    double (*earlier_at)(void *context, size_t node); // the same at a node of the band
    void *context;
    const reduced_values *start; // of the state that is solved from; NULL: not known
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

void reduced_solver_observe(reduced_solver *solver, reduced_observer *observer, void *context);

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

/* Scalars of a state, solved or not. */
contact_scalars reduced_scalars(reduced_solver *solver, const reduced_state *state);

/* |D f + D J dz| of the last least squares of the last stationary solution: what no step takes away. Before
 * that step the residual may be much larger. */
double reduced_left_residual(const reduced_solver *solver);

/* How far H at X = 0 moves at most by an error of norm 1 in the rows of the last stationary solution:
 * |L^-1 dH/dz| with the factor of its last least squares, which has to have been the solver's own. */
double reduced_central_sensitivity(reduced_solver *solver);

/* Values of a state, and of the last solution, whose bits are the same. */
void reduced_values_of(reduced_values *values, const reduced_model *model,
                       const double *coordinates, const size_t *exit);
void reduced_last_values(reduced_values *values, const reduced_solver *solver);

/* P and rho H of the last solution at the nodes of the model's rows, [num_rows]; `mass` may be NULL. */
void reduced_row_values(double *pressure, double *mass, const reduced_solver *solver,
                        const ehd_contact *contact);

/* P at `count` nodes of the band from place `first` on, whatever the exit. */
void reduced_band_pressure(double *pressure, const reduced_model *model, const double *coordinates,
                           size_t first, size_t count);

/* Keeps the Jacobian's factors at a state, for the steps in time that follow: reduced_solve with a squeeze
 * then iterates with them and makes a Jacobian of its own only where that does not converge. What it
 * converges to differs by the product of the residual that least squares leave and the change of the
 * Jacobian since. A function of its arguments alone, so that it can be made again. */
void reduced_keep_factors(reduced_solver *solver, const reduced_state *state,
                          const ehd_contact *contact, double rate);
void reduced_drop_factors(reduced_solver *solver);

/* Start from the trained solutions: a quadratic fit through those nearest in (ln M, alpha p_H), an affine one
 * where that would extrapolate, or the nearest one where this would. */
void reduced_guess(reduced_state *state, const reduced_model *model, double moes_M,
                   double alpha_p_H);

/* Start from the nearest trained solution that is not this contact's own. */
void reduced_neighbour(reduced_state *state, const reduced_model *model, double moes_M,
                       double alpha_p_H);

/* The trained range: the convex hull of the training points in (M, alpha p_H), and how fast a contact
 * changed at most. */
typedef struct trained_range trained_range;
trained_range *trained_range_create(const reduced_model *model); // NULL: no memory
trained_range *trained_range_free(trained_range *range);         // accepts and returns NULL

/* Why a contact lies outside, or NULL. `rate`: frame_rate, 0 when stationary. */
const char *trained_range_check(const trained_range *range, double moes_M, double alpha_p_H,
                                double rate);

#endif
