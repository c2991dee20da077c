/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Earlier states of the full model, carried over into the current frame by cubic splines (paper, eq. 15;
 * model.md, section 4). */
#ifndef EHD_EARLIER_H
#define EHD_EARLIER_H

#include "common/time/frame.h"
#include "fullrun/full_solver.h"

#include <gsl/gsl_spline.h>

typedef struct earlier_state {
    contact_frame frame;
    full_state state;
    gsl_spline *deflection; // film without gap
    gsl_spline *pressure;   // NULL when incompressible: the film is then all that is carried over
} earlier_state;

ehd_status earlier_init(earlier_state *self, const ehd_contact *reference, ehd_error *error);
void earlier_free(earlier_state *self);

/* Prepares the splines, once frame and state are set. */
void earlier_prepare(earlier_state *self,
                     double *work,                 // [num_nodes] scratch
                     const ehd_contact *reference, //
                     const double *nodes);         // [num_nodes] X of all nodes

/* rho H of an earlier state at the inner nodes of frame `now`. Where a contact that grows looks beyond
 * the grid there is no pressure, and gap and deflection are evaluated there directly. */
void earlier_mass(
    // output:
    double *mass, // [num_inner]
    // input:
    const earlier_state *self, const contact_frame *now, const ehd_contact *reference);

#endif
