/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/model/model_file.h"

#include "common/output/columns.h"
#include "romrun/model/basis_file.h"
#include "romrun/model/model_fields.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

const row_fields selected_fields = {"row",
                                    "needed_node",
                                    "selected_row",
                                    "row_weight",
                                    "needed_node_index",
                                    "needed_pressure_basis",
                                    {"needed_deformation_basis", "needed_coupled_basis"}};
const row_fields control_fields = {"control",
                                   "control_node",
                                   "control_row",
                                   "control_weight",
                                   "control_node_index",
                                   "control_pressure_basis",
                                   {"control_deformation_basis", "control_coupled_basis"}};

const traction_fields cubature_fields = {"cubature",
                                         "cubature_node_index",
                                         "cubature_friction",
                                         "cubature_dry",
                                         "moment_jacobian",
                                         "cubature_pressure_basis",
                                         {"cubature_deformation_basis", "cubature_coupled_basis"}};

const char *const band_fields[NUM_BAND_FIELDS] = {"band_line_begin", "band_line_end",
                                                  "band_line_least_exit", "band_line_most_exit"};

size_t *band_value(band_line *line, int field) {
    size_t *const values[NUM_BAND_FIELDS] = {&line->begin, &line->end, &line->min_exit,
                                             &line->max_exit};
    return values[field];
}

// ---- writing

static ehd_status put_axes(artefact *file, const reduced_model *model, ehd_error *error) {
    ehd_status status = grid_write(file, model->kind, &model->grid, error);

    if (!status) status = carriage_write(file, &model->carriage, error);
    if (!status) status = artefact_put_axis(file, "band_node", model->band.num_nodes, NULL, error);
    if (!status)
        status = artefact_put_axis(file, "pressure_mode", model->num_pressure, NULL, error);
    if (!status && model->num_deformation > 0)
        status = artefact_put_axis(file, "deformation_mode", model->num_deformation, NULL, error);
    if (!status && model->num_deformation > 0) status = film_axes_write(file, &model->grid, error);
    if (!status) status = artefact_put_axis(file, "state", model->states.num_states, NULL, error);
    return status;
}

/* Writes nodes as indices. `inner`: the nodes are inner nodes, and the indices count only inner
 * nodes. */
static ehd_status put_nodes(artefact *file, const char *field, const size_t *nodes, size_t count,
                            const ehd_grid *grid, bool inner, ehd_error *error) {
    int64_t *indices = malloc((count + 1) * sizeof *indices);
    if (!indices) return ehd_no_memory(error, artefact_path(file));
    for (size_t i = 0; i < count; i++)
        indices[i] = (int64_t)(inner ? grid_row_of_node(grid, nodes[i]) : nodes[i]);
    ehd_status status = artefact_put_integers(file, field, indices, error);
    free(indices);
    return status;
}

static ehd_status put_lines(artefact *file, const reduced_model *model, ehd_error *error) {
    size_t num_inner = model->grid.inner_lines, first = grid_first_line(&model->grid);
    const named_number minimum[] = {{"first_minimum_line", (double)model->band.first_minimum},
                                    {"last_minimum_line", (double)model->band.last_minimum},
                                    {0}};
    int64_t *values = malloc(num_inner * sizeof *values);
    ehd_status status = values ? EHD_OK : ehd_no_memory(error, artefact_path(file));

    for (int f = 0; f < NUM_BAND_FIELDS && !status; f++) {
        for (size_t l = 0; l < num_inner; l++)
            values[l] = (int64_t)*band_value(&model->band.lines[first + l], f);
        status = artefact_put_integers(file, band_fields[f], values, error);
    }
    free(values);
    return status ? status : numbers_put(file, 0, minimum, error);
}

static ehd_status put_independent(artefact *file, const reduced_model *model, ehd_error *error) {
    size_t width = model->num_deformation;
    double *kernel = malloc(model->band.num_nodes * width * sizeof *kernel);
    if (!kernel) return ehd_no_memory(error, artefact_path(file));
    for (size_t i = 0; i < model->band.num_nodes; i++)
        memcpy(kernel + i * width, model->cut.left + i * model->cut.num_rows,
               width * sizeof(double));
    ehd_status status = artefact_put(file, "band_projected_kernel", kernel, error);
    free(kernel);
    return status ? status : artefact_put(file, "elasticity_jacobian", model->cut.base, error);
}

static ehd_status put_rows(artefact *file, const row_set *set, const row_fields *fields,
                           const reduced_model *model, ehd_error *error) {
    if (set->num_rows == 0) return EHD_OK;
    ehd_status status = artefact_put_axis(file, fields->row_axis, set->num_rows, NULL, error);

    if (!status)
        status = artefact_put_axis(file, fields->needed_axis, set->num_needed, NULL, error);
    if (!status)
        status = put_nodes(file, fields->row, set->node, set->num_rows, &model->grid, true, error);
    if (!status) status = artefact_put(file, fields->weight, set->weight, error);
    if (!status)
        status = put_nodes(file, fields->needed, set->needed_node, set->num_needed, &model->grid,
                           false, error);
    if (!status) status = artefact_put(file, fields->pressure, set->pressure, error);
    return status ? status : artefact_put(file, fields->film[model->deformation], set->film, error);
}

static ehd_status put_tables(artefact *file, const reduced_model *model, ehd_error *error) {
    const double *load = model->cut.base + (model->cut.num_rows - 1) * model->num_pressure;
    bool coupled = model->deformation == DEFORMATION_COUPLED;
    ehd_status status = put_rows(file, &model->rows, &selected_fields, model, error);

    if (!status) status = artefact_put(file, "band_pressure_basis", model->band.pressure, error);
    if (!status)
        status = artefact_put(file, coupled ? "band_coupled_basis" : "band_deformation_basis",
                              model->band.film, error);
    if (!status) status = artefact_put(file, "load_jacobian", load, error);
    if (!status && !coupled) status = put_independent(file, model, error);
    return status ? status : put_rows(file, &model->control, &control_fields, model, error);
}

static ehd_status put_cubature(artefact *file, const reduced_model *model, ehd_error *error) {
    const node_cubature *cubature = &model->cubature;
    const row_set *set = &cubature->nodes;
    if (set->num_needed == 0) return EHD_OK;
    ehd_status status = artefact_put_axis(file, cubature_fields.axis, set->num_needed, NULL, error);

    if (!status)
        status = put_nodes(file, cubature_fields.node, set->needed_node, set->num_needed,
                           &model->grid, false, error);
    if (!status) status = artefact_put(file, cubature_fields.pressure, set->pressure, error);
    if (!status)
        status = artefact_put(file, cubature_fields.film[model->deformation], set->film, error);
    if (!status) status = artefact_put(file, cubature_fields.friction, cubature->friction, error);
    if (!status) status = artefact_put(file, cubature_fields.dry, cubature->dry, error);
    return status ? status : artefact_put(file, cubature_fields.moment, cubature->moment, error);
}

static ehd_status put_attributes(artefact *file, const reduced_model *model,
                                 const model_origin *origin, ehd_error *error) {
    const band_line *line = &model->band.lines[0];
    const named_number numbers[] = {{"band_begin", (double)line->begin},
                                    {"least_exit", (double)line->min_exit},
                                    {"most_exit", (double)line->max_exit},
                                    {"sigma_min_residual", origin->sigma_min_residual},
                                    {"sigma_min_jacobian", origin->sigma_min_jacobian},
                                    {"sigma_min_over_exits", origin->sigma_min_over_exits},
                                    {"stability", origin->stability},
                                    {0}};
    ehd_status status =
        artefact_put_text(file, "deformation", deformation_names[model->deformation], error);

    if (!status) status = numbers_put(file, 0, numbers, error);
    if (!status) status = artefact_put_text(file, "method", origin->method, error);
    if (!status) status = artefact_put_text(file, "basis_sha256", origin->basis_identity, error);
    return status;
}

static ehd_status put_weighting(artefact *file, const model_origin *origin, ehd_error *error) {
    ehd_status status =
        origin->factors ? artefact_put(file, "row_factor", origin->factors, error) : EHD_OK;

    if (status || !origin->weights) return status;
    status = artefact_put_axis(file, "jacobian_mode", origin->num_jacobian_modes, NULL, error);
    if (!status) status = artefact_put_text(file, "weights", origin->weights, error);
    if (!status) status = artefact_put(file, "row_jacobian_modes", origin->jacobian_modes, error);
    return status;
}

ehd_status model_put(artefact *file, const reduced_model *model, const reduced_basis *basis,
                     const model_origin *origin, ehd_error *error) {
    ehd_status status = put_axes(file, model, error);
    if (!status) status = put_attributes(file, model, origin, error);
    if (!status && model->band.num_lines > 1) status = put_lines(file, model, error);
    if (!status) status = put_tables(file, model, error);
    if (!status) status = put_weighting(file, origin, error);
    if (!status) status = put_cubature(file, model, error);
    if (!status)
        status = modes_write(file, "pressure_basis", basis->pressure, &basis->grid,
                             basis->num_pressure, true, error);
    if (!status && basis->deformation_modes)
        status = modes_write(file, "deformation_basis", basis->deformation_modes, &basis->grid,
                             basis->num_deformation, false, error);
    if (!status)
        status = states_write(file, &model->states, model->num_pressure, model->num_deformation,
                              &model->grid, error);
    if (!status && origin->sigma_min_by_exit)
        status = artefact_put(file, "sigma_min_by_exit", origin->sigma_min_by_exit, error);
    return status;
}

ehd_status model_write(const reduced_model *model, const reduced_basis *basis,
                       const model_origin *origin, const program *caller, const char *settings_text,
                       const char *const *inputs, ehd_error *error) {
    artefact *file = NULL;
    ehd_status status =
        artefact_create(&file, caller->output, &schema_model, caller, settings_text, inputs, error);

    if (!status) status = model_put(file, model, basis, origin, error);
    if (!status) status = artefact_finish(&file, error);
    artefact_close(&file);
    return status;
}
