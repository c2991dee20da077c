/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/solve/exit_search.h"

#include "common/physics/far_field.h"

#include <math.h>
#include <string.h>

/* WINDOW: largest move in one iteration of an exit that is a node, half widths. SETTLED: largest
 * distance between a settled exit and the wanted exit, half widths. A move by a node or two hardly
 * changes the film (README.md, The exit). */
static const double WINDOW = 0.05, SETTLED = 0.005;

/* Magnitude up to which negative pressures are ascribed to the truncated basis and ignored, Hertz
 * pressures. Iterations of a model of scenes/examples/line-in-time: 255 with a magnitude of 1e-5,
 * 265 with 1e-4, and 257 with 1e-7. */
static const double NOISE = 1e-5;

const double exits_near_change = 5e-3;

void exits_init(exit_search *self, const reduced_model *model, double spacing, arena *memory) {
    const exit_band *band = &model->band;

    self->model = model;
    self->spacing = spacing;
    self->wanted = arena_array(memory, band->num_lines, sizeof *self->wanted);
    self->moved = arena_array(memory, band->num_lines, sizeof *self->moved);
    self->watches = arena_array(memory, band->num_lines, sizeof *self->watches);
    self->band_film = arena_array(memory, band->num_nodes, sizeof(double));
    self->band_search = arena_array(memory, band->num_nodes, sizeof *self->band_search);
}

/* The search for the exits of one state. */
typedef struct exit_query {
    exit_search *search;
    node_state *nodes;
    const double *z;
    const ehd_contact *contact;
    const reduced_squeeze *squeeze; // NULL when stationary
    size_t window;                  // number of nodes searched on each side of the exit
} exit_query;

static size_t window_nodes(const reduced_model *model) {
    return (size_t)(WINDOW / model->grid.step) + 2;
}

/* Returns the first band node whose pressure the search before an exit needs. `window`: number of
 * nodes before the exit at which rows are evaluated. */
static size_t window_begin(const reduced_model *model, size_t exit, size_t window) {
    const size_t band_begin = model->band.lines[0].begin;
    size_t base = model->checkpoints.exit[reduced_model_checkpoint(model, &exit)];
    // the stencil of the first row in the window extends upstream of the window
    size_t reach = window + reynolds_reach_back(&model->grid);
    size_t begin = exit > band_begin + reach ? exit - reach : band_begin;

    return begin < base ? begin : base;
}

// ---- film and rows in the band

/* Returns H at a band node. Rows of neighbouring grid lines share nodes, so H at a node is
 * evaluated only once per search. */
static double film_at(const exit_query *query, size_t node, size_t index) {
    exit_search *self = query->search;

    if (self->band_search[index] != self->search) {
        self->band_film[index] = nodes_band_film(query->nodes, query->z, node);
        self->band_search[index] = self->search;
    }
    return self->band_film[index];
}

/* Evaluates H at `count` neighbouring nodes together. */
static void fill_films(const exit_query *query, size_t node, size_t count) {
    exit_search *self = query->search;
    size_t index = reduced_model_band_index(self->model, node);

    nodes_band_films(self->band_film + index, query->nodes, query->z, node, count);
    for (size_t i = index; i < index + count; i++)
        self->band_search[i] = self->search;
}

/* P, H and fluid at the nodes around a band node. */
typedef struct band_stencil {
    reynolds_stencil stencil;
    double pressure[NUM_STENCIL], film[NUM_STENCIL], memory[NUM_FLUID_ARRAYS * NUM_STENCIL];
    reynolds_fluid fluid;
} band_stencil;

/* Computes P at a boundary node of a stencil and, unless `banded`, H. `banded`: the grid line of
 * the node has nodes in the band; grid lines on the boundary have none. */
static void fill_outer_node(double *pressure, double *film, const exit_query *query, size_t node,
                            bool banded) {
    const reduced_model *model = query->search->model;
    const double approach = query->z[model->num_unknowns - 1];
    const double x = grid_x(&model->grid, node), y = grid_y(&model->grid, node);

    if (far_field_is_there(&model->grid))
        *pressure = far_field_pressure(query->contact, approach, x, y).value;
    if (!banded) *film = far_field_film(&model->grid.shape, approach, x, y);
}

static void fill_stencil(band_stencil *around, const exit_query *query, size_t node) {
    const reduced_model *model = query->search->model;
    const reynolds_stencil nodes = reynolds_stencil_at(&model->grid, node);
    const bool across = model->grid.inner_lines > 1;
    const size_t last = grid_width(&model->grid) - 1;
    bool outer[NUM_STENCIL]; // true: boundary node of a point contact
    size_t count = 0;

    for (size_t a = 0; a < NUM_STENCIL; a++) {
        size_t other = nodes.node[a];
        around->stencil.node[a] = NO_NODE;
        if (other == NO_NODE) continue;
        const grid_position at = reduced_model_position(model, other);
        bool banded = reduced_model_has_band(model, at.line);
        if (!banded && (a == NODE_LEFT2 || a == NODE_RIGHT2)) continue;
        around->stencil.node[a] = count;
        bool pressurised = at.column < query->nodes->exit[at.line];
        const band_line *line = &model->band.lines[at.line];
        size_t index = banded ? line->offset + at.column - line->begin : 0;
        around->pressure[count] = pressurised ? query->nodes->band_pressure[index] : 0;
        around->film[count] = banded ? film_at(query, other, index) : 0;
        outer[count] = across && (!banded || at.column == 0 || at.column == last);
        if (outer[count])
            fill_outer_node(&around->pressure[count], &around->film[count], query, other, banded);
        count++;
    }
    around->fluid = reynolds_fluid_in(around->memory, count, query->contact);
    reynolds_fluid_evaluate(&around->fluid, query->contact, around->pressure, count);
    for (size_t i = 0; i < count && around->fluid.density; i++)
        if (outer[i])
            around->fluid.density[i] = 1; // density at zero pressure, see far_field_set_density
}

static double multiplier_at(exit_query *query, size_t node) {
    const reduced_squeeze *squeeze = query->squeeze;
    const double previous = squeeze ? squeeze->previous_at(squeeze->context, node) : 0;
    const reynolds_squeeze here = {squeeze ? squeeze->rate : 0, &previous};
    band_stencil around;
    reynolds_row row;

    fill_stencil(&around, query, node);
    reynolds_rows(&row, &query->search->model->grid, query->contact->entrainment,
                  squeeze ? &here : NULL, &around.stencil, 1, &around.fluid, around.pressure,
                  around.film);
    return exit_multiplier(&row);
}

static double flux_at(exit_query *query, size_t node) {
    band_stencil around;

    fill_stencil(&around, query, node);
    return reynolds_flux(&query->search->model->grid, query->contact->entrainment, &around.stencil,
                         &around.fluid, around.pressure, around.film)
        .residual;
}

// ---- where the exits should be

/* Returns the farthest upstream node that may be the exit of a line contact: the stencil of the row
 * at the node before the exit must lie in the band. */
static size_t first_exit(const reduced_model *model) {
    const band_line *band = &model->band.lines[0];
    const size_t first = band->begin + reynolds_reach_back(&model->grid) + 1;

    return first > band->min_exit ? first : band->min_exit;
}

/* Returns the first node, from `node` to at most `end`, at which the entrained film alone carries
 * the flux. */
static size_t node_with_flux(exit_query *query, double flux, size_t node, size_t end) {
    const reduced_model *model = query->search->model;
    const double speed = query->contact->entrainment;

    while (node < end && speed * film_at(query, node, reduced_model_band_index(model, node)) < flux)
        node++;
    return node;
}

/* Finds the exit of a stationary line contact within the window, and returns it. A negative
 * pressure moves the exit upstream. A negative multiplier at the exit moves the exit downstream. In
 * both cases the search goes downstream from the node with the negative value, to the first node at
 * which the entrained film alone carries the flux. If the exit moved to the negative pressure
 * itself, some iterations would end with an exit ten nodes too far upstream, where all signs are
 * right (scenes/studies/stationary-line: minimum film 1 % off). */
static size_t find_by_flux(exit_query *query) {
    const reduced_model *model = query->search->model;
    const band_line *band = &model->band.lines[0];
    const double *pressure = query->nodes->band_pressure;
    const size_t exit = query->nodes->exit[0], window = query->window;
    const size_t begin = window_begin(model, exit, window);
    const size_t first_row = band->begin + reynolds_reach_back(&model->grid);
    size_t node = exit > begin + window ? exit - window : begin, found = exit;

    nodes_expand_band(query->nodes, query->z, begin, exit);
    node = node > first_row ? node : first_row;
    while (node < exit && pressure[node - band->begin] >= -NOISE)
        node++;
    if (node < exit) {
        found = node_with_flux(query, flux_at(query, node), node, exit - 1);
    } else if (exit < band->max_exit && multiplier_at(query, exit) < 0) {
        const size_t end = exit + window < band->max_exit ? exit + window : band->max_exit;
        found = node_with_flux(query, flux_at(query, exit), exit + 1, end);
    }
    return found > band->min_exit ? found : band->min_exit;
}

/* Finds the exit of a grid line from the signs of pressure and multiplier in the window, and
 * returns it. In a transient run, a node that enters or leaves the pressurised zone with a finite
 * pressure makes the film jump. The multipliers of a whole region then jump too. In a transient
 * point contact, nodes with negative pressure therefore stay outside of the pressurised zone;
 * otherwise the exits do not converge. */
static size_t find_by_signs(exit_query *query, size_t line) {
    const reduced_model *model = query->search->model;
    const band_line *band = &model->band.lines[line];
    const double *pressure = query->nodes->band_pressure + band->offset;
    size_t exit = query->nodes->exit[line], first = line * grid_width(&model->grid);
    size_t window = query->window;
    size_t column = exit > band->begin + window ? exit - window : band->begin;
    size_t end = exit + window < band->max_exit ? exit + window : band->max_exit;
    bool by_pressure = query->squeeze && model->band.num_lines > 1;

    while (column < exit && pressure[column - band->begin] >= -NOISE)
        column++;
    if (column < exit) return column > band->min_exit ? column : band->min_exit;
    while (column < end && !(by_pressure && pressure[column - band->begin] < -NOISE) &&
           multiplier_at(query, first + column) < 0)
        column++;
    return column;
}

/* Computes P and H at the band nodes that the rows at the exits of each grid line and of the
 * neighbouring lines need. P is computed in the whole window. Behind the exit, P is the pressure of
 * the modes before it is set to zero. */
static void expand_around(exit_query *query) {
    const reduced_model *model = query->search->model;
    const size_t *exits = query->nodes->exit;
    const size_t back = reynolds_reach_back(&model->grid);
    const size_t ahead = reynolds_reach_ahead(&model->grid);

    nodes_expand_runs(query->nodes, query->z);
    for (size_t l = 0; l < model->band.num_lines; l++) {
        const band_line *band = &model->band.lines[l];
        size_t exit = exits[l], first = exit, last = exit + ahead, reach = query->window + back;
        if (!reduced_model_has_band(model, l)) continue;
        for (size_t neighbour = l > ahead ? l - ahead : 0;
             neighbour <= l + ahead && neighbour < model->band.num_lines; neighbour++) {
            if (!reduced_model_has_band(model, neighbour)) continue;
            first = exits[neighbour] < first ? exits[neighbour] : first;
            last = exits[neighbour] > last ? exits[neighbour] : last;
        }
        size_t from = first < exit - back ? first : exit - back;
        last = last < band->end ? last : band->end - 1;
        fill_films(query, l * grid_width(&model->grid) + from, last + 1 - from);
        first = first > band->begin + reach ? first - reach : band->begin;
        size_t end = exit + query->window < band->end ? exit + query->window : band->end;
        nodes_expand_range(query->nodes, query->z, band->offset + first - band->begin, end - first);
    }
}

/* Checks whether the exit is searched for on a grid line. The search covers inner lines at
 * distances of `spacing`, and the last inner line. */
static bool is_searched(const exit_search *self, size_t line) {
    const ehd_grid *grid = &self->model->grid;
    size_t spacing = (size_t)(self->spacing / grid->step);
    size_t inner = line - grid_first_line(grid);

    if (!reduced_model_has_band(self->model, line)) return false;
    return spacing < 2 || inner % spacing == 0 || inner + 1 == grid->inner_lines;
}

/* Interpolates the exits of the grid lines on which the exit is not searched for. */
static void interpolate_exits(size_t *exits, const exit_search *self) {
    const ehd_grid *grid = &self->model->grid;
    size_t first = grid_first_line(grid), before = first;

    for (size_t l = first + 1; l < first + grid->inner_lines; l++) {
        if (!is_searched(self, l)) continue;
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

/* Sets self->wanted to the nodes where the exits should be. On grid lines that are not searched,
 * self->wanted is the present exit. */
static void find_exits(exit_query *query) {
    exit_search *self = query->search;
    const reduced_model *model = self->model;
    const size_t *exits = query->nodes->exit;

    self->search++;
    if (model->band.num_lines > 1) {
        expand_around(query);
        for (size_t l = 0; l < model->band.num_lines; l++)
            self->wanted[l] = is_searched(self, l) ? find_by_signs(query, l) : exits[l];
    } else if (query->squeeze) {
        nodes_expand_band(query->nodes, query->z, window_begin(model, exits[0], query->window),
                          exits[0]);
        self->wanted[0] = find_by_signs(query, 0);
    } else {
        self->wanted[0] = find_by_flux(query);
    }
}

/* Returns the multiplier at `node`, divided by its derivative with respect to the pressure at this
 * node. */
static double multiplier_margin(exit_query *query, size_t node) {
    band_stencil around;
    reynolds_row row;

    fill_stencil(&around, query, node);
    reynolds_rows(&row, &query->search->model->grid, query->contact->entrainment, NULL,
                  &around.stencil, 1, &around.fluid, around.pressure, around.film);
    return exit_multiplier(&row) / fabs(row.by_pressure[NODE_HERE]);
}

void exits_margins(double *margin, exit_search *self, node_state *nodes, const double *z,
                   const ehd_contact *contact) {
    const reduced_model *model = self->model;
    exit_query query = {.search = self, .nodes = nodes, .z = z, .contact = contact};

    self->search++;
    expand_around(&query);
    for (size_t l = 0; l < model->band.num_lines; l++) {
        const band_line *band = &model->band.lines[l];
        const size_t exit = nodes->exit[l];
        margin[l] = INFINITY;
        if (!reduced_model_has_band(model, l) || exit <= band->begin) continue;
        margin[l] = nodes->band_pressure[band->offset + exit - 1 - band->begin];
        if (exit < band->max_exit)
            margin[l] =
                fmin(margin[l], multiplier_margin(&query, l * grid_width(&model->grid) + exit));
        margin[l] = fmax(margin[l], 0);
    }
}

// ---- exit in the cell of a node

/* Computes P and H around the last node with pressure. */
static void expand_cell(band_stencil *around, const exit_query *query, size_t node) {
    const reduced_model *model = query->search->model;
    const size_t exit = node + 1, back = reynolds_reach_back(&model->grid);
    const size_t base = model->checkpoints.exit[reduced_model_checkpoint(model, &exit)];
    const size_t first = node - back;

    query->search->search++;
    nodes_expand_band(query->nodes, query->z, first < base ? first : base, exit);
    fill_films(query, first, back + 1 + reynolds_reach_ahead(&model->grid));
    fill_stencil(around, query, node);
}

bool exits_find_cell(exit_search *self, node_state *nodes, reduced_state *state,
                     const ehd_contact *contact, double flux) {
    const exit_query query = {
        .search = self, .nodes = nodes, .z = state->coordinates, .contact = contact};
    const ehd_grid *grid = &self->model->grid;
    band_stencil around;

    if (state->exit < first_exit(self->model)) return false;
    expand_cell(&around, &query, state->exit - 1);
    if (isnan(state->exit_offset)) {
        const double place = exit_place(grid, contact->entrainment, flux, NULL, &around.stencil,
                                        &around.fluid, around.film);
        if (isnan(place)) return false;
        state->exit_offset = fmin(fmax(place, 0), 1);
    }
    exit_cell_at(&self->cell, grid, contact->entrainment, state->exit_offset, flux, &around.stencil,
                 &around.fluid, around.pressure, around.film);
    if (self->cell.curvature > 0) return true;
    state->exit_offset = NAN;
    return false;
}

double exits_place(exit_search *self, node_state *nodes, const reduced_state *state,
                   const ehd_contact *contact, const reduced_squeeze *squeeze) {
    const exit_query query = {
        .search = self, .nodes = nodes, .z = state->coordinates, .contact = contact};
    const reduced_model *model = self->model;
    const size_t node = state->exit - 1;
    double previous[3];
    band_stencil around;

    if (!exit_is_within_node(&model->grid) || state->exit < first_exit(model)) return NAN;
    expand_cell(&around, &query, node);
    for (size_t i = 0; squeeze && i < 3; i++)
        previous[i] = squeeze->previous_at(squeeze->context, node - 1 + i);
    const reynolds_squeeze here = {squeeze ? squeeze->rate : 0, previous};
    const double flux = reynolds_flux(&model->grid, contact->entrainment, &around.stencil,
                                      &around.fluid, around.pressure, around.film)
                            .residual;
    return exit_place(&model->grid, contact->entrainment, flux, squeeze ? &here : NULL,
                      &around.stencil, &around.fluid, around.film);
}

bool exits_move_cell(reduced_state *state, const reduced_model *model, double change) {
    const band_line *band = &model->band.lines[0];
    const double offset = state->exit_offset + change, first = (double)first_exit(model);
    const double exit = (double)state->exit + floor(offset), last = (double)band->max_exit;

    state->exit = (size_t)fmin(fmax(exit, first), last);
    state->exit_offset = exit < first ? 0 : exit > last ? 1 : offset - floor(offset);
    return exit >= first && exit <= last;
}

// ---- moving the exits

/* Returns SETTLED as a number of nodes. */
static size_t settled_distance(const reduced_model *model) {
    return (size_t)(SETTLED / model->grid.step) + 1;
}

bool exits_settled(const exit_search *self, const node_state *nodes) {
    const reduced_model *model = self->model;
    size_t sum = 0;

    for (size_t l = 0; l < model->band.num_lines; l++)
        sum += index_distance(self->wanted[l], nodes->exit[l]);
    return sum <= settled_distance(model) * model->grid.inner_lines;
}

void exits_watch(exit_search *self, bool in_time) {
    self->in_time = in_time;
    for (size_t l = 0; l < self->model->band.num_lines; l++)
        self->watches[l] = (exit_watch){0};
}

/* Returns the node to which the exit of a grid line moves from `exit` (exits_watch). `next`: the
 * node where the signs of pressure and multiplier put the exit. */
static size_t watch_exit(const exit_search *self, exit_watch *watch, double change, size_t exit,
                         size_t next) {
    const int direction = next > exit ? 1 : next < exit ? -1 : 0;
    const bool turns = direction != 0 && watch->direction == -direction;
    const size_t distance = index_distance(next, exit), settled = settled_distance(self->model);
    const bool was_near = watch->distance <= settled;
    const size_t neighbour = next > exit ? exit + 1 : exit - 1;

    if (watch->held || !direction) return exit;
    watch->direction = direction;
    watch->distance = distance;
    watch->turns += turns;
    if (watch->turns == 0) return next;
    if (!self->in_time) {
        const bool near = distance <= settled && change < exits_near_change;
        return watch->turns > (near ? 0 : 3) ? exit : neighbour;
    }
    watch->held = turns && distance == 1;
    return watch->held && !(next > exit && was_near) ? exit : neighbour;
}

bool exits_adapt(exit_search *self, node_state *nodes, reduced_state *state,
                 const ehd_contact *contact, const reduced_squeeze *squeeze, double change) {
    const reduced_model *model = self->model;
    size_t num_lines = model->band.num_lines;
    exit_query query = {.search = self,
                        .nodes = nodes,
                        .z = state->coordinates,
                        .contact = contact,
                        .squeeze = squeeze,
                        .window = window_nodes(model)};

    if (self->in_time && num_lines == 1 && change > exits_near_change) return false;
    find_exits(&query);
    for (size_t l = 0; l < num_lines; l++)
        self->moved[l] =
            watch_exit(self, &self->watches[l], change, nodes->exit[l], self->wanted[l]);
    if (num_lines > 1) interpolate_exits(self->moved, self);
    bool moved = memcmp(self->moved, nodes->exit, num_lines * sizeof *self->moved) != 0;
    reduced_state_set_exits(state, model, self->moved);
    return moved;
}
