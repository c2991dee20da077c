/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Training of the nodes at which a model evaluates shear stresses (romrun/online/README.md,
 * traction). */
#ifndef EHD_CUBATURE_H
#define EHD_CUBATURE_H

#include "romrun/model/reduced_model.h"

/* Bytes that this takes at most. */
double cubature_bytes(const reduced_basis *basis);

/* Chooses nodes and weights from states of the basis, 120 at most, and adds them to a model of it. Where
 * there are no weights that integrate them (README.md), none are added. EHD_MEMORY, EHD_INTERNAL. */
ehd_status cubature_train(
    // in and out:
    reduced_model *model,
    // input:
    const reduced_basis *basis, ehd_error *error);

#endif
