/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fullrun/full_solver.h"

#include "common/physics/exit.h"
#include "common/program/arena.h"
#include "common/program/program.h"
#include "fullrun/gmres.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The state that a Newton step starts from. */
typedef struct step_base {
    double *pressure; // [num_nodes]
    double rigid_approach;
    size_t exit;
    double exit_offset;
} step_base;

struct full_solver {
    ehd_grid grid;
    const contact_kind *kind;
    full_settings settings;
    bool large;            // result of full_as_large
    size_t part;           // result of full_part
    team *threads;         // threads that share the work on a large grid; NULL: one thread
    const double *surface; // [num_nodes] heights that add to the gap; NULL: smooth surfaces
    ehd_deflection *deflection;
    gmres_workspace *workspace;
    reynolds_stencil *stencils; // [num_inner]
    reynolds_row *rows;         // [num_inner]
    double *row_scale;          // [num_inner]
    double *of_part;            // [parts of num_nodes] sum or maximum of each part
    double *step;               // [num_nodes] change of P in a Newton step
    double step_approach;       // change of H0 in this step
    double *step_film;  // [num_nodes] change of the deflection, if the exit is within a cell
    double step_offset; // move of the exit within a cell, in steps of the grid
    step_base base;
    contact_closure closure; // closure of the current state, with the load beyond the grid
    far_field outer;         // far field at the boundary nodes
    double *pressure;        // [num_nodes] P of state, far field and inlet tail together
    bool keeps_factors;      // the factors of the previous linear system may be used
    double largest_merit;    // largest merit() before a Newton step of this solution
    double largest_row;      // largest scaled residual, without the closure
    double *fluid_memory;    // [NUM_FLUID_ARRAYS, num_nodes]
    double seconds_rows;
    size_t num_unknowns;     // as in full_system
    size_t *unknown, *index; // [num_nodes]
    reynolds_fluid fluid;    // fluid whose arrays lie in fluid_memory
    exit_cell cell;
    arena memory;
};

/* Returns the default settings. Measurements on six line contacts of 1201 nodes:
 * - With a near field of 8 nodes GMRES takes 18 iterations per Newton iteration, at most 0.19 s in
 *   all. With a near field of 64 nodes GMRES takes 8 iterations, but 0.66 s.
 * - With a linear tolerance of 1e-8 GMRES takes 18 iterations. With a tolerance of 1e-2 GMRES takes
 *   7 iterations, but Newton takes 34 iterations instead of 28. */
full_settings full_default_settings(void) {
    full_settings settings = {.tolerance = 1e-10,
                              .max_iterations = 60,
                              .near_field = 8,
                              .linear_tolerance = 1e-8,
                              .solve_linear = full_solve_gmres};
    return settings;
}

full_solver *full_solver_free(full_solver *self) {
    if (!self) return NULL;
    deflection_free(self->deflection);
    gmres_workspace_free(self->workspace);
    arena_free(&self->memory);
    free(self);
    return NULL;
}

bool full_is_large(const ehd_grid *grid) {
    return grid->inner_lines > 1 && grid->num_inner > LARGE_GRID;
}

bool full_as_large(const ehd_grid *grid, const full_settings *settings) {
    return full_is_large(grid) || (settings->as_large && grid->inner_lines > 1);
}

size_t full_part(const ehd_grid *grid, bool large) {
    enum { NODES = 2048 };

    return large ? NODES : grid->num_nodes + 1;
}

double full_solver_bytes(const ehd_grid *grid) {
    const double of_solver = sizeof(reynolds_row) + sizeof(reynolds_stencil) + 27 * sizeof(double);
    // Numbers per node: 1 for the kernel and 2 for the transform of the kernel. A half grid has 2
    // more for the signal, a whole grid 4 for the signal and 4 for the spectrum.
    const double of_deflection = (grid->half ? 5 : 11) * sizeof(double);
    // bytes of the factors per node and per log2 of the number of nodes, measured with UMFPACK
    enum { OF_FACTORS = 100 };
    double nodes = (double)grid->num_inner;

    if (full_is_large(grid)) // coarser grids are freed before this one is solved
        return nodes * (gmres_workspace_bytes(grid) + of_solver + of_deflection);
    // 4/3: the grid and all coarser grids of a cold start, 1 + 1/4 + 1/16 …
    return 4. / 3 * nodes * (gmres_workspace_bytes(grid) + of_solver + of_deflection) +
           OF_FACTORS * nodes * log2(nodes);
}

static void set_stencils(void *context, const team_part *part) {
    const full_solver *self = context;

    for (size_t r = part->first; r < part->end; r++)
        self->stencils[r] = reynolds_stencil_at(&self->grid, grid_node_of_row(&self->grid, r));
}

ehd_status full_solver_create(full_solver **solver, const contact_kind *kind, const ehd_grid *grid,
                              const full_settings *settings, ehd_error *error) {
    size_t num_inner = grid->num_inner, num_nodes = grid->num_nodes;
    full_solver *self = calloc(1, sizeof *self);
    *solver = NULL;
    if (!self) return ehd_no_memory(error, "full model");

    arena *memory = &self->memory;
    self->grid = *grid;
    self->kind = kind;
    self->settings = *settings;
    const size_t widest = kind->dimensions > 1 ? 1 : num_inner - 1;
    if (self->settings.near_field > widest) self->settings.near_field = widest;
    self->large = full_as_large(grid, settings);
    self->part = full_part(grid, self->large);
    self->threads = self->large ? settings->threads : NULL;
    self->deflection = deflection_create_shared(kind, grid, self->threads);
    self->workspace = gmres_workspace_create(grid, &self->settings);
    self->stencils = arena_array(memory, num_inner, sizeof *self->stencils);
    self->rows = arena_array(memory, num_inner, sizeof *self->rows);
    self->row_scale = arena_array(memory, num_inner, sizeof(double));
    self->of_part = arena_array(memory, team_num_parts(num_nodes, self->part), sizeof(double));
    self->step = arena_array(memory, num_nodes, sizeof(double));
    self->step_film = arena_array(memory, num_nodes, sizeof(double));
    self->base.pressure = arena_array(memory, num_nodes, sizeof(double));
    far_field_init(&self->outer, grid, NULL, num_nodes, memory);
    self->pressure = arena_array(memory, num_nodes, sizeof(double));
    self->fluid_memory = arena_array(memory, NUM_FLUID_ARRAYS * num_nodes, sizeof(double));
    self->unknown = arena_array(memory, num_nodes, sizeof *self->unknown);
    self->index = arena_array(memory, num_nodes, sizeof *self->index);
    if (!self->deflection || !self->workspace || memory->failed) {
        full_solver_free(self);
        return ehd_no_memory(error, "full model");
    }
    team_share(self->threads, num_inner, self->part, set_stencils, self);
    *solver = self;
    return EHD_OK;
}

const full_settings *full_solver_settings(const full_solver *self) {
    return &self->settings;
}

ehd_status full_state_init(full_state *state, const ehd_grid *grid, ehd_error *error) {
    memset(state, 0, sizeof *state);
    state->pressure = calloc(grid->num_nodes, sizeof(double));
    state->film = calloc(grid->num_nodes, sizeof(double));
    state->ruptured = calloc(grid->num_nodes, sizeof *state->ruptured);
    if (!state->pressure || !state->film || !state->ruptured) {
        full_state_free(state);
        return ehd_no_memory(error, "state");
    }
    full_state_fill(state, grid);
    return EHD_OK;
}

void full_state_fill(full_state *state, const ehd_grid *grid) {
    state->exit = grid->num_nodes - 1;
    state->exit_offset = NAN;
    memset(state->ruptured, 0, grid->num_nodes * sizeof *state->ruptured);
    if (grid->inner_lines == 1) return;
    memset(state->ruptured, true, grid->num_nodes * sizeof *state->ruptured);
    for (size_t r = 0; r < grid->num_inner; r++)
        state->ruptured[grid_node_of_row(grid, r)] = false;
}

static void set_exit(full_state *state, size_t exit, const ehd_grid *grid) {
    state->exit = exit;
    state->exit_offset = NAN;
    memset(state->pressure + exit, 0, (grid->num_nodes - exit) * sizeof(double));
}

void full_state_set_zone(full_state *state, const ehd_grid *grid, size_t exit) {
    full_state_fill(state, grid);
    if (grid->inner_lines == 1)
        set_exit(state, exit, grid);
    else
        for (size_t k = 0; k < grid->num_nodes; k++)
            state->ruptured[k] = !(state->pressure[k] != 0);
}

void full_state_free(full_state *state) {
    free(state->pressure);
    free(state->film);
    free(state->ruptured);
    state->pressure = state->film = NULL;
    state->ruptured = NULL;
}

void full_state_copy(full_state *target, const full_state *source, const ehd_grid *grid) {
    memcpy(target->pressure, source->pressure, grid->num_nodes * sizeof(double));
    memcpy(target->film, source->film, grid->num_nodes * sizeof(double));
    target->rigid_approach = source->rigid_approach;
    target->exit = source->exit;
    target->exit_offset = source->exit_offset;
    memcpy(target->ruptured, source->ruptured, grid->num_nodes * sizeof *target->ruptured);
}

bool full_has_pressure(const full_state *state, size_t node) {
    return node >= 1 && node < state->exit && !state->ruptured[node];
}

bool full_is_cut(const full_state *state, const ehd_grid *grid, bool backwards) {
    for (size_t r = backwards ? 0 : grid->inner_x - 1; r < grid->num_inner; r += grid->inner_x)
        if (full_has_pressure(state, grid_node_of_row(grid, r))) return true;
    return false;
}

/* Context of work that threads share: an evaluation at all nodes, or of all rows. */
typedef struct evaluation {
    full_solver *solver;
    const ehd_contact *contact;
    const reynolds_squeeze *squeeze;
    full_state *state;
} evaluation;

static void add_gap(void *context, const team_part *part) {
    const evaluation *task = context;
    const full_solver *self = task->solver;
    full_state *state = task->state;

    for (size_t k = part->first; k < part->end; k++)
        state->film[k] += state->rigid_approach + grid_gap(&self->grid, k);
    for (size_t k = part->first; self->surface && k < part->end; k++)
        state->film[k] += self->surface[k];
}

void full_film(full_state *state, full_solver *self) {
    const ehd_grid *grid = &self->grid;
    evaluation task = {.solver = self, .state = state};

    deflection_apply(state->film, self->deflection, state->pressure);
    team_share(self->threads, grid->num_nodes, self->part, add_gap, &task);
}

void full_solver_set_surface(full_solver *self, const double *heights) {
    self->surface = heights;
}

// ---- rows

/* Returns the sum of the pressures of a large grid. The round-off of each addition is corrected in
 * the next one (W. Kahan, Comm. ACM 8, 1965). Without the correction, the error of the sum on 1025
 * by 513 nodes would be 1e-10, Newton's tolerance. */
static double compensated_sum(const full_state *state, const ehd_grid *grid) {
    double sum = 0, lost = 0;

    for (size_t k = 1; k < state->exit; k++) {
        const double term = grid_weight(grid, k) * state->pressure[k] - lost, next = sum + term;
        lost = (next - sum) - term;
        sum = next;
    }
    return sum;
}

/* Returns the residual of the closure equation, scaled such that the entries of its row are 1. On a
 * half grid they are 2, except at the mirror line. */
static double closure_residual(const full_solver *self, const full_state *state) {
    const contact_closure *closure = &self->closure;
    const ehd_grid *grid = &self->grid;
    const bool large = self->large;
    double sum = large ? compensated_sum(state, grid) : 0;

    for (size_t k = 1; k < state->exit && !large; k++)
        sum += grid_weight(grid, k) * state->pressure[k];
    return closure->by_load * sum +
           (closure->by_approach * state->rigid_approach - closure->value) / grid_cell(grid);
}

static size_t row_of_exit(const full_state *state, const ehd_grid *grid) {
    return grid_row_of_node(grid, state->exit - 1);
}

static void evaluate_cell(full_solver *self, double entrainment, const full_state *state) {
    const reynolds_stencil *stencil = &self->stencils[row_of_exit(state, &self->grid)];
    const reynolds_row flux = reynolds_flux(&self->grid, entrainment, stencil, &self->fluid,
                                            state->pressure, state->film);

    exit_cell_at(&self->cell, &self->grid, entrainment, state->exit_offset, flux.residual, stencil,
                 &self->fluid, state->pressure, state->film);
    exit_cell_add_flux(&self->cell, &flux);
}

static void evaluate_fluid(void *context, const team_part *part) {
    const evaluation *task = context;
    full_solver *self = task->solver;
    reynolds_fluid fluid = reynolds_fluid_from(&self->fluid, part->first);

    reynolds_fluid_evaluate(&fluid, task->contact, self->pressure + part->first,
                            part->end - part->first);
}

static void evaluate_some_rows(void *context, const team_part *part) {
    const evaluation *task = context;
    full_solver *self = task->solver;
    const reynolds_squeeze *all = task->squeeze;
    const reynolds_squeeze squeeze =
        all ? (reynolds_squeeze){all->rate, all->previous + part->first} : (reynolds_squeeze){0};

    reynolds_rows(self->rows + part->first, &self->grid, task->contact->entrainment,
                  all ? &squeeze : NULL, self->stencils + part->first, part->end - part->first,
                  &self->fluid, self->pressure, task->state->film);
}

/* Evaluates film, fluid and all Reynolds rows at the state. If the exit lies within the cell of a
 * node, evaluates this cell as well. The row of the cell replaces the row of the node. */
static void evaluate_rows(full_solver *self, const ehd_contact *contact,
                          const reynolds_squeeze *squeeze, full_state *state) {
    const size_t num_nodes = self->grid.num_nodes, part = self->part;
    const double before = program_seconds();
    evaluation task = {self, contact, squeeze, state};

    self->fluid = reynolds_fluid_in(self->fluid_memory, num_nodes, contact);
    full_film(state, self);
    self->closure = far_field_closure(&self->outer, contact, state->rigid_approach);
    memcpy(self->pressure, state->pressure, num_nodes * sizeof(double));
    far_field_add(self->pressure, &self->outer, contact, state->rigid_approach);
    self->pressure[0] += contact->tail.pressure;
    self->closure.value -= self->closure.by_load * contact->tail.load;
    team_share(self->threads, num_nodes, part, evaluate_fluid, &task);
    far_field_set_density(&self->fluid, &self->outer);
    team_share(self->threads, self->grid.num_inner, part, evaluate_some_rows, &task);
    if (!isnan(state->exit_offset)) {
        evaluate_cell(self, contact->entrainment, state);
        if (self->cell.curvature > 0)
            self->rows[row_of_exit(state, &self->grid)] = self->cell.row;
        else // far from the solution: the film behind the exit does not rise to carry the flux
            state->exit_offset = NAN;
    }
    self->seconds_rows += program_seconds() - before;
}

/* Returns the largest entry of a row of the Jacobian. The derivative with respect to the film,
 * times the kernel, is a derivative with respect to the pressure. */
static double row_magnitude(const full_solver *self, size_t r) {
    const reynolds_row *row = &self->rows[r];
    const int size = reynolds_stencil_size(&self->grid);
    double largest = 0, approach = 0;

    for (int a = 0; a < size; a++) {
        largest = fmax(largest, fabs(row->by_pressure[a]));
        approach += row->by_film[a];
    }
    double film = fabs(row->by_film[NODE_HERE]) * fabs(deflection_kernel(self->deflection)[0]);
    return fmax(fmax(largest, film), fabs(approach));
}

/* Returns the larger magnitude, or NaN if one of the two is NaN. */
static double larger(double magnitude, double other) {
    return isnan(other) || fabs(other) > magnitude ? fabs(other) : magnitude;
}

static void scale_some_rows(void *context, const team_part *part) {
    const evaluation *task = context;
    full_solver *self = task->solver;
    double largest = 0;

    for (size_t r = part->first; r < part->end; r++) {
        self->row_scale[r] = 1 / row_magnitude(self, r);
        if (full_has_pressure(task->state, grid_node_of_row(&self->grid, r)))
            largest = larger(largest, self->rows[r].residual * self->row_scale[r]);
    }
    self->of_part[part->number] = largest;
}

/* Computes the scales of the rows. Returns the largest scaled residual of the closure and of rows
 * at nodes with pressure. */
static double scale_rows(full_solver *self, full_state *state) {
    const size_t num_rows = self->grid.num_inner, part = self->part;
    evaluation task = {.solver = self, .state = state};
    double largest = 0;

    team_share(self->threads, num_rows, part, scale_some_rows, &task);
    for (size_t i = 0; i < team_num_parts(num_rows, part); i++)
        largest = larger(largest, self->of_part[i]);
    if (!isnan(state->exit_offset)) {
        double scale = self->row_scale[row_of_exit(state, &self->grid)];
        largest = larger(largest, self->cell.flux_residual * scale);
    }
    self->largest_row = largest;
    return larger(largest, closure_residual(self, state));
}

// ---- exit boundary

/* Returns the multiplier at a node without pressure, scaled like its row. */
static double scaled_multiplier(const full_solver *self, size_t node) {
    size_t r = grid_row_of_node(&self->grid, node);

    return exit_multiplier(&self->rows[r]) * self->row_scale[r];
}

// ---- exit within the cell of a node

/* Checks whether the exit may lie within the cell of a node. The film must be known at two nodes
 * upstream of the last node with pressure, and at two nodes downstream of it. */
static bool can_divide_node(const full_state *state, const ehd_grid *grid) {
    return state->exit >= 3 && state->exit + 1 < grid->num_nodes;
}

static bool has_ruptured_nodes(const full_state *state) {
    for (size_t k = 1; k < state->exit; k++)
        if (state->ruptured[k]) return true;
    return false;
}

/* Moves an exit from its node to a position within the cell, which follows from the pressure at the
 * last node with pressure (test_full_solver.c, pressure_holds_the_exit). The state's rows must be
 * evaluated. Returns false if the state stays as it is. */
static bool divide_node(full_solver *self, double entrainment, full_state *state) {
    if (!isnan(state->exit_offset) || !can_divide_node(state, &self->grid) ||
        has_ruptured_nodes(state))
        return false;
    state->exit_offset = 0;
    evaluate_cell(self, entrainment, state);
    const double square = state->pressure[state->exit - 1] / self->cell.curvature;
    state->exit_offset = square > 0 ? fmin(sqrt(square), 1) : 0;
    return true;
}

/* Returns the move of the exit in a Newton step, in steps of the grid. */
static double change_of_offset(const full_solver *self, const full_state *state) {
    const reynolds_row *offset = &self->cell.offset;
    const reynolds_stencil *stencil = &self->stencils[row_of_exit(state, &self->grid)];
    double change = offset->residual;

    for (int a = 0; a < NUM_LINE_STENCIL; a++) {
        const size_t node = stencil->node[a];
        if (node == NO_NODE) continue;
        change += offset->by_pressure[a] * self->step[node] +
                  offset->by_film[a] * (self->step_film[node] + self->step_approach);
    }
    return change;
}

/* Moves the exit by `change` steps of the grid, after a Newton step was added to the state. */
static void move_exit(full_state *state, const ehd_grid *grid, double change) {
    const double offset = state->exit_offset + (isfinite(change) ? change : 0);
    const double exit = fmax((double)state->exit + floor(offset), 3);
    const size_t last = grid->num_nodes - 1;

    set_exit(state, exit < (double)last ? (size_t)exit : last, grid);
    if (can_divide_node(state, grid)) state->exit_offset = offset - floor(offset);
}

// ---- Newton

/* Largest relative tolerance of a linear system. Measured on two point contacts of 128 cells: with
 * a largest tolerance of 0.01 they take 10 Newton iterations and 86 GMRES iterations. With 1e-4
 * they take 10 and 109, with 0.1 they take 11 and 84 (test_full_point.c,
 * inexact_newton_ends_where_dense_does). */
static const double MAX_FORCING = 0.01;

/* Returns the relative tolerance of the linear system in an inexact Newton step (Eisenstat and
 * Walker, SIAM J. Sci. Comput. 17, 1996). The tolerance is loose far from the solution. Near the
 * solution it is as tight as Newton's tolerance requires. On a line contact a system costs little,
 * and the tolerance is always linear_tolerance. */
static double linear_tolerance(const full_solver *self, double residual) {
    const full_settings *settings = &self->settings;

    if (self->kind->dimensions == 1) return settings->linear_tolerance;
    double forcing = 0.1 * fmax(residual, settings->tolerance / residual);
    return fmin(fmax(forcing, settings->linear_tolerance), MAX_FORCING);
}

/* Finds the Newton step. EHD_NOT_CONVERGED, with info->reason: there is no step. */
static ehd_status find_step(full_info *info, const full_state *state, full_solver *self,
                            ehd_error *error) {
    size_t iterations = 0;
    full_system system = {.grid = &self->grid,
                          .deflection = self->deflection,
                          .num_unknowns = self->num_unknowns,
                          .unknown = self->unknown,
                          .index = self->index,
                          .stencils = self->stencils,
                          .rows = self->rows,
                          .row_scale = self->row_scale,
                          .outer = &self->outer,
                          .closure_approach = self->closure.by_approach / grid_cell(&self->grid),
                          .closure_load = self->closure.by_load,
                          .closure_residual = closure_residual(self, state),
                          .near_field = self->settings.near_field,
                          .keeps_factors = self->keeps_factors,
                          .step = self->step,
                          .threads = self->threads,
                          .workspace = self->workspace};
    const double tolerance = linear_tolerance(self, info->residual);
    const double before = program_seconds();
    ehd_status status = self->settings.solve_linear(&system, tolerance, &iterations, error);
    info->seconds.linear += program_seconds() - before;
    info->gmres_iterations += iterations;
    if (status == EHD_NOT_CONVERGED) info->reason = "linear system singular";
    if (status) return status;

    self->step_approach = system.step_approach;
    if (isnan(state->exit_offset)) return EHD_OK;
    deflection_apply(self->step_film, self->deflection, self->step);
    self->step_offset = change_of_offset(self, state);
    return EHD_OK;
}

/* Sets the state to `base` plus the fraction `part` of the Newton step, and evaluates its rows. The
 * rows keep the scales of the base. */
static void move(full_solver *self, const ehd_contact *contact, const reynolds_squeeze *squeeze,
                 full_state *state, double part) {
    const step_base *base = &self->base;

    state->exit = base->exit;
    state->exit_offset = base->exit_offset;
    state->rigid_approach = base->rigid_approach + part * self->step_approach;
    for (size_t k = 1; k < state->exit; k++) // the step is zero at nodes without pressure
        state->pressure[k] = base->pressure[k] + part * self->step[k];
    if (!isnan(base->exit_offset)) move_exit(state, &self->grid, part * self->step_offset);
    evaluate_rows(self, contact, squeeze, state);
}

/* Sums the squares of the scaled residuals in one part of the work. The sum of the first part
 * includes the closure. */
static void square_some_rows(void *context, const team_part *part) {
    const evaluation *task = context;
    const full_solver *self = task->solver;
    const double of_closure = part->number > 0 ? 0 : closure_residual(self, task->state);
    double sum = of_closure * of_closure;

    for (size_t r = part->first; r < part->end; r++) {
        const double scaled = self->rows[r].residual * self->row_scale[r];
        if (full_has_pressure(task->state, grid_node_of_row(&self->grid, r)))
            sum += scaled * scaled;
    }
    self->of_part[part->number] = sum;
}

/* Returns the square sum of the scaled residuals of the closure and of rows at nodes with pressure.
 * A short enough part of a Newton step reduces this sum. */
static double merit(full_solver *self, full_state *state) {
    const size_t num_rows = self->grid.num_inner, part = self->part;
    evaluation task = {.solver = self, .state = state};
    double sum = 0;

    team_share(self->threads, num_rows, part, square_some_rows, &task);
    for (size_t i = 0; i < team_num_parts(num_rows, part); i++)
        sum += self->of_part[i];
    if (!isnan(state->exit_offset)) {
        const double scaled =
            self->cell.flux_residual * self->row_scale[row_of_exit(state, &self->grid)];
        sum += scaled * scaled;
    }
    return sum;
}

static bool film_is_positive(const full_solver *self, const full_state *state) {
    for (size_t k = 0; k < self->grid.num_nodes; k++)
        if (!(state->film[k] > 0)) return false;
    return true;
}

/* Largest number of halvings of a Newton step. With halvings 196 cold starts of line contacts (M 1
 * to 2000, L 0 to 25, Barus and Roelands, accurate rows) take 5.6 iterations on average. Without
 * halvings they take 88 (test_full_solver.c, steps_are_searched). */
static const int MAX_HALVINGS = 10;

/* If the sum of squares of the scaled residuals is below this limit, a Newton step need not reduce
 * the residuals. The first Newton steps from the solution of a neighbouring contact may increase
 * them. Measured on the region of lower load (scenes/studies/stationary-line), on a grid of step
 * 0.01, with starts from neighbours: with a limit of 1e-2 all contacts together take 837
 * iterations. If each Newton step must reduce the residuals, they take 1884 (README.md, Newton). */
static const double SMALL_RESIDUALS = 1e-2;

/* Takes a Newton step. Halves the step until the film is positive and the residuals are smaller
 * than the largest residuals from which a step of this solution has started. From one step to the
 * next the residuals may thus grow, as they do in the first steps from a film that is too thick (L.
 * Grippo, F. Lampariello, S. Lucidi, SIAM J. Numer. Anal. 23, 1986). After MAX_HALVINGS halvings a
 * step with a positive film is taken whatever its residuals. If the film is not positive, or if
 * there is no Newton step, returns EHD_NOT_CONVERGED and sets info->reason. */
static ehd_status take_step(full_info *info, full_state *state, full_solver *self,
                            const ehd_contact *contact, const reynolds_squeeze *squeeze,
                            ehd_error *error) {
    double factor = 1;
    self->largest_merit = fmax(self->largest_merit, merit(self, state));
    ehd_status status = find_step(info, state, self, error);
    if (status) return status;

    memcpy(self->base.pressure, state->pressure, self->grid.num_nodes * sizeof(double));
    self->base.rigid_approach = state->rigid_approach;
    self->base.exit = state->exit;
    self->base.exit_offset = state->exit_offset;
    move(self, contact, squeeze, state, factor);
    for (int i = 0; i < MAX_HALVINGS; i++) {
        if (film_is_positive(self, state) && merit(self, state) < self->largest_merit) break;
        factor /= 2;
        move(self, contact, squeeze, state, factor);
    }
    if (film_is_positive(self, state)) return EHD_OK;
    info->reason = "film driven to zero, as by too coarse a grid";
    return EHD_NOT_CONVERGED;
}

/* Returns the largest violation of P >= 0 and of the scaled Lambda >= 0. */
static double complementarity(const full_solver *self, const full_state *state) {
    double worst = 0;

    for (size_t r = 0; r < self->grid.num_inner; r++) {
        size_t k = grid_node_of_row(&self->grid, r);
        worst = fmax(worst, exit_violation(full_has_pressure(state, k), state->pressure[k],
                                           scaled_multiplier(self, k)));
    }
    return worst;
}

// In a transient run, or with a surface that is not smooth, the sign of a pressure (in Hertz
// pressures) or scaled multiplier is ignored if its magnitude is below this limit. Within a
// ruptured zone the sign is round-off. Measured on the paper's transient case (load amplitude 30 %,
// period 1/4, up to T = 1): it takes 6439 iterations with a limit of 1e-7, and 8664 without a
// limit. With limits of 1e-10 and 1e-9 the time steps become too short (test_full_march.c,
// sine_leads_to_a_periodic_state). Stationary contacts with smooth surfaces need no such limit.
static const double NOISE = 1e-7;

// values of index[]: a node gets pressure because of the sign of its own pressure or multiplier
// (WANTED), or because of the multipliers of nodes beside it (JOINED)
enum { WANTED = 1, JOINED };

/* On a line contact, marks runs of neighbouring nodes with negative multipliers, even if the
 * multipliers are small. A gap that closes far behind the exit has such a run. A run of n nodes
 * with the mean multiplier -m builds up a pressure of about m n^2 / 4. Returns whether a run was
 * marked. If single nodes were marked instead, the second zone of pressure would begin at a time
 * that depends on the grid: T = 0, 10 and 20 with a grid step of 0.02, 0.01 and 0.005 (line
 * contact, M = 3, L = 3, growing radius). */
static bool mark_runs(full_solver *self, const full_state *state) {
    // A run of n nodes with the mean scaled multiplier -m is marked if n^2 m exceeds this limit.
    // With a limit of 1e-4 the solutions of fewer than one time step in a hundred change
    // (test_second_zone.c, the_zone_does_not_depend_on_the_grid).
    const double least = 1e-5;
    const size_t end = self->grid.num_nodes - 1;
    bool found = false;

    for (size_t k = 1; k < end; k++) {
        const size_t first = k;
        double sum = 0;
        for (; k < end && !full_has_pressure(state, k) && scaled_multiplier(self, k) < 0; k++)
            sum -= scaled_multiplier(self, k);
        if (!(sum * (double)(k - first) > least)) continue;
        found = true;
        for (size_t i = first; i < k; i++)
            self->index[i] = WANTED;
    }
    return found;
}

/* Extends the pressure intervals of a line contact from the marked nodes, in both directions, until
 * the multipliers add up to zero. At this place the film can carry the arriving flow without
 * pressure. If intervals grew by one node per iteration, the roller that moves to and fro in
 * scenes/examples/line-in-time would take 4313 iterations instead of 2850. A second zone of
 * pressure grows by hundreds of nodes and would exceed the limit of iterations. On point contacts
 * this extension would take 4 % more iterations. */
static void grow_intervals(full_solver *self, const full_state *state) {
    const size_t num_rows = self->grid.num_inner;
    double sum[2] = {0, 0}; // sums of multipliers from the marked nodes on, forwards and backwards

    for (size_t i = 0; i < num_rows; i++)
        for (int way = 0; way < 2; way++) {
            const size_t r = way ? num_rows - 1 - i : i, k = grid_node_of_row(&self->grid, r);
            const double next = sum[way] + exit_multiplier(&self->rows[r]);
            const bool wanted = self->index[k] == WANTED, joins = sum[way] < 0 && next < 0;
            const bool grows = !full_has_pressure(state, k) && (wanted || joins);
            sum[way] = grows ? next : 0;
            if (grows && !wanted) self->index[k] = JOINED;
        }
}

/* Sets the pressurised zone by a primal-dual active set: each node follows the sign of its pressure
 * or multiplier. This is a semismooth Newton step (Hintermueller, Ito and Kunisch 2003). Returns
 * whether the zone has changed. A node may enter and leave the zone any number of times. With a
 * limit of four changes, all measured marches and 149 of 150 cold starts of point contacts would
 * stay the same. */
static bool adapt_zone(full_solver *self, full_state *state, bool in_time) {
    const ehd_grid *grid = &self->grid;
    size_t last = 0;
    bool changed = false;
    const bool line = grid->inner_lines == 1;
    const double noise = in_time || self->surface ? NOISE : 0;

    // An exit within a cell is moved by the Newton step, not by the active set. If a
    // surface is not smooth, the active set is needed nevertheless, because another zone may arise
    // behind the exit.
    if (!isnan(state->exit_offset) && !self->surface) return false;

    for (size_t r = 0; r < grid->num_inner; r++) {
        const size_t k = grid_node_of_row(grid, r);
        const bool open = full_has_pressure(state, k);
        const bool wanted =
            open ? state->pressure[k] >= -noise : scaled_multiplier(self, k) < -noise;
        changed |= wanted != open;
        self->index[k] = wanted ? WANTED : 0; // not yet stored in the state, because the next nodes
                                              // need the old zone
    }
    if (line) changed |= mark_runs(self, state);
    if (!changed) return false;
    if (line) grow_intervals(self, state);
    for (size_t r = 0; r < grid->num_inner; r++)
        if (self->index[grid_node_of_row(grid, r)]) last = grid_node_of_row(grid, r);
    state->exit = grid->inner_lines > 1 ? grid->num_nodes - 1 : last + 1;
    for (size_t r = 0; r < grid->num_inner; r++) {
        size_t k = grid_node_of_row(grid, r);
        state->ruptured[k] = k < state->exit && !self->index[k];
        if (!self->index[k]) state->pressure[k] = 0;
    }
    return true;
}

static void list_unknowns(full_solver *self, const full_state *state) {
    self->num_unknowns = 0;
    for (size_t k = 0; k < self->grid.num_nodes; k++) {
        bool open = full_has_pressure(state, k);
        self->index[k] = open ? self->num_unknowns : NO_NODE;
        if (open) self->unknown[self->num_unknowns++] = k;
    }
}

/* Returns the scaled residual that round-off may leave in the closure equation. The entries of this
 * row are 1, so round-off leaves some units in the last place of the sum of pressures. This
 * residual grows with the number of nodes. From 1400 nodes a side on, it exceeds the default
 * tolerance. */
static double rounding_left(const full_solver *self) {
    const double sum = fabs(self->closure.value) / grid_cell(&self->grid);

    return fmax(full_default_settings().tolerance, 4 * DBL_EPSILON * sum);
}

/* Checks whether the residual is below the tolerance. A tolerance below the default one is met as
 * far as round-off allows: the residual is below the default tolerance and no longer falls
 * (test_full_solver.c, rounding_ends_the_iteration). */
static bool is_solved(const full_solver *self, double residual, double last_residual) {
    if (residual < self->settings.tolerance) return true;
    return self->largest_row < full_default_settings().tolerance &&
           residual < rounding_left(self) && residual > 0.5 * last_residual;
}

/* Computes the position of an exit between nodes, for a solution with exits at nodes. `last` is the
 * last node of an interval with pressure. Returns the distance of the exit downstream of `last`, in
 * steps of the grid. NaN: the exit stays at the node behind `last`. */
static double place_of_exit(const full_solver *self, double entrainment,
                            const reynolds_squeeze *squeeze, const full_state *state, size_t last,
                            bool backwards) {
    const ehd_grid *grid = &self->grid;
    const size_t before = backwards ? grid->num_nodes - 1 - last : last;

    if (!exit_is_within_node(grid) || before < 3 || before + 2 >= grid->num_nodes) return NAN;
    const size_t r = grid_row_of_node(grid, last);
    const reynolds_stencil reversed = reynolds_stencil_reversed(grid, last);
    const reynolds_stencil *stencil = backwards ? &reversed : &self->stencils[r];
    const double speed = backwards ? -entrainment : entrainment;
    double previous[3]; // values upstream of the node, at the node and downstream of it
    const reynolds_squeeze around = {squeeze ? squeeze->rate : 0, previous};

    for (size_t i = 0; i < 3 && squeeze; i++)
        previous[i] = squeeze->previous[backwards ? r + 1 - i : r + i - 1];
    const double flux =
        reynolds_flux(grid, speed, stencil, &self->fluid, state->pressure, state->film).residual;
    return exit_place(grid, speed, flux, squeeze ? &around : NULL, stencil, &self->fluid,
                      state->film);
}

void full_place_exits(double *positions, const full_state *state, const full_solver *self,
                      const ehd_contact *contact, const reynolds_squeeze *squeeze, bool backwards) {
    const ehd_grid *grid = &self->grid;
    const double downstream = backwards ? -1 : 1;

    full_list_exits(positions, state, grid, backwards);
    for (size_t i = 0; i < GRID_EXITS && !isnan(positions[i]); i++) {
        const double column = round((positions[i] - grid->x_min) / grid->step) + 1 - downstream;
        const double place =
            place_of_exit(self, contact->entrainment, squeeze, state, (size_t)column, backwards);
        if (!isnan(place)) positions[i] += downstream * (place - 1) * grid->step;
    }
}

static ehd_status newton(full_info *info, full_state *state, full_solver *self,
                         const ehd_contact *contact, const reynolds_squeeze *squeeze,
                         bool within_node, ehd_error *error) {
    ehd_error ignored;

    if (!within_node) state->exit_offset = NAN;
    self->largest_merit = SMALL_RESIDUALS;
    evaluate_rows(self, contact, squeeze, state);
    for (size_t iteration = 0; iteration <= self->settings.max_iterations; iteration++) {
        const double last_residual = info->residual;
        info->residual = scale_rows(self, state);
        if (within_node && divide_node(self, contact->entrainment, state)) {
            evaluate_rows(self, contact, squeeze, state);
            info->residual = scale_rows(self, state);
        }
        if (!isfinite(info->residual)) {
            info->reason = "residual not finite";
            return EHD_OK;
        }
        // the zone follows from the pressures after a Newton step, so it is not adapted before the
        // first Newton step
        if (iteration > 0 && adapt_zone(self, state, squeeze != NULL)) {
            evaluate_rows(self, contact, squeeze, state);
            info->residual = scale_rows(self, state);
        } else if (iteration > 0 && is_solved(self, info->residual, last_residual)) {
            info->status = EHD_OK;
            info->complementarity = complementarity(self, state);
            info->reason = "";
            if (self->settings.exit_at_node)
                state->exit_offset = place_of_exit(self, contact->entrainment, squeeze, state,
                                                   state->exit - 1, false);
            return EHD_OK;
        }
        if (self->settings.watcher)
            self->settings.watcher(self->settings.watcher_context, &self->grid, iteration,
                                   info->residual);
        if (iteration == self->settings.max_iterations || program_interrupted()) break;

        list_unknowns(self, state);
        self->keeps_factors = squeeze && iteration > 0;
        ehd_status status = take_step(info, state, self, contact, squeeze, &ignored);
        info->newton_iterations++;
        if (status == EHD_NOT_CONVERGED) return EHD_OK;
        if (status) return ehd_fail(error, status, "%s", ignored.text);
    }
    if (program_interrupted()) return ehd_fail(error, EHD_INTERRUPTED, "full model: interrupted");
    info->reason = "iteration limit reached";
    return EHD_OK;
}

static void info_start(full_info *info) {
    memset(info, 0, sizeof *info);
    info->status = EHD_NOT_CONVERGED;
    info->residual = INFINITY;
    info->seconds.exit = NAN;
    info->reason = "";
}

static ehd_status solve(full_info *info, full_state *state, full_solver *self,
                        const ehd_contact *contact, const reynolds_squeeze *squeeze,
                        bool within_node, ehd_error *error) {
    double before = program_seconds();

    info_start(info);
    self->seconds_rows = 0;
    ehd_status status = newton(info, state, self, contact, squeeze, within_node, error);
    info->seconds.rows = self->seconds_rows;
    info->seconds.total = program_seconds() - before;
    return status;
}

bool full_exit_is_within_node(const full_solver *self) {
    return !self->settings.exit_at_node && exit_is_within_node(&self->grid);
}

ehd_status full_solve(full_info *info, full_state *state, full_solver *solver,
                      const ehd_contact *contact, const reynolds_squeeze *squeeze,
                      ehd_error *error) {
    const bool within_node = !squeeze && full_exit_is_within_node(solver);

    return solve(info, state, solver, contact, squeeze, within_node, error);
}

ehd_status full_solve_nodal(full_info *info, full_state *state, full_solver *solver,
                            const ehd_contact *contact, ehd_error *error) {
    return solve(info, state, solver, contact, NULL, false, error);
}
