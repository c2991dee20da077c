/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/solve/reduced_solver.h"

#include "common/algebra/vectors.h"
#include "common/program/program.h"
#include "romrun/solve/kept_factors.h"
#include "romrun/solve/row_system.h"
#include "romrun/solve/solved_system.h"
#include "romrun/state/node_traction.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- the solver's parts

struct reduced_solver {
    const reduced_model *model;
    reduced_settings settings;
    node_state nodes;
    row_system system;        // the least-squares problem
    exit_search exits;        // the search for the exit line
    kept_factors kept;        // factors of the Jacobian of an earlier time step
    kept_factors near;        // factors of a Jacobian near the present solution
    const kept_factors *used; // factors that the last solution used; NULL: new Jacobians
    double remaining;         // estimated change that one more iteration would cause, divided by
                              // the change that the last iteration caused
    size_t num_solutions;
    size_t num_factors; // number of Jacobians that were factorised to be kept
    reduced_observer *observer;
    reduced_observer_end *observer_end;
    void *observer_context;
    double *observed; // [2, rows of the model]
    double *joining;  // [nodes of a line contact's band, num_unknowns] work of join_nodes
    arena memory;
};

const reduced_settings reduced_defaults = {.tolerance = 1e-8, .max_iterations = 40};

reduced_solver *reduced_solver_free(reduced_solver *self) {
    if (!self) return NULL;
    system_free(&self->system);
    kept_factors_free(&self->kept);
    kept_factors_free(&self->near);
    arena_free(&self->memory);
    free(self);
    return NULL;
}

static bool is_line(const reduced_model *model) {
    return model->band.num_lines == 1;
}

ehd_status reduced_solver_create(reduced_solver **solver, const reduced_model *model,
                                 const reduced_settings *settings, ehd_error *error) {
    reduced_solver *self = calloc(1, sizeof *self);

    *solver = NULL;
    if (!self) return ehd_no_memory(error, "online solver");
    self->model = model;
    self->settings = *settings;
    nodes_init(&self->nodes, model, &self->memory);
    system_init(&self->system, model, &self->memory);
    exits_init(&self->exits, model, settings->exit_spacing, &self->memory);
    kept_factors_init(&self->kept, model, &self->memory);
    kept_factors_init(&self->near, model, &self->memory);
    self->observed = arena_array(&self->memory, 2 * model->rows.num_rows, sizeof(double));
    if (is_line(model))
        self->joining = arena_array(
            &self->memory, (model->band.num_nodes + 1) * model->num_unknowns, sizeof(double));
    if (self->memory.failed) {
        reduced_solver_free(self);
        return ehd_no_memory(error, "online solver");
    }
    *solver = self;
    return EHD_OK;
}

void reduced_solver_set_tolerance(reduced_solver *self, double tolerance) {
    self->settings.tolerance = tolerance;
}

void reduced_solver_observe(reduced_solver *self, reduced_observer *observer,
                            reduced_observer_end *end, void *context) {
    self->observer = observer;
    self->observer_end = end;
    self->observer_context = context;
}

const size_t *reduced_system_rows(size_t *num_rows, const reduced_solver *self) {
    *num_rows = self->system.num_active;
    return self->system.active;
}

/* Adds the time since `start` to *seconds and returns the present time. */
static double add_seconds(double *seconds, double start) {
    double now = program_seconds();

    *seconds += now - start;
    return now;
}

/* Sets the outcome to not converged, which is not an error. */
static ehd_status fail(reduced_info *info, const char *reason) {
    info->status = EHD_NOT_CONVERGED;
    info->reason = reason;
    return EHD_OK;
}

// ---- Gauss-Newton

/* Pressures at which rows are evaluated. AT_STATE: pressures of the state. ABOUT_FIRST, ABOUT_NEXT:
 * pressures of system_about, while a time step is far from its solution. With ABOUT_FIRST,
 * system_about uses the pressures of the last accepted state. */
typedef enum { AT_STATE, ABOUT_FIRST, ABOUT_NEXT } row_pressures;

static void evaluate(reduced_solver *self, const reduced_state *state, const reduced_values *known,
                     const ehd_contact *contact, const reduced_squeeze *squeeze, row_pressures at) {
    const double approach = state->coordinates[self->model->num_unknowns - 1];
    const double *about = NULL;

    nodes_move_exit(&self->nodes, reduced_state_exits(state));
    nodes_expand_state(&self->nodes, known, state->coordinates);
    if (at != AT_STATE)
        about = system_about(&self->system, &self->nodes, approach, contact,
                             at == ABOUT_FIRST ? squeeze->last : NULL);
    system_evaluate(&self->system, &self->nodes, approach, contact, squeeze, about);
}

/* Builds the least-squares problem from the rows before the exit and, if `with_cell`, the row of
 * the cell in which the exit lies. Returns the number of rows. */
static size_t build_system(reduced_solver *self, const reduced_state *state,
                           const reduced_squeeze *squeeze, bool with_cell) {
    row_system *system = &self->system;
    double weight = system_closure_weight(squeeze);

    system_list_active(system, &self->nodes, with_cell ? state->exit - 1 : NO_NODE);
    system_fill_matrix(system, &self->nodes, weight);
    size_t num_rows = system_fill_right(system, &self->nodes, state->coordinates, system->active,
                                        system->num_active, weight);
    if (!with_cell) return num_rows;
    system_add_cell(system, &self->nodes, &self->exits.cell);
    return num_rows + 1;
}

static ehd_status solve_step(reduced_solver *self, size_t num_rows) {
    const reduced_settings *settings = &self->settings;
    row_system *system = &self->system;

    if (settings->solve_linear)
        return settings->solve_linear(system->step, settings->linear_context, system->matrix,
                                      system->right, num_rows, self->model->num_unknowns);
    return least_squares_solve(system->step, system->factors, system->matrix, system->right,
                               num_rows);
}

/* Passes D f and D J dz of this iteration to the observer, with zeros for rows behind the exit. */
static ehd_status observe(reduced_solver *self, ehd_error *error) {
    const row_system *system = &self->system;
    size_t n = self->model->num_unknowns;
    double *residual = self->observed, *step = self->observed + self->model->rows.num_rows;

    if (!self->observer) return EHD_OK;
    memset(residual, 0, 2 * self->model->rows.num_rows * sizeof(double));
    for (size_t i = 0; i < system->num_active; i++) {
        size_t r = system->active[i];
        residual[r] = system->right[i];
        step[r] = dot(system->matrix + i * n, system->step, n);
    }
    return self->observer(self->observer_context, residual, step, error);
}

/* MAX_PRESSURE_CHANGE: largest change of the pressure in one iteration, Hertz pressures.
 * MIN_FILM_LEFT: fraction of the smallest film that must remain after an iteration. A step that
 * exceeds one of these limits is damped. Measured by solving each of twelve trained contacts from
 * the solution of each other contact. With a MAX_PRESSURE_CHANGE of 0.3 all solutions are found, in
 * 850 iterations. With 0.1 four solutions are not found, in 863 iterations. With 1 two solutions
 * are not found, in 893 iterations. A MIN_FILM_LEFT of up to 0.5 changes nothing
 * (test_reduced_solver.c, any_trained_solution_leads_to_any_other). */
static const double MAX_PRESSURE_CHANGE = 0.3;
static const double MIN_FILM_LEFT = 0.2;

/* Returns the damping factor of a step, from the changes of P and H at the needed nodes. *change:
 * largest change of P that the undamped step causes. */
static double damping(double *change, node_state *nodes, const double *step) {
    size_t num_needed = nodes->model->rows.num_needed;
    const double *film = nodes->now.film;
    double smallest = INFINITY, factor = 1;

    nodes_expand(&nodes->step, nodes, NULL, step);
    *change = 0;
    for (size_t q = 0; q < num_needed; q++) {
        *change = fmax(*change, fabs(nodes->step.pressure[q]));
        smallest = fmin(smallest, film[q]);
    }
    if (*change > MAX_PRESSURE_CHANGE) factor = MAX_PRESSURE_CHANGE / *change;
    for (size_t q = 0; q < num_needed; q++)
        if (nodes->step.film[q] < 0)
            factor = fmin(factor, (film[q] - MIN_FILM_LEFT * smallest) / -nodes->step.film[q]);
    return factor;
}

/* State of the iteration after a step. */
typedef struct iterate {
    double film;   // H at X = 0 after the step
    double change; // largest change of P at the needed nodes, undamped
    double factor; // damping factor
    double rate;   // ratio of `change` to the change in the last iteration
    double moved;  // undamped move of an exit within its cell, in grid steps
} iterate;

static iterate take_step(reduced_state *state, reduced_solver *self, const iterate *before) {
    const reduced_model *model = self->model;
    node_state *nodes = &self->nodes;
    iterate now;

    now.factor = damping(&now.change, nodes, self->system.step);
    now.rate = now.change / before->change;
    now.moved = 0;
    if (self->system.num_cells > 0)
        now.moved = self->exits.cell.offset.residual +
                    dot(self->system.offset, self->system.step, model->num_unknowns);
    axpy(state->coordinates, now.factor, self->system.step, model->num_unknowns);
    nodes_add_step(nodes, now.factor);
    now.film = nodes_at_centre(model, nodes->now.film) +
               now.factor * nodes_at_centre(model, nodes->step.film);
    return now;
}

/* The iteration has converged if the next iteration would change P by less than this limit, Hertz
 * pressures. Sixty contacts around scenes/examples/line take 258 iterations with a limit of 1e-4
 * and with a limit of 1e-2. With a limit of 1e-6 they take 282 iterations, and the films change by
 * less than 1e-10. */
static const double PRESSURE_TOLERANCE = 1e-4;

/* Returns the change that the next iteration is estimated to cause, divided by the change that this
 * iteration has caused. Convergence is taken as quadratic, so this ratio is the square of the
 * observed rate. Near the solution Gauss-Newton converges only linearly, so the next change is
 * larger than this estimate. But this happens only where the rate is small. */
static double next_rate(const iterate *now) {
    const double rate = fmin(now->rate, 1);

    return rate * rate;
}

/* Checks whether another iteration would change film and pressure by less than the tolerances. A
 * damped step is far from convergence and gives no rate. */
static bool converged(const iterate *before, const iterate *now, double tolerance) {
    const double next = next_rate(now);

    return before->factor == 1 && now->factor == 1 &&
           fabs(now->film - before->film) * next < tolerance * now->film &&
           now->change * next < PRESSURE_TOLERANCE;
}

/* Sets the exit line of the first iteration. The exit line of a stationary start comes from a fit
 * to other contacts. For a point contact whose exits are searched on all grid lines, iterations are
 * saved if this exit line is first moved so that it fits the initial pressures. */
static void start_exits(reduced_solver *self, reduced_state *state, const ehd_contact *contact,
                        const reduced_squeeze *squeeze) {
    exits_watch(&self->exits, squeeze != NULL);
    if (squeeze || self->model->band.num_lines == 1) return;
    nodes_move_exit(&self->nodes, reduced_state_exits(state));
    exits_adapt(&self->exits, &self->nodes, state, contact, NULL, INFINITY);
    exits_watch(&self->exits, false); // this move does not count as a change of direction
}

static bool end_near(reduced_info *info, reduced_state *state, reduced_solver *self,
                     const ehd_contact *contact, const reduced_squeeze *squeeze);

static const double *band_modes(const reduced_model *model, size_t node) {
    return model->band.pressure + reduced_model_band_index(model, node) * model->num_pressure;
}

/* Sets P to 0 at the nodes of a line contact that have joined the pressurised zone because the exit
 * moved downstream from `exit`. Behind an exit no row determines the modes: round-off leaves
 * pressures of up to 1e6 p_H there, and shorter time steps do not remove these pressures. Of all
 * states with P = 0 at the joining nodes, the new state changes the residuals of the last
 * least-squares problem least. The direction for node k is (J^T J)^-1 phi_k, where phi_k are the
 * values of the modes at node k. Multiples of the directions of the joining nodes before k are
 * subtracted, so that P at these nodes stays 0. */
static void join_nodes(reduced_state *state, reduced_solver *self, size_t exit) {
    const reduced_model *model = self->model;
    const size_t n = model->num_unknowns, p = model->num_pressure;

    for (size_t node = exit, i = 0; node < state->exit; node++, i++) {
        const double *modes = band_modes(model, node);
        double *direction = self->joining + i * n, *functional = self->system.step;

        memset(functional, 0, n * sizeof *functional);
        memcpy(functional, modes, p * sizeof *functional);
        least_squares_dual(direction, self->system.factors, functional);
        for (size_t j = 0; j < i; j++) {
            const double *other = band_modes(model, exit + j), *before = self->joining + j * n;
            const double part = dot(other, direction, p) / dot(other, before, p);
            axpy(direction, -part, before, n);
        }
        const double slope = dot(modes, direction, p);
        const double factor = slope != 0 ? -dot(modes, state->coordinates, p) / slope : NAN;
        if (!isfinite(factor)) return; // no mode determines P at this node
        axpy(state->coordinates, factor, direction, n);
    }
}

/* Runs the algorithm of Maier et al. (2015), section 3: Gauss-Newton on the weighted least squares
 * of the selected rows. Each iteration also adapts the exit line. In a transient run the function
 * tries once to finish with only one more Jacobian (end_near). The function tries this after the
 * first iteration that changes the pressure by less than exits_near_change. The outcome is
 * info->status. The function returns an error only if the observer fails or there is no memory. */
static ehd_status gauss_newton(reduced_info *info, reduced_state *state, reduced_solver *self,
                               const ehd_contact *contact, const reduced_squeeze *squeeze,
                               ehd_error *error) {
    const bool within_node =
        !squeeze && !self->settings.exit_at_node && exit_is_within_node(&self->model->grid);
    const bool in_time = squeeze && !self->observer && !self->settings.solve_linear;
    bool tried = !in_time; // true: end_near has been tried, or is not used
    row_pressures at = in_time && squeeze->last ? ABOUT_FIRST : AT_STATE;
    const reduced_values *known = NULL;
    iterate before = {NAN, NAN, 0, NAN, 0}, now;
    double start = program_seconds();
    bool joined = false; // true: join_nodes has changed the state, so its values are not known

    if (!within_node) state->exit_offset = NAN;
    info->own_jacobian = true;
    start_exits(self, state, contact, squeeze);
    start = add_seconds(&info->seconds.exit, start);
    for (size_t iteration = 0;;
         iteration++, before = now, known = joined ? NULL : &self->nodes.now.values) {
        const bool near = before.factor == 1 && before.change < exits_near_change;
        if (near) at = AT_STATE;
        if (near && !tried) {
            if (end_near(info, state, self, contact, squeeze)) return EHD_OK;
            tried = true;
            known = NULL;
            exits_watch(&self->exits, true);
            start = program_seconds();
        }
        // D f and D J of the rows before the exit line (eqs. 37, 38)
        evaluate(self, state, known, contact, squeeze, at);
        if (at == ABOUT_FIRST) at = ABOUT_NEXT;
        const bool with_cell =
            within_node && exits_find_cell(&self->exits, &self->nodes, state, contact,
                                           system_flux(&self->system, contact, &self->nodes));
        size_t num_rows = build_system(self, state, squeeze, with_cell);
        info->residual = vector_norm(self->system.right, num_rows);
        start = add_seconds(&info->seconds.rows, start);
        if (!isfinite(info->residual)) return fail(info, "residual not finite");
        if (iteration >= self->settings.max_iterations)
            return fail(info, "iteration limit reached");

        // step = argmin |D f + D J step| (eq. 28), and the damped step
        self->used = NULL;
        if (solve_step(self, num_rows))
            return fail(info, num_rows < self->model->num_unknowns
                                  ? "fewer rows before the exit than unknowns"
                                  : "least squares without a single finite solution");
        now = take_step(state, self, &before);
        info->iterations++;
        start = add_seconds(&info->seconds.linear, start);
        ehd_status status = observe(self, error);
        if (status) return status;
        if (!(now.factor > 0)) return fail(info, "film would become negative");

        // the exit line of the new state (eq. 39)
        bool moved = false, held = false;
        const size_t exit = state->exit;
        if (with_cell)
            held = !exits_move_cell(state, self->model, now.factor * now.moved);
        else
            moved = exits_adapt(&self->exits, &self->nodes, state, contact, squeeze, now.change);
        joined = squeeze && is_line(self->model) && state->exit > exit;
        if (joined) join_nodes(state, self, exit);
        start = add_seconds(&info->seconds.exit, start);
        if (within_node && !with_cell) continue; // not converged: the exit is still a node
        if (moved || at != AT_STATE || !converged(&before, &now, self->settings.tolerance))
            continue;
        self->remaining = next_rate(&now);
        bool settled = with_cell ? !held : exits_settled(&self->exits, &self->nodes);
        info->status = settled ? EHD_OK : EHD_UNTRUSTED;
        info->reason = settled ? "" : "an exit boundary that does not settle";
        return EHD_OK;
    }
}

// ---- in time, with the factors of an earlier Jacobian

/* Largest ratio of successive changes with kept factors (romrun/online/README.md, In time). This
 * ratio is also assumed for the first iteration, when no ratio is known. Iterations of a reduced
 * model of scenes/examples/line-in-time (step 0.02): 279 with a largest ratio of 0.5, and 339 with
 * 0.9. With 0.2 there are 250 iterations, but more of them compute new Jacobians
 * (test_kept_factors.c, kept_factors_serve_steps_alike). */
static const double MAX_KEPT_RATE = 0.5;

/* Limits of the change of P in one iteration with kept factors. The change is an L2 norm, which
 * follows from the coordinates and does not depend on the grid. MAX_KEPT_CHANGE: an iteration with
 * a larger change would need damping. KEPT_TOLERANCE: tolerance of the change. The line contact
 * under a load of period 1/2 (scenes/studies/transient-load) takes 370 iterations with new
 * Jacobians and 1768 with kept factors. With a MAX_KEPT_CHANGE of 2e-3 these numbers are 685 and
 * 1143, and the march takes 22 % more instructions. scenes/examples/line-in-time takes 255
 * iterations with a KEPT_TOLERANCE of 7e-6, and 328 with 7e-7. With a KEPT_TOLERANCE of 7e-5 the
 * film of this example changes by 4e-4. */
static const double MAX_KEPT_CHANGE = 2e-2, KEPT_TOLERANCE = 7e-6;

/* Factorises the Jacobian at the state at which the rows have been evaluated. */
static void make_factors(kept_factors *factors, reduced_solver *self,
                         const reduced_squeeze *squeeze) {
    const double weight = system_closure_weight(squeeze);

    system_list_active(&self->system, &self->nodes, NO_NODE);
    system_fill_matrix(&self->system, &self->nodes, weight);
    kept_factors_set(factors, &self->system, &self->nodes, weight);
    factors->rate = squeeze->rate;
    factors->number = ++self->num_factors;
}

void reduced_drop_factors(reduced_solver *self) {
    self->kept.valid = false;
}

void reduced_keep_factors(reduced_solver *self, const reduced_state *state,
                          const ehd_contact *contact, double rate) {
    double *no_residual = self->system.right; // the matrix needs no residual
    const reduced_squeeze squeeze = {.rate = rate, .previous = no_residual};

    memset(no_residual, 0, self->model->rows.num_rows * sizeof(double));
    evaluate(self, state, NULL, contact, &squeeze, AT_STATE);
    make_factors(&self->kept, self, &squeeze);
}

const reduced_state *reduced_take_factors(reduced_solver *self) {
    const kept_factors taken = self->near;

    self->near = self->kept;
    self->kept = taken;
    self->used = NULL; // near and kept factors have been swapped
    return &self->kept.start;
}

/* State of the iteration with kept factors. */
typedef struct kept_iterate {
    double change; // change of P, L2 norm; NaN before the first step
    bool converged;
    bool slow; // the last step was small, but not taken because the iteration converged too slowly
} kept_iterate;

/* Outcomes without convergence. KEPT_SLOW: the state is near the solution. KEPT_FAILED: the state
 * is useless. */
typedef enum { KEPT_CONVERGED, KEPT_SLOW, KEPT_FAILED } kept_outcome;

/* Takes one step with kept factors. Returns false, without taking the step, if the iteration
 * converges too slowly or would need damping. */
static bool take_kept_step(kept_iterate *at, reduced_info *info, reduced_state *state,
                           reduced_solver *self, const kept_factors *kept) {
    const reduced_model *model = self->model;
    double before = at->change, *step = self->system.step, *right = self->system.right;
    size_t num_rows = system_fill_right(&self->system, &self->nodes, state->coordinates, kept->row,
                                        kept->num_rows, kept->weight);

    info->residual = vector_norm(right, num_rows);
    if (!isfinite(info->residual) ||
        least_squares_again(step, kept->factors, kept->matrix, right, num_rows))
        return false;
    at->change = sqrt(grid_cell(&model->grid)) * vector_norm(step, model->num_pressure);
    double rate = isnan(before) ? MAX_KEPT_RATE : at->change / before;
    at->slow = at->change < MAX_KEPT_CHANGE && !(rate <= MAX_KEPT_RATE);
    if (!(at->change < MAX_KEPT_CHANGE && rate <= MAX_KEPT_RATE)) return false;
    double film = nodes_at_centre(model, self->nodes.now.film);
    double change = nodes_central_change(&self->nodes, step);
    at->converged =
        fabs(change) * rate < self->settings.tolerance * film && at->change * rate < KEPT_TOLERANCE;
    axpy(state->coordinates, 1, step, model->num_unknowns);
    info->iterations++;
    return true;
}

/* Iterates with `factors`, which are the kept factors or the factors near the solution. The factors
 * near the solution are made in the first iteration. */
static kept_outcome iterate_with(kept_factors *factors, reduced_info *info, reduced_state *state,
                                 reduced_solver *self, const ehd_contact *contact,
                                 const reduced_squeeze *squeeze) {
    const bool made = factors == &self->near; // true: makes factors as reduced_keep_factors does
    const reduced_values *known = made ? NULL : squeeze->start;
    kept_iterate at = {.change = NAN};
    double start = program_seconds();

    exits_watch(&self->exits, true);
    for (size_t iteration = 0; iteration < self->settings.max_iterations; iteration++) {
        evaluate(self, state, iteration == 0 ? known : NULL, contact, squeeze, AT_STATE);
        if (made && iteration == 0) make_factors(factors, self, squeeze);
        start = add_seconds(&info->seconds.rows, start);
        const bool converges = take_kept_step(&at, info, state, self, factors);
        start = add_seconds(&info->seconds.linear, start);
        if (!converges) return at.slow ? KEPT_SLOW : KEPT_FAILED;
        bool moved = exits_adapt(&self->exits, &self->nodes, state, contact, squeeze, at.change);
        start = add_seconds(&info->seconds.exit, start);
        // far from the exit at which the factors were made, the active rows do not match the
        // factorisation
        if (!kept_factors_are_near(factors, self->model, state)) return KEPT_FAILED;
        if (!moved && at.converged) {
            if (!exits_settled(&self->exits, &self->nodes)) return KEPT_FAILED;
            info->status = EHD_OK;
            info->reason = "";
            return KEPT_CONVERGED;
        }
        if (moved) at.change = NAN; // with other active rows the rate starts anew
    }
    return KEPT_FAILED;
}

/* Iterates with factors of the Jacobian at the state, which is near the solution. Returns false in
 * two cases:
 * - The iteration does not converge. The state is then the initial state.
 * - Exits have moved, so that other rows are active. The state is then nearer to the solution. */
static bool end_near(reduced_info *info, reduced_state *state, reduced_solver *self,
                     const ehd_contact *contact, const reduced_squeeze *squeeze) {
    const size_t bytes = self->model->band.num_lines * sizeof(size_t);

    reduced_state_copy(&self->near.start, state, self->model);
    if (iterate_with(&self->near, info, state, self, contact, squeeze) != KEPT_CONVERGED) {
        reduced_state_copy(state, &self->near.start, self->model);
        return false;
    }
    self->used = &self->near;
    info->near_factors = memcmp(self->near.exit, reduced_state_exits(state), bytes) == 0;
    if (!info->near_factors) info->status = EHD_NOT_CONVERGED;
    return info->near_factors;
}

/* Returns whether to try the kept factors. If the factors were made for a time step that is shorter
 * by a factor q, each iteration makes only 1/q of the necessary change, and the rate of convergence
 * is 1 - 1/q. If this rate exceeds MAX_KEPT_RATE, such a small change would be mistaken for
 * convergence. */
static bool kept_are_of_use(const reduced_solver *self, const reduced_squeeze *squeeze) {
    return squeeze && self->kept.valid && !self->observer &&
           self->kept.rate * (1 - MAX_KEPT_RATE) <= squeeze->rate;
}

/* Iterates with the kept factors, if they are of use. If this iteration converges too slowly,
 * iterates with factors of the Jacobian at the state reached. If no iteration with factors
 * converges, starts again from the initial state with new Jacobians. */
static ehd_status solve(reduced_info *info, reduced_state *state, reduced_solver *self,
                        const ehd_contact *contact, const reduced_squeeze *squeeze,
                        ehd_error *error) {
    self->used = NULL;
    self->remaining = 0;
    self->num_solutions++;
    if (!kept_are_of_use(self, squeeze))
        return gauss_newton(info, state, self, contact, squeeze, error);
    reduced_state_copy(&self->kept.start, state, self->model);
    const kept_outcome outcome = iterate_with(&self->kept, info, state, self, contact, squeeze);
    if (outcome == KEPT_CONVERGED) {
        self->used = &self->kept;
        return EHD_OK;
    }
    info->own_jacobian = true;
    if (outcome == KEPT_SLOW && end_near(info, state, self, contact, squeeze)) return EHD_OK;
    reduced_state_copy(state, &self->kept.start, self->model);
    return gauss_newton(info, state, self, contact, squeeze, error);
}

// ---- solving

/* Computes P and H of a state at the needed nodes. `known`: values of the state, or NULL. */
static void expand(reduced_solver *self, const reduced_state *state, const reduced_values *known) {
    nodes_move_exit(&self->nodes, reduced_state_exits(state));
    nodes_expand_state(&self->nodes, known, state->coordinates);
}

/* Returns the scalars of a state. Call expand for this state before. */
static contact_scalars scalars_of(reduced_solver *self, const reduced_state *state,
                                  const ehd_contact *contact) {
    return nodes_scalars(&self->nodes, state->coordinates,
                         reduced_exit_position(state, self->model), contact);
}

ehd_status reduced_solve(reduced_info *info, reduced_state *state, reduced_solver *solver,
                         const ehd_contact *contact, const reduced_squeeze *squeeze,
                         ehd_error *error) {
    double start = program_seconds();

    *info = (reduced_info){.status = EHD_NOT_CONVERGED, .reason = ""};
    ehd_status status = solve(info, state, solver, contact, squeeze, error);
    // in transient runs the values have to be bit-identical to the values of reduced_values_of
    const bool in_time = squeeze || solver->settings.exit_at_node;
    if (!status) {
        expand(solver, state, in_time ? NULL : &solver->nodes.now.values);
        if (in_time)
            state->exit_offset =
                exits_place(&solver->exits, &solver->nodes, state, contact, squeeze);
        info->scalars = scalars_of(solver, state, contact);
    }
    if (!status && info->status != EHD_NOT_CONVERGED && !(info->scalars.minimum_film_thickness > 0))
        fail(info, "a film that is not positive");
    if (!status && solver->observer_end)
        status = solver->observer_end(solver->observer_context, info, error);
    info->seconds.total = program_seconds() - start;
    return status;
}

void reduced_find_dip(contact_scalars *scalars, const reduced_solver *self, film_function *film,
                      const void *context) {
    size_t lowest;

    if (!nodes_have_dip(&self->nodes)) return;
    scalars->minimum_film_thickness = nodes_minimum_between(&lowest, &self->nodes, film, context);
    scalars->minimum_position = grid_x(&self->model->grid, lowest);
}

// ---- quantities of a solution

contact_scalars reduced_scalars(reduced_solver *self, const reduced_state *state,
                                const ehd_contact *contact) {
    expand(self, state, NULL);
    return scalars_of(self, state, contact);
}

bool reduced_doubts_flow(reduced_solver *self, const reduced_state *state,
                         const ehd_contact *contact) {
    const double approach = state->coordinates[self->model->num_unknowns - 1];

    if (!traction_thins_flow(contact) || contact->kind->dimensions == 1) return false;
    expand(self, state, NULL);
    return system_flow_doubt(&self->system, &self->nodes, approach, contact) > default_accuracy;
}

reduced_pressures reduced_pressure_range(reduced_solver *self, const reduced_state *state) {
    return nodes_pressure_range(&self->nodes, state->coordinates);
}

solved_system reduced_solved_system(reduced_solver *self) {
    row_system *system = &self->system;
    const kept_factors *used = self->used;
    const size_t num_reynolds = used ? used->num_rows : system->num_active;

    return (solved_system){.nodes = &self->nodes,
                           .exits = &self->exits,
                           .num_rows =
                               num_reynolds + self->model->num_deformation + 1 + system->num_cells,
                           .num_reynolds = num_reynolds,
                           .row = used ? used->row : system->active,
                           .matrix = used ? used->matrix : system->matrix,
                           .factors = used ? used->factors : system->factors,
                           .right = system->right,
                           .step = system->step,
                           .remaining = self->remaining,
                           .offset = system->num_cells > 0 ? system->offset : NULL,
                           .matrix_number = used ? used->number : 0,
                           .solution_number = self->num_solutions};
}

void reduced_last_values(reduced_values *values, const reduced_solver *self) {
    const reduced_model *model = self->model;
    const reduced_values *last = &self->nodes.now.values;

    values->checkpoint = last->checkpoint;
    memcpy(values->pressure, last->pressure, model->rows.num_needed * sizeof(double));
    memcpy(values->cut, last->cut, model->cut.num_rows * sizeof(double));
}

contact_traction reduced_traction(reduced_solver *self, const reduced_state *state,
                                  const ehd_contact *contact, const contact_scalars *scalars) {
    expand(self, state, NULL);
    return nodes_traction(&self->nodes, state->coordinates, contact, scalars);
}

reduced_needed reduced_needed_fields(const reduced_solver *self) {
    return (reduced_needed){self->nodes.now.pressure, self->nodes.now.film};
}

void reduced_row_values(double *pressure, double *mass, const reduced_solver *self,
                        const ehd_contact *contact) {
    const row_set *set = &self->model->rows;
    const node_fields *now = &self->nodes.now;

    for (size_t r = 0; r < set->num_rows; r++) {
        size_t q = set->stencils[r].node[NODE_HERE];
        pressure[r] = now->pressure[q];
        if (!mass) continue;
        mass[r] = now->film[q] * lubricant_density(&contact->lubricant,
                                                   now->pressure[q] * contact->hertz_pressure);
    }
}
