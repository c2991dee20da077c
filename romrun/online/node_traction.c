/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/online/node_traction.h"

#include <cblas.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

/* Pressures of the band before the exits and of what cuts them, and int P X. */
static double moment_of(node_state *self, const double *z) {
    const reduced_model *model = self->model;
    const ehd_grid *grid = &model->grid;
    double moment = cblas_ddot((int)model->num_pressure, model->cubature.moment, 1, z, 1);

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

/* Deflection at a column by the pressures of `count` columns of a line from `first` on; `kernel`: of the
 * distance of both lines, by that of columns. */
static double deflection_by(const double *kernel, size_t column, size_t first, size_t count,
                            const double *pressure) {
    size_t before = column > first ? column - first : 0;

    if (before > count) before = count;
    const double *falling = kernel + (column > first ? column - first + 1 - before : 0);
    const double *rising = kernel + (first + before > column ? first + before - column : 0);
    return cblas_ddot((int)before, falling, -1, pressure, 1) +
           cblas_ddot((int)(count - before), rising, 1, pressure + before, 1);
}

/* H at a node of the cubature; the band's pressures are known. One node by many, of which
 * reduced_model_deflect takes three times as long. */
static double film_at(const node_state *self, const double *z, size_t q, grid_position at) {
    const reduced_model *model = self->model;
    const row_set *set = &model->cubature.nodes;
    const bool coupled = model->deformation == DEFORMATION_COUPLED;
    const size_t width = coupled ? model->num_pressure : model->num_deformation;
    const size_t columns = grid_width(&model->grid);
    double film =
        z[model->num_unknowns - 1] + set->gap[q] +
        cblas_ddot((int)width, set->film + q * width, 1, coupled ? z : z + model->num_pressure, 1);

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

/* Pressure and film at a node of the cubature; false: it lies behind the exit. */
static bool expand_node(double *pressure, double *film, const node_state *self, const double *z,
                        size_t q) {
    const row_set *set = &self->model->cubature.nodes;
    const size_t num_pressure = self->model->num_pressure;
    const grid_position at = reduced_model_position(self->model, set->needed_node[q]);

    if (at.column >= self->exit[at.line]) return false;
    *pressure = cblas_ddot((int)num_pressure, set->pressure + q * num_pressure, 1, z, 1);
    *film = film_at(self, z, q, at);
    return true;
}

/* Stress at a node before the exit; the largest is kept. Far out in the inlet truncated modes
 * have pressures below zero, where the full model's are hardly above: the fluid is the same. */
static double stress_at(double *largest, const ehd_contact *contact, double pressure, double film) {
    const double stress = contact_shear_stress(contact, pressure, film);

    *largest = fmax(*largest, fabs(stress));
    return stress;
}

/* The largest stress is looked for at the needed nodes too, where the pressure is near its largest
 * there: it falls with that more than it rises with a thinner film. */
static const double NEAR_LARGEST = 0.7;

static void look_at_needed(double *largest, const node_state *self, const ehd_contact *contact) {
    const double *pressure = self->now.pressure;
    double most = 0;

    for (size_t q = 0; q < self->model->rows.num_needed; q++)
        most = pressure[q] > most ? pressure[q] : most;
    for (size_t q = 0; q < self->model->rows.num_needed; q++)
        if (pressure[q] >= NEAR_LARGEST * most)
            stress_at(largest, contact, pressure[q], self->now.film[q]);
}

/* Where a grid line's pressure ends. */
typedef struct line_end {
    size_t node;     // the last one with pressure
    double weight;   // of its cell in sums
    double pressure; // there
    double film[2];  // there and at the next node
} line_end;

/* False: none of its nodes in the band has pressure. */
static bool find_line_end(line_end *end, const node_state *self, const double *z, size_t line) {
    const reduced_model *model = self->model;
    const band_line *band = &model->band.lines[line];
    const size_t column = self->exit[line] - 1;

    if (!reduced_model_has_band(model, line) || column < band->begin) return false;
    end->node = line * grid_width(&model->grid) + column;
    end->weight = grid_load_weight(&model->grid, end->node);
    end->pressure = self->band_pressure[band->offset + column - band->begin];
    nodes_band_films(end->film, self, z, end->node, 2);
    return true;
}

contact_traction nodes_traction(node_state *self, const double *z, const ehd_contact *contact,
                                const contact_scalars *scalars) {
    const reduced_model *model = self->model;
    const node_cubature *cubature = &model->cubature;
    traction_sums sums = {.moment = moment_of(self, z)};
    double pressure, film;
    line_end end;

    // an even kernel does no net work along X: int H dP/dX = -int P X
    sums.rolling = -sums.moment;
    for (size_t q = 0; q < cubature->nodes.num_needed; q++) {
        if (!expand_node(&pressure, &film, self, z, q)) continue;
        const double stress = stress_at(&sums.largest_stress, contact, pressure, film);
        sums.friction += cubature->friction[q] * stress;
        sums.mean_stress += cubature->dry[q] * fabs(stress);
    }
    look_at_needed(&sums.largest_stress, self, contact);
    const bool on_line = model->band.num_lines == 1;
    for (size_t l = 0; l < model->band.num_lines; l++) {
        if (!find_line_end(&end, self, z, l)) continue;
        const double stress = stress_at(&sums.largest_stress, contact, end.pressure, end.film[0]);
        // what the cell behind the last node has beside the sum over nodes
        sums.friction += end.weight / model->grid.step *
                         contact_traction_behind(contact, &model->grid, end.node, stress, end.film,
                                                 on_line ? scalars->exit_position : NAN);
    }
    return contact_traction_from(contact, &sums, scalars->load);
}

// ---- derivatives of the friction

/* influence += factor times the deflection at a node by 1 at each band node before the exits. */
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
    double pressure, film;

    moment_of(self, z); // for the pressures of the band
    memset(influence, 0, model->band.num_nodes * sizeof *influence);
    for (size_t q = 0; q < set->num_needed; q++) {
        if (!expand_node(&pressure, &film, self, z, q)) continue;
        const stress_slopes slopes = contact_stress_slopes(contact, pressure, film);
        const double by_pressure = model->cubature.friction[q] * slopes.by_pressure;
        const double by_film = model->cubature.friction[q] * slopes.by_film;
        nodes_add_row(target, by_pressure, set->pressure + q * num_pressure, num_pressure);
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

    moment_of(self, z); // as above
    for (size_t l = 0; l < self->model->band.num_lines; l++)
        if (find_line_end(&end, self, z, l))
            squares += pow(
                risk[l] * end.weight * contact_shear_stress(contact, end.pressure, end.film[0]), 2);
    return sqrt(squares);
}
