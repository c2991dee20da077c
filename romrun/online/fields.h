/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fields of a reduced state on the whole grid: the only work whose cost grows with the grid. */
#ifndef EHD_FIELDS_H
#define EHD_FIELDS_H

#include "romrun/online/reduced_solver.h"

/* P and H at all nodes, [num_nodes]; H follows from P for either basis. EHD_MEMORY. */
ehd_status reduced_fields(
    // output:
    double *pressure, double *film,
    // input:
    const reduced_state *state, const reduced_model *model,
    const double *pressure_basis, // [num_nodes, num_pressure]
    ehd_error *error);

#endif
