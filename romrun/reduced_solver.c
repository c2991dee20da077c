/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/reduced_solver.h"

#include "common/program/program.h"
#include "romrun/band_minimum.h"
#include "romrun/least_squares.h"

#include <cblas.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Keeps the exit of a line from cycling: after it has turned round it moves by single nodes, and stays where it
 * is after some more turns. Near places that ask for one another, which keeps the pressure from converging,
 * do so for ever: then it stays at once. */
typedef struct exit_watch {
    // it cycles where it turned more often than this, wants to move by so many nodes at most, and the
    // pressure changes by less than `small`, or less than `stalled` and hardly less than before
    int most_turns;
    size_t near;
    double small, stalled;

    double change; // of the pressure, in the last iteration
    int direction, turns;
} exit_watch;

struct reduced_solver {
    const reduced_model *model;
    reduced_settings settings;
    reduced_observer *observer;
    void *observer_context;
    least_squares *least_squares;
    least_squares *kept; // factors of an earlier Jacobian
    double *kept_matrix; // [num_rows + num_deformation + 1, num_unknowns] that Jacobian
    bool has_kept;
    size_t kept_exit, num_kept; // of its rows the first num_kept are Reynolds rows
    size_t *kept_row;           // [num_rows]
    double kept_weight;         // of its closure

    size_t *exit;      // [num_lines] what follows is for; 0: none yet
    bool *alive;       // [num_needed] before the exit
    size_t checkpoint; // of the exit
    cut_run *runs;     // [num_lines] by which the exit differs from that one's
    size_t num_runs;
    double *cut; // [num_cut, num_pressure] the cut table for table_exit, which Jacobians take
    size_t *table_exit;     // [num_lines]; 0: none yet
    double *block;          // [num_rows + 1, CUT_BLOCK] left sides of the system's rows
    size_t *wanted, *moved; // [num_lines] exits asked for, and where they go
    exit_watch *watches;    // [num_lines]
    double *cut_value;      // [num_cut] the exit's cut table times z, which everything else takes
    double *step_cut;       // [num_cut] the same for a step
    reduced_values values, step_values;

    double *pressure, *film;           // [num_needed]
    double *step_pressure, *step_film; // [num_needed]
    double *fluid_memory;              // [4, num_needed]
    double *band_pressure;             // [num_band] P at band nodes, filled where asked for
    reynolds_row *rows;                // [num_rows]
    size_t num_system;                 // rows of the least-squares problem
    size_t *system_row;                // [num_rows] selected rows before the exit
    double *matrix;                    // [num_rows + num_deformation + 1, num_unknowns]
    double *right;                     // [num_rows + num_deformation + 1]
    double *step;                      // [num_unknowns]
    double *start;                     // [num_unknowns] to go back to; also scratch
    double *observed;                  // [2, num_rows]
};

ehd_status reduced_state_init(reduced_state *state, const reduced_model *model, ehd_error *error) {
    bool lines = model->num_lines > 1;

    *state = (reduced_state){.coordinates = calloc(model->num_unknowns, sizeof(double))};
    if (lines) state->exits = calloc(model->num_lines, sizeof *state->exits);
    if (state->coordinates && (state->exits || !lines)) return EHD_OK;
    reduced_state_free(state);
    return ehd_fail(error, EHD_MEMORY, "reduced state: found no memory");
}

void reduced_state_free(reduced_state *state) {
    free(state->coordinates);
    free(state->exits);
    memset(state, 0, sizeof *state);
}

const size_t *reduced_state_exits(const reduced_state *state) {
    return state->exits ? state->exits : &state->exit;
}

void reduced_state_set_exits(reduced_state *state, const reduced_model *model,
                             const size_t *exits) {
    state->exit = exits[grid_central_line(&model->grid) / grid_width(&model->grid)];
    if (state->exits) memmove(state->exits, exits, model->num_lines * sizeof *exits);
}

ehd_status reduced_values_init(reduced_values *values, const reduced_model *model,
                               ehd_error *error) {
    values->pressure = malloc(model->num_needed * sizeof(double));
    values->cut = malloc(model->num_cut * sizeof(double));
    values->checkpoint = model->num_checkpoints; // none
    if (values->pressure && values->cut) return EHD_OK;
    reduced_values_free(values);
    return ehd_fail(error, EHD_MEMORY, "online solver: found no memory");
}

void reduced_values_free(reduced_values *values) {
    free(values->pressure);
    free(values->cut);
    memset(values, 0, sizeof *values);
}

reduced_settings reduced_default_settings(void) {
    reduced_settings settings = {.tolerance = 1e-8, .max_iterations = 40};
    return settings;
}

reduced_solver *reduced_solver_free(reduced_solver *self) {
    if (self) {
        least_squares_free(self->least_squares);
        least_squares_free(self->kept);
        free(self->kept_matrix);
        free(self->kept_row);
        free(self->exit);
        free(self->alive);
        free(self->runs);
        free(self->table_exit);
        free(self->block);
        free(self->wanted);
        free(self->moved);
        free(self->watches);
        free(self->cut);
        free(self->cut_value);
        free(self->step_cut);
        reduced_values_free(&self->values);
        reduced_values_free(&self->step_values);
        free(self->pressure);
        free(self->film);
        free(self->step_pressure);
        free(self->step_film);
        free(self->fluid_memory);
        free(self->band_pressure);
        free(self->rows);
        free(self->system_row);
        free(self->matrix);
        free(self->right);
        free(self->step);
        free(self->start);
        free(self->observed);
        free(self);
    }
    return NULL;
}

ehd_status reduced_solver_create(reduced_solver **solver, const reduced_model *model,
                                 const reduced_settings *settings, ehd_error *error) {
    size_t most_rows = model->num_rows + model->num_deformation + 1;
    size_t num_lines = model->num_lines;
    bool coupled = model->deformation == DEFORMATION_COUPLED;
    size_t block_size = CUT_BLOCK * (model->num_rows + 1);
    reduced_solver *self = calloc(1, sizeof *self);

    *solver = NULL;
    if (!self) return ehd_fail(error, EHD_MEMORY, "online solver: found no memory");
    self->model = model;
    self->settings = *settings;
    self->least_squares = least_squares_create(most_rows, model->num_unknowns);
    self->kept = least_squares_create(most_rows, model->num_unknowns);
    self->kept_matrix = malloc(most_rows * model->num_unknowns * sizeof(double));
    self->kept_row = malloc(model->num_rows * sizeof *self->kept_row);
    self->exit = calloc(num_lines, sizeof *self->exit);
    self->alive = calloc(model->num_needed, sizeof *self->alive);
    self->runs = calloc(num_lines, sizeof *self->runs);
    self->table_exit = calloc(num_lines, sizeof *self->table_exit);
    self->block = malloc(block_size * sizeof(double));
    self->wanted = calloc(num_lines, sizeof *self->wanted);
    self->moved = calloc(num_lines, sizeof *self->moved);
    self->watches = calloc(num_lines, sizeof *self->watches);
    self->cut = malloc((coupled ? 1 : model->num_cut * model->num_pressure) * sizeof(double));
    self->cut_value = malloc(model->num_cut * sizeof(double));
    self->step_cut = malloc(model->num_cut * sizeof(double));
    self->pressure = malloc(model->num_needed * sizeof(double));
    self->film = malloc(model->num_needed * sizeof(double));
    self->step_pressure = malloc(model->num_needed * sizeof(double));
    self->step_film = malloc(model->num_needed * sizeof(double));
    self->fluid_memory = malloc(4 * model->num_needed * sizeof(double));
    self->band_pressure = malloc(model->num_band * sizeof(double));
    self->rows = malloc(model->num_rows * sizeof *self->rows);
    self->system_row = malloc(model->num_rows * sizeof *self->system_row);
    self->matrix = malloc(most_rows * model->num_unknowns * sizeof(double));
    self->right = malloc(most_rows * sizeof(double));
    self->step = malloc(model->num_unknowns * sizeof(double));
    self->start = malloc(model->num_unknowns * sizeof(double));
    self->observed = malloc(2 * model->num_rows * sizeof(double));
    if (!self->least_squares || !self->kept || !self->kept_matrix || !self->kept_row ||
        !self->exit || !self->alive || !self->runs || !self->table_exit || !self->block ||
        !self->wanted || !self->moved || !self->watches || !self->cut || !self->cut_value ||
        !self->step_cut || !self->pressure || !self->film || !self->step_pressure ||
        !self->step_film || !self->fluid_memory || !self->band_pressure || !self->rows ||
        !self->system_row || !self->matrix || !self->right || !self->step || !self->start ||
        !self->observed || reduced_values_init(&self->values, model, error) ||
        reduced_values_init(&self->step_values, model, error)) {
        reduced_solver_free(self);
        return ehd_fail(error, EHD_MEMORY, "online solver: found no memory");
    }
    *solver = self;
    return EHD_OK;
}

void reduced_solver_set_tolerance(reduced_solver *self, double tolerance) {
    self->settings.tolerance = tolerance;
}

void reduced_solver_observe(reduced_solver *self, reduced_observer *observer, void *context) {
    self->observer = observer;
    self->observer_context = context;
}

const size_t *reduced_system_rows(size_t *num_rows, const reduced_solver *self) {
    *num_rows = self->num_system;
    return self->system_row;
}

// ---- the exit's cut

static void move_exit(reduced_solver *self, const size_t *exit) {
    const reduced_model *model = self->model;
    size_t num_lines = model->num_lines, bytes = num_lines * sizeof *exit;

    if (memcmp(self->exit, exit, bytes) == 0) return;
    memcpy(self->exit, exit, bytes);
    for (size_t q = 0; q < model->num_needed; q++) {
        size_t node = model->needed_node[q];
        self->alive[q] = reduced_model_column(model, node) < exit[reduced_model_line(model, node)];
    }
    self->checkpoint = reduced_model_checkpoint(model, exit);
    self->num_runs = reduced_model_runs(
        self->runs, model, model->checkpoint_exit + self->checkpoint * num_lines, exit);
}

static const double *checkpoint_table(const reduced_solver *self) {
    const reduced_model *model = self->model;

    return model->checkpoint_cut + self->checkpoint * model->num_cut * model->num_pressure;
}

/* Brings the cut table of an independent basis to the exit, always from the exit's checkpoint: its bits then depend on
 * the exit alone, and rounding errors do not add up over thousands of steps in time. Of a coupled one the rows of the
 * Jacobian are brought there instead, of which there are fewer (add_runs). */
static void make_cut_table(reduced_solver *self) {
    const reduced_model *model = self->model;
    size_t size = model->num_cut * model->num_pressure, bytes = model->num_lines * sizeof(size_t);

    if (memcmp(self->table_exit, self->exit, bytes) == 0) return;
    memcpy(self->cut, checkpoint_table(self), size * sizeof(double));
    if (self->num_runs > 0)
        reduced_model_change_cut(self->cut, model, self->runs, self->num_runs, NULL);
    memcpy(self->table_exit, self->exit, bytes);
}

// ---- the state at nodes

static void product(double *y, const double *matrix, const double *x, size_t rows, size_t columns) {
    if (rows > 0)
        cblas_dgemv(CblasRowMajor, CblasNoTrans, (int)rows, (int)columns, 1, matrix, (int)columns,
                    x, 1, 0, y, 1);
}

/* P at `count` band nodes from place `first` on. */
static void expand_places(reduced_solver *self, const double *z, size_t first, size_t count) {
    const reduced_model *model = self->model;

    product(self->band_pressure + first, model->band_pressure + first * model->num_pressure, z,
            count, model->num_pressure);
}

/* P at band nodes of a line contact from `from` up to before `to`. */
static void expand_band(reduced_solver *self, const double *z, size_t from, size_t to) {
    if (to > from) expand_places(self, z, from - self->model->band_begin, to - from);
}

/* P at the band nodes by which the exit differs from its checkpoint's. */
static void expand_runs(reduced_solver *self, const double *z) {
    for (size_t r = 0; r < self->num_runs; r++)
        expand_places(self, z, self->runs[r].first, self->runs[r].count);
}

void reduced_values_of(reduced_values *values, const reduced_model *model, const double *z,
                       const size_t *exit) {
    size_t size = model->num_cut * model->num_pressure;

    values->checkpoint = reduced_model_checkpoint(model, exit);
    product(values->pressure, model->needed_pressure, z, model->num_needed, model->num_pressure);
    product(values->cut, model->checkpoint_cut + values->checkpoint * size, z, model->num_cut,
            model->num_pressure);
}

/* values += factor * of; both of the same checkpoint. */
static void add_values(reduced_values *values, double factor, const reduced_values *of,
                       const reduced_model *model) {
    cblas_daxpy((int)model->num_needed, factor, of->pressure, 1, values->pressure, 1);
    cblas_daxpy((int)model->num_cut, factor, of->cut, 1, values->cut, 1);
}

/* P and H (without gap) at the needed nodes, and what the cut table makes of P, for coordinates z at the
 * solver's exit: eq. (36) applied to a vector. `values` may be known. */
static void expand(double *pressure, double *film, double *cut_value, reduced_solver *self,
                   const reduced_values *values, const double *z) {
    const reduced_model *model = self->model;

    for (size_t q = 0; q < model->num_needed; q++)
        pressure[q] = self->alive[q] ? values->pressure[q] : 0;
    memcpy(cut_value, values->cut, model->num_cut * sizeof(double));
    expand_runs(self, z);
    for (size_t r = 0; r < self->num_runs; r++) {
        const cut_run *run = &self->runs[r];
        cblas_dgemv(CblasRowMajor, CblasTrans, (int)run->count, (int)model->num_cut, run->sign,
                    model->left + run->first * model->num_cut, (int)model->num_cut,
                    self->band_pressure + run->first, 1, 1, cut_value, 1);
    }
    if (model->deformation == DEFORMATION_COUPLED)
        memcpy(film, cut_value, model->num_needed * sizeof(double));
    else
        product(film, model->needed_film, z + model->num_pressure, model->num_needed,
                model->num_deformation);
    for (size_t q = 0; q < model->num_needed; q++)
        film[q] += z[model->num_unknowns - 1];
}

/* The same for the state being worked on. */
static void expand_state(reduced_solver *self, const reduced_values *known, const double *z) {
    if (!known || known->checkpoint != self->checkpoint) {
        reduced_values_of(&self->values, self->model, z, self->exit);
        known = &self->values;
    }
    expand(self->pressure, self->film, self->cut_value, self, known, z);
}

/* Load of the pressure expanded last, over the kind's unit. */
static double load_of(const reduced_solver *self) {
    return self->cut_value[self->model->num_cut - 1];
}

/* Place of a node of the band. */
static size_t band_place(const reduced_model *model, size_t node) {
    const band_line *line = &model->lines[reduced_model_line(model, node)];

    return line->offset + reduced_model_column(model, node) - line->begin;
}

/* `film` with what a run of band nodes deflects at a node. */
static double deflect_run(double film, const reduced_solver *self, const cut_run *run,
                          grid_place at) {
    const double *pressure = self->band_pressure + run->first;
    const reduced_model *model = self->model;

    if (run->sign > 0)
        return reduced_model_deflect(film, model, at, run->line, run->column, run->count, pressure);
    return film - reduced_model_deflect(0, model, at, run->line, run->column, run->count, pressure);
}

/* H at one band node at the solver's exit. For the coupled basis the exit's checkpoint gives the deflection of what
 * lies before it, and expand_runs or expand_band must have filled the pressures by which the exit differs. */
static double band_film(const reduced_solver *self, const double *z, size_t node) {
    const reduced_model *model = self->model;
    size_t place = band_place(model, node), num_pressure = model->num_pressure;
    double film = z[model->num_unknowns - 1] + grid_gap(&model->grid, node);

    if (model->deformation == DEFORMATION_INDEPENDENT) {
        const double *basis = model->band_film + place * model->num_deformation;
        return film + cblas_ddot((int)model->num_deformation, basis, 1, z + num_pressure, 1);
    }
    film += cblas_ddot((int)num_pressure,
                       model->checkpoint_band +
                           (self->checkpoint * model->num_band + place) * num_pressure,
                       1, z, 1);
    const grid_place at = reduced_model_place(model, node);
    for (size_t r = 0; r < self->num_runs; r++)
        film = deflect_run(film, self, &self->runs[r], at);
    return film;
}

// ---- exit boundary

static const double WINDOW = 0.05; // around the exit, where it is looked at and moved; half widths
static const double SETTLED = 0.005; // half widths
static const double NOISE = 1e-5;    // negative pressure that the truncated basis may show

static size_t window_begin(const reduced_model *model, size_t exit) {
    size_t base = model->checkpoint_exit[reduced_model_checkpoint(model, &exit)];
    size_t window = (size_t)(WINDOW / model->grid.step) + 2;
    size_t reach = window + 2; // a row at the window's first node has its stencil before it
    size_t begin = exit > model->band_begin + reach ? exit - reach : model->band_begin;

    return begin < base ? begin : base;
}

/* The Reynolds row at a band node, from the state around it; row.residual is -Lambda at the exit. */
static reynolds_row band_row(const reduced_solver *self, const double *z, size_t node,
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
        bool alive =
            reduced_model_column(model, other) < self->exit[reduced_model_line(model, other)];
        pressure[count] = alive ? self->band_pressure[band_place(model, other)] : 0;
        film[count++] = band_film(self, z, other);
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

    expand_band(self, z, begin, exit);
    while (node < exit && self->band_pressure[node - model->band_begin] >= -NOISE)
        node++;
    if (node < exit) {
        from = node > model->band_begin + 2 ? node : model->band_begin + 2;
        band_row(self, z, from, contact, NULL, &flux);
    } else {
        reynolds_row row = band_row(self, z, exit, contact, NULL, &flux);
        if (row.residual <= 0) return exit;
        from = exit + 1;
        end = exit + window < model->most_exit ? exit + window : model->most_exit;
    }
    for (node = from; node < end; node++)
        if (contact->entrainment * band_film(self, z, node) >= flux) break;
    node = node > model->least_exit ? node : model->least_exit;
    return node < model->most_exit ? node : model->most_exit;
}

/* With a film that varies in time, and across the lines of a point contact, there is no such flux: the exit of a
 * line goes by the signs of pressure and multiplier at each node of the window. */
static size_t exit_by_signs(reduced_solver *self, const double *z, size_t line, size_t window,
                            const ehd_contact *contact, const reduced_squeeze *squeeze) {
    const reduced_model *model = self->model;
    const band_line *band = &model->lines[line];
    const double *pressure = self->band_pressure + band->offset;
    size_t exit = self->exit[line], first = line * grid_width(&model->grid);
    size_t column = exit > band->begin + window ? exit - window : band->begin;
    size_t end = exit + window < band->most ? exit + window : band->most;
    double ignored;

    while (column < exit && pressure[column - band->begin] >= -NOISE)
        column++;
    if (column < exit) return column > band->least ? column : band->least;
    while (column < end &&
           band_row(self, z, first + column, contact, squeeze, &ignored).residual > 0)
        column++;
    return column;
}

static size_t adapt_exit_in_time(reduced_solver *self, const reduced_state *state,
                                 const ehd_contact *contact, const reduced_squeeze *squeeze) {
    const reduced_model *model = self->model;
    size_t window = (size_t)(WINDOW / model->grid.step) + 2;

    expand_band(self, state->coordinates, window_begin(model, state->exit), state->exit);
    return exit_by_signs(self, state->coordinates, 0, window, contact, squeeze);
}

/* P at the band nodes around the exit line, as far as rows at the exits of the lines beside a line need them. */
static void expand_around(reduced_solver *self, const double *z, size_t window) {
    const reduced_model *model = self->model;

    expand_runs(self, z);
    for (size_t l = 0; l < model->num_lines; l++) {
        const band_line *band = &model->lines[l];
        size_t first = self->exit[l], reach = window + 2;
        if (band->end == band->begin) continue;
        for (size_t beside = l > 0 ? l - 1 : 0; beside <= l + 1 && beside < model->num_lines;
             beside++)
            if (model->lines[beside].end > model->lines[beside].begin && self->exit[beside] < first)
                first = self->exit[beside];
        first = first > band->begin + reach ? first - reach : band->begin;
        if (first < self->exit[l])
            expand_places(self, z, band->offset + first - band->begin, self->exit[l] - first);
    }
}

/* Whether the exit is looked for on a line: on inner lines `spacing` apart, and the last one. */
static bool is_looked_at(const reduced_solver *self, size_t line) {
    const ehd_grid *grid = &self->model->grid;
    size_t spacing = (size_t)(self->settings.exit_spacing / grid->step);
    size_t inner = line - grid_first_line(grid);

    if (self->model->lines[line].end == self->model->lines[line].begin) return false;
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
            const band_line *band = &self->model->lines[i];
            size_t exit = (size_t)lround((double)exits[before] + slope * (double)(i - before));
            exits[i] = exit < band->least ? band->least : exit > band->most ? band->most : exit;
        }
        before = l;
    }
}

/* Where the exits should be, into self->wanted; on lines that are not looked at, where they are. */
static void find_exits(reduced_solver *self, const reduced_state *state, const ehd_contact *contact,
                       const reduced_squeeze *squeeze) {
    const reduced_model *model = self->model;
    size_t window = (size_t)(WINDOW / model->grid.step) + 2;

    if (model->num_lines == 1) {
        self->wanted[0] = squeeze ? adapt_exit_in_time(self, state, contact, squeeze)
                                  : adapt_exit(self, state, contact);
        return;
    }
    expand_around(self, state->coordinates, window);
    for (size_t l = 0; l < model->num_lines; l++)
        self->wanted[l] = is_looked_at(self, l)
                              ? exit_by_signs(self, state->coordinates, l, window, contact, squeeze)
                              : self->exit[l];
}

// ---- one iteration

static bool is_row_alive(const reduced_solver *self, size_t r) {
    return self->alive[self->model->stencils[r].node[NODE_HERE]];
}

/* The selected rows before the exit. */
static void list_system_rows(reduced_solver *self) {
    self->num_system = 0;
    for (size_t r = 0; r < self->model->num_rows; r++)
        if (is_row_alive(self, r)) self->system_row[self->num_system++] = r;
}

static void evaluate_rows(reduced_solver *self, const ehd_contact *contact,
                          const reduced_squeeze *squeeze, const reduced_values *known,
                          const double *z) {
    const reduced_model *model = self->model;
    size_t num_needed = model->num_needed;
    double *memory = self->fluid_memory;
    bool compressible = contact->lubricant.density != NULL;
    reynolds_fluid fluid = {memory, memory + num_needed,
                            compressible ? memory + 2 * num_needed : NULL,
                            compressible ? memory + 3 * num_needed : NULL};

    expand_state(self, known, z);
    for (size_t q = 0; q < num_needed; q++)
        self->film[q] += model->needed_gap[q];
    reynolds_fluid_evaluate(&fluid, contact, self->pressure, num_needed);
    const reynolds_squeeze rows_squeeze = {squeeze ? squeeze->rate : 0,
                                           squeeze ? squeeze->earlier : NULL};
    reynolds_rows(self->rows, model->grid.step, contact->entrainment,
                  squeeze ? &rows_squeeze : NULL, model->stencils, model->num_rows, &fluid,
                  self->pressure, self->film);
}

static void add_row(double *target, double factor, const double *source, size_t count) {
    for (size_t j = 0; j < count; j++)
        target[j] += factor * source[j];
}

/* target += sum of factors[a] * sources[a], in one pass. */
static void add_rows(double *restrict target, const double factors[NUM_LINE_STENCIL],
                     const double *const sources[NUM_LINE_STENCIL], size_t count) {
    for (size_t j = 0; j < count; j++) {
        double sum = target[j];
        for (int a = 0; a < NUM_LINE_STENCIL; a++)
            sum += factors[a] * sources[a][j];
        target[j] = sum;
    }
}

/* Row of the weighted reduced Jacobian: stencil coefficients times rows of the bases, those of the coupled film at the
 * exit's checkpoint. */
static void fill_reynolds_row(double *target, const reduced_solver *self, size_t r) {
    const reduced_model *model = self->model;
    const reynolds_stencil *stencil = &model->stencils[r];
    const reynolds_row *row = &self->rows[r];
    double weight = model->row_weight[r], approach = 0;
    bool coupled = model->deformation == DEFORMATION_COUPLED;
    size_t width = coupled ? model->num_pressure : model->num_deformation;
    size_t offset = coupled ? 0 : model->num_pressure;
    const double *film = coupled ? checkpoint_table(self) : model->needed_film;

    double by_pressure[NUM_LINE_STENCIL] = {0}, by_film[NUM_LINE_STENCIL] = {0};
    const double *pressures[NUM_LINE_STENCIL], *films[NUM_LINE_STENCIL];

    for (int a = 0; a < NUM_LINE_STENCIL; a++) {
        bool there = stencil->node[a] != NO_NODE;
        size_t q = there ? stencil->node[a] : 0;
        pressures[a] = model->needed_pressure + q * model->num_pressure;
        films[a] = film + q * width;
        if (!there) continue;
        if (self->alive[q]) by_pressure[a] = weight * row->by_pressure[a];
        by_film[a] = weight * row->by_film[a];
        approach += row->by_film[a];
    }
    memset(target, 0, model->num_unknowns * sizeof(double));
    add_rows(target, by_pressure, pressures, model->num_pressure);
    add_rows(target + offset, by_film, films, width);
    for (int a = NODE_LEFT; a <= NODE_RIGHT && stencil->node[a] != NO_NODE; a++) {
        size_t q = stencil->node[a];
        if (self->alive[q])
            add_row(target, weight * row->by_pressure[a],
                    model->needed_pressure + q * model->num_pressure, model->num_pressure);
        add_row(target + offset, weight * row->by_film[a], film + q * width, width);
        approach += row->by_film[a];
    }
    target[model->num_unknowns - 1] = weight * approach;
}

/* Right side of eq. (37): the Reynolds rows listed (those behind the exit count as fulfilled), projected
 * elasticity, closure. Returns the number of rows. */
static size_t fill_right(reduced_solver *self, const double *z, const size_t *list, size_t num_list,
                         const contact_closure *closure, double closure_weight) {
    const reduced_model *model = self->model;
    size_t count = 0;

    for (; count < num_list; count++) {
        size_t r = list[count];
        self->right[count] =
            is_row_alive(self, r) ? model->row_weight[r] * self->rows[r].residual : 0;
    }
    for (size_t j = 0; j < model->num_deformation; j++, count++)
        self->right[count] = z[model->num_pressure + j] - self->cut_value[j];
    self->right[count] =
        closure_weight * (closure->by_load * load_of(self) +
                          closure->by_approach * z[model->num_unknowns - 1] - closure->value);
    return count + 1;
}

/* What a band node's pressure makes of the system's rows: the load balance last, [num_system + 1]. The products are
 * rounded as fill_reynolds_row does, so that a node that is taken away leaves nothing of itself. */
static void weigh_left(double *left, size_t stride, const reduced_solver *self, size_t place,
                       double sign, double load_weight) {
    const reduced_model *model = self->model;
    const double *by_node = model->left + place * model->num_cut;

    for (size_t i = 0; i < self->num_system; i++) {
        size_t r = self->system_row[i];
        const reynolds_stencil *stencil = &model->stencils[r];
        double weight = model->row_weight[r], sum = 0;
        for (int a = 0; a < NUM_STENCIL; a++)
            if (stencil->node[a] != NO_NODE)
                sum += weight * self->rows[r].by_film[a] * by_node[stencil->node[a]];
        left[i * stride] = sign * sum;
    }
    left[self->num_system * stride] = sign * load_weight * by_node[model->num_cut - 1];
}

/* Brings the rows of a coupled basis from the exit's checkpoint to the exit: eq. (36) with the stencils applied to its
 * left sides first. */
static void add_runs(reduced_solver *self, double load_weight) {
    const reduced_model *model = self->model;

    for (size_t r = 0; r < self->num_runs; r++) {
        const cut_run *run = &self->runs[r];
        for (size_t i = 0; i < run->count; i += CUT_BLOCK) {
            size_t rank = run->count - i < CUT_BLOCK ? run->count - i : CUT_BLOCK;
            for (size_t k = 0; k < rank; k++)
                weigh_left(self->block + k, rank, self, run->first + i + k, run->sign, load_weight);
            cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, (int)self->num_system + 1,
                        (int)model->num_pressure, (int)rank, 1, self->block, (int)rank,
                        model->band_pressure + (run->first + i) * model->num_pressure,
                        (int)model->num_pressure, 1, self->matrix, (int)model->num_unknowns);
        }
    }
}

/* The projected elasticity of an independent basis, from row `count` on; returns the row behind. */
static size_t fill_elasticity(reduced_solver *self, size_t count) {
    const reduced_model *model = self->model;
    size_t n = model->num_unknowns, num_pressure = model->num_pressure;

    for (size_t j = 0; j < model->num_deformation; j++, count++) {
        double *row = self->matrix + count * n;
        memset(row, 0, n * sizeof(double));
        add_row(row, -1, self->cut + j * num_pressure, num_pressure);
        row[num_pressure + j] = 1;
    }
    return count;
}

/* Matrix of eq. (38) for the rows of the present system, at the present exit. */
static void fill_matrix(reduced_solver *self, const contact_closure *closure,
                        double closure_weight) {
    const reduced_model *model = self->model;
    size_t n = model->num_unknowns, num_pressure = model->num_pressure, count = 0;
    bool coupled = model->deformation == DEFORMATION_COUPLED;

    if (!coupled) make_cut_table(self);
    const double *load =
        (coupled ? checkpoint_table(self) : self->cut) + (model->num_cut - 1) * num_pressure;
    for (; count < self->num_system; count++)
        fill_reynolds_row(self->matrix + count * n, self, self->system_row[count]);
    count = fill_elasticity(self, count);
    double *row = self->matrix + count * n;
    memset(row, 0, n * sizeof(double));
    add_row(row, closure_weight * closure->by_load, load, num_pressure);
    row[n - 1] = closure_weight * closure->by_approach;
    if (coupled) add_runs(self, closure_weight * closure->by_load);
}

/* Short steps make large rows, among which the closure must not get lost. */
static double closure_weight_for(double rate) {
    return 1 + rate;
}

static const double MOST_PRESSURE_CHANGE = 0.3; // as in the full solver
static const double LEAST_FILM_LEFT = 0.2;

/* Damping factor by the state at the needed nodes; *change is the undamped largest pressure change. */
static double damping(reduced_solver *self, double *change) {
    const reduced_model *model = self->model;
    double least = INFINITY, factor = 1;

    reduced_values_of(&self->step_values, model, self->step, self->exit);
    expand(self->step_pressure, self->step_film, self->step_cut, self, &self->step_values,
           self->step);
    *change = 0;
    for (size_t q = 0; q < model->num_needed; q++) {
        *change = fmax(*change, fabs(self->step_pressure[q]));
        least = fmin(least, self->film[q]);
    }
    if (*change > MOST_PRESSURE_CHANGE) factor = MOST_PRESSURE_CHANGE / *change;
    for (size_t q = 0; q < model->num_needed; q++)
        if (self->step_film[q] < 0)
            factor = fmin(factor, (self->film[q] - LEAST_FILM_LEFT * least) / -self->step_film[q]);
    return factor;
}

static double at_centre(const reduced_model *model, const double *values) {
    double sum = 0;

    for (size_t i = 0; i < 4; i++)
        if (model->centre_weight[i] != 0) sum += model->centre_weight[i] * values[model->centre[i]];
    return sum;
}

/* Hands D f and D J dz of this iteration to the observer, rows behind the exit as zeros. */
static ehd_status observe(reduced_solver *self, ehd_error *error) {
    const reduced_model *model = self->model;
    double *residual = self->observed, *step = self->observed + model->num_rows;

    if (!self->observer) return EHD_OK;
    memset(residual, 0, 2 * model->num_rows * sizeof(double));
    for (size_t i = 0; i < self->num_system; i++) {
        size_t r = self->system_row[i];
        residual[r] = self->right[i];
        step[r] = cblas_ddot((int)model->num_unknowns, self->matrix + i * model->num_unknowns, 1,
                             self->step, 1);
    }
    return self->observer(self->observer_context, residual, step, error);
}

/* The band's film of a state, for band_minimum. */
typedef struct film_of_state {
    const reduced_solver *solver;
    const reduced_state *state;
} film_of_state;

static double film_at(const void *context, size_t node) {
    const film_of_state *self = context;

    return band_film(self->solver, self->state->coordinates, node);
}

static double minimum_film(reduced_solver *self, const reduced_state *state) {
    const film_of_state film = {self, state};
    const reduced_model *model = self->model;
    double least = INFINITY;

    expand_runs(self, state->coordinates);
    for (size_t l = model->first_minimum; l <= model->last_minimum; l++) {
        size_t first = l * grid_width(&model->grid);
        least = fmin(least, band_minimum(film_at, &film, first + model->lines[l].begin,
                                         first + self->exit[l] + 1));
    }
    return least;
}

/* How far an exit may be kept from where it should be: a node or two do not move the film, more do. */
static size_t settled_distance(const reduced_model *model) {
    return (size_t)(SETTLED / model->grid.step) + 1;
}

static bool exits_settled(const reduced_solver *self) {
    const size_t *exit = self->exit, *wanted = self->wanted;

    for (size_t l = 0; l < self->model->num_lines; l++)
        if ((wanted[l] > exit[l] ? wanted[l] - exit[l] : exit[l] - wanted[l]) >
            settled_distance(self->model))
            return false;
    return true;
}

/* Stationary, where the exit goes by the flux. A node's move changes the film by 1e-5 or a few of them: where
 * no more is asked the exit need not be looked for in a converged state. */
static exit_watch stationary_watch(const reduced_model *model, double tolerance) {
    const double coarse = 1e-5;

    return (exit_watch){.most_turns = 0,
                        .near = settled_distance(model),
                        .small = tolerance < coarse ? 1e-3 : 5e-3,
                        .stalled = 5e-3,
                        .change = INFINITY};
}

/* In time; `stalled` is the change of the pressure that a node's move can make. */
static exit_watch watch_in_time(double stalled) {
    return (exit_watch){.most_turns = 1, .near = 1, .stalled = stalled, .change = INFINITY};
}

/* `change` of the pressure in this iteration. */
static size_t watch_exit(exit_watch *watch, double change, size_t exit, size_t next) {
    const double decrease = 0.6; // that is none
    int direction = next > exit ? 1 : next < exit ? -1 : 0;
    bool near = (next > exit ? next - exit : exit - next) <= watch->near;
    bool stalls = change < watch->stalled && change > decrease * watch->change;
    bool cycles = near && (change < watch->small || stalls);

    watch->change = change;
    if (direction && watch->direction && direction != watch->direction) watch->turns++;
    if (direction) watch->direction = direction;
    if (watch->turns == 0) return next;
    if (watch->turns > (cycles ? watch->most_turns : 3)) return exit;
    return (size_t)((ptrdiff_t)exit + direction);
}

static void watch_exits(reduced_solver *self, exit_watch watch) {
    for (size_t l = 0; l < self->model->num_lines; l++)
        self->watches[l] = watch;
}

/* Moves the exits of a state, `change` being that of the pressure in this iteration; false where none moves. */
static bool adapt_exits(reduced_info *info, reduced_solver *self, reduced_state *state,
                        const ehd_contact *contact, const reduced_squeeze *squeeze, double change) {
    const reduced_model *model = self->model;
    double start = program_seconds();

    find_exits(self, state, contact, squeeze);
    for (size_t l = 0; l < model->num_lines; l++)
        self->moved[l] = watch_exit(&self->watches[l], change, self->exit[l], self->wanted[l]);
    if (model->num_lines > 1) fill_between(self->moved, self);
    bool moved = memcmp(self->moved, self->exit, model->num_lines * sizeof *self->moved) != 0;
    reduced_state_set_exits(state, model, self->moved);
    info->seconds_exit += program_seconds() - start;
    return moved;
}

/* Brings the rows and their values to the state, whose values may be known. */
static void evaluate(reduced_info *info, reduced_solver *self, const reduced_state *state,
                     const reduced_values *known, const ehd_contact *contact,
                     const reduced_squeeze *squeeze) {
    double start = program_seconds();
    move_exit(self, reduced_state_exits(state));
    evaluate_rows(self, contact, squeeze, known, state->coordinates);
    info->seconds_rows += program_seconds() - start;
}

/* The least-squares problem at the state; returns the number of its rows. */
static size_t build_system(reduced_info *info, reduced_solver *self, const reduced_state *state,
                           const reduced_values *known, const ehd_contact *contact,
                           const reduced_squeeze *squeeze) {
    double weight = squeeze ? closure_weight_for(squeeze->rate) : 1;
    evaluate(info, self, state, known, contact, squeeze);
    double start = program_seconds();
    list_system_rows(self);
    fill_matrix(self, &contact->closure, weight);
    size_t num_rows = fill_right(self, state->coordinates, self->system_row, self->num_system,
                                 &contact->closure, weight);

    info->residual = cblas_dnrm2((int)num_rows, self->right, 1);
    info->seconds_rows += program_seconds() - start;
    return num_rows;
}

/* Where an iteration has got to. */
typedef struct iterate {
    double film;   // H at X = 0 after the step
    double change; // largest change of P at the needed nodes, undamped
    double factor; // damping
    double rate;   // change over that of the iteration before
} iterate;

/* The step that least squares ask for, undamped. */
static ehd_status solve_step(reduced_solver *self, size_t num_rows) {
    const reduced_settings *settings = &self->settings;

    if (settings->solve_linear)
        return settings->solve_linear(self->step, settings->linear_context, self->matrix,
                                      self->right, num_rows, self->model->num_unknowns);
    return least_squares_solve(self->step, self->least_squares, self->matrix, self->right,
                               num_rows);
}

/* Least squares and damped step. Returns why it failed, or NULL. */
static const char *take_step(iterate *now, const iterate *before, reduced_info *info,
                             reduced_state *state, reduced_solver *self, size_t num_rows) {
    const reduced_model *model = self->model;
    double start = program_seconds();

    if (solve_step(self, num_rows)) return "least squares without a single finite solution";
    now->factor = damping(self, &now->change);
    now->rate = now->change / before->change;
    cblas_daxpy((int)model->num_unknowns, now->factor, self->step, 1, state->coordinates, 1);
    add_values(&self->values, now->factor, &self->step_values, model);
    now->film = at_centre(model, self->film) + now->factor * at_centre(model, self->step_film);
    info->iterations++;
    info->seconds_linear += program_seconds() - start;
    return NULL;
}

static const double PRESSURE_TOLERANCE = 1e-4; // of the Hertz pressure, at most
static const double PRESSURE_OVER_FILM = 1e4;  // of these tolerances
static const double CYCLE = 5e-3;              // that a node's move of the exit may make, in time

/* What another iteration would change, by the observed rate: quadratic convergence makes the next rate its
 * square. What Gauss-Newton leaves of linear convergence is slower than that only where the rate is small. */
static bool converged(const iterate *before, const iterate *now, double tolerance) {
    double rate = fmin(now->rate, 1), next = rate * rate;

    return now->factor == 1 && fabs(now->film - before->film) * next < tolerance * now->film &&
           now->change * next < fmin(PRESSURE_TOLERANCE, PRESSURE_OVER_FILM * tolerance);
}

/* Returns an error only where the observer or memory fails; the outcome is info->status. */
static ehd_status newton(reduced_info *info, reduced_state *state, reduced_solver *self,
                         const ehd_contact *contact, const reduced_squeeze *squeeze,
                         ehd_error *error) {
    iterate before = {NAN, NAN, 0, NAN}, now;

    info->own_jacobian = true;
    watch_exits(self, squeeze ? watch_in_time(CYCLE)
                              : stationary_watch(self->model, self->settings.tolerance));
    for (size_t iteration = 0;; iteration++, before = now) {
        const reduced_values *known = iteration > 0 ? &self->values : NULL;
        size_t num_rows = build_system(info, self, state, known, contact, squeeze);
        info->reason = !isfinite(info->residual)                    ? "residual not finite"
                       : iteration >= self->settings.max_iterations ? "iteration limit reached"
                                                                    : NULL;
        if (!info->reason) info->reason = take_step(&now, &before, info, state, self, num_rows);
        if (info->reason) return EHD_OK;
        ehd_status status = observe(self, error);
        if (status) return status;
        if (!(now.factor > 0)) {
            info->reason = "film would become negative";
            return EHD_OK;
        }

        if (!adapt_exits(info, self, state, contact, squeeze, now.change) &&
            converged(&before, &now, self->settings.tolerance)) {
            bool settled = exits_settled(self);
            info->status = settled ? EHD_OK : EHD_UNTRUSTED;
            info->reason = settled ? "" : "an exit boundary that does not settle";
            return EHD_OK;
        }
    }
}

// ---- with kept factors

static const size_t MOST_KEPT_ITERATIONS = 8;
// changes of P in the L2 norm, which the coordinates in orthonormal modes give on any grid
static const double MOST_KEPT_CHANGE = 2e-3; // in one iteration, beyond which damping might matter
static const double KEPT_TOLERANCE = 7e-6;
static const double KEPT_CYCLE = 3e-4;    // that a node's move of the exit may make
static const double MOST_KEPT_RATE = 0.5; // of convergence

void reduced_drop_factors(reduced_solver *self) {
    self->has_kept = false;
}

void reduced_keep_factors(reduced_solver *self, const reduced_state *state,
                          const ehd_contact *contact, double rate) {
    memset(self->right, 0, self->model->num_rows * sizeof(double)); // the matrix needs no residual
    const reduced_squeeze squeeze = {.rate = rate, .earlier = self->right};
    reduced_info ignored = {0};

    evaluate(&ignored, self, state, NULL, contact, &squeeze);
    list_system_rows(self);
    self->kept_weight = closure_weight_for(rate);
    fill_matrix(self, &contact->closure, self->kept_weight);
    self->kept_exit = state->exit;
    self->num_kept = self->num_system;
    memcpy(self->kept_row, self->system_row, self->num_system * sizeof *self->kept_row);
    size_t num_rows = self->num_system + self->model->num_deformation + 1;
    memcpy(self->kept_matrix, self->matrix, num_rows * self->model->num_unknowns * sizeof(double));
    self->has_kept = least_squares_factorise(self->kept, self->kept_matrix, num_rows) == EHD_OK;
}

/* What a step changes of H at the centre. */
static double central_change(reduced_solver *self) {
    const reduced_model *model = self->model;
    size_t num_pressure = model->num_pressure, num_deformation = model->num_deformation;
    const double *checkpoint = checkpoint_table(self);
    double change = self->step[model->num_unknowns - 1];

    expand_runs(self, self->step);
    for (size_t i = 0; i < 4; i++) {
        size_t q = model->centre[i];
        double film = 0;
        if (model->centre_weight[i] == 0) continue;
        if (model->deformation == DEFORMATION_INDEPENDENT) {
            film = cblas_ddot((int)num_deformation, model->needed_film + q * num_deformation, 1,
                              self->step + num_pressure, 1);
        } else {
            film = cblas_ddot((int)num_pressure, checkpoint + q * num_pressure, 1, self->step, 1);
            for (size_t r = 0; r < self->num_runs; r++)
                for (size_t n = 0, k = self->runs[r].first; n < self->runs[r].count; n++, k++)
                    film += self->runs[r].sign * model->left[k * model->num_cut + q] *
                            self->band_pressure[k];
        }
        change += model->centre_weight[i] * film;
    }
    return change;
}

/* Where the kept iteration has got to. */
typedef struct kept_iterate {
    double change; // of P, L2 norm; NaN before the first
    bool converged;
} kept_iterate;

/* One step; false where it says that the kept factors do not do. */
static bool take_kept_step(kept_iterate *at, reduced_info *info, reduced_state *state,
                           reduced_solver *self, const ehd_contact *contact) {
    const reduced_model *model = self->model;
    const double first_rate = 0.3; // of convergence, before it was observed
    double start = program_seconds(), before = at->change;
    size_t num_rows = fill_right(self, state->coordinates, self->kept_row, self->num_kept,
                                 &contact->closure, self->kept_weight);

    info->residual = cblas_dnrm2((int)num_rows, self->right, 1);
    if (!isfinite(info->residual) ||
        least_squares_again(self->step, self->kept, self->kept_matrix, self->right, num_rows))
        return false;
    at->change = sqrt(model->grid.step) * cblas_dnrm2((int)model->num_pressure, self->step, 1);
    double rate = isnan(before) ? first_rate : at->change / before;
    if (!(at->change < MOST_KEPT_CHANGE && rate < MOST_KEPT_RATE)) return false;
    double film = at_centre(model, self->film), change = central_change(self);
    at->converged =
        fabs(change) * rate < self->settings.tolerance * film && at->change * rate < KEPT_TOLERANCE;
    cblas_daxpy((int)model->num_unknowns, 1, self->step, 1, state->coordinates, 1);
    info->iterations++;
    info->seconds_linear += program_seconds() - start;
    return true;
}

/* Iterates with the kept factors; false where they do not do, and the state is then of no use. */
static bool newton_with_kept(reduced_info *info, reduced_state *state, reduced_solver *self,
                             const ehd_contact *contact, const reduced_squeeze *squeeze) {
    // farther away, rows that the factors lack or have in vain would count
    const size_t most_distance = (size_t)(0.025 / self->model->grid.step);
    watch_exits(self, watch_in_time(KEPT_CYCLE));
    kept_iterate at = {.change = NAN};
    for (size_t iteration = 0; iteration < MOST_KEPT_ITERATIONS; iteration++) {
        evaluate(info, self, state, iteration == 0 ? squeeze->start : NULL, contact, squeeze);
        if (!take_kept_step(&at, info, state, self, contact)) return false;
        bool moved = adapt_exits(info, self, state, contact, squeeze, at.change);
        size_t exit = state->exit;
        if ((exit > self->kept_exit ? exit - self->kept_exit : self->kept_exit - exit) >
            most_distance)
            return false;
        if (!moved && at.converged) {
            info->status = EHD_OK;
            info->reason = "";
            info->own_jacobian = false;
            return exits_settled(self);
        }
        if (moved) at.change = NAN; // another problem
    }
    return false;
}

/* With the kept factors where there are some and they do, else with Jacobians of its own. */
static ehd_status solve(reduced_info *info, reduced_state *state, reduced_solver *self,
                        const ehd_contact *contact, const reduced_squeeze *squeeze,
                        ehd_error *error) {
    size_t bytes = self->model->num_unknowns * sizeof(double), exit = state->exit;

    if (squeeze && self->has_kept && !self->observer) {
        memcpy(self->start, state->coordinates, bytes);
        if (newton_with_kept(info, state, self, contact, squeeze)) return EHD_OK;
        info->status = EHD_NOT_CONVERGED;
        memcpy(state->coordinates, self->start, bytes);
        state->exit = exit;
    }
    return newton(info, state, self, contact, squeeze, error);
}

contact_scalars reduced_scalars(reduced_solver *self, const reduced_state *state) {
    contact_scalars scalars;
    const reduced_model *model = self->model;

    move_exit(self, reduced_state_exits(state));
    expand_state(self, NULL, state->coordinates);
    for (size_t q = 0; q < model->num_needed; q++)
        self->film[q] += model->needed_gap[q];
    scalars.central_film_thickness = at_centre(model, self->film);
    scalars.central_pressure = at_centre(model, self->pressure);
    scalars.minimum_film_thickness = minimum_film(self, state);
    // in time a dip passes through the front of the contact too, where only the needed nodes are known
    for (size_t q = 0; q < model->num_needed; q++)
        if (self->alive[q])
            scalars.minimum_film_thickness = fmin(scalars.minimum_film_thickness, self->film[q]);
    scalars.rigid_approach = state->coordinates[model->num_unknowns - 1];
    scalars.exit_position = grid_x(&model->grid, state->exit);
    scalars.load = load_of(self) / model->kind->load;
    return scalars;
}

double reduced_left_residual(const reduced_solver *self) {
    size_t n = self->model->num_unknowns;
    size_t num_rows = self->num_system + self->model->num_deformation + 1;
    double sum = 0;

    for (size_t r = 0; r < num_rows; r++) {
        double left = self->right[r] + cblas_ddot((int)n, self->matrix + r * n, 1, self->step, 1);
        sum += left * left;
    }
    return sqrt(sum);
}

/* dH/dz at a needed node, times a factor, added to a row of the film's coordinates. */
static void add_film_row(double *target, double factor, const reduced_solver *self, size_t q) {
    const reduced_model *model = self->model;
    size_t num_pressure = model->num_pressure, num_deformation = model->num_deformation;

    if (model->deformation == DEFORMATION_INDEPENDENT) {
        add_row(target, factor, model->needed_film + q * num_deformation, num_deformation);
        return;
    }
    add_row(target, factor, checkpoint_table(self) + q * num_pressure, num_pressure);
    for (size_t r = 0; r < self->num_runs; r++)
        for (size_t n = 0, k = self->runs[r].first; n < self->runs[r].count; n++, k++)
            add_row(target, factor * self->runs[r].sign * model->left[k * model->num_cut + q],
                    model->band_pressure + k * num_pressure, num_pressure);
}

double reduced_central_sensitivity(reduced_solver *self) {
    const reduced_model *model = self->model;
    bool coupled = model->deformation == DEFORMATION_COUPLED;
    double *gradient = self->start, *film = gradient + (coupled ? 0 : model->num_pressure);

    memset(gradient, 0, model->num_unknowns * sizeof(double));
    for (size_t i = 0; i < 4; i++)
        if (model->centre_weight[i] != 0)
            add_film_row(film, model->centre_weight[i], self, model->centre[i]);
    gradient[model->num_unknowns - 1] = 1;
    return least_squares_sensitivity(self->least_squares, gradient);
}

void reduced_last_values(reduced_values *values, const reduced_solver *self) {
    const reduced_model *model = self->model;

    values->checkpoint = self->values.checkpoint;
    memcpy(values->pressure, self->values.pressure, model->num_needed * sizeof(double));
    memcpy(values->cut, self->values.cut, model->num_cut * sizeof(double));
}

void reduced_row_values(double *pressure, double *mass, const reduced_solver *self,
                        const ehd_contact *contact) {
    const reduced_model *model = self->model;
    const density_law *law = contact->lubricant.density;
    double ignored;

    for (size_t r = 0; r < model->num_rows; r++) {
        size_t q = model->stencils[r].node[NODE_HERE];
        pressure[r] = self->pressure[q];
        if (!mass) continue;
        mass[r] = self->film[q];
        if (law)
            mass[r] *= law->relative_density(fmax(self->pressure[q], 0) * contact->hertz_pressure,
                                             &ignored);
    }
}

void reduced_band_pressure(double *pressure, const reduced_model *model, const double *coordinates,
                           size_t from, size_t to) {
    product(pressure, model->band_pressure + (from - model->band_begin) * model->num_pressure,
            coordinates, to - from, model->num_pressure);
}

ehd_status reduced_solve(reduced_info *info, reduced_state *state, reduced_solver *solver,
                         const ehd_contact *contact, const reduced_squeeze *squeeze,
                         ehd_error *error) {
    double start = program_seconds();

    memset(info, 0, sizeof *info);
    info->status = EHD_NOT_CONVERGED;
    info->reason = "";
    ehd_status status = solve(info, state, solver, contact, squeeze, error);
    if (!status) info->scalars = reduced_scalars(solver, state);
    if (!status && info->status != EHD_NOT_CONVERGED &&
        !(info->scalars.minimum_film_thickness > 0)) {
        info->status = EHD_NOT_CONVERGED;
        info->reason = "a film that is not positive";
    }
    info->seconds = program_seconds() - start;
    return status;
}
