/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/online/online_objects.h"

#include <stdlib.h>

ehd_status online_solver_create(online_solver **solver, const online_model *model,
                                ehd_error *error) {
    online_solver *self = calloc(1, sizeof *self);
    ehd_status status = EHD_OK;

    *solver = NULL;
    if (self) self->parts = calloc(model->num_parts, sizeof *self->parts);
    if (!self || !self->parts) {
        free(self);
        return ehd_no_memory(error, "online solver");
    }
    self->model = model;
    self->used = self->parts;
    for (size_t p = 0; p < model->num_parts && !status; p++)
        status = part_solver_init(&self->parts[p], &model->parts[p], error);
    if (status)
        online_solver_free(self);
    else
        *solver = self;
    return status;
}

online_solver *online_solver_free(online_solver *self) {
    if (self) {
        for (size_t p = 0; p < self->model->num_parts; p++)
            part_solver_free(&self->parts[p]);
        free(self->parts);
        free(self);
    }
    return NULL;
}

void online_solver_set_tolerance(online_solver *self, double tolerance) {
    for (size_t p = 0; p < self->model->num_parts; p++)
        reduced_solver_set_tolerance(self->parts[p].reduced, tolerance);
}

ehd_status online_solve(online_result *result, online_solver *solver, const ehd_contact *contact,
                        ehd_error *error) {
    const size_t part = online_part_for(solver->model, solver->parts, contact);
    const ehd_status status = part_solve(result, &solver->parts[part], contact, error);

    solver->used = &solver->parts[part];
    if (!status) result->part = part;
    return status;
}

online_indications online_indicate(online_solver *solver, const ehd_contact *contact) {
    return part_indicate(solver->used, contact);
}

double online_indicate_peak(online_solver *solver) {
    return part_indicate_peak(solver->used);
}

contact_traction online_traction(online_solver *solver, const ehd_contact *contact) {
    return part_traction(solver->used, contact);
}

double online_friction_bound(online_solver *solver, const ehd_contact *contact, double friction) {
    return part_friction_bound(solver->used, contact, friction);
}

double online_indicate_friction(online_solver *solver, const ehd_contact *contact,
                                double friction) {
    return part_indicate_friction(solver->used, contact, friction);
}

const ehd_grid *online_solved_grid(const online_solver *solver) {
    return &solver->used->model->reduced.grid;
}

ehd_status online_not_prepared(const model_part *model, const char *call, ehd_error *error) {
    return ehd_fail(error, EHD_INTERNAL,
                    "%s: found a model that is not prepared, expected %s before", model->path,
                    call);
}

ehd_status online_fields(double *pressure, double *film, const online_solver *solver,
                         ehd_error *error) {
    const part_solver *used = solver->used;
    const model_part *model = used->model;

    if (!model->fields) return online_not_prepared(model, "online_prepare_fields", error);
    reduced_fields(pressure, film, &used->state, &model->reduced, model->fields);
    return EHD_OK;
}

void online_exits(double *positions, const online_solver *solver) {
    const part_solver *used = solver->used;
    const reduced_model *model = &used->model->reduced;

    if (model->band.num_lines == 1)
        positions[0] = reduced_exit_position(&used->state, model);
    else
        grid_exits(positions, reduced_state_exits(&used->state), &model->grid);
}
