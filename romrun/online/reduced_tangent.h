/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Derivatives of a reduced solution, from the Jacobian of its least squares (romrun/library/README.md). */
#ifndef EHD_REDUCED_TANGENT_H
#define EHD_REDUCED_TANGENT_H

#include "romrun/online/reduced_solver.h"

typedef struct reduced_tangent reduced_tangent;

/* Memory of its own, so that a solver's last solution stays as it is; the model must outlive it.
 * EHD_MEMORY. */
ehd_status reduced_tangent_create(
    // output:
    reduced_tangent **self, // free with reduced_tangent_free
    // input:
    const reduced_model *model, ehd_error *error);
reduced_tangent *reduced_tangent_free(reduced_tangent *self); // accepts and returns NULL

/* What a solution is of. */
typedef struct reduced_equations {
    const ehd_contact *contact;
    const reduced_squeeze *squeeze; // NULL when stationary; its `start` and `last` do not count
} reduced_equations;

/* Linearises the equations at their solution. `exit_at_node` as in reduced_settings.
 * EHD_NOT_CONVERGED: the least squares have no single finite solution. */
ehd_status reduced_tangent_at(
    // in and out:
    reduced_tangent *self,
    // input:
    const reduced_state *state, const reduced_equations *equations, bool exit_at_node,
    ehd_error *error);

/* A change of the solution. */
typedef struct reduced_change {
    const double *coordinates; // [num_unknowns], the tangent's; one of each kind
    double exit_offset;        // of an exit within a node, steps; 0 where exits are nodes
} reduced_change;

/* The change of the solution per unit of a parameter, from the equations half a distance before and
 * behind: (J^T J) dz = -J^T dr. Gauss-Newton's part suffices: the second derivatives that it lacks are
 * multiplied by what rows leave, and change derivatives by a tenth to a hundredth of what the truncated
 * modes do to them (romrun/library/README.md). EHD_NOT_CONVERGED as above. */
ehd_status reduced_tangent_along(
    // output:
    reduced_change *change,
    // in and out:
    reduced_tangent *self,
    // input:
    const reduced_equations beside[2], double distance, ehd_error *error);

/* How a frame moves that the equations stand in: contacts half a distance before and behind, and their
 * scales over those between them. */
typedef struct reduced_motion {
    const ehd_contact *contacts; // [2]
    double film_scale[2], half_width[2];
    double distance;
} reduced_motion;

/* Where the parameter varies with T as exp(sT), the solution does by `change`, that of reduced_tangent_along,
 * at s = 0: the derivative of that by s. In the moving frame what the squeeze term takes is
 * d(rho H)/dT + rho H d(ln film scale)/dT - X d(rho H)/dX d(ln a)/dT. Stationary solutions only. */
ehd_status reduced_tangent_slow(
    // output:
    reduced_change *slow,
    double *bound, // by how much what least squares leave of it moves its approach, as if rows had
                   // nothing to do with each other
    // in and out:
    reduced_tangent *self,
    // input:
    const reduced_change *change, const ehd_contact *contact, const reduced_motion *motion,
    ehd_error *error);

/* Scalars of a solution and its largest pressure, in the contact's frame. */
typedef struct reduced_quantities {
    contact_scalars scalars; // exit NaN where it is known as a node only
    double peak_pressure;    // at the nodes that a solution looks at
} reduced_quantities;

/* Those of the equations beside, whose solution is `distance` along a change. */
reduced_quantities reduced_tangent_quantities(reduced_tangent *self, const reduced_change *change,
                                              double distance, const reduced_equations *beside);

#endif
