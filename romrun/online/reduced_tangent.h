/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes derivatives of a reduced solution from the Jacobian of its least-squares problem
 * (romrun/library/README.md, The tangent).
 * Called by online_derivatives.c and frame_tangent.c. */
#ifndef EHD_REDUCED_TANGENT_H
#define EHD_REDUCED_TANGENT_H

#include "romrun/solve/reduced_solver.h"

typedef struct reduced_tangent reduced_tangent;

/* Creates a tangent. The tangent has its own memory, so it does not change the last solution of a
 * solver. The model must outlive the tangent. Errors: EHD_MEMORY. */
ehd_status reduced_tangent_create(
    // output:
    reduced_tangent **self, // free with reduced_tangent_free
    // input:
    const reduced_model *model, ehd_error *error);
reduced_tangent *reduced_tangent_free(reduced_tangent *self); // accepts and returns NULL

/* The equations of a solution. */
typedef struct reduced_equations {
    const ehd_contact *contact;
    const reduced_squeeze *squeeze; // NULL: stationary. Its members `start` and `last` are not used
} reduced_equations;

/* Linearises the equations at their solution. `exit_at_node`: as in reduced_settings.
 * EHD_NOT_CONVERGED: the least squares have no single finite solution. */
ehd_status reduced_tangent_at(
    // in and out:
    reduced_tangent *self,
    // input:
    const reduced_state *state, const reduced_equations *equations, bool exit_at_node,
    ehd_error *error);

/* A change of the solution. */
typedef struct reduced_change {
    const double *coordinates; // [num_unknowns] owned by the tangent, valid until the next call of
                               // the function that has filled it
    double exit_offset; // change of the exit within its cell, in grid steps; 0 if exits are nodes
} reduced_change;

/* Computes the change dz of the solution per unit of a parameter: (J^T J) dz = -J^T dr. `beside`:
 * the equations with the parameter changed by -distance/2 and by +distance/2. dr: difference of
 * their residuals, divided by `distance`. Second derivatives, multiplied by the residual of the
 * rows, are neglected. They would change the result by a tenth to a hundredth of the effect of the
 * truncated modes (romrun/library/README.md). EHD_NOT_CONVERGED: as in reduced_tangent_at. */
ehd_status reduced_tangent_along(
    // output:
    reduced_change *change,
    // in and out:
    reduced_tangent *self,
    // input:
    const reduced_equations beside[2], double distance, ehd_error *error);

/* Change of the frame along a parameter: the contacts at -distance/2 and +distance/2, and the
 * scales of their frames divided by the scales of the middle frame. */
typedef struct reduced_motion {
    const ehd_contact *contacts; // [2]
    double film_scale[2], half_width[2];
    double distance;
} reduced_motion;

/* If a parameter varies as exp(sT), the change of the solution depends on s. Computes the
 * derivative of this change with respect to s at s = 0, for stationary solutions only. `change`:
 * the change at s = 0, from reduced_tangent_along. In the moving frame, with the half width a, the
 * squeeze term is d(rho H)/dT + rho H d(ln film scale)/dT - X d(rho H)/dX d(ln a)/dT. */
ehd_status reduced_tangent_slow(
    // output:
    reduced_change *slow,
    double *bound, // change of the approach of `slow` that the remaining least-squares residual
                   // causes, with the errors of the rows taken as independent
    // in and out:
    reduced_tangent *self,
    // input:
    const reduced_change *change, const ehd_contact *contact, const reduced_motion *motion,
    ehd_error *error);

/* Scalars of a solution and its largest pressure, in the contact's frame. */
typedef struct reduced_quantities {
    contact_scalars scalars; // the exit is NaN if only its node is known
    double peak_pressure;    // largest P at the needed nodes, in the band and at X = 0
} reduced_quantities;

/* Returns the quantities of the solution of the equations `beside`. This solution is the linearised
 * state plus `distance` times a change. */
reduced_quantities reduced_tangent_quantities(reduced_tangent *self, const reduced_change *change,
                                              double distance, const reduced_equations *beside);

#endif
