/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the band of a model, the range of nodes that contains the exits and smallest films of the
 * training (romrun/solve/README.md). Also checks a band that was read from a file.
 * Called by reduced_build.c to find the band, and by flat_model.c and model_read.c to check the
 * band. */
#include "romrun/model/reduced_build.h"

#include "common/algebra/product.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Margins of the band, in half widths. The band extends beyond the trained exits by EXIT_MARGIN for
 * a line contact, and by LINES_MARGIN for a point contact, whose exits vary more on each grid line.
 * The band begins MINIMUM_MARGIN before the trained film minima. Exits of iterates may lie beyond
 * the trained exits. Without EXIT_MARGIN, or with -0.1 for MINIMUM_MARGIN, the iteration does not
 * converge from every trained solution to every other trained solution (test_reduced_solver.c,
 * any_trained_solution_leads_to_any_other). */
static const double EXIT_MARGIN = 0.1, LINES_MARGIN = 0.3, MINIMUM_MARGIN = 0.05;

/* Returns the node of the film minimum of a training state. `deflection`: deflection that the
 * pressure of this state causes. */
static size_t film_minimum(const reduced_basis *basis, const double *deflection,
                           const size_t *exit) {
    const ehd_grid *grid = &basis->grid;
    size_t width = grid_width(grid), num_lines = grid_lines(grid), best = exit[0];
    size_t centre = (size_t)(-grid->x_min / grid->step) + 1;
    double smallest = INFINITY;

    for (size_t l = 0; l < num_lines; l++)
        for (size_t c = centre; c <= exit[l] && c < width; c++) {
            size_t k = l * width + c;
            double film = deflection[k] + grid_gap(grid, k);
            if (film < smallest) {
                smallest = film;
                best = k;
            }
        }
    return best;
}

static void deflect_state(double *deflections, const reduced_basis *basis, size_t state,
                          ehd_deflection *deflection) {
    const reduced_states *states = &basis->states;
    const size_t *exit = states->exit + state * states->num_lines;
    size_t width = grid_width(&basis->grid);

    memset(deflections, 0, basis->grid.num_nodes * sizeof *deflections);
    add_product(deflections, basis->pressure, basis->num_pressure, basis->grid.num_nodes,
                basis->num_pressure, states->coordinates + state * states->num_unknowns);
    for (size_t l = 0; l < states->num_lines; l++)
        memset(deflections + l * width + exit[l], 0, (width - exit[l]) * sizeof(double));
    deflection_apply(deflections, deflection, deflections);
}

/* Finds the most upstream and the most downstream exit of the training on each grid line. Sets
 * `begin` of the line to the most upstream column of a film minimum on this line or near it. */
static void find_extremes(reduced_model *model, const reduced_basis *basis,
                          ehd_deflection *deflection, double *work) {
    const reduced_states *states = &basis->states;
    size_t width = grid_width(&basis->grid), near = (size_t)ceil(MINIMUM_MARGIN / basis->grid.step);

    model->band.first_minimum = model->band.num_lines - 1;
    model->band.last_minimum = 0;
    for (size_t l = 0; l < model->band.num_lines; l++)
        model->band.lines[l] =
            (band_line){.begin = width - 1, .min_exit = width - 1, .max_exit = 1};
    for (size_t s = 0; s < states->num_states; s++) {
        const size_t *exit = states->exit + s * states->num_lines;
        deflect_state(work, basis, s, deflection);
        size_t minimum = film_minimum(basis, work, exit);
        size_t own = reduced_model_line(model, minimum);
        size_t column = reduced_model_column(model, minimum);
        for (size_t l = 0; l < model->band.num_lines; l++) {
            band_line *line = &model->band.lines[l];
            line->min_exit = exit[l] < line->min_exit ? exit[l] : line->min_exit;
            line->max_exit = exit[l] > line->max_exit ? exit[l] : line->max_exit;
            if (index_distance(l, own) > near || !grid_is_inner_line(&basis->grid, l)) continue;
            line->begin = column < line->begin ? column : line->begin;
            model->band.first_minimum =
                l < model->band.first_minimum ? l : model->band.first_minimum;
            model->band.last_minimum = l > model->band.last_minimum ? l : model->band.last_minimum;
        }
    }
}

/* Widens the range of the exits on each grid line by EXIT_MARGIN or LINES_MARGIN. Upstream of this
 * range it leaves space for the stencil of a row. */
static void widen_exits(reduced_model *model) {
    const ehd_grid *grid = &model->grid;
    size_t margin =
               (size_t)ceil((model->band.num_lines > 1 ? LINES_MARGIN : EXIT_MARGIN) / grid->step),
           width = grid_width(grid);
    const size_t back = reynolds_reach_back(grid);
    // the exit of a line contact lies behind the centre
    size_t first_column = model->band.num_lines > 1 ? 2 : (size_t)(-grid->x_min / grid->step) + 2;

    for (size_t l = 0; l < model->band.num_lines; l++) {
        band_line *line = &model->band.lines[l];
        if (!grid_is_inner_line(grid, l)) {
            *line = (band_line){1, 1, 0, 1, 1};
            continue;
        }
        line->min_exit = line->min_exit > first_column + margin + back ? line->min_exit - margin
                                                                       : first_column + back;
        line->max_exit = line->max_exit + margin < width - 2 ? line->max_exit + margin : width - 2;
    }
}

/* Sets the columns of the band on each grid line. The band begins upstream of all film minima on or
 * near this line, and upstream of all nodes that the rows at the exits of this and the neighbouring
 * grid lines need. It ends downstream of all these exits. */
static void set_band(reduced_model *model) {
    const ehd_grid *grid = &model->grid;
    const size_t width = grid_width(grid), ahead = reynolds_reach_ahead(grid);
    size_t before = (size_t)ceil(MINIMUM_MARGIN / grid->step) + reynolds_reach_back(grid);
    size_t first_column = model->band.num_lines > 1 ? 1 : (size_t)(-grid->x_min / grid->step) + 2;

    model->band.num_nodes = 0;
    for (size_t l = 0; l < model->band.num_lines; l++) {
        band_line *line = &model->band.lines[l];
        size_t first = line->begin, last = line->max_exit;
        line->offset = model->band.num_nodes;
        if (!grid_is_inner_line(grid, l)) continue;
        for (size_t neighbour = l > ahead ? l - ahead : 0;
             neighbour <= l + ahead && neighbour < model->band.num_lines; neighbour++) {
            if (!grid_is_inner_line(grid, neighbour)) continue;
            const band_line *other = &model->band.lines[neighbour];
            first = other->min_exit < first ? other->min_exit : first;
            last = other->max_exit > last ? other->max_exit : last;
        }
        line->begin = first > first_column + before ? first - before : first_column;
        line->end = last + 1 + ahead < width ? last + 1 + ahead : width;
        model->band.num_nodes += line->end - line->begin;
    }
}

ehd_status reduced_model_find_band(reduced_model *model, const reduced_basis *basis,
                                   ehd_deflection *deflection, ehd_error *error) {
    double *work = malloc(basis->grid.num_nodes * sizeof(double));

    model->band.lines =
        arena_array(&model->memory, model->band.num_lines, sizeof *model->band.lines);
    if (!work || !model->band.lines) {
        free(work);
        return ehd_no_memory(error, "reduced model");
    }
    find_extremes(model, basis, deflection, work);
    widen_exits(model);
    set_band(model);
    free(work);
    return EHD_OK;
}

// ---- checks of a file

/* Checks whether the exits of a grid line lie inside the band of this line, with space for the
 * stencil of a row. */
static bool exits_fit(const band_line *line, const ehd_grid *grid) {
    const size_t width = grid_width(grid);
    const size_t end = line->max_exit + 1 + reynolds_reach_ahead(grid);

    return line->begin >= 1 && line->begin + reynolds_reach_back(grid) <= line->min_exit &&
           line->min_exit <= line->max_exit && line->max_exit <= width - 2 &&
           (end < width ? end : width) <= line->end && line->end <= width;
}

ehd_status reduced_check_band(const reduced_model *model, const char *path, ehd_error *error) {
    size_t count = 0;

    for (size_t l = 0; l < model->band.num_lines; l++) {
        const band_line *line = &model->band.lines[l];
        if (!grid_is_inner_line(&model->grid, l)) continue;
        count += line->end - line->begin;
        if (!exits_fit(line, &model->grid))
            return ehd_fail(error, EHD_DATA,
                            "%s: found exits from %zu to %zu, expected them inside the band of "
                            "columns %zu to %zu",
                            path, line->min_exit, line->max_exit, line->begin, line->end);
    }
    if (count == model->band.num_nodes) return EHD_OK;
    return ehd_fail(error, EHD_DATA, "%s: band_node: found %zu, expected %zu, as many as the lines",
                    path, model->band.num_nodes, count);
}

ehd_status reduced_check_exits(const reduced_model *model, const reduced_states *states,
                               const char *path, ehd_error *error) {
    for (size_t i = 0; i < states->num_states * states->num_lines; i++) {
        const band_line *line = &model->band.lines[i % states->num_lines];
        if (states->exit[i] < line->begin || states->exit[i] > line->end)
            return ehd_fail(error, EHD_DATA,
                            "%s: state_exit_node: found an exit at column %zu, expected %zu to "
                            "%zu, inside the band",
                            path, states->exit[i], line->begin, line->end);
    }
    return EHD_OK;
}
