/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Trial and test bases of a set of training solutions (Maier, Hager, Hetzler and Seemann, Tribology
 * International 2015, section 3.1). */
#ifndef EHD_BASES_H
#define EHD_BASES_H

#include "podbuild/pod.h"
#include "podbuild/snapshot_set.h"
#include "romrun/model/reduced_model.h"

typedef struct bases_settings {
    pod_settings pressure;
    pod_settings deformation; // unused if kind is DEFORMATION_COUPLED
    deformation_kind kind;
} bases_settings;

/* Computes the PODs of the pressures and, if independent, of the deflections, the weight D of the
 * first pressure mode, and the training solutions in reduced coordinates. Errors: EHD_DATA (more
 * modes than the rank of the snapshots), EHD_MEMORY, EHD_INTERNAL (LAPACK). */
ehd_status bases_build(
    // output:
    reduced_basis *basis,       // free with reduced_basis_free
    pod_basis *pressure_pod,    // free with pod_free
    pod_basis *deformation_pod, // free with pod_free; empty if coupled
    // input:
    const snapshot_set *set, const bases_settings *settings, ehd_error *error);

/* Initialises a basis without arrays. This function and the next three are steps of bases_build,
 * for callers that compute the modes in another way. */
void bases_begin(
    // output:
    reduced_basis *basis, // free with reduced_basis_free; all arrays are NULL
    // input:
    const contact_kind *kind, const ehd_grid *grid, const ehd_carriage *carriage,
    deformation_kind deformation);
/* Returns a transposed copy of the modes, [num_nodes, num_modes] row-major as in a reduced_basis;
 * free with free(). Returns NULL without memory. */
double *bases_turn_modes(const pod_basis *pod);
/* Allocates basis->weight and sets it from the first pressure mode, which the basis must hold.
 * Errors: EHD_MEMORY. */
ehd_status bases_weigh(reduced_basis *basis, ehd_error *error);
/* Copies the states of a set. Of the coordinates only the last one, the rigid approach, is set. */
void bases_fill_states(reduced_states *states, const snapshot_set *set);

/* Returns the sum of the squared singular values of the omitted modes, relative to the sum of
 * all. */
double bases_energy_discarded(const pod_basis *basis);

#endif
