/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/online/node_traction.h"

#include <cblas.h>
#include <math.h>

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

/* Stress at a node with pressure, 0 at others; the largest is kept. */
static double stress_at(double *largest, const ehd_contact *contact, double pressure, double film) {
    if (!(pressure > 0)) return 0;
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

/* What the cell behind the last node with pressure of a grid line has beside the sum over nodes. */
static double behind_line(double *largest, const node_state *self, const double *z,
                          const ehd_contact *contact, size_t line, double exit_position) {
    const reduced_model *model = self->model;
    const band_line *band = &model->band.lines[line];
    const size_t column = self->exit[line] - 1;
    const size_t node = line * grid_width(&model->grid) + column;
    double films[2];
    if (!reduced_model_has_band(model, line) || column < band->begin) return 0;

    const double pressure = self->band_pressure[band->offset + column - band->begin];
    if (!(pressure > 0)) return 0;
    nodes_band_films(films, self, z, node, 2);
    const double stress = stress_at(largest, contact, pressure, films[0]);
    return grid_load_weight(&model->grid, node) / model->grid.step *
           contact_traction_behind(contact, &model->grid, node, stress, films, exit_position);
}

contact_traction nodes_traction(node_state *self, const double *z, const ehd_contact *contact,
                                const contact_scalars *scalars) {
    const reduced_model *model = self->model;
    const node_cubature *cubature = &model->cubature;
    const row_set *set = &cubature->nodes;
    const size_t num_pressure = model->num_pressure;
    traction_sums sums = {.moment = moment_of(self, z)};

    // an even kernel does no net work along X: int H dP/dX = -int P X
    sums.rolling = -sums.moment;
    for (size_t q = 0; q < set->num_needed; q++) {
        const grid_position at = reduced_model_position(model, set->needed_node[q]);
        if (at.column >= self->exit[at.line]) continue;
        const double pressure =
            cblas_ddot((int)num_pressure, set->pressure + q * num_pressure, 1, z, 1);
        const double stress =
            stress_at(&sums.largest_stress, contact, pressure, film_at(self, z, q, at));
        sums.friction += cubature->friction[q] * stress;
        sums.mean_stress += cubature->dry[q] * fabs(stress);
    }
    look_at_needed(&sums.largest_stress, self, contact);
    const bool on_line = model->band.num_lines == 1;
    for (size_t l = 0; l < model->band.num_lines; l++)
        sums.friction += behind_line(&sums.largest_stress, self, z, contact, l,
                                     on_line ? scalars->exit_position : NAN);
    return contact_traction_from(contact, &sums, scalars->load);
}
