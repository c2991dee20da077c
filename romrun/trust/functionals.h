/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the errors of quantities of a solution from residuals (romrun/trust/README.md, Error
 * estimates).
 *
 * A quantity is given by its gradient, the derivatives with respect to the unknowns. The gradient
 * and the factors of the last Newton step give the change of the quantity that an error of 1 in
 * each row causes. The error of the quantity is the root of the sum, over the rows, of (residual
 * times this change)^2. The residual of a row has three parts, whose squares are added:
 * - D f + D J dz, the residual after the last Newton step dz;
 * - solved_system.remaining times D J dz, for the iterations that were not made;
 * - the residuals of the control rows near this row, given as `added`.
 * Called by indicator.c, reduced_march.c and reduced_tangent.c. */
#ifndef EHD_FUNCTIONALS_H
#define EHD_FUNCTIONALS_H

#include "romrun/solve/least_squares.h"
#include "romrun/solve/reduced_solver.h"

typedef enum reduced_film {
    REDUCED_CENTRAL_FILM,
    REDUCED_MINIMUM_FILM, // lowest film at those nodes of the rows' stencils that have pressure
    NUM_REDUCED_FILMS
} reduced_film;

/* Holds work arrays, and results that later calls use again. */
typedef struct functionals functionals;
functionals *functionals_create(const reduced_model *model); // NULL: no memory
functionals *functionals_free(functionals *self);            // accepts and returns NULL

/* Returns the change of a film of the last solution that the residuals of the least squares cause.
 * NaN: no node has pressure. */
double functionals_film_error(
    // output:
    double *influence, // [rows of the model] change of the film due to an error of 1 in a weighted
                       // row; 0 for rows outside of the least squares. NULL: no influence is needed
    // in and out:
    functionals *self, reduced_solver *solver,
    // input:
    reduced_film film);

/* Errors of other quantities of the last stationary solution.
 * - central_pressure: error of P at X = 0.
 * - exit_position: error of the exit in half widths; NaN if exits are nodes.
 * - load: error of the load, divided by the reference load.
 * - pressure, film: largest errors of P and H over the nodes of the rows before the exit. */
typedef struct reduced_errors {
    double central_pressure, exit_position, load, pressure, film;
} reduced_errors;
reduced_errors functionals_other_errors(
    // in and out:
    functionals *self, reduced_solver *solver,
    // input:
    const reduced_state *state, const ehd_contact *contact,
    const double *added); // [rows of the model] for each row, the sum of the squared residuals of
                          // the control rows nearest to this row; added to the square of the
                          // row's own residual

/* Returns the error of the largest P among the nodes of the rows. This takes a fraction of the time
 * of functionals_other_errors. */
double functionals_peak_error(functionals *self, reduced_solver *solver, const double *added);

/* Returns the error of the friction of the last stationary solution, divided by the reference load.
 * If exits are nodes, the result includes the effect of exits that are wrong by one node. The model
 * must have a cubature. `contact`: the contact of the solution, but with any sliding and any law of
 * shear stress. */
double functionals_friction_error(functionals *self, reduced_solver *solver,
                                  const reduced_state *state, const ehd_contact *contact,
                                  const double *added);

/* Computes how much an error of 1 in each row changes a quantity: J (J^T J)^-1 gradient. */
void functionals_moves(
    // output:
    double *moves, // [num_rows]
    // in and out:
    double *gradient, // [num_columns] overwritten
    least_squares *factors,
    // input:
    const double *matrix, size_t num_rows, size_t num_columns); // J

/* Computes the residuals after a Newton step, right + J step. */
void functionals_left(double *left, const double *right, const double *matrix, const double *step,
                      size_t num_rows, size_t num_columns);

#endif
