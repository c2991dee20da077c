/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes trial and test bases from a set of training solutions (Maier, Hager, Hetzler and
 * Seemann, Tribology International 2015, section 3.1). */
#ifndef EHD_BASES_H
#define EHD_BASES_H

#include "common/program/program.h"
#include "podbuild/bases_plan.h"
#include "podbuild/pod.h"
#include "podbuild/snapshot_set.h"
#include "romrun/model/reduced_model.h"

/* Computes the POD of the pressures, the POD of the deflections (if the basis has independent
 * deflections), the weight D from the first pressure mode, and the coordinates of the training
 * solutions. Reads all sources once for the modes, once more for the modes of independent
 * deflections, and once for the coordinates. Afterwards only `basis` holds the modes. Errors:
 * EHD_DATA (more modes are wanted than the rank of the snapshots, or part files have omitted too
 * much energy), EHD_INTERRUPTED, EHD_MEMORY, EHD_INTERNAL (LAPACK); else as snapshot_set_open. */
ehd_status bases_build(
    // output:
    reduced_basis *basis,       // free with reduced_basis_free
    pod_basis *pressure_pod,    // free with pod_free; modes is NULL
    pod_basis *deformation_pod, // as pressure_pod; empty if coupled
    // in and out:
    snapshot_set *from,
    // input:
    const bases_settings *settings,
    const bases_plan *plan, // NULL: all rows are one block
    const program *caller,  // for progress and interruption; NULL: neither
    ehd_error *error);

#endif
