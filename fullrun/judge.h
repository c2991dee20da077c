/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks whether a solution of the full model may be used (README.md, Newton).
 * Called by main.c, training.c and full_march.c, and by romrun/calibrate/fallback.c. */
#ifndef EHD_JUDGE_H
#define EHD_JUDGE_H

#include "fullrun/full_solver.h"

enum { JUDGE_REASON = 256 }; // bytes, with the closing zero

/* Returns whether a solution may be used. `reason` is the cause if it may not, or "":
 * - EHD_NOT_CONVERGED: the solver has not converged, the exit boundary is not inside the domain, or
 *   a pressure exceeds the limit of the viscosity law.
 * - EHD_UNTRUSTED: the equations do not hold for the thinned flow (reynolds_flow_doubt).
 * - EHD_OK: the solution may be used. */
ehd_status full_judge(
    // output:
    char reason[JUDGE_REASON],
    // input:
    const full_info *info, const full_state *state, const ehd_contact *contact);

/* Returns the largest error bound of the Reynolds rows of a shear-thinned flow on the grid
 * (reynolds_flow_doubt), or 0 if the flow is not thinned. */
double full_flow_doubt(const full_state *state, const ehd_contact *contact);

/* Checks whether a pressure exceeds the limit of the viscosity law. */
bool full_beyond_law(const full_state *state, const ehd_contact *contact);

#endif
