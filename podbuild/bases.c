/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "podbuild/bases.h"

#include "common/physics/deflection.h"
#include "podbuild/test_weight.h"

#include <cblas.h>
#include <stdlib.h>
#include <string.h>

double bases_energy_discarded(const pod_basis *basis) {
    double all = 0, left_out = 0;

    for (size_t i = basis->num_singular_values; i-- > 0;) {
        double square = basis->singular_values[i] * basis->singular_values[i];
        all += square;
        if (i >= basis->num_modes) left_out += square;
    }
    return all > 0 ? left_out / all : 0;
}

/* Computes the deflections of `count` pressures at all nodes. Boundary nodes are included,
 * because they have a film too. Deflection is linear in the pressure, so the deflections of
 * compressed snapshots represent the deflections of the snapshots. Allocates *deflections,
 * [count, num_nodes]. */
static ehd_status deflect(double **deflections, const snapshot_set *set, const double *pressures,
                          size_t count, ehd_error *error) {
    size_t num_nodes = set->grid.num_nodes;
    ehd_deflection *deflection = deflection_create(set->kind, &set->grid);

    *deflections = malloc(count * num_nodes * sizeof(double));
    if (!deflection || !*deflections) {
        deflection_free(deflection);
        return ehd_no_memory(error, "deflections");
    }
    for (size_t s = 0; s < count; s++)
        deflection_apply(*deflections + s * num_nodes, deflection, pressures + s * num_nodes);
    deflection_free(deflection);
    return EHD_OK;
}

double *bases_turn_modes(const pod_basis *pod) {
    double *modes = malloc(pod->num_nodes * pod->num_modes * sizeof(double));

    for (size_t j = 0; modes && j < pod->num_modes; j++)
        for (size_t k = 0; k < pod->num_nodes; k++)
            modes[k * pod->num_modes + j] = pod->modes[j * pod->num_nodes + k];
    return modes;
}

/* Projects the fields of all states, [num_states, num_nodes], onto the modes of a POD. Writes the
 * coordinates to the columns from `first` on. */
static void project(reduced_states *states, size_t first, const pod_basis *pod,
                    const double *fields) {
    for (size_t s = 0; s < states->num_states; s++)
        cblas_dgemv(CblasRowMajor, CblasNoTrans, (int)pod->num_modes, (int)pod->num_nodes, 1,
                    pod->modes, (int)pod->num_nodes, fields + s * pod->num_nodes, 1, 0,
                    states->coordinates + s * states->num_unknowns + first, 1);
}

void bases_fill_states(reduced_states *states, const snapshot_set *set) {
    const size_t num_states = set->num_states, num_lines = grid_lines(&set->grid);
    const size_t last = states->num_unknowns - 1;

    for (size_t s = 0; s < num_states; s++)
        states->coordinates[s * states->num_unknowns + last] = set->rigid_approach[s];
    memcpy(states->exit, set->exit, num_states * num_lines * sizeof *states->exit);
    memcpy(states->moes_M, set->moes_M, num_states * sizeof(double));
    memcpy(states->alpha_p_H, set->alpha_p_H, num_states * sizeof(double));
    memcpy(states->thinning, set->thinning, num_states * sizeof *states->thinning);
    memcpy(states->central_film_thickness, set->central_film_thickness,
           num_states * sizeof(double));
    memcpy(states->stationary, set->stationary, num_states * sizeof *states->stationary);
    memcpy(states->rate, set->rate, num_states * sizeof(double));
    memcpy(states->load_rate, set->load_rate, num_states * sizeof(double));
    memcpy(states->effects, set->effects, num_states * sizeof *states->effects);
    memcpy(states->rises, set->rises, num_states * sizeof *states->rises);
}

static ehd_status fill_states(reduced_basis *basis, const snapshot_set *set,
                              const pod_basis *pressure_pod, const pod_basis *deformation_pod,
                              const double *deflections, ehd_error *error) {
    reduced_states *states = &basis->states;
    size_t num_unknowns = reduced_num_unknowns(basis->num_pressure, basis->num_deformation);
    ehd_status status =
        reduced_states_init(states, set->num_states, grid_lines(&set->grid), num_unknowns, error);

    if (status) return status;
    project(states, 0, pressure_pod, set->pressure);
    if (deflections) project(states, basis->num_pressure, deformation_pod, deflections);
    bases_fill_states(states, set);
    return EHD_OK;
}

void bases_begin(reduced_basis *basis, const contact_kind *kind, const ehd_grid *grid,
                 const ehd_carriage *carriage, deformation_kind deformation) {
    *basis = (reduced_basis){
        .kind = kind, .grid = *grid, .carriage = *carriage, .deformation = deformation};
}

ehd_status bases_weigh(reduced_basis *basis, ehd_error *error) {
    basis->weight = malloc(basis->grid.num_nodes * sizeof(double));
    if (!basis->weight) return ehd_no_memory(error, "bases");
    return test_weight_mode(basis->weight, basis, NULL, 0, error);
}

ehd_status bases_build(reduced_basis *basis, pod_basis *pressure_pod, pod_basis *deformation_pod,
                       const snapshot_set *set, const bases_settings *settings, ehd_error *error) {
    size_t num_nodes = set->grid.num_nodes;
    double *deflections = NULL, *snapshots = NULL;

    bases_begin(basis, set->kind, &set->grid, &set->carriage, settings->kind);
    memset(pressure_pod, 0, sizeof *pressure_pod);
    memset(deformation_pod, 0, sizeof *deformation_pod);
    ehd_status status = pod_build(pressure_pod, set->snapshots, set->num_snapshots, num_nodes,
                                  &settings->pressure, error);
    if (!status && settings->kind == DEFORMATION_INDEPENDENT) {
        status = deflect(&deflections, set, set->pressure, set->num_states, error);
        if (!status) status = deflect(&snapshots, set, set->snapshots, set->num_snapshots, error);
        if (!status)
            status = pod_build(deformation_pod, snapshots, set->num_snapshots, num_nodes,
                               &settings->deformation, error);
    }
    if (!status) {
        basis->num_pressure = pressure_pod->num_modes;
        basis->num_deformation = deformation_pod->num_modes;
        basis->pressure = bases_turn_modes(pressure_pod);
        if (deflections) basis->deformation_modes = bases_turn_modes(deformation_pod);
        if (!basis->pressure || (deflections && !basis->deformation_modes))
            status = ehd_no_memory(error, "bases");
    }
    if (!status) status = bases_weigh(basis, error);
    if (!status)
        status = fill_states(basis, set, pressure_pod, deformation_pod, deflections, error);
    free(deflections);
    free(snapshots);
    if (status) {
        reduced_basis_free(basis);
        pod_free(pressure_pod);
        pod_free(deformation_pod);
    }
    return status;
}
