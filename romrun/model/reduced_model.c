/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/model/reduced_cut.h"

#include "common/physics/deflection.h"

#include <cblas.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

const char *const deformation_names[] = {"independent", "coupled", NULL};

static const double EXIT_MARGIN = 0.1;     // beyond the trained exits, half widths
static const double LINES_MARGIN = 0.3;    // where there are several, of which each wanders farther
static const double MINIMUM_MARGIN = 0.05; // before the trained film minima, half widths

size_t reduced_num_unknowns(size_t num_pressure, size_t num_deformation) {
    return num_pressure + num_deformation + 1;
}

ehd_status reduced_states_init(reduced_states *states, size_t num_states, size_t num_lines,
                               size_t num_unknowns, ehd_error *error) {
    states->num_states = num_states;
    states->num_lines = num_lines;
    states->num_unknowns = num_unknowns;
    states->coordinates = calloc(num_states * num_unknowns, sizeof(double));
    states->exit = calloc(num_states * num_lines, sizeof *states->exit);
    states->moes_M = calloc(num_states, sizeof(double));
    states->alpha_p_H = calloc(num_states, sizeof(double));
    states->central_film_thickness = calloc(num_states, sizeof(double));
    states->stationary = malloc((num_states + 1) * sizeof *states->stationary);
    states->rate = calloc(num_states, sizeof(double));
    if (!states->coordinates || !states->exit || !states->moes_M || !states->alpha_p_H ||
        !states->central_film_thickness || !states->stationary || !states->rate) {
        reduced_states_free(states);
        return ehd_fail(error, EHD_MEMORY, "reduced model: found no memory for %zu states",
                        num_states);
    }
    for (size_t s = 0; s < num_states; s++)
        states->stationary[s] = true;
    return EHD_OK;
}

static bool is_same(double left, double right) {
    return fabs(left - right) <= 1e-9 * fmax(fabs(left), fabs(right));
}

bool reduced_states_have(const reduced_states *states, const ehd_contact *contact) {
    for (size_t s = 0; s < states->num_states; s++)
        if (is_same(states->moes_M[s], contact->moes_M) &&
            is_same(states->alpha_p_H[s], contact->alpha_p_H))
            return true;
    return false;
}

void reduced_states_free(reduced_states *states) {
    free(states->coordinates);
    free(states->exit);
    free(states->moes_M);
    free(states->alpha_p_H);
    free(states->central_film_thickness);
    free(states->stationary);
    free(states->rate);
    memset(states, 0, sizeof *states);
}

void reduced_basis_free(reduced_basis *basis) {
    free(basis->pressure);
    free(basis->deformation_modes);
    free(basis->weight);
    reduced_states_free(&basis->states);
    memset(basis, 0, sizeof *basis);
}

static void control_rows_free(control_rows *control) {
    free(control->node);
    free(control->weight);
    free(control->stencils);
    free(control->needed_node);
    free(control->pressure);
    free(control->film);
    free(control->checkpoint_film);
}

void reduced_model_free(reduced_model *model) {
    free(model->row_node);
    free(model->row_weight);
    free(model->stencils);
    free(model->needed_node);
    free(model->needed_gap);
    free(model->needed_pressure);
    free(model->needed_film);
    free(model->lines);
    free(model->band_pressure);
    free(model->band_film);
    free(model->kernel);
    free(model->left);
    free(model->cut_base);
    free(model->checkpoint_exit);
    free(model->checkpoint_cut);
    free(model->checkpoint_band);
    control_rows_free(&model->control);
    reduced_states_free(&model->states);
    memset(model, 0, sizeof *model);
}

// ---- lines and columns

size_t reduced_model_line(const reduced_model *model, size_t node) {
    return model->num_lines > 1 ? node / grid_width(&model->grid) : 0;
}

size_t reduced_model_column(const reduced_model *model, size_t node) {
    return model->num_lines > 1 ? node % grid_width(&model->grid) : node;
}

grid_place reduced_model_place(const reduced_model *model, size_t node) {
    return (grid_place){reduced_model_line(model, node), reduced_model_column(model, node)};
}

bool reduced_model_has_band(const reduced_model *model, size_t line) {
    return model->lines[line].end > model->lines[line].begin;
}

size_t reduced_model_band_place(const reduced_model *model, size_t node) {
    const band_line *line = &model->lines[reduced_model_line(model, node)];

    return line->offset + reduced_model_column(model, node) - line->begin;
}

void reduced_model_deflect(double *film, const reduced_model *model, grid_place at, size_t num_at,
                           size_t line, size_t first, size_t count, const double *pressure,
                           double sign) {
    size_t width = grid_width(&model->grid);
    const double *kernel = model->kernel + index_distance(at.line, line) * width;
    bool has_mirrored = model->grid.half && line > 0;
    const double *mirrored = has_mirrored ? model->kernel + (at.line + line) * width : NULL;

    for (size_t i = 0; i < count; i++) {
        double source = sign * pressure[i];
        for (size_t a = 0; a < num_at; a++) {
            size_t apart = index_distance(at.column + a, first + i);
            film[a] += kernel[apart] * source;
            if (has_mirrored) film[a] += mirrored[apart] * source;
        }
    }
}

// ---- which nodes

/* Nodes around X = 0 (Y = 0) and their weights: one node where it lies there, else cubic interpolation. */
static void centre_nodes(size_t nodes[4], double weights[4], const ehd_grid *grid) {
    double place = -grid->x_min / grid->step + 1;
    size_t k = (size_t)floor(place + 1e-6);
    double t = place - (double)k;
    size_t before = grid_central_line(grid);

    for (size_t i = 0; i < 4; i++)
        nodes[i] = before + k - 1 + i;
    weights[0] = -t * (t - 1) * (t - 2) / 6;
    weights[1] = (t + 1) * (t - 1) * (t - 2) / 2;
    weights[2] = -(t + 1) * t * (t - 2) / 2;
    weights[3] = (t + 1) * t * (t - 1) / 6;
    if (fabs(t) < 1e-6)
        for (size_t i = 0; i < 4; i++)
            weights[i] = i == 1 ? 1 : 0;
}

/* Marks the nodes that rows need. */
static void mark_stencils(bool *needed, const ehd_grid *grid, const size_t *rows, size_t num_rows) {
    for (size_t r = 0; r < num_rows; r++) {
        reynolds_stencil stencil = reynolds_stencil_at(grid, rows[r]);
        for (int a = 0; a < NUM_STENCIL; a++)
            if (stencil.node[a] != NO_NODE) needed[stencil.node[a]] = true;
    }
}

/* The nodes that rows and, where wanted, the centre need, in ascending order. */
static ehd_status list_nodes(size_t **nodes, size_t *num_listed, reduced_model *model,
                             const size_t *rows, size_t num_rows, bool with_centre,
                             ehd_error *error) {
    size_t num_nodes = model->grid.num_nodes, centre[4], count = 0;
    bool *needed = calloc(num_nodes, sizeof *needed);

    if (!needed) return ehd_fail(error, EHD_MEMORY, "reduced model: found no memory");
    mark_stencils(needed, &model->grid, rows, num_rows);
    centre_nodes(centre, model->centre_weight, &model->grid);
    for (size_t i = 0; i < 4 && with_centre; i++)
        if (model->centre_weight[i] != 0) needed[centre[i]] = true;
    for (size_t k = 0; k < num_nodes; k++)
        count += needed[k];
    *nodes = malloc(count * sizeof **nodes);
    if (*nodes)
        for (size_t k = 0; k < num_nodes; k++)
            if (needed[k]) (*nodes)[(*num_listed)++] = k;
    free(needed);
    return *nodes ? EHD_OK : ehd_fail(error, EHD_MEMORY, "reduced model: found no memory");
}

ehd_status reduced_model_list_needed(reduced_model *model, ehd_error *error) {
    return list_nodes(&model->needed_node, &model->num_needed, model, model->row_node,
                      model->num_rows, true, error);
}

ehd_status reduced_model_list_control(reduced_model *model, ehd_error *error) {
    control_rows *control = &model->control;

    return list_nodes(&control->needed_node, &control->num_needed, model, control->node,
                      control->num_rows, false, error);
}

/* Place of a node in an ascending list that has it; NO_NODE stays what it is. */
static size_t place_in(const size_t *nodes, size_t count, size_t node) {
    size_t low = 0, high = count;

    if (node == NO_NODE) return NO_NODE;
    while (high - low > 1) {
        size_t middle = (low + high) / 2;
        if (nodes[middle] <= node)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* Stencils of rows, as places in an ascending list of nodes. */
static void fill_stencils(reynolds_stencil *stencils, const ehd_grid *grid, const size_t *rows,
                          size_t num_rows, const size_t *nodes, size_t num_nodes) {
    for (size_t r = 0; r < num_rows; r++) {
        stencils[r] = reynolds_stencil_at(grid, rows[r]);
        for (int a = 0; a < NUM_STENCIL; a++)
            stencils[r].node[a] = place_in(nodes, num_nodes, stencils[r].node[a]);
    }
}

// ---- building from the bases

/* Whether a line of the grid has inner nodes; the others are boundary. */
static bool is_inner_line(const ehd_grid *grid, size_t line) {
    return line >= grid_first_line(grid) && line < grid_first_line(grid) + grid->inner_lines;
}

/* Film minimum of a training state, as a node: the deflection of its pressure, from the bases. */
static size_t film_minimum(const reduced_basis *basis, const double *deflection,
                           const size_t *exit) {
    const ehd_grid *grid = &basis->grid;
    size_t width = grid_width(grid), num_lines = grid_lines(grid), best = exit[0];
    size_t centre = (size_t)(-grid->x_min / grid->step) + 1;
    double least = INFINITY;

    for (size_t l = 0; l < num_lines; l++)
        for (size_t c = centre; c <= exit[l] && c < width; c++) {
            size_t k = l * width + c;
            double film = deflection[k] + grid_gap(grid, k);
            if (film < least) {
                least = film;
                best = k;
            }
        }
    return best;
}

/* Deflection of a training state's pressure. */
static void deflect_state(double *deflections, const reduced_basis *basis, size_t state,
                          ehd_deflection *deflection) {
    const reduced_states *states = &basis->states;
    const size_t *exit = states->exit + state * states->num_lines;
    size_t width = grid_width(&basis->grid);

    cblas_dgemv(CblasRowMajor, CblasNoTrans, (int)basis->grid.num_nodes, (int)basis->num_pressure,
                1, basis->pressure, (int)basis->num_pressure,
                states->coordinates + state * states->num_unknowns, 1, 0, deflections, 1);
    for (size_t l = 0; l < states->num_lines; l++)
        memset(deflections + l * width + exit[l], 0, (width - exit[l]) * sizeof(double));
    deflection_apply(deflections, deflection, deflections);
}

/* The extremes of training on each line, in place of where the exit may lie, and in `begin` the first film minimum
 * on it or near it. */
static void find_extremes(reduced_model *model, const reduced_basis *basis,
                          ehd_deflection *deflection, double *work) {
    const reduced_states *states = &basis->states;
    size_t width = grid_width(&basis->grid), near = (size_t)ceil(MINIMUM_MARGIN / basis->grid.step);

    model->first_minimum = model->num_lines - 1;
    model->last_minimum = 0;
    for (size_t l = 0; l < model->num_lines; l++)
        model->lines[l] = (band_line){.begin = width - 1, .least = width - 1, .most = 1};
    for (size_t s = 0; s < states->num_states; s++) {
        const size_t *exit = states->exit + s * states->num_lines;
        deflect_state(work, basis, s, deflection);
        size_t minimum = film_minimum(basis, work, exit);
        size_t own = reduced_model_line(model, minimum);
        size_t column = reduced_model_column(model, minimum);
        for (size_t l = 0; l < model->num_lines; l++) {
            band_line *line = &model->lines[l];
            line->least = exit[l] < line->least ? exit[l] : line->least;
            line->most = exit[l] > line->most ? exit[l] : line->most;
            if (index_distance(l, own) > near || !is_inner_line(&basis->grid, l)) continue;
            line->begin = column < line->begin ? column : line->begin;
            model->first_minimum = l < model->first_minimum ? l : model->first_minimum;
            model->last_minimum = l > model->last_minimum ? l : model->last_minimum;
        }
    }
}

/* Where the exit may lie on each line. A row at the exit needs the two nodes before it. */
static void widen_exits(reduced_model *model) {
    const ehd_grid *grid = &model->grid;
    size_t margin = (size_t)ceil((model->num_lines > 1 ? LINES_MARGIN : EXIT_MARGIN) / grid->step),
           width = grid_width(grid);
    // on a line contact it lies behind the centre
    size_t foremost = model->num_lines > 1 ? 2 : (size_t)(-grid->x_min / grid->step) + 2;

    for (size_t l = 0; l < model->num_lines; l++) {
        band_line *line = &model->lines[l];
        if (!is_inner_line(grid, l)) {
            *line = (band_line){1, 1, 0, 1, 1};
            continue;
        }
        line->least = line->least > foremost + margin + 2 ? line->least - margin : foremost + 2;
        line->most = line->most + margin < width - 2 ? line->most + margin : width - 2;
    }
}

/* Columns of each line: from before the first film minimum, and what rows at the exits of the lines beside it need,
 * to behind the last exit of these. */
static void place_band(reduced_model *model) {
    const ehd_grid *grid = &model->grid;
    size_t before = (size_t)ceil(MINIMUM_MARGIN / grid->step) + 2;
    size_t foremost = model->num_lines > 1 ? 1 : (size_t)(-grid->x_min / grid->step) + 2;

    model->num_band = 0;
    for (size_t l = 0; l < model->num_lines; l++) {
        band_line *line = &model->lines[l];
        size_t first = line->begin, last = line->most;
        line->offset = model->num_band;
        if (!is_inner_line(grid, l)) continue;
        for (size_t beside = l > 0 ? l - 1 : 0; beside <= l + 1 && beside < model->num_lines;
             beside++) {
            if (!is_inner_line(grid, beside)) continue;
            const band_line *other = &model->lines[beside];
            first = other->least < first ? other->least : first;
            last = other->most > last ? other->most : last;
        }
        line->begin = first > foremost + before ? first - before : foremost;
        line->end = last + 2;
        model->num_band += line->end - line->begin;
    }
    model->band_begin = model->lines[0].begin;
    model->least_exit = model->lines[0].least;
    model->most_exit = model->lines[0].most;
}

/* The band: from before the first trained film minimum to behind the last trained exit. */
static ehd_status find_band(reduced_model *model, const reduced_basis *basis,
                            ehd_deflection *deflection, ehd_error *error) {
    double *work = malloc(basis->grid.num_nodes * sizeof(double));

    model->lines = calloc(model->num_lines, sizeof *model->lines);
    if (!work || !model->lines) {
        free(work);
        return ehd_fail(error, EHD_MEMORY, "reduced model: found no memory");
    }
    find_extremes(model, basis, deflection, work);
    widen_exits(model);
    place_band(model);
    free(work);
    return EHD_OK;
}

/* Whether a node lies before the band, where there is always pressure. */
static bool is_before_band(const reduced_model *model, size_t node) {
    return reduced_model_column(model, node) < model->lines[reduced_model_line(model, node)].begin;
}

/* Deflections of the pressure modes cut where the band begins, [num_nodes, num_pressure]. */
static void deflect_modes(double *coupled, const reduced_model *model, const reduced_basis *basis,
                          ehd_deflection *deflection, double *work) {
    size_t num_nodes = basis->grid.num_nodes, num_pressure = basis->num_pressure;

    for (size_t j = 0; j < num_pressure; j++) {
        for (size_t k = 0; k < num_nodes; k++)
            work[k] = is_before_band(model, k) ? basis->pressure[k * num_pressure + j] : 0;
        deflection_apply(work, deflection, work);
        for (size_t k = 0; k < num_nodes; k++)
            coupled[k * num_pressure + j] = work[k];
    }
}

/* Copies rows of a node-major matrix: target[i, :] = source[nodes[i], :]. */
static double *gather_rows(const double *source, const size_t *nodes, size_t count, size_t width) {
    double *target = malloc(count * width * sizeof(double));

    for (size_t i = 0; target && i < count; i++)
        memcpy(target + i * width, source + nodes[i] * width, width * sizeof(double));
    return target;
}

/* The same for the band's nodes, line after line. */
static double *gather_band(const double *source, const reduced_model *model, size_t width) {
    double *target = malloc(model->num_band * width * sizeof(double));

    for (size_t l = 0; target && l < model->num_lines; l++) {
        const band_line *line = &model->lines[l];
        size_t first = l * grid_width(&model->grid) + line->begin;
        memcpy(target + line->offset * width, source + first * width,
               (line->end - line->begin) * width * sizeof(double));
    }
    return target;
}

/* What a node's pressure adds to the load. */
static double load_weight(const ehd_grid *grid, size_t node) {
    return grid_cell(grid) * grid_weight(grid, node);
}

/* The cut table for an exit where the band begins. Coupled: deflections at the needed nodes. Independent:
 * V_delta^T K V_p. Last row: the load balance. */
static void fill_cut_base(reduced_model *model, const reduced_basis *basis, const double *coupled) {
    size_t num_pressure = model->num_pressure, last = model->num_cut - 1;
    double *load = model->cut_base + last * num_pressure;

    if (model->deformation == DEFORMATION_COUPLED)
        memcpy(model->cut_base, model->needed_film, last * num_pressure * sizeof(double));
    else
        cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, (int)last, (int)num_pressure,
                    (int)basis->grid.num_nodes, 1, basis->deformation_modes, (int)last, coupled,
                    (int)num_pressure, 0, model->cut_base, (int)num_pressure);
    for (size_t j = 0; j < num_pressure; j++) {
        load[j] = 0;
        for (size_t k = 1; k < basis->grid.num_nodes; k++)
            if (is_before_band(model, k))
                load[j] += load_weight(&model->grid, k) * basis->pressure[k * num_pressure + j];
    }
}

/* Left sides of the independent basis, but for the load: row i is V_delta^T K e_i = K^T V_delta at node i. K is
 * symmetric where every node counts as often as the cells it stands for: K^T = W K W^-1 on a half grid. */
static void fill_left_independent(reduced_model *model, const reduced_basis *basis,
                                  ehd_deflection *deflection, double *work) {
    const ehd_grid *grid = &basis->grid;
    size_t num_deformation = model->num_deformation;

    for (size_t j = 0; j < num_deformation; j++) {
        for (size_t k = 0; k < grid->num_nodes; k++)
            work[k] = basis->deformation_modes[k * num_deformation + j] / grid_weight(grid, k);
        deflection_apply(work, deflection, work);
        for (size_t l = 0; l < model->num_lines; l++) {
            const band_line *line = &model->lines[l];
            for (size_t c = line->begin; c < line->end; c++) {
                size_t node = l * grid_width(grid) + c, place = line->offset + c - line->begin;
                model->left[place * model->num_cut + j] = grid_weight(grid, node) * work[node];
            }
        }
    }
}

static ehd_status copy_states(reduced_states *target, const reduced_states *source,
                              ehd_error *error) {
    ehd_status status = reduced_states_init(target, source->num_states, source->num_lines,
                                            source->num_unknowns, error);
    size_t count = source->num_states;

    if (status) return status;
    memcpy(target->coordinates, source->coordinates, count * source->num_unknowns * sizeof(double));
    memcpy(target->exit, source->exit, count * source->num_lines * sizeof *target->exit);
    memcpy(target->moes_M, source->moes_M, count * sizeof(double));
    memcpy(target->alpha_p_H, source->alpha_p_H, count * sizeof(double));
    memcpy(target->central_film_thickness, source->central_film_thickness, count * sizeof(double));
    memcpy(target->stationary, source->stationary, count * sizeof *target->stationary);
    memcpy(target->rate, source->rate, count * sizeof(double));
    return EHD_OK;
}

static ehd_status list_rows(reduced_model *model, const reduced_basis *basis, const size_t *rows,
                            size_t num_rows, ehd_error *error) {
    model->num_rows = rows ? num_rows : basis->grid.num_inner;
    if (model->num_rows + 1 + model->num_deformation < model->num_unknowns)
        return ehd_fail(error, EHD_DATA, "rows: found %zu, expected at least %zu, one an unknown",
                        model->num_rows, model->num_pressure);
    model->row_node = malloc(model->num_rows * sizeof *model->row_node);
    model->row_weight = malloc(model->num_rows * sizeof(double));
    if (!model->row_node || !model->row_weight)
        return ehd_fail(error, EHD_MEMORY, "reduced model: found no memory");
    for (size_t r = 0; r < model->num_rows; r++) {
        size_t node = rows ? rows[r] : grid_node_of_row(&basis->grid, r);
        size_t column = reduced_model_column(model, node);
        if (column < 1 || column > basis->grid.inner_x || node >= basis->grid.num_nodes ||
            !is_inner_line(&basis->grid, reduced_model_line(model, node)))
            return ehd_fail(error, EHD_DATA, "rows: found node %zu, expected 1 to %zu", node,
                            basis->grid.num_inner);
        model->row_node[r] = node;
        model->row_weight[r] = basis->weight[node];
    }
    return EHD_OK;
}

/* Bases at the needed nodes and in the band, and the cut table. */
static ehd_status fill_tables(reduced_model *model, const reduced_basis *basis,
                              ehd_deflection *deflection, ehd_error *error) {
    size_t num_nodes = basis->grid.num_nodes, num_pressure = basis->num_pressure;
    bool coupled_basis = model->deformation == DEFORMATION_COUPLED;
    double *coupled = malloc(num_nodes * num_pressure * sizeof(double));
    double *work = malloc(num_nodes * sizeof(double));
    ehd_status status = ehd_fail(error, EHD_MEMORY, "reduced model: found no memory");

    if (coupled && work) {
        const double *film = coupled_basis ? coupled : basis->deformation_modes;
        size_t width = coupled_basis ? num_pressure : basis->num_deformation;
        deflect_modes(coupled, model, basis, deflection, work);
        model->num_cut = (coupled_basis ? model->num_needed : model->num_deformation) + 1;
        model->needed_pressure =
            gather_rows(basis->pressure, model->needed_node, model->num_needed, num_pressure);
        model->needed_film = gather_rows(film, model->needed_node, model->num_needed, width);
        model->band_pressure = gather_band(basis->pressure, model, num_pressure);
        model->band_film = gather_band(film, model, width);
        model->cut_base = malloc(model->num_cut * num_pressure * sizeof(double));
        model->left = malloc(model->num_band * model->num_cut * sizeof(double));
        if (model->needed_pressure && model->needed_film && model->band_pressure &&
            model->band_film && model->cut_base && model->left) {
            fill_cut_base(model, basis, coupled);
            if (!coupled_basis) fill_left_independent(model, basis, deflection, work);
            status = EHD_OK;
        }
    }
    free(work);
    free(coupled);
    return status;
}

ehd_status reduced_model_build(reduced_model *model, const reduced_basis *basis, const size_t *rows,
                               size_t num_rows, ehd_error *error) {
    ehd_deflection *deflection = deflection_create(basis->kind, &basis->grid);

    memset(model, 0, sizeof *model);
    model->kind = basis->kind;
    model->grid = basis->grid;
    model->num_lines = grid_lines(&basis->grid);
    model->deformation = basis->deformation;
    model->num_pressure = basis->num_pressure;
    model->num_deformation = basis->num_deformation;
    model->num_unknowns = reduced_num_unknowns(basis->num_pressure, basis->num_deformation);
    ehd_status status =
        deflection ? EHD_OK : ehd_fail(error, EHD_MEMORY, "reduced model: found no memory");
    if (!status) status = list_rows(model, basis, rows, num_rows, error);
    if (!status) status = reduced_model_list_needed(model, error);
    if (!status) status = find_band(model, basis, deflection, error);
    if (!status) status = fill_tables(model, basis, deflection, error);
    if (!status) status = copy_states(&model->states, &basis->states, error);
    if (!status) status = reduced_model_complete(model, error);
    deflection_free(deflection);
    if (status) reduced_model_free(model);
    return status;
}

/* The tables of control rows, but for what follows from them. */
static ehd_status fill_control(reduced_model *model, const reduced_basis *basis,
                               ehd_deflection *deflection, ehd_error *error) {
    size_t num_nodes = basis->grid.num_nodes, num_pressure = basis->num_pressure;
    bool coupled_basis = model->deformation == DEFORMATION_COUPLED;
    control_rows *control = &model->control;
    double *coupled = malloc(num_nodes * num_pressure * sizeof(double));
    double *work = malloc(num_nodes * sizeof(double));

    if (coupled && work) {
        if (coupled_basis) deflect_modes(coupled, model, basis, deflection, work);
        control->pressure =
            gather_rows(basis->pressure, control->needed_node, control->num_needed, num_pressure);
        control->film =
            gather_rows(coupled_basis ? coupled : basis->deformation_modes, control->needed_node,
                        control->num_needed, coupled_basis ? num_pressure : basis->num_deformation);
    }
    free(work);
    free(coupled);
    return control->pressure && control->film
               ? EHD_OK
               : ehd_fail(error, EHD_MEMORY, "reduced model: found no memory");
}

ehd_status reduced_model_add_control(reduced_model *model, const reduced_basis *basis,
                                     const size_t *rows, size_t num_rows, ehd_error *error) {
    control_rows *control = &model->control;
    ehd_deflection *deflection = deflection_create(basis->kind, &basis->grid);
    ehd_status status = EHD_OK;

    control->num_rows = num_rows;
    control->node = malloc((num_rows + 1) * sizeof *control->node);
    control->weight = malloc((num_rows + 1) * sizeof *control->weight);
    if (!deflection || !control->node || !control->weight)
        status = ehd_fail(error, EHD_MEMORY, "reduced model: found no memory");
    for (size_t r = 0; r < num_rows && !status; r++) {
        control->node[r] = rows[r];
        control->weight[r] = basis->weight[rows[r]];
    }
    if (!status) status = reduced_model_list_control(model, error);
    if (!status) status = fill_control(model, basis, deflection, error);
    if (!status) status = reduced_model_complete_control(model, error);
    deflection_free(deflection);
    return status;
}

// ---- what follows from the tables

/* Left sides of the coupled basis, but for the load: row i is K at the needed nodes from band node i. */
static void fill_left_coupled(reduced_model *model) {
    const double unit = 1;

    for (size_t l = 0; l < model->num_lines; l++) {
        const band_line *line = &model->lines[l];
        for (size_t c = line->begin; c < line->end; c++) {
            double *left = model->left + (line->offset + c - line->begin) * model->num_cut;
            memset(left, 0, model->num_needed * sizeof(double));
            for (size_t q = 0; q < model->num_needed; q++)
                reduced_model_deflect(left + q, model,
                                      reduced_model_place(model, model->needed_node[q]), 1, l, c, 1,
                                      &unit, 1);
        }
    }
}

/* And of either basis what a band node adds to the load. */
static void fill_left_load(reduced_model *model) {
    for (size_t l = 0; l < model->num_lines; l++) {
        const band_line *line = &model->lines[l];
        double weight = load_weight(&model->grid, l * grid_width(&model->grid) + line->begin);
        for (size_t i = line->offset; i < line->offset + line->end - line->begin; i++)
            model->left[(i + 1) * model->num_cut - 1] = weight;
    }
}

ehd_status reduced_model_complete(reduced_model *model, ehd_error *error) {
    const ehd_grid *grid = &model->grid;
    size_t centre[4], width = grid_width(grid),
                      kernel_lines = (grid->half ? 2 : 1) * model->num_lines;

    model->stencils = malloc(model->num_rows * sizeof *model->stencils);
    model->needed_gap = malloc(model->num_needed * sizeof(double));
    model->kernel = malloc(kernel_lines * width * sizeof(double));
    if (!model->stencils || !model->needed_gap || !model->kernel)
        return ehd_fail(error, EHD_MEMORY, "reduced model: found no memory for its tables");

    fill_stencils(model->stencils, &model->grid, model->row_node, model->num_rows,
                  model->needed_node, model->num_needed);
    centre_nodes(centre, model->centre_weight, &model->grid);
    for (size_t i = 0; i < 4; i++)
        model->centre[i] = place_in(model->needed_node, model->num_needed, centre[i]);
    for (size_t q = 0; q < model->num_needed; q++)
        model->needed_gap[q] = grid_gap(&model->grid, model->needed_node[q]);
    for (size_t l = 0; l < kernel_lines; l++)
        for (size_t d = 0; d < width; d++)
            model->kernel[l * width + d] =
                model->kind->kernel((double)d * grid->step, (double)l * grid->step, grid->step);
    if (model->deformation == DEFORMATION_COUPLED) fill_left_coupled(model);
    fill_left_load(model);
    return reduced_model_make_checkpoints(model, error);
}

ehd_status reduced_model_complete_control(reduced_model *model, ehd_error *error) {
    control_rows *control = &model->control;

    control->stencils = malloc((control->num_rows + 1) * sizeof *control->stencils);
    if (!control->stencils)
        return ehd_fail(error, EHD_MEMORY, "reduced model: found no memory for its tables");
    fill_stencils(control->stencils, &model->grid, control->node, control->num_rows,
                  control->needed_node, control->num_needed);
    return reduced_model_make_control_checkpoints(model, error);
}
