/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/online/time_indicator.h"

#include "romrun/model/reduced_cut.h"

#include <cblas.h>
#include <math.h>
#include <stdlib.h>

enum { NUM_INLET = 12, NUM_INSIDE = 12, MOST_NODES = NUM_INLET + NUM_INSIDE };

// X between which films are formed and then carried unchanged, and behind which the constriction
// settles them anew; denser towards the entry, where a residual enters with a larger share
static const double FAR_INLET = -2.6, ENTRY = -0.85, CONSTRICTION = 0.6, DENSER = 1.7;
static const double CENTRE = 0.1, ARRIVING = 0.3; // of a film's errors the largest that far away

void time_indicator_free(time_indicator *self) {
    film_errors_free(&self->errors);
    arena_free(&self->memory);
}

// ---- control nodes

/* Adds the node of the central line nearest to X, unless it is the last one. */
static void add_node(time_indicator *self, double x) {
    const ehd_grid *grid = &self->model->grid;
    const size_t margin = 4; // columns that the stencils reach
    const size_t begin = grid_central_line(grid), last = grid_width(grid) - 1 - margin;
    const double columns = round((x - grid_x(grid, begin)) / grid->step);
    const size_t column = (size_t)fmin(fmax(columns, (double)margin), (double)last);

    if (self->num_nodes > 0 && begin + column <= self->node[self->num_nodes - 1]) return;
    self->x[self->num_nodes] = grid_x(grid, begin + column);
    self->node[self->num_nodes++] = begin + column;
}

static void choose_nodes(time_indicator *self) {
    for (size_t i = NUM_INLET; i-- > 0;)
        add_node(self, ENTRY + (FAR_INLET - ENTRY) * pow((double)i / (NUM_INLET - 1), DENSER));
    self->num_inlet = self->num_nodes;
    for (size_t i = 1; i <= NUM_INSIDE; i++)
        add_node(self, ENTRY + (CONSTRICTION - ENTRY) * (double)i / NUM_INSIDE);
}

static int compare_indices(const void *a, const void *b) {
    const size_t p = *(const size_t *)a, q = *(const size_t *)b;

    return p < q ? -1 : p > q;
}

/* Stencils of indices in needed_node, which are these of all stencils. */
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
    for (size_t i = 0; i < self->num_nodes; i++)
        for (size_t a = 0; a < NUM_STENCIL; a++) {
            size_t *node = &self->stencils[i].node[a];
            if (*node == NO_NODE) continue;
            const size_t *found =
                bsearch(node, needed, self->num_needed, sizeof *needed, compare_indices);
            *node = (size_t)(found - needed);
        }
}

ehd_status time_indicator_init(time_indicator *self, const reduced_model *model, ehd_error *error) {
    const size_t most = MOST_NODES, most_needed = most * NUM_STENCIL;
    arena *memory = &self->memory;

    *self = (time_indicator){.model = model, .entry = ENTRY};
    self->node = arena_array(memory, most, sizeof *self->node);
    self->x = arena_array(memory, most, sizeof(double));
    self->stencils = arena_array(memory, most, sizeof *self->stencils);
    self->needed_node = arena_array(memory, most_needed, sizeof *self->needed_node);
    self->pressure = arena_array(memory, most_needed, sizeof(double));
    self->film = arena_array(memory, most_needed, sizeof(double));
    self->fluid_memory = arena_array(memory, NUM_FLUID_ARRAYS * most_needed, sizeof(double));
    self->previous = arena_array(memory, most, sizeof(double));
    self->entrained = arena_array(memory, most, sizeof(double));
    self->share = arena_array(memory, most, sizeof(double));
    self->rows = arena_array(memory, most, sizeof *self->rows);
    self->residual = arena_array(memory, most, sizeof(double));
    ehd_status status = film_errors_init(&self->errors, error);
    if (!status && memory->failed)
        status = ehd_fail(error, EHD_MEMORY, "online solver: found no memory");
    if (status) {
        time_indicator_free(self);
        return status;
    }
    choose_nodes(self);
    list_needed(self);
    return EHD_OK;
}

// ---- residuals

static void expand(time_indicator *self, const previous_film *state, const film_splines *splines) {
    const reduced_model *model = self->model;
    const size_t *exit = reduced_state_exits(&state->state), num = model->num_pressure;

    for (size_t q = 0; q < self->num_needed; q++) {
        const size_t node = self->needed_node[q];
        const bool before =
            reduced_model_column(model, node) < exit[reduced_model_line(model, node)];
        self->pressure[q] = before ? cblas_ddot((int)num, splines->pressure_basis + node * num, 1,
                                                state->state.coordinates, 1)
                                   : 0;
        self->film[q] = previous_film_thickness(state, node, model, splines);
    }
}

/* A source of fluid in the inlet raises the pressure on both sides of it: what flows on into the
 * contact is the part before it of the integral of 1/H^3, which makes the pressure there. */
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
                             const ehd_contact *contact, double rate, const film_splines *splines) {
    const reduced_model *model = self->model;
    const size_t *exit = reduced_state_exits(&state->state);
    const reynolds_squeeze squeeze = {rate, self->previous};
    reynolds_fluid fluid = reynolds_fluid_in(self->fluid_memory, self->num_needed, contact);

    expand(self, state, splines);
    reynolds_fluid_evaluate(&fluid, contact, self->pressure, self->num_needed);
    reynolds_rows(self->rows, &model->grid, contact->entrainment, rate > 0 ? &squeeze : NULL,
                  self->stencils, self->num_nodes, &fluid, self->pressure, self->film);
    for (size_t i = 0; i < self->num_nodes; i++) {
        const size_t node = self->node[i];
        const bool before =
            reduced_model_column(model, node) < exit[reduced_model_line(model, node)];
        self->residual[i] = before ? fabs(self->rows[i].residual) : 0;
    }
    find_shares(self);
}

// ---- what they do to the films

/* An error of the film at a control node, at most all of it, also where it is not a number. */
static double at_most_all(const time_indicator *self, size_t i, double error) {
    const double film = self->film[self->stencils[i].node[NODE_HERE]];

    return error < film ? error : film;
}

/* The error of rho H with which films enter: the fluid that the inlet's residuals add. */
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
    const size_t first = self->num_inlet - 1; // at the entry
    double inside[MOST_NODES];

    film_errors_carry(&self->errors, then, now);
    film_errors_enter(&self->errors, then, now, self->entry, entering(self, entrainment));
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

double time_indicator_central(const time_indicator *self) {
    return film_errors_largest(&self->errors, -CENTRE, CENTRE);
}

double time_indicator_arriving(const time_indicator *self, double x) {
    return film_errors_largest(&self->errors, x - ARRIVING, x);
}
