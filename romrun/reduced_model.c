/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/reduced_model.h"

#include "common/physics/deflection.h"

#include <cblas.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

const char *const deformation_names[] = {"independent", "coupled", NULL};

static const double EXIT_MARGIN = 0.1;          // beyond the trained exits, half widths
static const double MINIMUM_MARGIN = 0.05;      // before the trained film minima, half widths
static const double CHECKPOINT_DISTANCE = 0.02; // half widths

size_t reduced_num_unknowns(size_t num_pressure, size_t num_deformation) {
    return num_pressure + num_deformation + 1;
}

ehd_status reduced_states_init(reduced_states *states, size_t num_states, size_t num_unknowns,
                               ehd_error *error) {
    states->num_states = num_states;
    states->num_unknowns = num_unknowns;
    states->coordinates = calloc(num_states * num_unknowns, sizeof(double));
    states->exit = calloc(num_states, sizeof *states->exit);
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
}

void reduced_model_free(reduced_model *model) {
    free(model->row_node);
    free(model->row_weight);
    free(model->stencils);
    free(model->needed_node);
    free(model->needed_gap);
    free(model->needed_pressure);
    free(model->needed_film);
    free(model->band_pressure);
    free(model->band_film);
    free(model->kernel);
    free(model->left);
    free(model->cut_base);
    free(model->checkpoint_cut);
    free(model->checkpoint_band);
    control_rows_free(&model->control);
    reduced_states_free(&model->states);
    memset(model, 0, sizeof *model);
}

// ---- which nodes

/* Nodes around X = 0 and their weights: one node where it lies there, else cubic interpolation. */
static void centre_nodes(size_t nodes[4], double weights[4], const ehd_grid *grid) {
    double place = -grid->x_min / grid->step + 1;
    size_t k = (size_t)floor(place + 1e-6);
    double t = place - (double)k;

    for (size_t i = 0; i < 4; i++)
        nodes[i] = k - 1 + i;
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

/* Film minimum of a training state, as a node: the deflection of its pressure, from the bases. */
static size_t film_minimum(const reduced_basis *basis, const double *deflection, size_t state) {
    const reduced_states *states = &basis->states;
    size_t exit = states->exit[state], best = exit;
    double least = INFINITY;
    size_t centre = (size_t)(-basis->grid.x_min / basis->grid.step) + 1;

    for (size_t k = centre; k <= exit && k < basis->grid.num_nodes; k++) {
        double x = grid_x(&basis->grid, k);
        double film = deflection[k] + contact_gap(x, 0);
        if (film < least) {
            least = film;
            best = k;
        }
    }
    return best;
}

/* The band: from before the first trained film minimum to behind the last trained exit. */
static ehd_status find_band(reduced_model *model, const reduced_basis *basis,
                            ehd_deflection *deflection, ehd_error *error) {
    const ehd_grid *grid = &basis->grid;
    const reduced_states *states = &basis->states;
    size_t first = grid->num_nodes - 1, least = first, most = 1;
    size_t margin = (size_t)ceil(EXIT_MARGIN / grid->step);
    size_t before = (size_t)ceil(MINIMUM_MARGIN / grid->step) + 2;
    double *pressure = malloc(grid->num_nodes * sizeof(double));

    if (!pressure) return ehd_fail(error, EHD_MEMORY, "reduced model: found no memory");
    for (size_t s = 0; s < states->num_states; s++) {
        size_t exit = states->exit[s];
        least = exit < least ? exit : least;
        most = exit > most ? exit : most;
        cblas_dgemv(CblasRowMajor, CblasNoTrans, (int)grid->num_nodes, (int)basis->num_pressure, 1,
                    basis->pressure, (int)basis->num_pressure,
                    states->coordinates + s * states->num_unknowns, 1, 0, pressure, 1);
        memset(pressure + exit, 0, (grid->num_nodes - exit) * sizeof(double));
        deflection_apply(pressure, deflection, pressure);
        size_t minimum = film_minimum(basis, pressure, s);
        first = minimum < first ? minimum : first;
    }
    free(pressure);
    size_t centre = (size_t)(-grid->x_min / grid->step) + 2;
    // a row at the exit needs the two nodes before it in the band
    model->least_exit = least > centre + margin + 2 ? least - margin : centre + 2;
    model->most_exit = most + margin < grid->num_nodes - 2 ? most + margin : grid->num_nodes - 2;
    first = first < model->least_exit ? first : model->least_exit;
    model->band_begin = first > centre + before ? first - before : centre;
    model->num_band = model->most_exit + 2 - model->band_begin;
    return EHD_OK;
}

/* Deflections of the pressure modes cut at band_begin, [num_nodes, num_pressure]. */
static void deflect_modes(double *coupled, const reduced_model *model, const reduced_basis *basis,
                          ehd_deflection *deflection, double *work) {
    size_t num_nodes = basis->grid.num_nodes, num_pressure = basis->num_pressure;

    for (size_t j = 0; j < num_pressure; j++) {
        for (size_t k = 0; k < num_nodes; k++)
            work[k] = k < model->band_begin ? basis->pressure[k * num_pressure + j] : 0;
        deflection_apply(work, deflection, work);
        for (size_t k = 0; k < num_nodes; k++)
            coupled[k * num_pressure + j] = work[k];
    }
}

/* Copies rows of a node-major matrix: target[i, :] = source[nodes[i], :]. */
static double *gather_rows(const double *source, const size_t *nodes, size_t first, size_t count,
                           size_t width) {
    double *target = malloc(count * width * sizeof(double));

    for (size_t i = 0; target && i < count; i++)
        memcpy(target + i * width, source + (nodes ? nodes[i] : first + i) * width,
               width * sizeof(double));
    return target;
}

/* The cut table for an exit at band_begin. Coupled: deflections at the needed nodes. Independent:
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
        for (size_t k = 1; k < model->band_begin; k++)
            load[j] += model->grid.step * basis->pressure[k * num_pressure + j];
    }
}

/* Left sides of the independent basis: row i is (V_delta^T K e_i, step). */
static void fill_left_independent(reduced_model *model, const reduced_basis *basis,
                                  ehd_deflection *deflection, double *work) {
    size_t width = model->num_cut, num_deformation = model->num_deformation;

    for (size_t j = 0; j < num_deformation; j++) {
        for (size_t k = 0; k < basis->grid.num_nodes; k++)
            work[k] = basis->deformation_modes[k * num_deformation + j];
        deflection_apply(work, deflection, work); // K is symmetric
        for (size_t i = 0; i < model->num_band; i++)
            model->left[i * width + j] = work[model->band_begin + i];
    }
    for (size_t i = 0; i < model->num_band; i++)
        model->left[i * width + num_deformation] = model->grid.step;
}

static ehd_status copy_states(reduced_states *target, const reduced_states *source,
                              ehd_error *error) {
    ehd_status status =
        reduced_states_init(target, source->num_states, source->num_unknowns, error);
    size_t count = source->num_states;

    if (status) return status;
    memcpy(target->coordinates, source->coordinates, count * source->num_unknowns * sizeof(double));
    memcpy(target->exit, source->exit, count * sizeof *target->exit);
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
        size_t node = rows ? rows[r] : r + 1;
        if (node < 1 || node > basis->grid.num_inner)
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
            gather_rows(basis->pressure, model->needed_node, 0, model->num_needed, num_pressure);
        model->needed_film = gather_rows(film, model->needed_node, 0, model->num_needed, width);
        model->band_pressure =
            gather_rows(basis->pressure, NULL, model->band_begin, model->num_band, num_pressure);
        model->band_film = gather_rows(film, NULL, model->band_begin, model->num_band, width);
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
        control->pressure = gather_rows(basis->pressure, control->needed_node, 0,
                                        control->num_needed, num_pressure);
        control->film =
            gather_rows(coupled_basis ? coupled : basis->deformation_modes, control->needed_node, 0,
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

/* Left sides of the coupled basis: row i is (K at the needed nodes from band node i, step). */
static void fill_left_coupled(reduced_model *model) {
    size_t width = model->num_cut;

    for (size_t i = 0; i < model->num_band; i++) {
        size_t node = model->band_begin + i;
        for (size_t q = 0; q < model->num_needed; q++) {
            size_t other = model->needed_node[q];
            model->left[i * width + q] = model->kernel[other > node ? other - node : node - other];
        }
        model->left[i * width + model->num_needed] = model->grid.step;
    }
}

/* Adds the band's nodes from `from` up to before `to` to a cut table. */
static void extend_cut(double *cut, const reduced_model *model, size_t from, size_t to) {
    size_t first = from - model->band_begin;

    if (to > from)
        cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, (int)model->num_cut,
                    (int)model->num_pressure, (int)(to - from), 1,
                    model->left + first * model->num_cut, (int)model->num_cut,
                    model->band_pressure + first * model->num_pressure, (int)model->num_pressure, 1,
                    cut, (int)model->num_pressure);
}

/* The same for the deflections at the band's nodes (coupled). */
static void extend_band(double *band, const reduced_model *model, size_t from, size_t to) {
    size_t num_pressure = model->num_pressure;

    for (size_t source = from; source < to; source++)
        for (size_t i = 0; i < model->num_band; i++) {
            size_t node = model->band_begin + i;
            double influence = model->kernel[node > source ? node - source : source - node];
            cblas_daxpy((int)num_pressure, influence,
                        model->band_pressure + (source - model->band_begin) * num_pressure, 1,
                        band + i * num_pressure, 1);
        }
}

static void fill_checkpoints(reduced_model *model) {
    size_t cut_size = model->num_cut * model->num_pressure;
    size_t band_size = model->num_band * model->num_pressure;
    size_t before = model->band_begin;
    const double *cut = model->cut_base, *band = model->band_film;

    for (size_t c = 0; c < model->num_checkpoints; c++) {
        size_t exit = model->least_exit + c * model->checkpoint_stride;
        double *next = model->checkpoint_cut + c * cut_size;
        memcpy(next, cut, cut_size * sizeof(double));
        extend_cut(next, model, before, exit);
        cut = next;
        if (model->checkpoint_band) {
            next = model->checkpoint_band + c * band_size;
            memcpy(next, band, band_size * sizeof(double));
            extend_band(next, model, before, exit);
            band = next;
        }
        before = exit;
    }
}

size_t reduced_model_checkpoint(const reduced_model *model, size_t exit) {
    return (exit - model->least_exit) / model->checkpoint_stride;
}

ehd_status reduced_model_complete(reduced_model *model, ehd_error *error) {
    size_t num_pressure = model->num_pressure, centre[4];
    bool coupled = model->deformation == DEFORMATION_COUPLED;

    model->checkpoint_stride = (size_t)(CHECKPOINT_DISTANCE / model->grid.step) + 1;
    model->num_checkpoints = (model->most_exit - model->least_exit) / model->checkpoint_stride + 1;
    model->stencils = malloc(model->num_rows * sizeof *model->stencils);
    model->needed_gap = malloc(model->num_needed * sizeof(double));
    model->kernel = malloc(model->grid.num_nodes * sizeof(double));
    model->checkpoint_cut =
        malloc(model->num_checkpoints * model->num_cut * num_pressure * sizeof(double));
    if (coupled)
        model->checkpoint_band =
            malloc(model->num_checkpoints * model->num_band * num_pressure * sizeof(double));
    if (!model->stencils || !model->needed_gap || !model->kernel || !model->checkpoint_cut ||
        (coupled && !model->checkpoint_band))
        return ehd_fail(error, EHD_MEMORY, "reduced model: found no memory for its tables");

    fill_stencils(model->stencils, &model->grid, model->row_node, model->num_rows,
                  model->needed_node, model->num_needed);
    centre_nodes(centre, model->centre_weight, &model->grid);
    for (size_t i = 0; i < 4; i++)
        model->centre[i] = place_in(model->needed_node, model->num_needed, centre[i]);
    for (size_t q = 0; q < model->num_needed; q++)
        model->needed_gap[q] = grid_gap(&model->grid, model->needed_node[q]);
    for (size_t d = 0; d < model->grid.num_nodes; d++)
        model->kernel[d] = model->kind->kernel((double)d * model->grid.step, 0, model->grid.step);
    if (coupled) fill_left_coupled(model);
    fill_checkpoints(model);
    return EHD_OK;
}

ehd_status reduced_model_complete_control(reduced_model *model, ehd_error *error) {
    control_rows *control = &model->control;

    control->stencils = malloc((control->num_rows + 1) * sizeof *control->stencils);
    if (!control->stencils)
        return ehd_fail(error, EHD_MEMORY, "reduced model: found no memory for its tables");
    fill_stencils(control->stencils, &model->grid, control->node, control->num_rows,
                  control->needed_node, control->num_needed);
    return EHD_OK;
}
