/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/trust/time_indicator.h"

#include "romrun/model/reduced_cut.h"
#include "romrun/solve/kept_factors.h"

#include <math.h>
#include <stdlib.h>

/* NUM_EACH: number of control nodes in the inlet, and also inside of the contact (README.md, Error
 * estimates in time). */
enum { NUM_EACH = 12, MOST_NODES = 2 * NUM_EACH };

// Limits X of the control nodes, half widths. Films form between FAR_INLET and ENTRY. The
// fluid then carries them unchanged to CONSTRICTION, and behind it they change again. DENSER:
// exponent that makes nodes denser towards ENTRY, where a larger fraction of a residual enters the
// contact (README.md, Error estimates in time).
static const double FAR_INLET = -2.6, ENTRY = -0.85, CONSTRICTION = 0.6, DENSER = 1.7;
// The estimate is the largest carried error within these distances, half widths: CENTRE before the
// centre, BEHIND_CENTRE behind the centre, and ARRIVING before the minimum film. The distances are
// needed because short waves behind a front move more slowly than the fluid. The largest error of
// the central film was compared with its bound. In 20 histories (scenes/studies/silent-in-time,
// calibration seed 1000007) the error is 5.7 times the bound if BEHIND_CENTRE is 0.1, and 1.4 times
// the bound if it is 0.3 or more. In 75 other histories the error is 1.4 times the bound if
// BEHIND_CENTRE is 0.4 or more (README.md, Error estimates in time).
static const double CENTRE = 0.1, BEHIND_CENTRE = 0.4, ARRIVING = 0.3;

void time_indicator_free(time_indicator *self) {
    arena_free(&self->memory);
}

// ---- control nodes

/* Adds the node of the central grid line nearest to X, if it lies behind the last added node. */
static void add_node(time_indicator *self, double x) {
    const ehd_grid *grid = &self->model->grid;
    enum { MARGIN = 4 }; // number of columns that a stencil reaches on each side
    const size_t begin = grid_central_line(grid), last = grid_width(grid) - 1 - MARGIN;
    const double columns = round((x - grid_x(grid, begin)) / grid->step);
    const size_t column = (size_t)fmin(fmax(columns, (double)MARGIN), (double)last);

    if (self->num_nodes > 0 && begin + column <= self->node[self->num_nodes - 1]) return;
    self->x[self->num_nodes] = grid_x(grid, begin + column);
    self->node[self->num_nodes++] = begin + column;
}

static void choose_nodes(time_indicator *self) {
    for (size_t i = NUM_EACH; i-- > 0;)
        add_node(self, ENTRY + (FAR_INLET - ENTRY) * pow((double)i / (NUM_EACH - 1), DENSER));
    self->num_inlet = self->num_nodes;
    for (size_t i = 1; i <= NUM_EACH; i++)
        add_node(self, ENTRY + (CONSTRICTION - ENTRY) * (double)i / NUM_EACH);
}

static int compare_indices(const void *a, const void *b) {
    const size_t p = *(const size_t *)a, q = *(const size_t *)b;

    return p < q ? -1 : p > q;
}

/* Returns the index of a node in an ascending list, or NO_NODE. */
static size_t index_of(size_t node, const size_t *nodes, size_t num) {
    const size_t *found = bsearch(&node, nodes, num, sizeof *nodes, compare_indices);

    return found ? (size_t)(found - nodes) : NO_NODE;
}

/* Returns the index in model->rows.needed_node of the node needed_node[q] of the indicator. Returns
 * NO_NODE if the rows of the model do not need this node. */
static size_t find_among(const time_indicator *self, size_t q) {
    const row_set *rows = &self->model->rows;

    return index_of(self->needed_node[q], rows->needed_node, rows->num_needed);
}

/* Lists the nodes of all stencils in needed_node, and fills the stencils with indices into this
 * list. */
static void list_needed(time_indicator *self) {
    size_t num = 0, *needed = self->needed_node;

    for (size_t i = 0; i < self->num_nodes; i++) {
        self->stencils[i] = reynolds_stencil_at(&self->model->grid, self->node[i]);
        for (size_t a = 0; a < NUM_STENCIL; a++)
            if (self->stencils[i].node[a] != NO_NODE) needed[num++] = self->stencils[i].node[a];
    }
    qsort(needed, num, sizeof *needed, compare_indices);
    for (size_t i = 0; i < num; i++)
        if (i == 0 || needed[i] != needed[self->num_needed - 1])
            needed[self->num_needed++] = needed[i];
    self->num_fixed = self->num_needed;
    for (size_t i = 0; i < self->num_nodes; i++)
        for (size_t a = 0; a < NUM_STENCIL; a++) {
            size_t *node = &self->stencils[i].node[a];
            if (*node != NO_NODE) *node = index_of(*node, needed, self->num_needed);
        }
    for (size_t q = 0; q < self->num_needed; q++)
        self->among[q] = find_among(self, q);
}

// ---- around the exit

/* Returns the number of control nodes on each side of the exit: one more than the number of nodes
 * by which the exit may have moved since the Jacobian was made. */
static size_t reach_at_exit(const reduced_model *model) {
    return kept_factors_reach(model) + 1;
}

/* Returns the index of a node among the needed nodes around the exit. Adds a missing node. */
static size_t need(time_indicator *self, size_t node) {
    for (size_t q = self->num_fixed; q < self->num_needed; q++)
        if (self->needed_node[q] == node) return q;
    self->needed_node[self->num_needed] = node;
    self->among[self->num_needed] = find_among(self, self->num_needed);
    return self->num_needed++;
}

void time_indicator_place(time_indicator *self, const reduced_state *state) {
    const reduced_model *model = self->model;
    const size_t first = grid_central_line(&model->grid), l = reduced_model_line(model, first);
    const band_line *line = &model->band.lines[l];

    const bool none = !state || !reduced_model_has_band(model, l);
    const size_t exit = none ? 0 : reduced_state_exits(state)[l], reach = reach_at_exit(model);

    if (exit == self->placed) return;
    self->placed = exit;
    self->num_at_exit = 0;
    self->num_needed = self->num_fixed;
    if (none) return;
    const size_t begin = exit > line->begin + reach ? exit - reach : line->begin;
    const size_t inner = grid_width(&model->grid) - 1, end = line->end < inner ? line->end : inner;
    for (size_t c = begin; c < exit + reach && c < end; c++) {
        const size_t i = self->num_nodes + self->num_at_exit;
        self->num_at_exit++;
        self->node[i] = first + c;
        self->row[i] = reduced_model_row(model, self->node[i]);
        self->stencils[i] = reynolds_stencil_at(&model->grid, first + c);
        for (size_t a = 0; a < NUM_STENCIL; a++) {
            size_t *node = &self->stencils[i].node[a];
            if (*node != NO_NODE) *node = need(self, *node);
        }
    }
}

// ---- memory

ehd_status time_indicator_init(time_indicator *self, const reduced_model *model, ehd_error *error) {
    const size_t most = MOST_NODES + 2 * reach_at_exit(model), most_needed = most * NUM_STENCIL;
    arena *memory = &self->memory;

    *self = (time_indicator){.model = model, .entry = ENTRY};
    self->node = arena_array(memory, most, sizeof *self->node);
    self->row = arena_array(memory, most, sizeof *self->row);
    self->x = arena_array(memory, most, sizeof(double));
    self->stencils = arena_array(memory, most, sizeof *self->stencils);
    self->needed_node = arena_array(memory, most_needed, sizeof *self->needed_node);
    self->among = arena_array(memory, most_needed, sizeof *self->among);
    self->pressure = arena_array(memory, most_needed, sizeof(double));
    self->film = arena_array(memory, most_needed, sizeof(double));
    self->fluid_memory = arena_array(memory, NUM_FLUID_ARRAYS * most_needed, sizeof(double));
    self->previous = arena_array(memory, most, sizeof(double));
    self->entrained = arena_array(memory, most, sizeof(double));
    self->share = arena_array(memory, most, sizeof(double));
    self->rows = arena_array(memory, most, sizeof *self->rows);
    self->residual = arena_array(memory, most, sizeof(double));
    if (memory->failed) {
        time_indicator_free(self);
        return ehd_no_memory(error, "online solver");
    }
    choose_nodes(self);
    for (size_t i = 0; i < self->num_nodes; i++)
        self->row[i] = reduced_model_row(model, self->node[i]);
    list_needed(self);
    return EHD_OK;
}

// ---- residuals

/* Computes P and H at the needed nodes. At nodes that the solver also needs, takes both values from
 * the solver. */
static void expand(time_indicator *self, const previous_film *state, const reduced_solver *solver) {
    const reduced_model *model = self->model;
    const size_t *exit = reduced_state_exits(&state->state);
    const reduced_needed known = reduced_needed_fields(solver);

    for (size_t q = 0; q < self->num_needed; q++) {
        const size_t node = self->needed_node[q], among = self->among[q];
        if (among != NO_NODE) {
            self->pressure[q] = known.pressure[among];
            self->film[q] = known.film[among];
            continue;
        }
        const bool before =
            reduced_model_column(model, node) < exit[reduced_model_line(model, node)];
        self->pressure[q] = before ? previous_film_pressure(state, node) : 0;
        self->film[q] = previous_film_thickness(state, node);
    }
}

/* Finds, for each control node of the inlet, which fraction of the fluid from a source at this node
 * flows on into the contact. A source raises the pressure on both of its sides. This pressure is an
 * integral of 1/H^3 over X. The wanted fraction is the integral over the part of the inlet upstream
 * of the source, divided by the integral over the whole inlet. */
static void find_shares(time_indicator *self) {
    double before = 0;

    self->share[0] = 0;
    for (size_t i = 0; i < self->num_inlet; i++) {
        const double film = self->film[self->stencils[i].node[NODE_HERE]];
        const double conductance = 1 / (film * film * film);
        if (i > 0)
            self->share[i] =
                self->share[i - 1] + (self->x[i] - self->x[i - 1]) * (conductance + before) / 2;
        before = conductance;
    }
    const double all = self->share[self->num_inlet - 1];
    for (size_t i = 0; i < self->num_inlet && all > 0; i++)
        self->share[i] /= all;
}

void time_indicator_evaluate(time_indicator *self, const previous_film *state,
                             const reduced_solver *solver, const ehd_contact *contact,
                             double rate) {
    const reduced_model *model = self->model;
    const size_t *exit = reduced_state_exits(&state->state);
    const size_t num_nodes = self->num_nodes + self->num_at_exit;
    const reynolds_squeeze squeeze = {rate, self->previous};
    reynolds_fluid fluid = reynolds_fluid_in(self->fluid_memory, self->num_needed, contact);

    expand(self, state, solver);
    reynolds_fluid_evaluate(&fluid, contact, self->pressure, self->num_needed);
    reynolds_rows(self->rows, &model->grid, contact->entrainment, rate > 0 ? &squeeze : NULL,
                  self->stencils, num_nodes, &fluid, self->pressure, self->film);
    for (size_t i = 0; i < num_nodes; i++) {
        const size_t node = self->node[i];
        const double residual = self->rows[i].residual;
        const bool before =
            reduced_model_column(model, node) < exit[reduced_model_line(model, node)];
        const bool at_exit = i >= self->num_nodes;
        // at a node without pressure (behind the exit, or where all modes are zero) the multiplier
        // is -residual, so only a positive residual, an excess of fluid, is an error
        const bool full = at_exit ? self->pressure[self->stencils[i].node[NODE_HERE]] > 0 : before;
        self->residual[i] = full ? fabs(residual) : at_exit ? fmax(residual, 0) : 0;
    }
    find_shares(self);
}

// ---- effect of the residuals on the films

/* Returns the smaller of two values: an error, and the film at a control node. If the error is NaN,
 * returns the film. */
static double at_most_all(const time_indicator *self, size_t i, double error) {
    const double film = self->film[self->stencils[i].node[NODE_HERE]];

    return error < film ? error : film;
}

/* Returns the error of rho H of the films that enter the contact. This error is caused by the fluid
 * that the residuals in the inlet add. */
static double entering(const time_indicator *self, double entrainment) {
    const size_t last = self->num_inlet - 1;
    double added = 0;

    for (size_t i = 1; i <= last; i++)
        added += (self->x[i] - self->x[i - 1]) / 2 *
                 (self->share[i] * self->residual[i] + self->share[i - 1] * self->residual[i - 1]);
    return at_most_all(self, last, added / entrainment);
}

void time_indicator_carry(time_indicator *self, const contact_frame *then, const contact_frame *now,
                          double entrainment, double step) {
    const size_t first = self->num_inlet - 1; // node at the entry
    const double share = frame_step_share(then, step, &self->model->grid);
    const double entered = self->errors.kept[0]; // error of the films that entered last
    double inside[MOST_NODES];

    film_errors_carry(&self->errors, then, now);
    film_errors_enter(&self->errors, then, now, self->entry,
                      entered + share * (entering(self, entrainment) - entered));
    for (size_t i = first; i < self->num_nodes; i++)
        inside[i] = at_most_all(self, i, step * self->residual[i]);
    film_errors_add(&self->errors, 1, inside + first, self->x + first, self->num_nodes - first);
}

void time_indicator_start(time_indicator *self, double entrainment) {
    const size_t first = self->num_inlet - 1;
    double inside[MOST_NODES] = {0};

    film_errors_set(&self->errors, NULL);
    film_errors_enter(&self->errors, NULL, NULL, INFINITY, entering(self, entrainment));
    for (size_t i = first + 1; i < self->num_nodes; i++) {
        const double added = (self->x[i] - self->x[i - 1]) / 2 *
                             (self->residual[i] + self->residual[i - 1]) / entrainment;
        inside[i] = at_most_all(self, i, inside[i - 1] + added);
    }
    film_errors_add(&self->errors, 1, inside + first, self->x + first, self->num_nodes - first);
}

// ---- residuals of rows

/* Checks whether the last least-squares problem contained the equation at control node i. It did
 * not if the model has no row at this node. `influence` is 0 for rows that the problem did not
 * contain. */
static bool is_solved(const time_indicator *self, const double *influence, size_t i) {
    return self->row[i] != NO_NODE && influence[self->row[i]] != 0;
}

double time_indicator_at_exit(const time_indicator *self, const double *influence) {
    const row_set *rows = &self->model->rows;
    double sum = 0;

    for (size_t i = self->num_nodes; i < self->num_nodes + self->num_at_exit; i++) {
        if (self->residual[i] == 0 || is_solved(self, influence, i)) continue;
        const size_t row = reduced_model_nearest_row(self->model, self->node[i], influence);
        sum += pow(self->residual[i] * rows->weight[row] * influence[row], 2);
    }
    return sqrt(sum);
}

static size_t octave(double length) {
    int exponent;

    frexp(length, &exponent); // length < 2^exponent
    const int index = exponent + NUM_LENGTHS - 2;
    return index < 0 ? 0 : index < NUM_LENGTHS ? (size_t)index : NUM_LENGTHS - 1;
}

void time_indicator_add_local(time_indicator *self, const double errors[NUM_REDUCED_FILMS],
                              const contact_scalars *scalars, const contact_frame *then,
                              const contact_frame *now) {
    const double films[NUM_REDUCED_FILMS] = {
        [REDUCED_CENTRAL_FILM] = scalars->central_film_thickness,
        [REDUCED_MINIMUM_FILM] = scalars->minimum_film_thickness};
    const double length = fmax(scalars->exit_position - scalars->minimum_position,
                               self->model->grid.step); // half widths
    const double path = then ? (now->path - then->path) / now->half_width : 0;
    const size_t here = octave(length);
    local_errors *local = &self->local;

    *local = then ? self->kept_local : (local_errors){0};
    local->length[here] = length;
    for (size_t l = 0; l < NUM_LENGTHS; l++) {
        if (!(local->length[l] > 0)) continue; // this octave has no errors yet
        const double left = then ? frame_film_ratio(now, then) * exp(-path / local->length[l]) : 0;
        for (int q = 0; q < NUM_REDUCED_FILMS; q++)
            local->of_film[q][l] *= left;
    }
    for (int q = 0; q < NUM_REDUCED_FILMS; q++) {
        const double error = local->of_film[q][here] + errors[q];
        local->of_film[q][here] =
            error < films[q] ? error : films[q]; // not more than the film, also if the error is NaN
    }
}

double time_indicator_local(const time_indicator *self, reduced_film film, double thickness) {
    double sum = 0;

    for (size_t l = 0; l < NUM_LENGTHS; l++)
        sum += self->local.of_film[film][l];
    return fmin(sum, thickness);
}

void time_indicator_keep(time_indicator *self) {
    film_errors_keep(&self->errors);
    self->kept_local = self->local;
}

void time_indicator_clear(time_indicator *self) {
    film_errors_set(&self->errors, NULL);
    self->local = self->kept_local = (local_errors){0};
}

// ---- carried errors of the attempted step

double time_indicator_central(const time_indicator *self) {
    return film_errors_largest(&self->errors, -CENTRE, BEHIND_CENTRE);
}

double time_indicator_arriving(const time_indicator *self, double x) {
    return film_errors_largest(&self->errors, x - ARRIVING, x);
}
