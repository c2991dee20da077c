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
