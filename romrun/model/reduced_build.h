/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds a reduced model from bases on the whole grid (romrun/solve/README.md, The exit; Maier et
 * al. (2015), sections 3.2 and 3.3). Its main function, reduced_model_build, is declared in
 * reduced_model.h.
 * Called by deimselect/row_choice.c, by snapgen, and by podbuild/test_weight.c. */
#ifndef EHD_REDUCED_BUILD_H
#define EHD_REDUCED_BUILD_H

#include "common/physics/deflection.h"
#include "romrun/model/reduced_model.h"

/* Sets the band. On each grid line the band begins upstream of all film minima in training and ends
 * downstream of all exits in training. Errors: EHD_MEMORY. */
ehd_status reduced_model_find_band(
    // in and out:
    reduced_model *model,
    // input:
    const reduced_basis *basis, ehd_deflection *deflection, ehd_error *error);

#endif
