/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/program/program.h"
#include "romrun/online/solver_parts.h"

#include <math.h>
#include <string.h>

// ---- exit boundary

static const double WINDOW = 0.05; // around the exit, where it is looked at and moved; half widths
static const double SETTLED = 0.005; // half widths
static const double NOISE = 1e-5;    // negative pressure that the truncated basis may show

static size_t window_begin(const reduced_model *model, size_t exit) {
    size_t base = model->checkpoints.exit[reduced_model_checkpoint(model, &exit)];
    size_t window = (size_t)(WINDOW / model->grid.step) + 2;
    size_t reach = window + 2; // a row at the window's first node has its stencil before it
    size_t begin =
        exit > model->band.lines[0].begin + reach ? exit - reach : model->band.lines[0].begin;

    return begin < base ? begin : base;
}

/* H at a band node of the state whose exits are looked for, once: the rows of neighbouring lines share nodes. */
static double film_at(reduced_solver *self, const double *z, size_t node, size_t place) {
    if (self->band_search[place] != self->search) {
        self->band_film[place] = nodes_band_film(self, z, node);
        self->band_search[place] = self->search;
    }
    return self->band_film[place];
}

/* The same at `count` neighbouring nodes together. */
static void take_films(reduced_solver *self, const double *z, size_t node, size_t count) {
    size_t place = reduced_model_band_place(self->model, node);

    nodes_band_films(self->band_film + place, self, z, node, count);
    for (size_t i = place; i < place + count; i++)
        self->band_search[i] = self->search;
}

/* The Reynolds row at a band node, from the state around it; row.residual is -Lambda at the exit. */
static reynolds_row band_row(reduced_solver *self, const double *z, size_t node,
                             const ehd_contact *contact, const reduced_squeeze *squeeze,
                             double *flux) {
    const reduced_model *model = self->model;
    const reynolds_stencil around = reynolds_stencil_at(&model->grid, node);
    double pressure[NUM_STENCIL], film[NUM_STENCIL], memory[4][NUM_STENCIL];
    reynolds_stencil stencil;
    reynolds_fluid fluid = {memory[0], memory[1], contact->lubricant.density ? memory[2] : NULL,
                            contact->lubricant.density ? memory[3] : NULL};
    reynolds_row row;
    size_t count = 0;

    for (size_t a = 0; a < NUM_STENCIL; a++) {
        size_t other = around.node[a];
        stencil.node[a] = other == NO_NODE ? NO_NODE : count;
        if (other == NO_NODE) continue;
        const grid_place at = reduced_model_place(model, other);
        bool banded = reduced_model_has_band(model, at.line),
             alive = at.column < self->exit[at.line];
        size_t place = banded ? reduced_model_band_place(model, other) : 0;
        pressure[count] = alive ? self->band_pressure[place] : 0;
        // A boundary line has no nodes in the band. Its film is of no effect: nothing flows across to it from
        // the exit, where there is no pressure either.
        film[count++] = banded ? film_at(self, z, other, place) : 0;
    }
    reynolds_fluid_evaluate(&fluid, contact, pressure, count);
    double earlier = squeeze ? squeeze->earlier_at(squeeze->context, node) : 0;
    const reynolds_squeeze here = {squeeze ? squeeze->rate : 0, &earlier};
    reynolds_rows(&row, model->grid.step, contact->entrainment, squeeze ? &here : NULL, &stencil, 1,
                  &fluid, pressure, film);

    // flux through the half node before: U rho H - eps dP/dx
    double eps = 0, mass = 0;
    for (int a = NODE_BACK; a <= NODE_HERE; a++) {
        eps += 0.5 * fluid.mobility[a] * film[a] * film[a] * film[a];
        mass += 0.5 * (fluid.density ? fluid.density[a] : 1) * film[a];
    }
    *flux = contact->entrainment * mass -
            eps * (pressure[NODE_HERE] - pressure[NODE_BACK]) / model->grid.step;
    return row;
}

/* Where the exit should be for the present state: back on negative pressure, on where the multiplier
 * is negative; as far as the flux says, within a window. The flux at a node before the rupture is what
 * an unpressurised film carries at the exit. */
static size_t adapt_exit(reduced_solver *self, const reduced_state *state,
                         const ehd_contact *contact) {
    const reduced_model *model = self->model;
    const double *z = state->coordinates;
    size_t exit = state->exit, begin = window_begin(model, exit), from = exit, end = exit - 1;
    size_t window = (size_t)(WINDOW / model->grid.step) + 2;
    size_t node = exit > begin + window ? exit - window : begin;
    double flux;

    nodes_expand_band(self, z, begin, exit);
    while (node < exit && self->band_pressure[node - model->band.lines[0].begin] >= -NOISE)
        node++;
    if (node < exit) {
        from = node > model->band.lines[0].begin + 2 ? node : model->band.lines[0].begin + 2;
        band_row(self, z, from, contact, NULL, &flux);
    } else {
        reynolds_row row = band_row(self, z, exit, contact, NULL, &flux);
        if (row.residual <= 0) return exit;
        from = exit + 1;
        end = exit + window < model->band.lines[0].max_exit ? exit + window
                                                            : model->band.lines[0].max_exit;
    }
    for (node = from; node < end; node++)
        if (contact->entrainment * film_at(self, z, node, reduced_model_band_place(model, node)) >=
            flux)
            break;
    node = node > model->band.lines[0].min_exit ? node : model->band.lines[0].min_exit;
    return node < model->band.lines[0].max_exit ? node : model->band.lines[0].max_exit;
}

/* With a film that varies in time, and across the lines of a point contact, there is no such flux: the exit of a
 * line goes by the signs of pressure and multiplier at each node of the window. In time a node that leaves or enters
 * with a pressure changes the film at once, and with it the multipliers of a whole region, which would ask for nodes
 * whose pressure is negative: these stay outside on a point contact, where exits would not come to rest otherwise. */
static size_t exit_by_signs(reduced_solver *self, const double *z, size_t line, size_t window,
                            const ehd_contact *contact, const reduced_squeeze *squeeze) {
    const reduced_model *model = self->model;
    const band_line *band = &model->band.lines[line];
    const double *pressure = self->band_pressure + band->offset;
    size_t exit = self->exit[line], first = line * grid_width(&model->grid);
    size_t column = exit > band->begin + window ? exit - window : band->begin;
    size_t end = exit + window < band->max_exit ? exit + window : band->max_exit;
    double ignored;

    while (column < exit && pressure[column - band->begin] >= -NOISE)
        column++;
    if (column < exit) return column > band->min_exit ? column : band->min_exit;
    bool by_pressure = squeeze && model->band.num_lines > 1;
    while (column < end && !(by_pressure && pressure[column - band->begin] < -NOISE) &&
           band_row(self, z, first + column, contact, squeeze, &ignored).residual > 0)
        column++;
    return column;
}

static size_t adapt_exit_in_time(reduced_solver *self, const reduced_state *state,
                                 const ehd_contact *contact, const reduced_squeeze *squeeze) {
    const reduced_model *model = self->model;
    size_t window = (size_t)(WINDOW / model->grid.step) + 2;

    nodes_expand_band(self, state->coordinates, window_begin(model, state->exit), state->exit);
    return exit_by_signs(self, state->coordinates, 0, window, contact, squeeze);
}

/* P and H at the band nodes around the exit line: as far as rows at the exits of a line and of those beside it need
 * them, P in the whole window, what the modes say behind the exit too. */
static void expand_around(reduced_solver *self, const double *z, size_t window) {
    const reduced_model *model = self->model;

    nodes_expand_runs(self, z);
    for (size_t l = 0; l < model->band.num_lines; l++) {
        const band_line *band = &model->band.lines[l];
        size_t exit = self->exit[l], first = exit, last = exit + 1, reach = window + 2;
        if (!reduced_model_has_band(model, l)) continue;
        for (size_t beside = l > 0 ? l - 1 : 0; beside <= l + 1 && beside < model->band.num_lines;
             beside++) {
            if (!reduced_model_has_band(model, beside)) continue;
            first = self->exit[beside] < first ? self->exit[beside] : first;
            last = self->exit[beside] > last ? self->exit[beside] : last;
        }
        size_t from = first < exit - 2 ? first : exit - 2;
        take_films(self, z, l * grid_width(&model->grid) + from, last + 1 - from);
        first = first > band->begin + reach ? first - reach : band->begin;
        size_t end = exit + window < band->end ? exit + window : band->end;
        nodes_expand_places(self, z, band->offset + first - band->begin, end - first);
    }
}

/* Whether the exit is looked for on a line: on inner lines `spacing` apart, and the last one. */
static bool is_looked_at(const reduced_solver *self, size_t line) {
    const ehd_grid *grid = &self->model->grid;
    size_t spacing = (size_t)(self->settings.exit_spacing / grid->step);
    size_t inner = line - grid_first_line(grid);

    if (!reduced_model_has_band(self->model, line)) return false;
    return spacing < 2 || inner % spacing == 0 || inner + 1 == grid->inner_lines;
}

/* Exits of the lines between those that are looked at. */
static void fill_between(size_t *exits, const reduced_solver *self) {
    const ehd_grid *grid = &self->model->grid;
    size_t first = grid_first_line(grid), before = first;

    for (size_t l = first + 1; l < first + grid->inner_lines; l++) {
        if (!is_looked_at(self, l)) continue;
        double slope = ((double)exits[l] - (double)exits[before]) / (double)(l - before);
        for (size_t i = before + 1; i < l; i++) {
            const band_line *band = &self->model->band.lines[i];
            size_t exit = (size_t)lround((double)exits[before] + slope * (double)(i - before));
            exits[i] = exit < band->min_exit   ? band->min_exit
                       : exit > band->max_exit ? band->max_exit
                                               : exit;
        }
        before = l;
    }
}

/* Where the exits should be, into self->wanted; on lines that are not looked at, where they are. */
static void find_exits(reduced_solver *self, const reduced_state *state, const ehd_contact *contact,
                       const reduced_squeeze *squeeze) {
    const reduced_model *model = self->model;
    size_t window = (size_t)(WINDOW / model->grid.step) + 2;

    self->search++;
    if (model->band.num_lines == 1) {
        self->wanted[0] = squeeze ? adapt_exit_in_time(self, state, contact, squeeze)
                                  : adapt_exit(self, state, contact);
        return;
    }
    expand_around(self, state->coordinates, window);
    for (size_t l = 0; l < model->band.num_lines; l++)
        self->wanted[l] = is_looked_at(self, l)
                              ? exit_by_signs(self, state->coordinates, l, window, contact, squeeze)
                              : self->exit[l];
}

/* How far an exit may be kept from where it should be: a node or two do not move the film, more do. */
static size_t settled_distance(const reduced_model *model) {
    return (size_t)(SETTLED / model->grid.step) + 1;
}

bool exits_settled(const reduced_solver *self) {
    const reduced_model *model = self->model;
    size_t sum = 0;

    for (size_t l = 0; l < model->band.num_lines; l++)
        sum += index_distance(self->wanted[l], self->exit[l]);
    return sum <= settled_distance(model) * model->grid.inner_lines;
}

exit_watch exits_stationary_watch(const reduced_model *model, double tolerance) {
    const double coarse = 1e-5;

    return (exit_watch){.most_turns = 0,
                        .near = settled_distance(model),
                        .small = tolerance < coarse ? 1e-3 : 5e-3,
                        .stalled = 5e-3,
                        .change = INFINITY};
}

exit_watch exits_watch_in_time(double stalled) {
    return (exit_watch){.most_turns = 1, .near = 1, .stalled = stalled, .change = INFINITY};
}

/* `change` of the pressure in this iteration. */
static size_t watch_exit(exit_watch *watch, double change, size_t exit, size_t next) {
    const double decrease = 0.6; // that is none
    int direction = next > exit ? 1 : next < exit ? -1 : 0;
    bool near = index_distance(next, exit) <= watch->near;
    bool stalls = change < watch->stalled && change > decrease * watch->change;
    bool cycles = near && (change < watch->small || stalls);

    watch->change = change;
    if (direction && watch->direction && direction != watch->direction) watch->turns++;
    if (direction) watch->direction = direction;
    if (watch->turns == 0) return next;
    if (watch->turns > (cycles ? watch->most_turns : 3)) return exit;
    return (size_t)((ptrdiff_t)exit + direction);
}

void exits_watch(reduced_solver *self, exit_watch watch) {
    for (size_t l = 0; l < self->model->band.num_lines; l++)
        self->watches[l] = watch;
}

bool exits_adapt(reduced_info *info, reduced_solver *self, reduced_state *state,
                 const ehd_contact *contact, const reduced_squeeze *squeeze, double change) {
    const reduced_model *model = self->model;
    double start = program_seconds();

    find_exits(self, state, contact, squeeze);
    for (size_t l = 0; l < model->band.num_lines; l++)
        self->moved[l] = watch_exit(&self->watches[l], change, self->exit[l], self->wanted[l]);
    if (model->band.num_lines > 1) fill_between(self->moved, self);
    bool moved = memcmp(self->moved, self->exit, model->band.num_lines * sizeof *self->moved) != 0;
    reduced_state_set_exits(state, model, self->moved);
    info->seconds_exit += program_seconds() - start;
    return moved;
}
