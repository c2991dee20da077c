/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/online/reduced_solver.h"

#include "common/program/program.h"
#include "romrun/online/band_minimum.h"
#include "romrun/online/solver_parts.h"

#include <cblas.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

ehd_status reduced_state_init(reduced_state *state, const reduced_model *model, ehd_error *error) {
    bool lines = model->band.num_lines > 1;

    *state = (reduced_state){.coordinates = calloc(model->num_unknowns, sizeof(double))};
    if (lines) state->exits = calloc(model->band.num_lines, sizeof *state->exits);
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
    if (state->exits) memmove(state->exits, exits, model->band.num_lines * sizeof *exits);
}

ehd_status reduced_values_init(reduced_values *values, const reduced_model *model,
                               ehd_error *error) {
    values->pressure = malloc(model->rows.num_needed * sizeof(double));
    values->cut = malloc(model->cut.num_rows * sizeof(double));
    values->checkpoint = model->checkpoints.num; // none
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
        free(self->kept_exit);
        free(self->exit);
        free(self->alive);
        free(self->runs);
        free(self->table_exit);
        free(self->block);
        free(self->block_right);
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
        free(self->band_film);
        free(self->band_search);
        free(self->rows);
        free(self->system_row);
        free(self->matrix);
        free(self->right);
        free(self->step);
        free(self->start);
        free(self->start_exit);
        free(self->observed);
        free(self);
    }
    return NULL;
}

ehd_status reduced_solver_create(reduced_solver **solver, const reduced_model *model,
                                 const reduced_settings *settings, ehd_error *error) {
    size_t most_rows = model->rows.num_rows + model->num_deformation + 1;
    size_t num_lines = model->band.num_lines;
    bool coupled = model->deformation == DEFORMATION_COUPLED;
    // of left sides of rows, or of those of the cut table with their right sides
    size_t block_size = CUT_BLOCK * (coupled ? model->rows.num_rows + 1
                                             : model->cut.num_rows + model->num_pressure);
    reduced_solver *self = calloc(1, sizeof *self);

    *solver = NULL;
    if (!self) return ehd_fail(error, EHD_MEMORY, "online solver: found no memory");
    self->model = model;
    self->settings = *settings;
    self->least_squares = least_squares_create(most_rows, model->num_unknowns);
    self->kept = least_squares_create(most_rows, model->num_unknowns);
    self->kept_matrix = malloc(most_rows * model->num_unknowns * sizeof(double));
    self->kept_row = malloc(model->rows.num_rows * sizeof *self->kept_row);
    self->kept_exit = calloc(num_lines, sizeof *self->kept_exit);
    self->start_exit = calloc(num_lines, sizeof *self->start_exit);
    self->exit = calloc(num_lines, sizeof *self->exit);
    self->alive = calloc(model->rows.num_needed, sizeof *self->alive);
    self->runs = calloc(num_lines, sizeof *self->runs);
    self->table_exit = calloc(num_lines, sizeof *self->table_exit);
    self->block = malloc(block_size * sizeof(double));
    self->block_right = malloc(CUT_BLOCK * model->num_pressure * sizeof(double));
    self->wanted = calloc(num_lines, sizeof *self->wanted);
    self->moved = calloc(num_lines, sizeof *self->moved);
    self->watches = calloc(num_lines, sizeof *self->watches);
    self->cut = malloc((coupled ? 1 : model->cut.num_rows * model->num_pressure) * sizeof(double));
    self->cut_value = malloc(model->cut.num_rows * sizeof(double));
    self->step_cut = malloc(model->cut.num_rows * sizeof(double));
    self->pressure = malloc(model->rows.num_needed * sizeof(double));
    self->film = malloc(model->rows.num_needed * sizeof(double));
    self->step_pressure = malloc(model->rows.num_needed * sizeof(double));
    self->step_film = malloc(model->rows.num_needed * sizeof(double));
    self->fluid_memory = malloc(4 * model->rows.num_needed * sizeof(double));
    self->band_pressure = malloc(model->band.num_nodes * sizeof(double));
    self->band_film = malloc(model->band.num_nodes * sizeof(double));
    self->band_search = calloc(model->band.num_nodes, sizeof *self->band_search);
    self->rows = malloc(model->rows.num_rows * sizeof *self->rows);
    self->system_row = malloc(model->rows.num_rows * sizeof *self->system_row);
    self->matrix = malloc(most_rows * model->num_unknowns * sizeof(double));
    self->right = malloc(most_rows * sizeof(double));
    self->step = malloc(model->num_unknowns * sizeof(double));
    self->start = malloc(model->num_unknowns * sizeof(double));
    self->observed = malloc(2 * model->rows.num_rows * sizeof(double));
    if (!self->least_squares || !self->kept || !self->kept_matrix || !self->kept_row ||
        !self->kept_exit || !self->start_exit || !self->exit || !self->alive || !self->runs ||
        !self->table_exit || !self->block || !self->block_right || !self->wanted || !self->moved ||
        !self->watches || !self->cut || !self->cut_value || !self->step_cut || !self->pressure ||
        !self->film || !self->step_pressure || !self->step_film || !self->fluid_memory ||
        !self->band_pressure || !self->band_film || !self->band_search || !self->rows ||
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

static const double MOST_PRESSURE_CHANGE = 0.3; // as in the full solver
static const double LEAST_FILM_LEFT = 0.2;

/* Damping factor by the state at the needed nodes; *change is the undamped largest pressure change. */
static double damping(reduced_solver *self, double *change) {
    const reduced_model *model = self->model;
    double least = INFINITY, factor = 1;

    nodes_values_at(&self->step_values, model, self->step, self->checkpoint);
    nodes_expand(self->step_pressure, self->step_film, self->step_cut, self, &self->step_values,
                 self->step);
    *change = 0;
    for (size_t q = 0; q < model->rows.num_needed; q++) {
        *change = fmax(*change, fabs(self->step_pressure[q]));
        least = fmin(least, self->film[q]);
    }
    if (*change > MOST_PRESSURE_CHANGE) factor = MOST_PRESSURE_CHANGE / *change;
    for (size_t q = 0; q < model->rows.num_needed; q++)
        if (self->step_film[q] < 0)
            factor = fmin(factor, (self->film[q] - LEAST_FILM_LEFT * least) / -self->step_film[q]);
    return factor;
}

static double at_centre(const reduced_model *model, const double *values) {
    double sum = 0;

    for (size_t i = 0; i < 4; i++)
        if (model->centre.weight[i] != 0)
            sum += model->centre.weight[i] * values[model->centre.place[i]];
    return sum;
}

/* Hands D f and D J dz of this iteration to the observer, rows behind the exit as zeros. */
static ehd_status observe(reduced_solver *self, ehd_error *error) {
    const reduced_model *model = self->model;
    double *residual = self->observed, *step = self->observed + model->rows.num_rows;

    if (!self->observer) return EHD_OK;
    memset(residual, 0, 2 * model->rows.num_rows * sizeof(double));
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

    return nodes_band_film(self->solver, self->state->coordinates, node);
}

static double minimum_film(reduced_solver *self, const reduced_state *state) {
    const film_of_state film = {self, state};
    const reduced_model *model = self->model;
    double least = INFINITY;

    nodes_expand_runs(self, state->coordinates);
    for (size_t l = model->band.first_minimum; l <= model->band.last_minimum; l++) {
        size_t first = l * grid_width(&model->grid);
        least = fmin(least, band_minimum(film_at, &film, first + model->band.lines[l].begin,
                                         first + self->exit[l] + 1));
    }
    return least;
}

/* Brings the rows and their values to the state, whose values may be known. */
static void evaluate(reduced_info *info, reduced_solver *self, const reduced_state *state,
                     const reduced_values *known, const ehd_contact *contact,
                     const reduced_squeeze *squeeze) {
    double start = program_seconds();
    nodes_move_exit(self, reduced_state_exits(state));
    system_evaluate_rows(self, contact, squeeze, known, state->coordinates);
    info->seconds_rows += program_seconds() - start;
}

/* The least-squares problem at the state; returns the number of its rows. */
static size_t build_system(reduced_info *info, reduced_solver *self, const reduced_state *state,
                           const reduced_values *known, const ehd_contact *contact,
                           const reduced_squeeze *squeeze) {
    double weight = squeeze ? system_closure_weight(squeeze->rate) : 1;
    evaluate(info, self, state, known, contact, squeeze);
    double start = program_seconds();
    system_list_rows(self);
    system_fill_matrix(self, &contact->closure, weight);
    size_t num_rows = system_fill_right(self, state->coordinates, self->system_row,
                                        self->num_system, &contact->closure, weight);

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

    if (solve_step(self, num_rows))
        return num_rows < model->num_unknowns ? "fewer rows before the exit than unknowns"
                                              : "least squares without a single finite solution";
    now->factor = damping(self, &now->change);
    now->rate = now->change / before->change;
    cblas_daxpy((int)model->num_unknowns, now->factor, self->step, 1, state->coordinates, 1);
    nodes_add_values(&self->values, now->factor, &self->step_values, model);
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

/* Begins to watch the exits. Those of a stationary state may come from other contacts: with lines of them, whose exits
 * follow one another, iterations are saved by those that the state itself asks for. */
static void start_exits(reduced_info *info, reduced_solver *self, reduced_state *state,
                        const ehd_contact *contact, const reduced_squeeze *squeeze) {
    const exit_watch watch = squeeze
                                 ? exits_watch_in_time(CYCLE)
                                 : exits_stationary_watch(self->model, self->settings.tolerance);

    exits_watch(self, watch);
    if (squeeze || self->model->band.num_lines == 1) return;
    nodes_move_exit(self, reduced_state_exits(state));
    exits_adapt(info, self, state, contact, NULL, INFINITY);
    exits_watch(self, watch); // where it began does not count
}

/* Returns an error only where the observer or memory fails; the outcome is info->status. */
static ehd_status newton(reduced_info *info, reduced_state *state, reduced_solver *self,
                         const ehd_contact *contact, const reduced_squeeze *squeeze,
                         ehd_error *error) {
    iterate before = {NAN, NAN, 0, NAN}, now;

    info->own_jacobian = true;
    start_exits(info, self, state, contact, squeeze);
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

        if (!exits_adapt(info, self, state, contact, squeeze, now.change) &&
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
    memset(self->right, 0,
           self->model->rows.num_rows * sizeof(double)); // the matrix needs no residual
    const reduced_squeeze squeeze = {.rate = rate, .earlier = self->right};
    reduced_info ignored = {0};

    evaluate(&ignored, self, state, NULL, contact, &squeeze);
    system_list_rows(self);
    self->kept_weight = system_closure_weight(rate);
    system_fill_matrix(self, &contact->closure, self->kept_weight);
    memcpy(self->kept_exit, self->exit, self->model->band.num_lines * sizeof *self->kept_exit);
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
    const double *checkpoint = nodes_checkpoint_table(self);
    double change = self->step[model->num_unknowns - 1];

    nodes_expand_runs(self, self->step);
    for (size_t i = 0; i < 4; i++) {
        size_t q = model->centre.place[i];
        double film = 0;
        if (model->centre.weight[i] == 0) continue;
        if (model->deformation == DEFORMATION_INDEPENDENT) {
            film = cblas_ddot((int)num_deformation, model->rows.film + q * num_deformation, 1,
                              self->step + num_pressure, 1);
        } else {
            film = cblas_ddot((int)num_pressure, checkpoint + q * num_pressure, 1, self->step, 1);
            for (size_t r = 0; r < self->num_runs; r++)
                for (size_t n = 0, k = self->runs[r].first; n < self->runs[r].count; n++, k++)
                    film += self->runs[r].sign * model->cut.left[k * model->cut.num_rows + q] *
                            self->band_pressure[k];
        }
        change += model->centre.weight[i] * film;
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
    size_t num_rows = system_fill_right(self, state->coordinates, self->kept_row, self->num_kept,
                                        &contact->closure, self->kept_weight);

    info->residual = cblas_dnrm2((int)num_rows, self->right, 1);
    if (!isfinite(info->residual) ||
        least_squares_again(self->step, self->kept, self->kept_matrix, self->right, num_rows))
        return false;
    at->change =
        sqrt(grid_cell(&model->grid)) * cblas_dnrm2((int)model->num_pressure, self->step, 1);
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

/* Whether no line's exit lies more than `most` nodes from where the kept factors have it. */
static bool is_near_kept(const reduced_solver *self, const reduced_state *state, size_t most) {
    const size_t *exit = reduced_state_exits(state), *kept = self->kept_exit;

    for (size_t l = 0; l < self->model->band.num_lines; l++)
        if (index_distance(exit[l], kept[l]) > most) return false;
    return true;
}

/* Iterates with the kept factors; false where they do not do, and the state is then of no use. */
static bool newton_with_kept(reduced_info *info, reduced_state *state, reduced_solver *self,
                             const ehd_contact *contact, const reduced_squeeze *squeeze) {
    // farther away, rows that the factors lack or have in vain would count
    const size_t most_distance = (size_t)(0.025 / self->model->grid.step);
    exits_watch(self, exits_watch_in_time(KEPT_CYCLE));
    kept_iterate at = {.change = NAN};
    for (size_t iteration = 0; iteration < MOST_KEPT_ITERATIONS; iteration++) {
        evaluate(info, self, state, iteration == 0 ? squeeze->start : NULL, contact, squeeze);
        if (!take_kept_step(&at, info, state, self, contact)) return false;
        bool moved = exits_adapt(info, self, state, contact, squeeze, at.change);
        if (!is_near_kept(self, state, most_distance)) return false;
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
    const reduced_model *model = self->model;
    size_t bytes = model->num_unknowns * sizeof(double);

    if (squeeze && self->has_kept && !self->observer) {
        memcpy(self->start, state->coordinates, bytes);
        memcpy(self->start_exit, reduced_state_exits(state),
               model->band.num_lines * sizeof *self->start_exit);
        if (newton_with_kept(info, state, self, contact, squeeze)) return EHD_OK;
        info->status = EHD_NOT_CONVERGED;
        memcpy(state->coordinates, self->start, bytes);
        reduced_state_set_exits(state, model, self->start_exit);
    }
    return newton(info, state, self, contact, squeeze, error);
}

contact_scalars reduced_scalars(reduced_solver *self, const reduced_state *state) {
    contact_scalars scalars;
    const reduced_model *model = self->model;

    nodes_move_exit(self, reduced_state_exits(state));
    nodes_expand_state(self, NULL, state->coordinates);
    for (size_t q = 0; q < model->rows.num_needed; q++)
        self->film[q] += model->rows.gap[q];
    scalars.central_film_thickness = at_centre(model, self->film);
    scalars.central_pressure = at_centre(model, self->pressure);
    scalars.minimum_film_thickness = minimum_film(self, state);
    // in time a dip passes through the front of the contact too, where only the needed nodes are known
    for (size_t q = 0; q < model->rows.num_needed; q++)
        if (self->alive[q])
            scalars.minimum_film_thickness = fmin(scalars.minimum_film_thickness, self->film[q]);
    scalars.rigid_approach = state->coordinates[model->num_unknowns - 1];
    scalars.exit_position = grid_x(&model->grid, state->exit);
    scalars.load = nodes_load(self) / model->kind->load;
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
        nodes_add_row(target, factor, model->rows.film + q * num_deformation, num_deformation);
        return;
    }
    nodes_add_row(target, factor, nodes_checkpoint_table(self) + q * num_pressure, num_pressure);
    for (size_t r = 0; r < self->num_runs; r++)
        for (size_t n = 0, k = self->runs[r].first; n < self->runs[r].count; n++, k++)
            nodes_add_row(
                target, factor * self->runs[r].sign * model->cut.left[k * model->cut.num_rows + q],
                model->band.pressure + k * num_pressure, num_pressure);
}

double reduced_central_sensitivity(reduced_solver *self) {
    const reduced_model *model = self->model;
    bool coupled = model->deformation == DEFORMATION_COUPLED;
    double *gradient = self->start, *film = gradient + (coupled ? 0 : model->num_pressure);

    memset(gradient, 0, model->num_unknowns * sizeof(double));
    for (size_t i = 0; i < 4; i++)
        if (model->centre.weight[i] != 0)
            add_film_row(film, model->centre.weight[i], self, model->centre.place[i]);
    gradient[model->num_unknowns - 1] = 1;
    return least_squares_sensitivity(self->least_squares, gradient);
}

void reduced_last_values(reduced_values *values, const reduced_solver *self) {
    const reduced_model *model = self->model;

    values->checkpoint = self->values.checkpoint;
    memcpy(values->pressure, self->values.pressure, model->rows.num_needed * sizeof(double));
    memcpy(values->cut, self->values.cut, model->cut.num_rows * sizeof(double));
}

void reduced_row_values(double *pressure, double *mass, const reduced_solver *self,
                        const ehd_contact *contact) {
    const reduced_model *model = self->model;
    const density_law *law = contact->lubricant.density;
    double ignored;

    for (size_t r = 0; r < model->rows.num_rows; r++) {
        size_t q = model->rows.stencils[r].node[NODE_HERE];
        pressure[r] = self->pressure[q];
        if (!mass) continue;
        mass[r] = self->film[q];
        if (law)
            mass[r] *= law->relative_density(fmax(self->pressure[q], 0) * contact->hertz_pressure,
                                             &ignored);
    }
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
