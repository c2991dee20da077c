/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/state/node_traction.h"

#include "common/algebra/vectors.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* Returns int P X. Computes the pressures of the runs, and the pressures of the band before the
 * exits. */
static double moment_of(node_state *self, const double *z) {
    const reduced_model *model = self->model;
    const ehd_grid *grid = &model->grid;
    double moment = dot(model->cubature.moment, z, model->num_pressure);

    nodes_expand_runs(self, z);
    for (size_t l = 0; l < model->band.num_lines; l++) {
        const band_line *line = &model->band.lines[l];
        if (!reduced_model_has_band(model, l) || self->exit[l] <= line->begin) continue;
        const size_t first = l * grid_width(grid) + line->begin;
        const size_t count = self->exit[l] - line->begin;
        const double *pressure = self->band_pressure + line->offset;
        nodes_expand_range(self, z, line->offset, count);
        for (size_t i = 0; i < count; i++)
            moment += grid_load_weight(grid, first + i) * grid_x(grid, first + i) * pressure[i];
    }
    return moment;
}

/* Returns the deflection at a column by the pressures of `count` columns of a grid line from
 * `first` on. `kernel`: influence of a pressure by distance in columns, for the given distance
 * between both grid lines. */
static double deflection_by(const double *kernel, size_t column, size_t first, size_t count,
                            const double *pressure) {
    size_t before = column > first ? column - first : 0;

    if (before > count) before = count;
    const double *falling = kernel + (column > first ? column - first + 1 - before : 0);
    const double *rising = kernel + (first + before > column ? first + before - column : 0);
    return dot_reversed(falling, pressure, before) + dot(rising, pressure + before, count - before);
}

/* Returns H at a node of the cubature. The pressures of the band must be known. Sums the deflection
 * by many pressures at one node with deflection_by, because reduced_model_deflect takes three times
 * as long. */
static double film_at(const node_state *self, const double *z, size_t q, grid_position at) {
    const reduced_model *model = self->model;
    const row_set *set = &model->cubature.nodes;
    const bool coupled = model->deformation == DEFORMATION_COUPLED;
    const size_t width = coupled ? model->num_pressure : model->num_deformation;
    const size_t columns = grid_width(&model->grid);
    double film = z[model->num_unknowns - 1] + set->gap[q] +
                  dot(set->film + q * width, coupled ? z : z + model->num_pressure, width);

    for (size_t l = 0; l < model->band.num_lines && coupled; l++) {
        const band_line *line = &model->band.lines[l];
        if (!reduced_model_has_band(model, l) || self->exit[l] <= line->begin) continue;
        const size_t count = self->exit[l] - line->begin;
        const double *pressure = self->band_pressure + line->offset;
        film += deflection_by(model->kernel + index_distance(at.line, l) * columns, at.column,
                              line->begin, count, pressure);
        if (model->grid.half && l > 0)
            film += deflection_by(model->kernel + (at.line + l) * columns, at.column, line->begin,
                                  count, pressure);
    }
    return film;
}

/* Computes pressure and film at a node of the cubature. Returns false if the node lies behind the
 * exit. */
static bool expand_node(double *pressure, double *film, const node_state *self, const double *z,
                        size_t q) {
    const row_set *set = &self->model->cubature.nodes;
    const size_t num_pressure = self->model->num_pressure;
    const grid_position at = reduced_model_position(self->model, set->needed_node[q]);

    if (at.column >= self->exit[at.line]) return false;
    *pressure = dot(set->pressure + q * num_pressure, z, num_pressure);
    *film = film_at(self, z, q, at);
    return true;
}

/* dP/dX at a node of the cubature, and its derivatives `by` with respect to the pressures at the
 * two neighbours along X. `beside`: indices of the neighbours in the cubature; NO_NODE: the
 * neighbour's pressure is zero. Only thinned flows need the gradient, because the gradient changes
 * their shear stress. Models of thinned flows therefore contain the neighbours. */
typedef struct node_gradient {
    double value;
    size_t beside[2];
    double by[2];
} node_gradient;

static double pressure_at(const node_state *self, const double *z, size_t q) {
    const size_t num_pressure = self->model->num_pressure;

    return dot(self->model->cubature.nodes.pressure + q * num_pressure, z, num_pressure);
}

static node_gradient gradient_at(const node_state *self, const double *z, size_t q) {
    const row_set *set = &self->model->cubature.nodes;
    const size_t node = set->needed_node[q];
    const grid_position at = reduced_model_position(self->model, node);
    const double per_pressure = 1 / (2 * self->model->grid.step);
    const bool before = q > 0 && set->needed_node[q - 1] + 1 == node;
    const bool behind = q + 1 < set->num_needed && set->needed_node[q + 1] == node + 1;
    node_gradient gradient = {.beside = {NO_NODE, NO_NODE}, .by = {-per_pressure, per_pressure}};

    // if the model does not contain both neighbours, the gradient stays 0
    if (!(before || at.column == 1) || !(behind || at.column + 1 >= self->exit[at.line]))
        return gradient;
    if (before) gradient.beside[0] = q - 1;
    if (behind && at.column + 1 < self->exit[at.line]) gradient.beside[1] = q + 1;
    for (int side = 0; side < 2; side++)
        if (gradient.beside[side] != NO_NODE)
            gradient.value += gradient.by[side] * pressure_at(self, z, gradient.beside[side]);
    return gradient;
}

/* Checks whether a node of the cubature has a weight in the sums. Nodes that the cubature contains
 * only as neighbours of other nodes have no weight. */
static bool has_weight(const node_cubature *cubature, size_t q) {
    return cubature->friction[q] != 0 || cubature->dry[q] != 0;
}

/* Returns the stress at a node before the exit, and updates the largest stress. Pressures slightly
 * below zero are used as they are: truncated modes have such pressures far out in the inlet, where
 * the pressures of the full model are slightly above zero. The properties of the fluid are the same
 * at both pressures. */
static double stress_at(double *largest, const ehd_contact *contact, double pressure, double film,
                        double gradient) {
    const double stress = contact_shear_stress(contact, pressure, film, gradient);

    *largest = fmax(*largest, fabs(stress));
    return stress;
}

/* Searches for the largest shear stress at the needed nodes, which are all nodes of the rows'
 * stencils. If the pressure gradient thins the flow, the stress also depends on dP/dX. The search
 * then uses only the node of each row, in the middle of its stencil, because only there both
 * neighbours along X are also needed nodes (romrun/solve/README.md, Traction). */
static void look_at_needed(double *largest, const node_state *self, const ehd_contact *contact) {
    const double *pressure = self->now.pressure;

    if (traction_thins_flow(contact)) {
        for (size_t r = 0; r < self->model->rows.num_rows; r++) {
            const size_t *node = self->model->rows.stencils[r].node, q = node[NODE_HERE];
            const double change = pressure[node[NODE_AHEAD]] - pressure[node[NODE_BACK]];
            stress_at(largest, contact, pressure[q], self->now.film[q],
                      change / (2 * self->model->grid.step));
        }
        return;
    }
    for (size_t q = 0; q < self->model->rows.num_needed; q++)
        stress_at(largest, contact, pressure[q], self->now.film[q], 0);
}

/* The end of the pressurised zone on a grid line. */
typedef struct line_end {
    size_t node;   // last node with pressure
    double weight; // weight of the node in sums over the grid
    double pressure;
    double gradient; // dP/dX at the node; the next node has zero pressure
    double film[2];  // film at the node and at the next node
} line_end;

/* Finds the end of the pressurised zone on a grid line. Returns false if no node of the line in the
 * band has pressure. */
static bool find_line_end(line_end *end, const node_state *self, const double *z, size_t line) {
    const reduced_model *model = self->model;
    const band_line *band = &model->band.lines[line];
    const size_t column = self->exit[line] - 1;

    if (!reduced_model_has_band(model, line) || column < band->begin) return false;
    end->node = line * grid_width(&model->grid) + column;
    end->weight = grid_load_weight(&model->grid, end->node);
    end->pressure = self->band_pressure[band->offset + column - band->begin];
    end->gradient = column == band->begin
                        ? 0
                        : -self->band_pressure[band->offset + column - 1 - band->begin] /
                              (2 * model->grid.step);
    nodes_band_films(end->film, self, z, end->node, 2);
    return true;
}

contact_traction nodes_traction(node_state *self, const double *z, const ehd_contact *contact,
                                const contact_scalars *scalars) {
    const reduced_model *model = self->model;
    const node_cubature *cubature = &model->cubature;
    const bool thinned = traction_thins_flow(contact);
    traction_sums sums = {.moment = moment_of(self, z)};
    double pressure, film;
    line_end end;

    for (size_t q = 0; q < cubature->nodes.num_needed; q++) {
        if (!has_weight(cubature, q) || !expand_node(&pressure, &film, self, z, q)) continue;
        const double gradient = thinned ? gradient_at(self, z, q).value : 0;
        const double stress = stress_at(&sums.largest_stress, contact, pressure, film, gradient);
        sums.friction += cubature->friction[q] * stress;
        sums.mean_stress += cubature->dry[q] * fabs(stress);
    }
    look_at_needed(&sums.largest_stress, self, contact);
    const bool on_line = model->band.num_lines == 1;
    for (size_t l = 0; l < model->band.num_lines; l++) {
        if (!find_line_end(&end, self, z, l)) continue;
        const double stress =
            stress_at(&sums.largest_stress, contact, end.pressure, end.film[0], end.gradient);
        // corrects the sum over nodes for the cell behind the last node with pressure
        sums.friction += end.weight / model->grid.step *
                         contact_traction_behind(contact, &model->grid, end.node, stress, end.film,
                                                 on_line ? scalars->exit_position : NAN);
    }
    const traction_sums beyond = contact_traction_beyond(contact, scalars);
    sums.friction += beyond.friction;
    sums.moment -= beyond.rolling;
    // since the kernel is even, the deflection does no net work along X: int H dP/dX = -int P X
    sums.rolling = -sums.moment;
    return contact_traction_from(contact, &sums, scalars->load);
}

// ---- derivatives of the friction

/* Adds `factor` times a deflection to `influence` for each band node before the exits. The
 * deflection is caused at node `at` by a pressure of 1 at the band node. */
static void add_band_influence(double *influence, double factor, const node_state *self,
                               grid_position at) {
    const reduced_model *model = self->model;
    const size_t columns = grid_width(&model->grid);

    for (size_t l = 0; l < model->band.num_lines; l++) {
        const band_line *line = &model->band.lines[l];
        if (!reduced_model_has_band(model, l)) continue;
        const double *own = model->kernel + index_distance(at.line, l) * columns;
        const double *mirrored =
            model->grid.half && l > 0 ? model->kernel + (at.line + l) * columns : NULL;
        for (size_t column = line->begin; column < self->exit[l]; column++) {
            const size_t distance = index_distance(at.column, column);
            influence[line->offset + column - line->begin] +=
                factor * (own[distance] + (mirrored ? mirrored[distance] : 0));
        }
    }
}

void nodes_add_friction(double *target, double *influence, node_state *self, const double *z,
                        const ehd_contact *contact) {
    const reduced_model *model = self->model;
    const row_set *set = &model->cubature.nodes;
    const size_t num_pressure = model->num_pressure, last = model->num_unknowns - 1;
    const bool coupled = model->deformation == DEFORMATION_COUPLED;
    const size_t width = coupled ? num_pressure : model->num_deformation;
    const bool thinned = traction_thins_flow(contact);
    double pressure, film;

    moment_of(self, z); // fills the pressures of the band
    memset(influence, 0, model->band.num_nodes * sizeof *influence);
    for (size_t q = 0; q < set->num_needed; q++) {
        if (!has_weight(&model->cubature, q) || !expand_node(&pressure, &film, self, z, q))
            continue;
        const node_gradient gradient = thinned ? gradient_at(self, z, q) : (node_gradient){0};
        const stress_slopes slopes = contact_stress_slopes(contact, pressure, film, gradient.value);
        const double by_pressure = model->cubature.friction[q] * slopes.by_pressure;
        const double by_film = model->cubature.friction[q] * slopes.by_film;
        nodes_add_row(target, by_pressure, set->pressure + q * num_pressure, num_pressure);
        for (int side = 0; side < 2 && thinned; side++)
            if (gradient.beside[side] != NO_NODE)
                nodes_add_row(target,
                              model->cubature.friction[q] * slopes.by_gradient * gradient.by[side],
                              set->pressure + gradient.beside[side] * num_pressure, num_pressure);
        nodes_add_row(coupled ? target : target + num_pressure, by_film, set->film + q * width,
                      width);
        target[last] += by_film;
        if (coupled)
            add_band_influence(influence, by_film, self,
                               reduced_model_position(model, set->needed_node[q]));
    }
    for (size_t k = 0; k < model->band.num_nodes; k++)
        if (influence[k] != 0)
            nodes_add_row(target, influence[k], model->band.pressure + k * num_pressure,
                          num_pressure);
}

double nodes_friction_of_exits(node_state *self, const double *z, const ehd_contact *contact,
                               const double *risk) {
    double squares = 0;
    line_end end;

    moment_of(self, z); // fills the pressures of the band
    for (size_t l = 0; l < self->model->band.num_lines; l++)
        if (find_line_end(&end, self, z, l))
            squares +=
                pow(risk[l] * end.weight *
                        contact_shear_stress(contact, end.pressure, end.film[0], end.gradient),
                    2);
    return sqrt(squares);
}
