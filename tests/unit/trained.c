/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/unit/trained.h"

#include "fullrun/full_solver.h"
#include "tests/unit/sample.h"

#include <stdlib.h>
#include <string.h>

static const double moes_M[] = {8, 11, 15, 20}, moes_L[] = {2, 4, 6};

static void keep(trained *self, size_t s, const full_state *solution) {
    snapshot_set *set = &self->set;
    const ehd_contact *contact = &self->contacts[s];
    size_t num_nodes = set->grid.num_nodes;

    memcpy(set->pressure + s * num_nodes, solution->pressure, num_nodes * sizeof(double));
    memcpy(self->film + s * num_nodes, solution->film, num_nodes * sizeof(double));
    set->stationary[s] = true;
    set->rigid_approach[s] = solution->rigid_approach;
    set->exit[s] = solution->exit;
    set->moes_M[s] = contact->moes_M;
    set->alpha_p_H[s] = contact->alpha_p_H;
    set->central_film_thickness[s] =
        full_evaluate_scalars(solution, contact).central_film_thickness;
}

void trained_init(trained *self, double step) {
    full_settings settings = full_default_settings();
    full_solver *solver;
    full_state solution;
    full_info info;

    memset(self, 0, sizeof *self);
    settings.tolerance = 1e-13;
    settings.linear_tolerance = 1e-10;
    for (size_t s = 0; s < TRAINED_STATES; s++)
        self->contacts[s] =
            sample_contact("barus", "dowson-higginson", moes_M[s / 3], moes_L[s % 3], step);
    snapshot_set *set = &self->set;
    set->kind = self->contacts[0].kind;
    set->grid = self->contacts[0].grid;
    set->num_states = TRAINED_STATES;
    set->pressure = calloc(TRAINED_STATES * set->grid.num_nodes, sizeof(double));
    set->rigid_approach = calloc(TRAINED_STATES, sizeof(double));
    set->exit = calloc(TRAINED_STATES, sizeof *set->exit);
    set->moes_M = calloc(TRAINED_STATES, sizeof(double));
    set->alpha_p_H = calloc(TRAINED_STATES, sizeof(double));
    set->central_film_thickness = calloc(TRAINED_STATES, sizeof(double));
    set->stationary = calloc(TRAINED_STATES, sizeof *set->stationary);
    set->rate = calloc(TRAINED_STATES, sizeof(double));
    self->film = calloc(TRAINED_STATES * set->grid.num_nodes, sizeof(double));
    assert_int_equal(full_solver_create(&solver, set->kind, &set->grid, &settings, NULL), EHD_OK);
    assert_int_equal(full_state_init(&solution, &set->grid, NULL), EHD_OK);
    for (size_t s = 0; s < TRAINED_STATES; s++) {
        assert_int_equal(full_solve_cold(&info, &solution, solver, &self->contacts[s], NULL),
                         EHD_OK);
        assert_string_equal(info.reason, "");
        keep(self, s, &solution);
    }
    set->num_snapshots = TRAINED_STATES;
    set->snapshots = calloc(TRAINED_STATES * set->grid.num_nodes, sizeof(double));
    memcpy(set->snapshots, set->pressure, TRAINED_STATES * set->grid.num_nodes * sizeof(double));
    full_state_free(&solution);
    full_solver_free(solver);
}

void trained_free(trained *self) {
    snapshot_set_free(&self->set);
    free(self->film);
}

void trained_basis(reduced_basis *basis, const trained *self, deformation_kind kind,
                   size_t num_pressure, size_t num_deformation) {
    const bases_settings settings = {
        {.num_modes = num_pressure}, {.num_modes = num_deformation}, kind};
    pod_basis pressure, deformation;
    ehd_error error = {""};

    if (bases_build(basis, &pressure, &deformation, &self->set, &settings, &error))
        fail_msg("%s", error.text);
    pod_free(&pressure);
    pod_free(&deformation);
}
