/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chooses the nodes at which a model evaluates shear stresses, and their weights, by non-negative
 * least squares (romrun/solve/README.md, Traction).
 * Called by main.c, and by row_plan.c for the memory. */
#ifndef EHD_CUBATURE_H
#define EHD_CUBATURE_H

#include "romrun/model/reduced_model.h"

/* Returns the largest memory that cubature_train uses, bytes. */
double cubature_bytes(const reduced_basis *basis);

/* Chooses nodes and weights that integrate the shear stresses of at most 120 training states of the
 * basis. Adds the nodes and weights to a model of this basis. Adds nothing if no weights are
 * accurate enough. Errors: EHD_MEMORY, EHD_INTERNAL. */
ehd_status cubature_train(
    // in and out:
    reduced_model *model,
    // input:
    const reduced_basis *basis, ehd_error *error);

#endif
