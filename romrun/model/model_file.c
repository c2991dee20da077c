/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/model/model_file.h"

#include "romrun/model/basis_file.h"
#include "romrun/model/weighting.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

static ehd_status no_memory(const artefact *file, ehd_error *error) {
    return ehd_fail(error, EHD_MEMORY, "%s: found no memory", artefact_path(file));
}

// ---- writing

static ehd_status put_axes(artefact *file, const reduced_model *model, ehd_error *error) {
    ehd_status status = grid_write(file, model->kind, &model->grid, error);

    if (!status) status = artefact_put_axis(file, "row", model->num_rows, NULL, error);
    if (!status) status = artefact_put_axis(file, "needed_node", model->num_needed, NULL, error);
    if (!status) status = artefact_put_axis(file, "band_node", model->num_band, NULL, error);
    if (!status)
        status = artefact_put_axis(file, "pressure_mode", model->num_pressure, NULL, error);
    if (!status && model->num_deformation > 0)
        status = artefact_put_axis(file, "deformation_mode", model->num_deformation, NULL, error);
    if (!status && model->num_deformation > 0) status = film_axes_write(file, &model->grid, error);
    if (!status) status = artefact_put_axis(file, "state", model->states.num_states, NULL, error);
    return status;
}

/* Node numbers as a file's indices: `inner` ones count the inner nodes alone. */
static ehd_status put_nodes(artefact *file, const char *field, const size_t *nodes, size_t count,
                            const ehd_grid *grid, bool inner, ehd_error *error) {
    int64_t *indices = malloc((count + 1) * sizeof *indices);
    if (!indices) return no_memory(file, error);
    for (size_t i = 0; i < count; i++)
        indices[i] = (int64_t)(inner ? grid_row_of_node(grid, nodes[i]) : nodes[i]);
    ehd_status status = artefact_put_integers(file, field, indices, error);
    free(indices);
    return status;
}

/* What a file has of the band on each line of a point contact. */
static const struct {
    const char *field;
    size_t place; // in a band_line
} band_fields[] = {{"band_line_begin", offsetof(band_line, begin)},
                   {"band_line_end", offsetof(band_line, end)},
                   {"band_line_least_exit", offsetof(band_line, least)},
                   {"band_line_most_exit", offsetof(band_line, most)}};
enum { NUM_BAND_FIELDS = sizeof band_fields / sizeof *band_fields };

static size_t *band_value(band_line *line, int field) {
    return (size_t *)((char *)line + band_fields[field].place);
}

static ehd_status put_lines(artefact *file, const reduced_model *model, ehd_error *error) {
    size_t num_inner = model->grid.inner_lines, first = grid_first_line(&model->grid);
    int64_t *values = malloc(num_inner * sizeof *values);
    ehd_status status = values ? EHD_OK : no_memory(file, error);

    for (int f = 0; f < NUM_BAND_FIELDS && !status; f++) {
        for (size_t l = 0; l < num_inner; l++)
            values[l] = (int64_t)*band_value(&model->lines[first + l], f);
        status = artefact_put_integers(file, band_fields[f].field, values, error);
    }
    free(values);
    if (!status)
        status =
            artefact_put_integer(file, "first_minimum_line", (int64_t)model->first_minimum, error);
    return status ? status
                  : artefact_put_integer(file, "last_minimum_line", (int64_t)model->last_minimum,
                                         error);
}

static ehd_status put_independent(artefact *file, const reduced_model *model, ehd_error *error) {
    size_t width = model->num_deformation;
    double *kernel = malloc(model->num_band * width * sizeof *kernel);
    if (!kernel) return no_memory(file, error);
    for (size_t i = 0; i < model->num_band; i++)
        memcpy(kernel + i * width, model->left + i * model->num_cut, width * sizeof(double));
    ehd_status status = artefact_put(file, "band_projected_kernel", kernel, error);
    free(kernel);
    if (!status) status = artefact_put(file, "needed_deformation_basis", model->needed_film, error);
    if (!status) status = artefact_put(file, "band_deformation_basis", model->band_film, error);
    if (!status) status = artefact_put(file, "elasticity_jacobian", model->cut_base, error);
    return status;
}

static ehd_status put_tables(artefact *file, const reduced_model *model, ehd_error *error) {
    const double *load = model->cut_base + (model->num_cut - 1) * model->num_pressure;
    const ehd_grid *grid = &model->grid;
    ehd_status status =
        put_nodes(file, "selected_row", model->row_node, model->num_rows, grid, true, error);

    if (!status) status = artefact_put(file, "row_weight", model->row_weight, error);
    if (!status)
        status = put_nodes(file, "needed_node_index", model->needed_node, model->num_needed, grid,
                           false, error);
    if (!status)
        status = artefact_put(file, "needed_pressure_basis", model->needed_pressure, error);
    if (!status) status = artefact_put(file, "band_pressure_basis", model->band_pressure, error);
    if (!status) status = artefact_put(file, "load_jacobian", load, error);
    if (status) return status;
    if (model->deformation == DEFORMATION_INDEPENDENT) return put_independent(file, model, error);
    status = artefact_put(file, "needed_coupled_basis", model->needed_film, error);
    if (!status) status = artefact_put(file, "band_coupled_basis", model->band_film, error);
    return status;
}

static ehd_status put_control(artefact *file, const reduced_model *model, ehd_error *error) {
    const control_rows *control = &model->control;
    bool coupled = model->deformation == DEFORMATION_COUPLED;
    if (control->num_rows == 0) return EHD_OK;
    ehd_status status = artefact_put_axis(file, "control", control->num_rows, NULL, error);

    if (!status) status = artefact_put_axis(file, "control_node", control->num_needed, NULL, error);
    if (!status)
        status = put_nodes(file, "control_row", control->node, control->num_rows, &model->grid,
                           true, error);
    if (!status) status = artefact_put(file, "control_weight", control->weight, error);
    if (!status)
        status = put_nodes(file, "control_node_index", control->needed_node, control->num_needed,
                           &model->grid, false, error);
    if (!status) status = artefact_put(file, "control_pressure_basis", control->pressure, error);
    if (!status)
        status = artefact_put(file, coupled ? "control_coupled_basis" : "control_deformation_basis",
                              control->film, error);
    return status;
}

static ehd_status put_attributes(artefact *file, const reduced_model *model,
                                 const model_origin *origin, ehd_error *error) {
    const struct {
        const char *name;
        size_t value;
    } places[] = {{"band_begin", model->band_begin},
                  {"least_exit", model->least_exit},
                  {"most_exit", model->most_exit}};
    const struct {
        const char *name;
        double value;
    } reals[] = {{"sigma_min_residual", origin->sigma_min_residual},
                 {"sigma_min_jacobian", origin->sigma_min_jacobian},
                 {"sigma_min_over_exits", origin->sigma_min_over_exits},
                 {"stability", origin->stability}};
    ehd_status status =
        artefact_put_text(file, "deformation", deformation_names[model->deformation], error);

    for (size_t i = 0; i < 3 && !status; i++)
        status = artefact_put_integer(file, places[i].name, (int64_t)places[i].value, error);
    for (size_t i = 0; i < sizeof reals / sizeof *reals && !status; i++)
        status = artefact_put_real(file, reals[i].name, reals[i].value, error);
    if (!status) status = artefact_put_text(file, "method", origin->method, error);
    if (!status) status = artefact_put_text(file, "basis_sha256", origin->basis_identity, error);
    return status;
}

static ehd_status put_weighting(artefact *file, const model_origin *origin, ehd_error *error) {
    if (!origin->weights) return EHD_OK;
    ehd_status status =
        artefact_put_axis(file, "jacobian_mode", origin->num_jacobian_modes, NULL, error);
    if (!status) status = artefact_put_text(file, "weights", origin->weights, error);
    if (!status) status = artefact_put(file, "row_factor", origin->factors, error);
    if (!status) status = artefact_put(file, "row_jacobian_modes", origin->jacobian_modes, error);
    return status;
}

ehd_status model_write(const reduced_model *model, const reduced_basis *basis,
                       const model_origin *origin, const program *caller, const char *settings_text,
                       const char *const *inputs, ehd_error *error) {
    artefact *file = NULL;
    ehd_status status =
        artefact_create(&file, caller->output, &schema_model, caller, settings_text, inputs, error);

    if (!status) status = put_axes(file, model, error);
    if (!status) status = put_attributes(file, model, origin, error);
    if (!status && model->num_lines > 1) status = put_lines(file, model, error);
    if (!status) status = put_tables(file, model, error);
    if (!status) status = put_control(file, model, error);
    if (!status) status = put_weighting(file, origin, error);
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
    if (!status) status = artefact_finish(&file, error);
    artefact_close(&file);
    return status;
}

// ---- reading

/* What is stored, against which the wanted sizes are checked. */
typedef struct stored_sizes {
    size_t pressure, deformation, rows, needed, band;
    size_t jacobian; // modes of the Jacobian products
} stored_sizes;

static ehd_status choose_size(size_t *size, size_t wanted, size_t stored, const char *option,
                              const artefact *file, ehd_error *error) {
    if (wanted > stored)
        return ehd_fail(error, EHD_DATA, "%s: found %zu, expected at most the %zu stored in %s",
                        option, wanted, stored, artefact_path(file));
    *size = wanted ? wanted : stored;
    return EHD_OK;
}

/* Reads [rows, columns] and keeps the rows listed (NULL: all) and the first columns. */
static ehd_status read_part(double **part, artefact *file, const char *field, size_t rows,
                            size_t columns, const size_t *kept_rows, size_t num_kept,
                            size_t kept_columns, ehd_error *error) {
    double *whole = malloc((rows * columns + 1) * sizeof *whole);

    *part = malloc((num_kept * kept_columns + 1) * sizeof **part);
    ehd_status status = whole && *part ? EHD_OK : no_memory(file, error);
    if (!status && !artefact_has(file, field))
        status = ehd_fail(error, EHD_DATA, "%s: found no dataset %s, expected it for this basis",
                          artefact_path(file), field);
    if (!status) status = artefact_get(file, field, whole, error);
    for (size_t i = 0; i < rows * columns && !status; i++)
        if (!isfinite(whole[i]))
            status = ehd_fail(error, EHD_DATA, "%s: %s: found a value that is not finite",
                              artefact_path(file), field);
    for (size_t i = 0; i < num_kept && !status; i++)
        memcpy(*part + i * kept_columns, whole + (kept_rows ? kept_rows[i] : i) * columns,
               kept_columns * sizeof(double));
    free(whole);
    return status;
}

static ehd_status read_nodes(size_t **nodes, artefact *file, const char *field, size_t count,
                             bool inner, const ehd_grid *grid, ehd_error *error) {
    int64_t *indices = malloc((count + 1) * sizeof *indices);

    *nodes = malloc((count + 1) * sizeof **nodes);
    ehd_status status = indices && *nodes ? EHD_OK : no_memory(file, error);
    if (!status) status = artefact_get_integers(file, field, indices, error);
    for (size_t i = 0; i < count && !status; i++) {
        int64_t last = (int64_t)(inner ? grid->num_inner : grid->num_nodes) - 1;
        if (indices[i] < 0 || indices[i] > last)
            status = ehd_fail(error, EHD_DATA, "%s: %s: found %lld, expected 0 to %lld",
                              artefact_path(file), field, (long long)indices[i], (long long)last);
        else
            (*nodes)[i] = inner ? grid_node_of_row(grid, (size_t)indices[i]) : (size_t)indices[i];
    }
    free(indices);
    return status;
}

/* Places in a stored list of nodes of those that the chosen rows need. */
static ehd_status match_nodes(size_t **places, const size_t *nodes, size_t count,
                              const ehd_grid *grid, artefact *file, const char *field,
                              size_t num_stored, ehd_error *error) {
    size_t *stored = NULL, at = 0;
    ehd_status status = read_nodes(&stored, file, field, num_stored, false, grid, error);

    *places = malloc((count + 1) * sizeof **places);
    if (!status && !*places) status = no_memory(file, error);
    for (size_t i = 0; i < count && !status; i++) {
        while (at < num_stored && stored[at] < nodes[i])
            at++;
        if (at == num_stored || stored[at] != nodes[i])
            status = ehd_fail(error, EHD_DATA,
                              "%s: %s: found no node %zu, expected all that the rows need, "
                              "ascending",
                              artefact_path(file), field, nodes[i]);
        else
            (*places)[i] = at;
    }
    free(stored);
    return status;
}

/* The factors of the first rows and modes alone, in place of those of the whole. */
static ehd_status weigh_again(reduced_model *model, artefact *file, const stored_sizes *stored,
                              const weighting *weights, ehd_error *error) {
    size_t num_rows = model->num_rows;
    size_t num_modes =
        model->num_unknowns < stored->jacobian ? model->num_unknowns : stored->jacobian;
    double *factors = malloc(num_rows * sizeof *factors), *before = NULL, *sampled = NULL;
    ehd_status status = factors ? EHD_OK : no_memory(file, error);

    if (!status)
        status = read_part(&before, file, "row_factor", stored->rows, 1, NULL, num_rows, 1, error);
    if (!status)
        status = read_part(&sampled, file, "row_jacobian_modes", stored->rows, stored->jacobian,
                           NULL, num_rows, num_modes, error);
    for (size_t r = 0; r < num_rows && !status; r++)
        if (!(before[r] > 0))
            status = ehd_fail(error, EHD_DATA, "%s: row_factor: found %g, expected above 0",
                              artefact_path(file), before[r]);
    if (!status) status = weights->weigh(factors, sampled, num_rows, num_modes, error);
    for (size_t r = 0; r < num_rows && !status; r++)
        model->row_weight[r] *= factors[r] / before[r];
    free(sampled);
    free(before);
    free(factors);
    return status;
}

/* Weights belong to a list of rows and to the modes it was weighed for, so that a part has its own. */
static ehd_status weigh_part(reduced_model *model, artefact *file, const stored_sizes *stored,
                             ehd_error *error) {
    bool whole = model->num_rows == stored->rows && model->num_pressure == stored->pressure &&
                 model->num_deformation == stored->deformation;
    char *name = NULL;

    if (whole || !artefact_has(file, "weights") || !artefact_has(file, "row_factor") ||
        !artefact_has(file, "row_jacobian_modes"))
        return EHD_OK;
    ehd_status status = artefact_get_text(file, "weights", &name, error);
    const weighting *weights = status ? NULL : weighting_find(name);
    if (!status && !weights)
        status = ehd_fail(error, EHD_DATA,
                          "%s: weights: found %.40s, expected one that is known, for a part of the "
                          "rows or modes",
                          artefact_path(file), name);
    if (!status) status = weigh_again(model, file, stored, weights, error);
    free(name);
    return status;
}

static ehd_status read_rows(reduced_model *model, artefact *file, const stored_sizes *stored,
                            ehd_error *error) {
    ehd_status status =
        read_nodes(&model->row_node, file, "selected_row", stored->rows, true, &model->grid, error);

    if (!status)
        status = read_part(&model->row_weight, file, "row_weight", stored->rows, 1, NULL,
                           model->num_rows, 1, error);
    if (!status) status = weigh_part(model, file, stored, error);
    if (!status) status = reduced_model_list_needed(model, error);
    return status;
}

static ehd_status read_line(size_t *value, artefact *file, const char *name,
                            const reduced_model *model, ehd_error *error) {
    int64_t line = 0;
    ehd_status status = artefact_get_integer(file, name, &line, error);

    if (!status && (line < (int64_t)grid_first_line(&model->grid) ||
                    line >= (int64_t)(grid_first_line(&model->grid) + model->grid.inner_lines)))
        status = ehd_fail(error, EHD_DATA, "%s: %s: found %lld, expected a line of y",
                          artefact_path(file), name, (long long)line);
    *value = (size_t)line;
    return status;
}

/* Each line's exits inside of its band with room for the rows there, and the lines together all band nodes. */
static ehd_status check_lines(const reduced_model *model, const artefact *file, ehd_error *error) {
    size_t width = grid_width(&model->grid), count = 0;

    for (size_t l = 0; l < model->num_lines; l++) {
        const band_line *line = &model->lines[l];
        if (line->end == line->begin) continue;
        count += line->end - line->begin;
        if (!(line->begin >= 1 && line->begin + 2 <= line->least && line->least <= line->most &&
              line->most + 2 <= line->end && line->end <= width))
            return ehd_fail(error, EHD_DATA,
                            "%s: band_line_begin: found columns %zu to %zu with exits from %zu to "
                            "%zu, expected these inside",
                            artefact_path(file), line->begin, line->end, line->least, line->most);
    }
    if (count == model->num_band) return EHD_OK;
    return ehd_fail(error, EHD_DATA, "%s: band_node: found %zu, expected %zu, as many as the lines",
                    artefact_path(file), model->num_band, count);
}

static ehd_status read_lines(reduced_model *model, artefact *file, ehd_error *error) {
    size_t num_inner = model->grid.inner_lines, first = grid_first_line(&model->grid);
    int64_t *values = malloc(num_inner * sizeof *values);
    ehd_status status = values ? EHD_OK : no_memory(file, error);

    for (size_t l = 0; l < model->num_lines; l++)
        model->lines[l] = (band_line){1, 1, 0, 1, 1};
    for (int f = 0; f < NUM_BAND_FIELDS && !status; f++) {
        if (!artefact_has(file, band_fields[f].field))
            status = ehd_fail(error, EHD_DATA,
                              "%s: found no dataset %s, expected it for a point contact",
                              artefact_path(file), band_fields[f].field);
        if (!status) status = artefact_get_integers(file, band_fields[f].field, values, error);
        for (size_t l = 0; l < num_inner && !status; l++)
            *band_value(&model->lines[first + l], f) = (size_t)values[l];
    }
    free(values);
    for (size_t l = 1; l < model->num_lines && !status; l++)
        model->lines[l].offset =
            model->lines[l - 1].offset + model->lines[l - 1].end - model->lines[l - 1].begin;
    if (!status) status = check_lines(model, file, error);
    if (!status)
        status = read_line(&model->first_minimum, file, "first_minimum_line", model, error);
    return status ? status
                  : read_line(&model->last_minimum, file, "last_minimum_line", model, error);
}

/* The band of a line contact. */
static ehd_status read_places(reduced_model *model, artefact *file, ehd_error *error) {
    struct {
        const char *name;
        size_t *value;
    } places[] = {{"band_begin", &model->band_begin},
                  {"least_exit", &model->least_exit},
                  {"most_exit", &model->most_exit}};
    ehd_status status = EHD_OK;

    for (size_t i = 0; i < 3 && !status; i++) {
        int64_t value = 0;
        status = artefact_get_integer(file, places[i].name, &value, error);
        if (!status && (value < 3 || (size_t)value >= model->grid.num_nodes))
            status = ehd_fail(error, EHD_DATA, "%s: %s: found %lld, expected 3 to %zu",
                              artefact_path(file), places[i].name, (long long)value,
                              model->grid.num_nodes - 1);
        *places[i].value = (size_t)value;
    }
    if (!status &&
        !(model->band_begin + 2 <= model->least_exit && model->least_exit <= model->most_exit &&
          model->most_exit + 2 <= model->band_begin + model->num_band))
        status = ehd_fail(error, EHD_DATA,
                          "%s: found exits from %zu to %zu, expected them inside the band",
                          artefact_path(file), model->least_exit, model->most_exit);
    model->lines[0] = (band_line){model->band_begin, model->band_begin + model->num_band, 0,
                                  model->least_exit, model->most_exit};
    return status;
}

static ehd_status read_band(reduced_model *model, artefact *file, ehd_error *error) {
    model->lines = calloc(model->num_lines, sizeof *model->lines);
    if (!model->lines) return no_memory(file, error);
    return model->num_lines > 1 ? read_lines(model, file, error) : read_places(model, file, error);
}

/* The cut table at band_begin and the left sides, from what the file holds of them. */
static ehd_status read_cut(reduced_model *model, artefact *file, const stored_sizes *stored,
                           ehd_error *error) {
    bool coupled = model->deformation == DEFORMATION_COUPLED;
    size_t num_pressure = model->num_pressure, width = model->num_deformation;
    double *load = NULL, *elasticity = NULL, *kernel = NULL;
    ehd_status status =
        read_part(&load, file, "load_jacobian", 1, stored->pressure, NULL, 1, num_pressure, error);

    model->num_cut = (coupled ? model->num_needed : width) + 1;
    model->cut_base = malloc(model->num_cut * num_pressure * sizeof(double));
    model->left = malloc(model->num_band * model->num_cut * sizeof(double));
    if (!status && (!model->cut_base || !model->left)) status = no_memory(file, error);
    if (!status && !coupled)
        status = read_part(&elasticity, file, "elasticity_jacobian", stored->deformation,
                           stored->pressure, NULL, width, num_pressure, error);
    if (!status && !coupled)
        status = read_part(&kernel, file, "band_projected_kernel", stored->band,
                           stored->deformation, NULL, model->num_band, width, error);
    if (!status) {
        memcpy(model->cut_base, coupled ? model->needed_film : elasticity,
               (model->num_cut - 1) * num_pressure * sizeof(double));
        memcpy(model->cut_base + (model->num_cut - 1) * num_pressure, load,
               num_pressure * sizeof(double));
        for (size_t i = 0; i < model->num_band && !coupled; i++)
            memcpy(model->left + i * model->num_cut, kernel + i * width, width * sizeof(double));
    }
    free(kernel);
    free(elasticity);
    free(load);
    return status;
}

static ehd_status read_tables(reduced_model *model, artefact *file, const stored_sizes *stored,
                              ehd_error *error) {
    bool coupled = model->deformation == DEFORMATION_COUPLED;
    size_t stored_width = coupled ? stored->pressure : stored->deformation;
    size_t width = coupled ? model->num_pressure : model->num_deformation;
    size_t *places = NULL;
    ehd_status status = match_nodes(&places, model->needed_node, model->num_needed, &model->grid,
                                    file, "needed_node_index", stored->needed, error);

    if (!status)
        status = read_part(&model->needed_pressure, file, "needed_pressure_basis", stored->needed,
                           stored->pressure, places, model->num_needed, model->num_pressure, error);
    if (!status)
        status = read_part(&model->needed_film, file,
                           coupled ? "needed_coupled_basis" : "needed_deformation_basis",
                           stored->needed, stored_width, places, model->num_needed, width, error);
    if (!status)
        status = read_part(&model->band_pressure, file, "band_pressure_basis", stored->band,
                           stored->pressure, NULL, model->num_band, model->num_pressure, error);
    if (!status)
        status = read_part(&model->band_film, file,
                           coupled ? "band_coupled_basis" : "band_deformation_basis", stored->band,
                           stored_width, NULL, model->num_band, width, error);
    if (!status) status = read_cut(model, file, stored, error);
    free(places);
    return status;
}

static ehd_status read_control_tables(reduced_model *model, artefact *file,
                                      const stored_sizes *stored, ehd_error *error) {
    bool coupled = model->deformation == DEFORMATION_COUPLED;
    control_rows *control = &model->control;
    size_t num_stored = artefact_length(file, "control_node"), *places = NULL;
    ehd_status status = match_nodes(&places, control->needed_node, control->num_needed,
                                    &model->grid, file, "control_node_index", num_stored, error);

    if (!status)
        status =
            read_part(&control->pressure, file, "control_pressure_basis", num_stored,
                      stored->pressure, places, control->num_needed, model->num_pressure, error);
    if (!status)
        status = read_part(
            &control->film, file, coupled ? "control_coupled_basis" : "control_deformation_basis",
            num_stored, coupled ? stored->pressure : stored->deformation, places,
            control->num_needed, coupled ? model->num_pressure : model->num_deformation, error);
    free(places);
    return status;
}

/* All control rows, whatever the number of selected ones. */
static ehd_status read_control(reduced_model *model, artefact *file, const stored_sizes *stored,
                               ehd_error *error) {
    control_rows *control = &model->control;
    ehd_status status;

    control->num_rows = artefact_length(file, "control");
    if (control->num_rows == 0) return EHD_OK;
    status = read_nodes(&control->node, file, "control_row", control->num_rows, true, &model->grid,
                        error);
    if (!status)
        status = read_part(&control->weight, file, "control_weight", control->num_rows, 1, NULL,
                           control->num_rows, 1, error);
    if (!status) status = reduced_model_list_control(model, error);
    return status ? status : read_control_tables(model, file, stored, error);
}

/* The states' coordinates in the chosen modes. */
static ehd_status read_states(reduced_model *model, artefact *file, const stored_sizes *stored,
                              ehd_error *error) {
    reduced_states whole = {0};
    reduced_states *kept = &model->states;
    ehd_status status =
        states_read(&whole, file, stored->pressure, stored->deformation, &model->grid, error);

    if (!status)
        status = reduced_states_init(kept, whole.num_states, whole.num_lines, model->num_unknowns,
                                     error);
    if (!status)
        memcpy(kept->exit, whole.exit, whole.num_states * whole.num_lines * sizeof *kept->exit);
    for (size_t s = 0; s < whole.num_states && !status; s++) {
        const double *source = whole.coordinates + s * whole.num_unknowns;
        double *target = kept->coordinates + s * kept->num_unknowns;
        memcpy(target, source, model->num_pressure * sizeof(double));
        memcpy(target + model->num_pressure, source + stored->pressure,
               model->num_deformation * sizeof(double));
        target[kept->num_unknowns - 1] = source[whole.num_unknowns - 1];
        kept->moes_M[s] = whole.moes_M[s];
        kept->alpha_p_H[s] = whole.alpha_p_H[s];
        kept->central_film_thickness[s] = whole.central_film_thickness[s];
        kept->stationary[s] = whole.stationary[s];
        kept->rate[s] = whole.rate[s];
    }
    reduced_states_free(&whole);
    return status;
}

static ehd_status choose_sizes(reduced_model *model, stored_sizes *stored, artefact *file,
                               const ehdrom_sizes *wanted, ehd_error *error) {
    bool coupled = model->deformation == DEFORMATION_COUPLED;

    stored->pressure = artefact_length(file, "pressure_mode");
    stored->deformation = coupled ? 0 : artefact_length(file, "deformation_mode");
    stored->rows = artefact_length(file, "row");
    stored->jacobian = artefact_length(file, "jacobian_mode");
    stored->needed = artefact_length(file, "needed_node");
    stored->band = model->num_band = artefact_length(file, "band_node");
    ehd_status status = choose_size(&model->num_pressure, wanted->pressure_modes, stored->pressure,
                                    "--pressure-modes", file, error);
    if (!status)
        status = choose_size(&model->num_deformation, wanted->deformation_modes,
                             stored->deformation, "--deformation-modes", file, error);
    if (!status)
        status = choose_size(&model->num_rows, wanted->rows, stored->rows, "--rows", file, error);
    if (status) return status;
    model->num_unknowns = reduced_num_unknowns(model->num_pressure, model->num_deformation);
    if (model->num_rows < model->num_pressure)
        return ehd_fail(error, EHD_DATA, "--rows: found %zu, expected at least the %zu modes",
                        model->num_rows, model->num_pressure);
    return EHD_OK;
}

ehd_status model_read(reduced_model *model, const char *path, const ehdrom_sizes *sizes,
                      ehd_error *error) {
    const artefact_schema *const kinds[] = {&schema_model, NULL};
    artefact *file = NULL;
    const ehdrom_sizes whole = {0};
    stored_sizes stored;
    ehd_status status = artefact_open(&file, path, kinds, error);

    memset(model, 0, sizeof *model);
    if (!status) status = grid_read(&model->grid, &model->kind, file, error);
    model->num_lines = grid_lines(&model->grid);
    if (!status) status = deformation_read(&model->deformation, file, error);
    if (!status) status = choose_sizes(model, &stored, file, sizes ? sizes : &whole, error);
    if (!status) status = read_band(model, file, error);
    if (!status) status = read_rows(model, file, &stored, error);
    if (!status) status = read_tables(model, file, &stored, error);
    if (!status) status = read_control(model, file, &stored, error);
    if (!status) status = read_states(model, file, &stored, error);
    artefact_close(&file);
    if (!status) status = reduced_model_complete(model, error);
    if (!status && model->control.num_rows > 0)
        status = reduced_model_complete_control(model, error);
    if (status) reduced_model_free(model);
    return status;
}

/* The first `wanted` of the stored modes. */
static ehd_status read_modes(double **modes, artefact *file, const char *field,
                             const char *mode_axis, size_t wanted, const ehd_grid *grid, bool inner,
                             ehd_error *error) {
    size_t stored = artefact_length(file, mode_axis), num_nodes = grid->num_nodes;
    double *whole = NULL;
    ehd_status status = modes_read(&whole, file, field, grid, stored, inner, error);

    *modes = status ? NULL : malloc(num_nodes * wanted * sizeof(double));
    if (!status && !*modes) status = no_memory(file, error);
    for (size_t k = 0; k < num_nodes && !status; k++)
        memcpy(*modes + k * wanted, whole + k * stored, wanted * sizeof(double));
    free(whole);
    return status;
}

ehd_status model_read_modes(double **pressure_basis, double **deformation_basis, const char *path,
                            const reduced_model *model, ehd_error *error) {
    const artefact_schema *const kinds[] = {&schema_model, NULL};
    bool wanted = deformation_basis && model->num_deformation > 0;
    artefact *file = NULL;
    ehd_status status = artefact_open(&file, path, kinds, error);

    *pressure_basis = NULL;
    if (deformation_basis) *deformation_basis = NULL;
    if (!status)
        status = read_modes(pressure_basis, file, "pressure_basis", "pressure_mode",
                            model->num_pressure, &model->grid, true, error);
    if (!status && wanted && !artefact_has(file, "deformation_basis"))
        status = ehd_fail(error, EHD_DATA,
                          "%s: found no dataset deformation_basis, expected it for a transient "
                          "scene with an independent basis",
                          path);
    if (!status && wanted)
        status = read_modes(deformation_basis, file, "deformation_basis", "deformation_mode",
                            model->num_deformation, &model->grid, false, error);
    artefact_close(&file);
    return status;
}
