/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/unit/trained.h"

#include "common/physics/minimum.h"
#include "common/physics/traction.h"
#include "fullrun/full_solver.h"
#include "tests/unit/sample.h"

#include <stdlib.h>
#include <string.h>

static const double moes_M[] = {8, 11, 15, 20}, moes_L[] = {2, 4, 6};

/* Solves the contacts by the full model. */
static void train(trained *self) {
    full_settings settings = full_default_settings();
    full_solver *solver;
    full_state solution;
    full_info info;
    solved_state states[TRAINED_STATES];

    settings.tolerance = 1e-13;
    settings.linear_tolerance = 1e-10;
    const contact_kind *kind = self->contacts[0].kind;
    const ehd_grid *grid = &self->contacts[0].grid;
    self->pressure = calloc(TRAINED_STATES * grid->num_nodes, sizeof(double));
    self->film = calloc(TRAINED_STATES * grid->num_nodes, sizeof(double));
    assert_int_equal(full_solver_create(&solver, kind, grid, &settings, NULL), EHD_OK);
    assert_int_equal(full_state_init(&solution, grid, NULL), EHD_OK);
    for (size_t s = 0; s < TRAINED_STATES; s++) {
        const ehd_contact *contact = &self->contacts[s];
        double *here = self->pressure + s * grid->num_nodes;
        assert_int_equal(full_solve_cold(&info, &solution, solver, contact, NULL), EHD_OK);
        assert_string_equal(info.reason, "");
        memcpy(here, solution.pressure, grid->num_nodes * sizeof *here);
        memcpy(self->film + s * grid->num_nodes, solution.film, grid->num_nodes * sizeof(double));
        self->exit_position[s] = full_evaluate_scalars(&solution, contact).exit_position;
        states[s] =
            (solved_state){here,
                           solution.rigid_approach,
                           contact->moes_M,
                           contact->alpha_p_H,
                           traction_thinning(contact),
                           full_evaluate_scalars(&solution, contact).central_film_thickness,
                           lubricant_rises_at(&contact->lubricant, contact->hertz_pressure)};
    }
    assert_int_equal(snapshot_set_gather(&self->set, states, TRAINED_STATES, kind, grid, NULL),
                     EHD_OK);
    self->states = &self->set.sources->states;
    full_state_free(&solution);
    full_solver_free(solver);
}

static void make_contacts(trained *self, double step) {
    memset(self, 0, sizeof *self);
    for (size_t s = 0; s < TRAINED_STATES; s++)
        self->contacts[s] =
            sample_contact("barus", "dowson-higginson", moes_M[s / 3], moes_L[s % 3], step);
}

void trained_init(trained *self, double step) {
    make_contacts(self, step);
    train(self);
}

void trained_init_accurate(trained *self, double step) {
    make_contacts(self, step);
    for (size_t s = 0; s < TRAINED_STATES; s++)
        self->contacts[s].grid.discretization = DISCRETIZATION_ACCURATE;
    train(self);
}

void trained_init_thinned(trained *self, double step) {
    make_contacts(self, step);
    for (size_t s = 0; s < TRAINED_STATES; s++) {
        ehd_contact *contact = &self->contacts[s];
        contact->grid.discretization = DISCRETIZATION_ACCURATE;
        contact->half_width = 1e-4;
        contact->radius = 0.01;
        contact->slide_roll = 0.5 + 0.1 * (double)(s % 2);
        contact->lubricant.thinning_stress = (s % 3 == 0 ? 1e-4 : 2e-4) * contact->hertz_pressure;
    }
    train(self);
}

void trained_init_published(trained *self, double step) {
    memset(self, 0, sizeof *self);
    for (size_t s = 0; s < TRAINED_STATES; s++)
        self->contacts[s] = sample_published(
            sample_contact("barus", "dowson-higginson", moes_M[s / 3], moes_L[s % 3], step));
    train(self);
}

void trained_init_point(trained *self, bool half, const char *boundary) {
    memset(self, 0, sizeof *self);
    for (size_t s = 0; s < TRAINED_STATES; s++) {
        scene given = sample_scene("barus", "dowson-higginson", moes_M[s / 3], moes_L[s % 3]);
        strcpy(given.contact, "point");
        strcpy(given.boundary, boundary);
        given.grid.x_min = -2.5;
        given.grid.x_max = 1.5;
        given.grid.step = 0.125;
        given.grid.y_max = 2;
        given.grid.half = half;
        assert_int_equal(scene_contact(&self->contacts[s], &given, NULL), EHD_OK);
    }
    train(self);
}

static double film_at(const void *film, size_t node) {
    return ((const double *)film)[node];
}

double trained_least_film(const double *film, const ehd_grid *grid) {
    size_t least = grid_node_of_row(grid, 0);

    for (size_t r = 1; r < grid->num_inner; r++)
        if (film[grid_node_of_row(grid, r)] < film[least]) least = grid_node_of_row(grid, r);
    return minimum_around(grid, least, film_at, film);
}

void trained_free(trained *self) {
    snapshot_set_close(&self->set);
    free(self->pressure);
    free(self->film);
}

void trained_basis(reduced_basis *basis, const trained *self, deformation_kind kind,
                   size_t num_pressure, size_t num_deformation) {
    const bases_settings settings = {
        .pressure.num_modes = num_pressure, .deformation.num_modes = num_deformation, .kind = kind};
    snapshot_set set = self->set;
    pod_basis pressure, deformation;
    ehd_error error = {""};

    if (bases_build(basis, &pressure, &deformation, &set, &settings, NULL, NULL, &error))
        fail_msg("%s", error.text);
    pod_free(&pressure);
    pod_free(&deformation);
}

void trained_few_init(trained *self, reduced_basis bases[2], size_t rows[FEW_ROWS]) {
    trained_init(self, 0.05);
    trained_basis(&bases[0], self, DEFORMATION_INDEPENDENT, 9, 7);
    trained_basis(&bases[1], self, DEFORMATION_COUPLED, 9, 0);
    for (size_t r = 0; r < FEW_ROWS; r++)
        rows[r] = 40 + (r * 27) % 67; // 40 … 106
}

void trained_few_free(trained *self, reduced_basis bases[2]) {
    reduced_basis_free(&bases[0]);
    reduced_basis_free(&bases[1]);
    trained_free(self);
}
