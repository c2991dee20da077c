/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/unit/marching.h"

void marching_start(marching *self, const ehd_contact *contact, const reduced_basis *of,
                    const contact_frame *frame) {
    marching_start_with(self, contact, of, NULL, 0, frame);
}

void marching_start_with(marching *self, const ehd_contact *contact, const reduced_basis *of,
                         const size_t *rows, size_t num_rows, const contact_frame *frame) {
    ehd_error error = {""};

    self->reference = *contact;
    self->reference.grid = of->grid;
    ehd_status status = reduced_model_build(&self->model, of, rows, num_rows, &error);
    self->model.carriage = (ehd_carriage){contact->transport, contact->smoothing};
    if (!status)
        status = film_splines_build(&self->splines, &self->model, of->pressure,
                                    of->deformation_modes, &error);
    if (!status)
        status = reduced_march_create(&self->march, &self->model, &self->splines, &self->reference,
                                      &strict_settings, &error);
    if (status) fail_msg("%s", error.text);
    self->solver = reduced_march_solver(self->march);
    if (self->solver.start(&self->last, self->solver.self, frame, &error))
        fail_msg("%s", error.text);
}

void marching_free(marching *self) {
    reduced_march_free(self->march);
    film_splines_free(&self->splines);
    reduced_model_free(&self->model);
}

ehd_contact marching_contact(const trained *of, double moes_M, bool along_path) {
    ehd_contact contact = of->contacts[4];

    contact_set_moes(&contact, moes_M, 4);
    contact.transport = along_path ? TRANSPORT_PATH : TRANSPORT_UPWIND;
    contact.smoothing = 0.014;
    return contact;
}

reduced_basis marching_nodes(const trained *of, deformation_kind kind, const double *weight) {
    reduced_basis nodes = identity_basis(&of->set, kind, weight);
    const size_t last = grid_width(&nodes.grid) - 2, inner = grid_lines(&nodes.grid) - 1;

    for (size_t s = 0; s < nodes.states.num_states; s++)
        nodes.states.rate[s] = nodes.states.load_rate[s] = 1000;
    for (size_t l = 0; l < inner && nodes.grid.inner_lines > 1; l++)
        nodes.states.exit[l] = last;
    return nodes;
}

void marching_trainings_init(marching_trainings *self) {
    trained_few_init(&self->line, self->bases, self->rows);
    trained_init_point(&self->point, true, "open");
    trained_basis(&self->point_basis, &self->point, DEFORMATION_COUPLED, 0, 0);
}

void marching_trainings_free(marching_trainings *self) {
    trained_few_free(&self->line, self->bases);
    reduced_basis_free(&self->point_basis);
    trained_free(&self->point);
}
