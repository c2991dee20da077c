/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes derivatives of a contact's results with respect to its conditions. The results are in
 * the reference frame. The contact's own frame scales with load, radius and modulus, so the
 * derivatives follow from the chain rule (romrun/library/README.md, The tangent). Called by
 * online_derivatives.c for derivatives and responses. */
#ifndef EHD_FRAME_TANGENT_H
#define EHD_FRAME_TANGENT_H

#include "common/time/frame.h"
#include "romrun/online/reduced_tangent.h"

/* A function that returns the equations in a frame, and its context. `side` (0 or 1) selects the
 * work memory that the function may use. */
typedef struct frame_equations {
    void *context;
    reduced_equations (*in_frame)(void *context, const contact_frame *frame, ehd_contact *contact,
                                  int side);
} frame_equations;

/* Results of a solution in the reference frame. */
typedef struct frame_quantities {
    contact_scalars scalars;
    double peak_pressure, half_width;
} frame_quantities;

/* Linearises the equations of a frame at their solution (reduced_tangent_at). */
ehd_status frame_linearise(
    // in and out:
    reduced_tangent *tangent,
    // input:
    const reduced_state *state, const contact_frame *at, const frame_equations *equations,
    bool exit_at_node, ehd_error *error);

/* Computes derivatives with respect to a parameter that differs by `distance` between the two
 * frames `beside`. The equations must have been linearised at the frame half way between them.
 * `change`: change of the solution per unit of the parameter. */
ehd_status frame_tangent(
    // output:
    frame_quantities *derivatives, reduced_change *change,
    // in and out:
    reduced_tangent *tangent,
    // input:
    const contact_frame beside[2], double distance, const ehd_contact *reference,
    const frame_equations *equations, ehd_error *error);

/* If the parameter of the last frame_tangent varies as exp(sT), the derivatives of the results with
 * respect to this parameter depend on s. Computes how these derivatives change per unit of s (in
 * 1/T) at s = 0. For stationary contacts only. */
ehd_status frame_tangent_slow(
    // output:
    contact_scalars *slow, // rigid_approach and load in the reference frame
    double *bound,         // bound of the error of the approach (reduced_tangent_slow)
    // in and out:
    reduced_tangent *tangent,
    // input:
    const reduced_change *change, const contact_frame *at, const contact_frame beside[2],
    double distance, const ehd_contact *reference, const frame_equations *equations,
    ehd_error *error);

#endif
