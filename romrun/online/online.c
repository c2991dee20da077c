/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/online/online_objects.h"

#include <math.h>
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
    const part_solver *used = solver->used;
    const model_part *model = used->model;
    const contact_scalars *scalars = &used->scalars;
    online_indications found;

    for (int q = 0; q < NUM_INDICATED; q++)
        found.bound[q] = found.deviation[q] = NAN;
    if (!used->solved) return found;
    indicator_bound_others(found.bound, used->indicator, used->reduced, &used->state, contact,
                           scalars);
    if (contact_has_traction(contact))
        found.bound[INDICATED_FRICTION] =
            online_friction_bound(solver, contact, online_traction(solver, contact).friction);
    for (int q = 0; q < NUM_INDICATED; q++)
        if (model->other_factor[q] > 0)
            found.deviation[q] = trade_indicated(model->other_factor[q],
                                                 model->shape[OF_OTHERS + q], found.bound[q]);
    if (contact->closure.by_load != 0 && model->indicator_factor > 0)
        found.deviation[INDICATED_LOAD] =
            fabs(scalars->load - contact->closure.value / contact->kind->load);
    return found;
}

double online_indicate_peak(online_solver *solver) {
    const part_solver *used = solver->used;
    const model_part *model = used->model;

    if (!used->solved || !(model->other_factor[INDICATED_PRESSURE] > 0)) return NAN;
    return trade_indicated(model->other_factor[INDICATED_PRESSURE],
                           model->shape[OF_OTHERS + INDICATED_PRESSURE],
                           indicator_bound_peak(used->indicator, used->reduced));
}

contact_traction online_traction(online_solver *solver, const ehd_contact *contact) {
    const part_solver *used = solver->used;

    if (!used->solved || !part_has_traction(used->model)) return contact_traction_unknown();
    return reduced_traction(used->reduced, &used->state, contact, &used->scalars);
}

double online_friction_bound(online_solver *solver, const ehd_contact *contact, double friction) {
    const part_solver *used = solver->used;

    if (friction == 0) return 0; // without sliding the friction is 0 in any model
    if (!used->solved || !part_has_traction(used->model)) return NAN;
    return indicator_bound_friction(used->indicator, used->reduced, &used->state, contact,
                                    friction);
}

double online_indicate_friction(online_solver *solver, const ehd_contact *contact,
                                double friction) {
    const model_part *model = solver->used->model;

    if (!(model->other_factor[INDICATED_FRICTION] > 0)) return NAN;
    return trade_indicated(model->other_factor[INDICATED_FRICTION],
                           model->shape[OF_OTHERS + INDICATED_FRICTION],
                           online_friction_bound(solver, contact, friction));
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
