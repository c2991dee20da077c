/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whether a solution of the full model may be used. */
#ifndef EHD_JUDGE_H
#define EHD_JUDGE_H

#include "fullrun/full_solver.h"

enum { JUDGE_REASON = 256 }; // bytes, with the closing zero

/* EHD_OK; EHD_NOT_CONVERGED with the reason: the solver's own, an exit boundary that is not inside
 * the domain, or a pressure beyond the viscosity law's limit; or EHD_UNTRUSTED: a thinned flow for which
 * the equations do not hold (reynolds_flow_doubt). */
ehd_status full_judge(
    // output:
    char reason[JUDGE_REASON],
    // input:
    const full_info *info, const full_state *state, const ehd_contact *contact);

/* As reynolds_flow_doubt, of the whole grid. */
double full_flow_doubt(const full_state *state, const ehd_contact *contact);

/* Whether a pressure lies beyond the viscosity law's limit. */
bool full_beyond_law(const full_state *state, const ehd_contact *contact);

#endif
