/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The online solver: Gauss-Newton on the weighted least squares of the selected rows, with a local exit
 * boundary (paper, eqs. 28, 37-39). Nothing in here is of the size of the grid. */
#ifndef EHD_REDUCED_SOLVER_H
#define EHD_REDUCED_SOLVER_H

#include "romrun/reduced_model.h"

typedef struct reduced_settings {
    double tolerance; // relative change of the central film that another iteration would make; 1e-8
    size_t max_iterations; // 40
} reduced_settings;

reduced_settings reduced_default_settings(void);

/* A reduced state: z = (a, d, H0) and the exit. */
typedef struct reduced_state {
    double *coordinates; // [num_unknowns]
    size_t exit;         // grid node
} reduced_state;

typedef struct reduced_info {
    ehd_status status; // EHD_OK, EHD_NOT_CONVERGED or EHD_UNTRUSTED (exit not settled)
    size_t iterations;
    double residual; // |D f| over the rows and the linear equations, at the last iteration
    double central_film_thickness, minimum_film_thickness, central_pressure;
    double exit_position, load;
    double seconds, seconds_rows, seconds_linear, seconds_exit;
    const char *reason;
} reduced_info;

/* Called with the weighted residual D f and the weighted product J dz of every iteration (row
 * selection's snapshots, section 3.2); entries of rows behind the exit are zero. */
typedef ehd_status reduced_observer(void *context, const double *weighted_residual, // [num_rows]
                                    const double *weighted_step,                    // [num_rows]
                                    ehd_error *error);

typedef struct reduced_solver reduced_solver;

/* Memory of one solver; the model must outlive it. One object a thread. EHD_MEMORY. */
ehd_status reduced_solver_create(
    // output:
    reduced_solver **solver, // free with reduced_solver_free
    // input:
    const reduced_model *model, const reduced_settings *settings, ehd_error *error);
reduced_solver *reduced_solver_free(reduced_solver *solver); // accepts and returns NULL

void reduced_solver_observe(reduced_solver *solver, reduced_observer *observer, void *context);

/* Newton from the state given. Not converged is an outcome in info->status, not an error. */
ehd_status reduced_solve(
    // output:
    reduced_info *info,
    // in and out: start and solution
    reduced_state *state,
    // input:
    reduced_solver *solver, const ehd_contact *contact, ehd_error *error);

/* Start from the trained solutions: an affine fit through those nearest in (ln M, alpha p_H), or the
 * nearest one where the fit would extrapolate. */
void reduced_guess(reduced_state *state, const reduced_model *model, double moes_M,
                   double alpha_p_H);

/* Start from the nearest trained solution that is not this contact's own. */
void reduced_neighbour(reduced_state *state, const reduced_model *model, double moes_M,
                       double alpha_p_H);

/* Whether (M, alpha p_H) lies in the convex hull of the training points. */
int reduced_trained(const reduced_model *model, double moes_M, double alpha_p_H);

#endif
