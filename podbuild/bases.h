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
    pod_settings deformation; // not used when coupled
    deformation_kind kind;
} bases_settings;

/* PODs of pressure and, when independent, deflection; the weight D by the first mode; the training
 * solutions in reduced coordinates. EHD_DATA (more modes than snapshots), EHD_MEMORY, EHD_INTERNAL.
 */
ehd_status bases_build(
    // output:
    reduced_basis *basis,       // free with reduced_basis_free
    pod_basis *pressure_pod,    // free with pod_free
    pod_basis *deformation_pod, // free with pod_free; empty when coupled
    // input:
    const snapshot_set *set, const bases_settings *settings, ehd_error *error);

/* The parts of it, for who builds otherwise. */
void bases_begin(
    // output:
    reduced_basis *basis, // free with reduced_basis_free; nothing is allocated
    // input:
    const contact_kind *kind, const ehd_grid *grid, const ehd_carriage *carriage,
    deformation_kind deformation);
/* Modes as the reduced basis holds them, node-major; NULL without memory, free(). */
double *bases_turn_modes(const pod_basis *pod);
/* The weight by the first mode of a basis that has its pressure modes. EHD_MEMORY. */
ehd_status bases_weigh(reduced_basis *basis, ehd_error *error);
/* What a set knows of its states, but for the coordinates of their fields. */
void bases_fill_states(reduced_states *states, const snapshot_set *set);

/* Part of the squared singular values that lies behind the basis. */
double bases_energy_discarded(const pod_basis *basis);

#endif
