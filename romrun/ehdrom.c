/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/ehdrom.h"

#include "common/physics/deflection.h"
#include "romrun/model_file.h"
#include "romrun/reduced_solver.h"

#include <cblas.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct ehdrom_model {
    reduced_model reduced;
    char *path;
};

struct ehdrom_solver {
    const ehdrom_model *model;
    reduced_solver *reduced;
    reduced_state state;
    double *pressure_basis; // [num_nodes, num_pressure], read when fields are asked for
};

ehd_status ehdrom_open(ehdrom_model **model, const char *path, const ehdrom_sizes *sizes,
                       ehd_error *error) {
    ehdrom_model *self = calloc(1, sizeof *self);

    *model = NULL;
    if (self) self->path = strdup(path);
    if (!self || !self->path) {
        free(self);
        return ehd_fail(error, EHD_MEMORY, "%s: found no memory", path);
    }
    ehd_status status = model_read(&self->reduced, path, sizes, error);
    if (status)
        ehdrom_close(self);
    else
        *model = self;
    return status;
}

ehdrom_model *ehdrom_close(ehdrom_model *self) {
    if (self) {
        reduced_model_free(&self->reduced);
        free(self->path);
        free(self);
    }
    return NULL;
}

ehdrom_properties ehdrom_describe(const ehdrom_model *self) {
    const reduced_model *model = &self->reduced;
    ehdrom_properties properties = {.num_inner = model->grid.num_inner,
                                    .x_min = model->grid.x_min,
                                    .step = model->grid.step,
                                    .deformation = deformation_names[model->deformation],
                                    .pressure_modes = model->num_pressure,
                                    .deformation_modes = model->num_deformation,
                                    .unknowns = model->num_unknowns,
                                    .rows = model->num_rows,
                                    .needed_nodes = model->num_needed,
                                    .states = model->states.num_states};
    return properties;
}

ehd_status ehdrom_solver_create(ehdrom_solver **solver, const ehdrom_model *model,
                                ehd_error *error) {
    const reduced_settings settings = reduced_default_settings();
    ehdrom_solver *self = calloc(1, sizeof *self);
    ehd_status status = EHD_OK;

    *solver = NULL;
    if (!self) return ehd_fail(error, EHD_MEMORY, "online solver: found no memory");
    self->model = model;
    self->state.coordinates = calloc(model->reduced.num_unknowns, sizeof(double));
    if (!self->state.coordinates)
        status = ehd_fail(error, EHD_MEMORY, "online solver: found no memory");
    if (!status) status = reduced_solver_create(&self->reduced, &model->reduced, &settings, error);
    if (status)
        ehdrom_solver_free(self);
    else
        *solver = self;
    return status;
}

ehdrom_solver *ehdrom_solver_free(ehdrom_solver *self) {
    if (self) {
        reduced_solver_free(self->reduced);
        free(self->state.coordinates);
        free(self->pressure_basis);
        free(self);
    }
    return NULL;
}

static ehd_status check_contact(const ehdrom_model *model, const ehd_contact *contact,
                                ehd_error *error) {
    const ehd_grid *own = &model->reduced.grid, *grid = &contact->grid;

    if (contact->kind == model->reduced.kind && grid_same(grid, own)) return EHD_OK;
    return ehd_fail(error, EHD_DATA,
                    "grid: found a %s contact with %zu nodes from %g in steps of %g, expected a %s "
                    "contact with %zu from %g in steps of %g as in %s",
                    contact->kind->name, grid->num_inner, grid->x_min, grid->step,
                    model->reduced.kind->name, own->num_inner, own->x_min, own->step, model->path);
}

/* Converged, but is it to be trusted? */
static void judge(ehdrom_result *result, const reduced_model *model, const ehd_contact *contact) {
    if (result->status) return;
    if (!reduced_trained(model, contact->moes_M, contact->alpha_p_H)) {
        result->status = EHD_UNTRUSTED;
        result->reason = "outside of the trained range of M and alpha p_H";
    }
}

ehd_status ehdrom_solve(ehdrom_result *result, ehdrom_solver *solver, const ehd_contact *contact,
                        ehd_error *error) {
    const reduced_model *model = &solver->model->reduced;
    reduced_info info;
    ehd_status status = check_contact(solver->model, contact, error);
    if (status) return status;

    reduced_guess(&solver->state, model, contact->moes_M, contact->alpha_p_H);
    status = reduced_solve(&info, &solver->state, solver->reduced, contact, error);
    if (status) return status;
    *result = (ehdrom_result){.status = info.status,
                              .reason = info.reason,
                              .central_film_thickness = info.central_film_thickness,
                              .minimum_film_thickness = info.minimum_film_thickness,
                              .central_pressure = info.central_pressure,
                              .rigid_approach = solver->state.coordinates[model->num_unknowns - 1],
                              .exit_position = info.exit_position,
                              .load = info.load,
                              .iterations = info.iterations,
                              .residual = info.residual,
                              .seconds = info.seconds,
                              .seconds_rows = info.seconds_rows,
                              .seconds_linear = info.seconds_linear,
                              .seconds_exit = info.seconds_exit};
    judge(result, model, contact);
    return EHD_OK;
}

ehd_status ehdrom_fields(double *pressure, double *film, ehdrom_solver *solver, ehd_error *error) {
    const reduced_model *model = &solver->model->reduced;
    const ehd_grid *grid = &model->grid;
    const double *z = solver->state.coordinates;

    if (!solver->pressure_basis) {
        ehd_status status =
            model_read_pressure_basis(&solver->pressure_basis, solver->model->path, model, error);
        if (status) return status;
    }
    ehd_deflection *deflection = deflection_create(model->kind, grid);
    if (!deflection)
        return ehd_fail(error, EHD_MEMORY, "fields: found no memory for %zu nodes",
                        grid->num_nodes);
    cblas_dgemv(CblasRowMajor, CblasNoTrans, (int)grid->num_nodes, (int)model->num_pressure, 1,
                solver->pressure_basis, (int)model->num_pressure, z, 1, 0, pressure, 1);
    size_t exit = solver->state.exit;
    memset(pressure + exit, 0, (grid->num_nodes - exit) * sizeof(double));
    // the film of the pressure, also for the independent basis: it is what the solution means
    deflection_apply(film, deflection, pressure);
    for (size_t k = 0; k < grid->num_nodes; k++)
        film[k] += z[model->num_unknowns - 1] + model->kind->gap(grid_x(grid, k));
    deflection_free(deflection);
    return EHD_OK;
}
