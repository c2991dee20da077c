/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Building a reduced model from bases on the whole grid. */
#ifndef EHD_REDUCED_BUILD_H
#define EHD_REDUCED_BUILD_H

#include "common/physics/deflection.h"
#include "romrun/model/reduced_model.h"

/* Sets the band. On each line it begins before the first film minimum of the training and ends
 * behind the last exit of the training. EHD_MEMORY. */
ehd_status reduced_model_find_band(
    // in and out:
    reduced_model *model,
    // input:
    const reduced_basis *basis, ehd_deflection *deflection, ehd_error *error);

#endif
