/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads model.h5 (schemas/model.md; model_file.h). If only some rows or modes of a model are read,
 * the rows get new weights (weighting.h).
 * Called by romrun/online/part.c, by romrun/calibrate/calibrate.c, and by readers.c for --check. */
#include "romrun/model/basis_file.h"
#include "romrun/model/model_fields.h"
#include "romrun/model/model_file.h"
#include "romrun/model/weighting.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* Numbers of modes and rows of the stored model. */
typedef struct stored_sizes {
    size_t pressure, deformation, rows, band;
    size_t jacobian; // number of modes of the Jacobian products (weighting.h)
} stored_sizes;

static ehd_status choose_size(size_t *size, size_t wanted, size_t stored, const char *option,
                              const artefact *file, ehd_error *error) {
    if (wanted > stored)
        return ehd_fail(error, EHD_DATA, "%s: found %zu, expected at most the %zu stored in %s",
                        option, wanted, stored, artefact_path(file));
    *size = wanted ? wanted : stored;
    return EHD_OK;
}

/* Reads a table [rows, columns]. Keeps the rows listed in `kept_rows` (NULL: the first num_kept
 * rows), and of these rows the first kept_columns columns. */
static ehd_status read_part(double **part, arena *memory, artefact *file, const char *field,
                            size_t rows, size_t columns, const size_t *kept_rows, size_t num_kept,
                            size_t kept_columns, ehd_error *error) {
    double *whole = array_new(rows, columns, sizeof *whole);

    *part = arena_table(memory, num_kept, kept_columns, sizeof **part);
    ehd_status status = whole && *part ? EHD_OK : ehd_no_memory(error, artefact_path(file));
    if (!status && !artefact_has(file, field))
        status = ehd_fail(error, EHD_DATA, "%s: found no dataset %s, expected it for this basis",
                          artefact_path(file), field);
    if (!status) status = artefact_get(file, field, whole, rows * columns, error);
    for (size_t i = 0; i < num_kept && !status; i++)
        memcpy(*part + i * kept_columns, whole + (kept_rows ? kept_rows[i] : i) * columns,
               kept_columns * sizeof(double));
    free(whole);
    return status;
}

static ehd_status read_nodes(size_t **nodes, arena *memory, artefact *file, const char *field,
                             size_t count, bool inner, const ehd_grid *grid, ehd_error *error) {
    int64_t *indices = array_new(count, 1, sizeof *indices);

    *nodes = arena_array(memory, count, sizeof **nodes);
    ehd_status status = indices && *nodes ? EHD_OK : ehd_no_memory(error, artefact_path(file));
    if (!status) status = artefact_get_integers(file, field, indices, count, error);
    for (size_t i = 0; i < count && !status; i++)
        (*nodes)[i] = inner ? grid_node_of_row(grid, (size_t)indices[i]) : (size_t)indices[i];
    free(indices);
    return status;
}

/* Finds the indices of `nodes` in a stored list. The list must be ascending and contain all these
 * nodes. */
static ehd_status match_nodes(size_t **indices, arena *memory, const size_t *nodes, size_t count,
                              const ehd_grid *grid, artefact *file, const char *field,
                              size_t num_stored, ehd_error *error) {
    size_t *stored = NULL, at = 0;
    ehd_status status = read_nodes(&stored, memory, file, field, num_stored, false, grid, error);

    *indices = arena_array(memory, count, sizeof **indices);
    if (!status && !*indices) status = ehd_no_memory(error, artefact_path(file));
    for (size_t i = 0; i < count && !status; i++) {
        while (at < num_stored && stored[at] < nodes[i])
            at++;
        if (at == num_stored || stored[at] != nodes[i])
            status = ehd_fail(error, EHD_DATA,
                              "%s: %s: found no node %zu, expected all that the rows need, "
                              "ascending",
                              artefact_path(file), field, nodes[i]);
        else
            (*indices)[i] = at;
    }
    return status;
}

/* Replaces the factors that weigh the rows of the whole model by factors for a smaller model, which
 * has only the first rows and modes. */
static ehd_status reweigh(reduced_model *model, artefact *file, const stored_sizes *stored,
                          const weighting *weights, ehd_error *error) {
    size_t num_rows = model->rows.num_rows;
    size_t num_modes =
        model->num_unknowns < stored->jacobian ? model->num_unknowns : stored->jacobian;
    arena memory = {0};
    double *factors = arena_array(&memory, num_rows, sizeof *factors), *before = NULL;
    double *sampled = NULL;
    ehd_status status = factors ? EHD_OK : ehd_no_memory(error, artefact_path(file));

    if (!status)
        status = read_part(&before, &memory, file, "row_factor", stored->rows, 1, NULL, num_rows, 1,
                           error);
    if (!status)
        status = read_part(&sampled, &memory, file, "row_jacobian_modes", stored->rows,
                           stored->jacobian, NULL, num_rows, num_modes, error);
    if (!status) status = weights->weigh(factors, sampled, num_rows, num_modes, error);
    for (size_t r = 0; r < num_rows && !status; r++)
        model->rows.weight[r] *= factors[r] / before[r];
    arena_free(&memory);
    return status;
}

/* Computes new weights if only some rows or modes are read, because the weights of a list of rows
 * and modes do not hold for a part of the list. */
static ehd_status weigh_part(reduced_model *model, artefact *file, const stored_sizes *stored,
                             ehd_error *error) {
    bool whole = model->rows.num_rows == stored->rows && model->num_pressure == stored->pressure &&
                 model->num_deformation == stored->deformation;
    char *name = NULL;

    if (whole || !artefact_has(file, "weights") || !artefact_has(file, "row_factor") ||
        !artefact_has(file, "row_jacobian_modes"))
        return EHD_OK;
    ehd_status status = artefact_get_text(file, "weights", &name, error);
    const weighting *weights = status ? NULL : entry_find(weightings, sizeof *weightings, name);
    if (!status && !weights)
        status = ehd_fail(error, EHD_DATA,
                          "%s: weights: found %.40s, expected one that is known, for a part of the "
                          "rows or modes",
                          artefact_path(file), name);
    if (!status) status = reweigh(model, file, stored, weights, error);
    free(name);
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

static ehd_status read_lines(reduced_model *model, artefact *file, ehd_error *error) {
    size_t num_inner = model->grid.inner_lines, first = grid_first_line(&model->grid);
    int64_t *values = array_new(num_inner, 1, sizeof *values);
    ehd_status status = values ? EHD_OK : ehd_no_memory(error, artefact_path(file));

    for (size_t l = 0; l < model->band.num_lines; l++)
        model->band.lines[l] = (band_line){1, 1, 0, 1, 1};
    for (int f = 0; f < NUM_BAND_FIELDS && !status; f++) {
        if (!artefact_has(file, band_fields[f]))
            status = ehd_fail(error, EHD_DATA,
                              "%s: found no dataset %s, expected it for a point contact",
                              artefact_path(file), band_fields[f]);
        if (!status) status = artefact_get_integers(file, band_fields[f], values, num_inner, error);
        for (size_t l = 0; l < num_inner && !status; l++)
            *band_value(&model->band.lines[first + l], f) = (size_t)values[l];
    }
    free(values);
    for (size_t l = 1; l < model->band.num_lines && !status; l++)
        model->band.lines[l].offset = model->band.lines[l - 1].offset +
                                      model->band.lines[l - 1].end - model->band.lines[l - 1].begin;
    if (!status) status = reduced_check_band(model, artefact_path(file), error);
    if (!status)
        status = read_line(&model->band.first_minimum, file, "first_minimum_line", model, error);
    return status ? status
                  : read_line(&model->band.last_minimum, file, "last_minimum_line", model, error);
}

/* Reads the band of a line contact. */
static ehd_status read_band_line(reduced_model *model, artefact *file, ehd_error *error) {
    band_line *line = &model->band.lines[0];
    struct {
        const char *name;
        size_t *value;
    } columns[] = {{"band_begin", &line->begin},
                   {"least_exit", &line->min_exit},
                   {"most_exit", &line->max_exit}};

    for (size_t i = 0; i < 3; i++) {
        int64_t value = 0;
        ehd_status status = artefact_get_integer(file, columns[i].name, &value, error);
        if (status) return status;
        if (value < 3 || (size_t)value >= model->grid.num_nodes)
            return ehd_fail(error, EHD_DATA, "%s: %s: found %lld, expected 3 to %zu",
                            artefact_path(file), columns[i].name, (long long)value,
                            model->grid.num_nodes - 1);
        *columns[i].value = (size_t)value;
    }
    line->end = line->begin + model->band.num_nodes;
    return reduced_check_band(model, artefact_path(file), error);
}

static ehd_status read_band(reduced_model *model, artefact *file, ehd_error *error) {
    model->band.lines =
        arena_array(&model->memory, model->band.num_lines, sizeof *model->band.lines);
    if (!model->band.lines) return ehd_no_memory(error, artefact_path(file));
    return model->band.num_lines > 1 ? read_lines(model, file, error)
                                     : read_band_line(model, file, error);
}

/* Reads the cut table for an exit at the beginning of the band (`base` of exit_cut). For an
 * independent basis also reads `left`. */
static ehd_status read_cut(reduced_model *model, artefact *file, const stored_sizes *stored,
                           ehd_error *error) {
    bool coupled = model->deformation == DEFORMATION_COUPLED;
    size_t num_pressure = model->num_pressure, width = model->num_deformation;
    exit_cut *cut = &model->cut;
    arena memory = {0};
    double *load, *elasticity = NULL, *kernel = NULL;
    ehd_status status = read_part(&load, &memory, file, "load_jacobian", 1, stored->pressure, NULL,
                                  1, num_pressure, error);

    cut->num_rows = (coupled ? model->rows.num_needed : width) + 1;
    cut->base = arena_table(&model->memory, cut->num_rows, num_pressure, sizeof(double));
    cut->left = arena_table(&model->memory, model->band.num_nodes, cut->num_rows, sizeof(double));
    if (!status && (!cut->base || !cut->left)) status = ehd_no_memory(error, artefact_path(file));
    if (!status && !coupled)
        status = read_part(&elasticity, &memory, file, "elasticity_jacobian", stored->deformation,
                           stored->pressure, NULL, width, num_pressure, error);
    if (!status && !coupled)
        status = read_part(&kernel, &memory, file, "band_projected_kernel", stored->band,
                           stored->deformation, NULL, model->band.num_nodes, width, error);
    if (!status) {
        size_t last = (cut->num_rows - 1) * num_pressure;
        memcpy(cut->base, coupled ? model->rows.film : elasticity, last * sizeof(double));
        memcpy(cut->base + last, load, num_pressure * sizeof(double));
        for (size_t i = 0; i < model->band.num_nodes && !coupled; i++)
            memcpy(cut->left + i * cut->num_rows, kernel + i * width, width * sizeof(double));
    }
    arena_free(&memory);
    return status;
}

/* Return the number of columns of the film's basis, in the model and in the file. */
static size_t film_width(const reduced_model *model) {
    return model->deformation == DEFORMATION_COUPLED ? model->num_pressure : model->num_deformation;
}

static size_t stored_film_width(const reduced_model *model, const stored_sizes *stored) {
    return model->deformation == DEFORMATION_COUPLED ? stored->pressure : stored->deformation;
}

/* Reads the bases at the nodes that the first set->num_rows rows need. The file may contain more
 * nodes. */
static ehd_status read_needed(reduced_model *model, row_set *set, const row_fields *fields,
                              artefact *file, const stored_sizes *stored, ehd_error *error) {
    size_t num_stored = artefact_length(file, fields->needed_axis), *indices;
    arena memory = {0};
    ehd_status status = reduced_model_list_needed(model, set, error);

    if (!status)
        status = match_nodes(&indices, &memory, set->needed_node, set->num_needed, &model->grid,
                             file, fields->needed, num_stored, error);
    if (!status)
        status = read_part(&set->pressure, &model->memory, file, fields->pressure, num_stored,
                           stored->pressure, indices, set->num_needed, model->num_pressure, error);
    if (!status)
        status = read_part(&set->film, &model->memory, file, fields->film[model->deformation],
                           num_stored, stored_film_width(model, stored), indices, set->num_needed,
                           film_width(model), error);
    arena_free(&memory);
    return status;
}

/* Reads the first set->num_rows of `num_stored` rows. */
static ehd_status read_rows(reduced_model *model, row_set *set, const row_fields *fields,
                            size_t num_stored, artefact *file, ehd_error *error) {
    ehd_status status = read_nodes(&set->node, &model->memory, file, fields->row, num_stored, true,
                                   &model->grid, error);

    return status ? status
                  : read_part(&set->weight, &model->memory, file, fields->weight, num_stored, 1,
                              NULL, set->num_rows, 1, error);
}

/* Sorts rows by their nodes. Rows at neighbouring nodes share a half node. If these rows follow
 * each other, the flux at the half node is evaluated only once. */
static void sort_rows(row_set *set) {
    for (size_t r = 1; r < set->num_rows; r++)
        for (size_t i = r; i > 0 && set->node[i - 1] > set->node[i]; i--) {
            const size_t node = set->node[i];
            const double weight = set->weight[i];
            set->node[i] = set->node[i - 1];
            set->weight[i] = set->weight[i - 1];
            set->node[i - 1] = node;
            set->weight[i - 1] = weight;
        }
}

static ehd_status read_tables(reduced_model *model, artefact *file, const stored_sizes *stored,
                              ehd_error *error) {
    bool coupled = model->deformation == DEFORMATION_COUPLED;
    exit_band *band = &model->band;
    ehd_status status = read_rows(model, &model->rows, &selected_fields, stored->rows, file, error);

    if (!status) status = weigh_part(model, file, stored, error);
    if (!status) sort_rows(&model->rows);
    if (!status) status = read_needed(model, &model->rows, &selected_fields, file, stored, error);
    if (!status)
        status =
            read_part(&band->pressure, &model->memory, file, "band_pressure_basis", stored->band,
                      stored->pressure, NULL, band->num_nodes, model->num_pressure, error);
    if (!status)
        status = read_part(&band->film, &model->memory, file,
                           coupled ? "band_coupled_basis" : "band_deformation_basis", stored->band,
                           stored_film_width(model, stored), NULL, band->num_nodes,
                           film_width(model), error);
    return status ? status : read_cut(model, file, stored, error);
}

/* Reads all control rows, even if only some of the selected rows are read. */
static ehd_status read_control(reduced_model *model, artefact *file, const stored_sizes *stored,
                               ehd_error *error) {
    row_set *control = &model->control;

    control->num_rows = artefact_length(file, control_fields.row_axis);
    if (control->num_rows == 0) return EHD_OK;
    ehd_status status = read_rows(model, control, &control_fields, control->num_rows, file, error);
    return status ? status : read_needed(model, control, &control_fields, file, stored, error);
}

/* Reads the cubature for traction if the file has one. All its nodes are read, even if only some
 * rows or modes are read. */
static ehd_status read_cubature(reduced_model *model, artefact *file, const stored_sizes *stored,
                                ehd_error *error) {
    const traction_fields *fields = &cubature_fields;
    const size_t num = artefact_length(file, fields->axis);
    node_cubature *cubature = &model->cubature;
    row_set *set = &cubature->nodes;
    arena *memory = &model->memory;
    if (num == 0) return EHD_OK;

    set->num_needed = num;
    ehd_status status =
        read_nodes(&set->needed_node, memory, file, fields->node, num, false, &model->grid, error);
    if (!status)
        status = read_part(&set->pressure, memory, file, fields->pressure, num, stored->pressure,
                           NULL, num, model->num_pressure, error);
    if (!status)
        status = read_part(&set->film, memory, file, fields->film[model->deformation], num,
                           stored_film_width(model, stored), NULL, num, film_width(model), error);
    if (!status)
        status = read_part(&cubature->friction, memory, file, fields->friction, num, 1, NULL, num,
                           1, error);
    if (!status)
        status = read_part(&cubature->dry, memory, file, fields->dry, num, 1, NULL, num, 1, error);
    if (!status)
        status = read_part(&cubature->moment, memory, file, fields->moment, 1, stored->pressure,
                           NULL, 1, model->num_pressure, error);
    return status ? status : reduced_model_place_rows(model, set, error);
}

/* Reads the states, and keeps only the coordinates of the modes in use. */
static ehd_status read_states(reduced_model *model, artefact *file, const stored_sizes *stored,
                              ehd_error *error) {
    reduced_states whole = {0};
    reduced_states *kept = &model->states;
    ehd_status status =
        states_read(&whole, file, stored->pressure, stored->deformation, &model->grid, error);

    if (!status) status = reduced_check_exits(model, &whole, artefact_path(file), error);
    if (!status)
        status = reduced_states_init(kept, whole.num_states, whole.num_lines, model->num_unknowns,
                                     error);
    if (!status) reduced_states_put(kept, 0, &whole);
    for (size_t s = 0; s < whole.num_states && !status; s++) {
        const double *source = whole.coordinates + s * whole.num_unknowns;
        double *target = kept->coordinates + s * kept->num_unknowns;
        memcpy(target, source, model->num_pressure * sizeof(double));
        memcpy(target + model->num_pressure, source + stored->pressure,
               model->num_deformation * sizeof(double));
        target[kept->num_unknowns - 1] = source[whole.num_unknowns - 1];
    }
    reduced_states_free(&whole);
    return status;
}

static ehd_status choose_sizes(reduced_model *model, stored_sizes *stored, artefact *file,
                               const model_sizes *wanted, ehd_error *error) {
    bool coupled = model->deformation == DEFORMATION_COUPLED;

    stored->pressure = artefact_length(file, "pressure_mode");
    stored->deformation = coupled ? 0 : artefact_length(file, "deformation_mode");
    stored->rows = artefact_length(file, "row");
    stored->jacobian = artefact_length(file, "jacobian_mode");
    stored->band = model->band.num_nodes = artefact_length(file, "band_node");
    ehd_status status = choose_size(&model->num_pressure, wanted->pressure_modes, stored->pressure,
                                    "--pressure-modes", file, error);
    if (!status)
        status = choose_size(&model->num_deformation, wanted->deformation_modes,
                             stored->deformation, "--deformation-modes", file, error);
    if (!status)
        status =
            choose_size(&model->rows.num_rows, wanted->rows, stored->rows, "--rows", file, error);
    if (status) return status;
    model->num_unknowns = reduced_num_unknowns(model->num_pressure, model->num_deformation);
    return reduced_check_num_rows(model->rows.num_rows, model->num_pressure, model->num_deformation,
                                  "--rows", error);
}

ehd_status model_open(artefact **file, const char *path, ehd_error *error) {
    static const artefact_schema *const kinds[] = {&schema_model, NULL};

    return artefact_open(file, path, kinds, error);
}

ehd_status model_get(reduced_model *model, artefact *file, const model_sizes *sizes,
                     ehd_error *error) {
    const model_sizes whole = {0};
    stored_sizes stored;

    memset(model, 0, sizeof *model);
    ehd_status status = grid_read(&model->grid, &model->kind, file, error);
    if (!status) status = carriage_read(&model->carriage, file, error);
    model->band.num_lines = grid_lines(&model->grid);
    if (!status) status = deformation_read(&model->deformation, file, error);
    if (!status) status = choose_sizes(model, &stored, file, sizes ? sizes : &whole, error);
    if (!status) status = read_band(model, file, error);
    if (!status) status = read_tables(model, file, &stored, error);
    if (!status) status = read_control(model, file, &stored, error);
    if (!status) status = read_cubature(model, file, &stored, error);
    if (!status) status = read_states(model, file, &stored, error);
    if (!status) status = shown_get(&model->shown, &model->memory, file, error);
    if (!status) status = reduced_model_complete(model, error);
    if (!status && model->control.num_rows > 0)
        status = reduced_model_complete_control(model, error);
    if (status) reduced_model_free(model);
    return status;
}

ehd_status model_read(reduced_model *model, const char *path, const model_sizes *sizes,
                      ehd_error *error) {
    artefact *file = NULL;
    ehd_status status = model_open(&file, path, error);

    if (status)
        memset(model, 0, sizeof *model);
    else
        status = model_get(model, file, sizes, error);
    artefact_close(&file);
    return status;
}

/* Reads the first `wanted` of the stored modes. */
static ehd_status read_modes(double **modes, artefact *file, const char *field,
                             const char *mode_axis, size_t wanted, const ehd_grid *grid, bool inner,
                             ehd_error *error) {
    size_t stored = artefact_length(file, mode_axis), num_nodes = grid->num_nodes;
    double *whole = NULL;
    ehd_status status = modes_read(&whole, file, field, grid, stored, inner, error);

    *modes = status ? NULL : array_new(num_nodes, wanted, sizeof(double));
    if (!status && !*modes) status = ehd_no_memory(error, artefact_path(file));
    for (size_t k = 0; k < num_nodes && !status; k++)
        memcpy(*modes + k * wanted, whole + k * stored, wanted * sizeof(double));
    free(whole);
    return status;
}

bool model_has_modes(const artefact *file, const reduced_model *model) {
    return model->num_deformation == 0 || artefact_has(file, "deformation_basis");
}

ehd_status model_get_modes(double **pressure_basis, double **deformation_basis, artefact *file,
                           const reduced_model *model, ehd_error *error) {
    const bool wanted = deformation_basis && model->num_deformation > 0;
    ehd_status status = EHD_OK;

    if (pressure_basis) *pressure_basis = NULL;
    if (deformation_basis) *deformation_basis = NULL;
    if (pressure_basis)
        status = read_modes(pressure_basis, file, "pressure_basis", "pressure_mode",
                            model->num_pressure, &model->grid, true, error);
    if (!status && wanted && !model_has_modes(file, model))
        status = ehd_fail(error, EHD_DATA,
                          "%s: found no dataset deformation_basis, expected it for a transient "
                          "scene with an independent basis",
                          artefact_path(file));
    if (!status && wanted)
        status = read_modes(deformation_basis, file, "deformation_basis", "deformation_mode",
                            model->num_deformation, &model->grid, false, error);
    return status;
}
