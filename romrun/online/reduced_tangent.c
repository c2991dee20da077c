/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/online/reduced_tangent.h"

#include "common/algebra/vectors.h"
#include "romrun/solve/exit_search.h"
#include "romrun/solve/row_system.h"
#include "romrun/trust/functionals.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct reduced_tangent {
    const reduced_model *model;
    node_state nodes;
    row_system system;
    exit_search exits;
    reduced_state state; // state at which the equations are linearised
    bool with_cell;      // true: the exit lies within the cell of a node, and the least squares
                         // have a row for this cell
    bool at_place;       // true: the exit of the solution is a node; the flux determines where in
                         // the cell behind this node the exit lies
    size_t num_rows;
    double *rights;       // [2, system_max_rows] right sides at -distance/2 and +distance/2
    double *along, *slow; // [num_unknowns] results of reduced_tangent_along and
                          // reduced_tangent_slow
    double *coordinates;  // [num_unknowns] work memory
    arena memory;
};

reduced_tangent *reduced_tangent_free(reduced_tangent *self) {
    if (!self) return NULL;
    system_free(&self->system);
    reduced_state_free(&self->state);
    arena_free(&self->memory);
    free(self);
    return NULL;
}

ehd_status reduced_tangent_create(reduced_tangent **created, const reduced_model *model,
                                  ehd_error *error) {
    reduced_tangent *self = calloc(1, sizeof *self);

    *created = NULL;
    if (!self) return ehd_no_memory(error, "derivatives");
    self->model = model;
    nodes_init(&self->nodes, model, &self->memory);
    system_init(&self->system, model, &self->memory);
    exits_init(&self->exits, model, 0, &self->memory);
    self->rights = arena_array(&self->memory, system_max_rows(model), 2 * sizeof(double));
    self->along = arena_array(&self->memory, model->num_unknowns, sizeof(double));
    self->slow = arena_array(&self->memory, model->num_unknowns, sizeof(double));
    self->coordinates = arena_array(&self->memory, model->num_unknowns, sizeof(double));
    if (self->memory.failed || reduced_state_init(&self->state, model, NULL)) {
        reduced_tangent_free(self);
        return ehd_no_memory(error, "derivatives");
    }
    *created = self;
    return EHD_OK;
}

static ehd_status singular(ehd_error *error) {
    return ehd_fail(
        error, EHD_NOT_CONVERGED,
        "derivatives: found least squares without a single finite solution, expected one");
}

// ---- the equations

/* Evaluates the rows at self->state, around which the equations are linearised. Only rows before
 * the exits of this state count. With `with_cell`, also evaluates the grid cell in which the exit
 * of a stationary line contact lies. Returns whether this cell was found (exits_find_cell). */
static bool evaluate(reduced_tangent *self, const reduced_equations *of, bool with_cell) {
    reduced_state *state = &self->state;
    const double approach = state->coordinates[self->model->num_unknowns - 1];

    nodes_move_exit(&self->nodes, reduced_state_exits(state));
    nodes_expand_state(&self->nodes, NULL, state->coordinates);
    system_evaluate(&self->system, &self->nodes, approach, of->contact, of->squeeze, NULL);
    const bool has_cell =
        with_cell && exits_find_cell(&self->exits, &self->nodes, state, of->contact,
                                     system_flux(&self->system, of->contact, &self->nodes));
    system_list_active(&self->system, &self->nodes, has_cell ? state->exit - 1 : NO_NODE);
    return has_cell;
}

/* Adds `distance` times a change to the linearised state. Stores the coordinates of the sum in
 * self->coordinates and evaluates the sum at the nodes. */
static void move_along(reduced_tangent *self, const reduced_change *change, double distance) {
    const size_t n = self->model->num_unknowns;

    memcpy(self->coordinates, self->state.coordinates, n * sizeof *self->coordinates);
    nodes_add_row(self->coordinates, distance, change->coordinates, n);
    nodes_expand_state(&self->nodes, NULL, self->coordinates);
}

/* Fills the right side of the least squares and returns its number of rows. The residuals are
 * evaluated with a fixed position of the exit within its cell. The change of this position is then
 * eliminated from the right side, as from the matrix (exit.h). */
static size_t fill_right(reduced_tangent *self, const reduced_equations *of) {
    const size_t num_rows =
        system_fill_right(&self->system, &self->nodes, self->state.coordinates, self->system.active,
                          self->system.num_active, system_closure_weight(of->squeeze));

    if (!self->with_cell) return num_rows;
    system_add_cell_right(&self->system, &self->nodes, &self->exits.cell);
    return num_rows + 1;
}

ehd_status reduced_tangent_at(reduced_tangent *self, const reduced_state *state,
                              const reduced_equations *equations, bool exit_at_node,
                              ehd_error *error) {
    row_system *system = &self->system;
    const reduced_model *model = self->model;
    const bool within = exit_is_within_node(&model->grid) && !isnan(state->exit_offset);

    reduced_state_copy(&self->state, state, model);
    self->with_cell = evaluate(self, equations, within && !exit_at_node && !equations->squeeze);
    self->at_place = within && !self->with_cell;
    system_fill_matrix(system, &self->nodes, system_closure_weight(equations->squeeze));
    if (self->with_cell) system_add_cell(system, &self->nodes, &self->exits.cell);
    self->num_rows = fill_right(self, equations);
    if (least_squares_solve(system->step, system->factors, system->matrix, system->right,
                            self->num_rows))
        return singular(error);
    return EHD_OK;
}

/* Computes z = argmin |J z + right|, [num_unknowns], where J is the Jacobian of the linearised
 * equations. */
static ehd_status solve(reduced_change *change, double *z, reduced_tangent *self,
                        const double *right, ehd_error *error) {
    row_system *system = &self->system;

    if (least_squares_again(z, system->factors, system->matrix, right, self->num_rows) &&
        least_squares_solve(z, system->factors, system->matrix, right, self->num_rows))
        return singular(error);
    *change = (reduced_change){.coordinates = z};
    if (self->with_cell)
        change->exit_offset = dot(self->system.offset, z, self->model->num_unknowns);
    return EHD_OK;
}

ehd_status reduced_tangent_along(reduced_change *change, reduced_tangent *self,
                                 const reduced_equations beside[2], double distance,
                                 ehd_error *error) {
    double *sides[2] = {self->rights, self->rights + system_max_rows(self->model)};
    double offset[2] = {0, 0};

    for (int i = 0; i < 2; i++) {
        if (evaluate(self, &beside[i], self->with_cell) != self->with_cell) return singular(error);
        fill_right(self, &beside[i]);
        memcpy(sides[i], self->system.right, self->num_rows * sizeof(double));
        if (self->with_cell) offset[i] = self->exits.cell.offset.residual;
    }
    for (size_t i = 0; i < self->num_rows; i++)
        sides[1][i] = (sides[1][i] - sides[0][i]) / distance;
    const ehd_status status = solve(change, self->along, self, sides[1], error);
    if (self->with_cell) change->exit_offset += (offset[1] - offset[0]) / distance;
    return status;
}

/* Computes self->system.right += factor * D rho H at the nodes of the active rows. D: weights of
 * the rows. rho H is evaluated for the linearised state plus `distance` times a change. */
static void add_mass(reduced_tangent *self, const reduced_change *change, double distance,
                     const ehd_contact *contact, double factor) {
    const row_set *set = &self->model->rows;
    row_system *system = &self->system;

    move_along(self, change, distance);
    for (size_t i = 0; i < system->num_active; i++) {
        const size_t r = system->active[i], q = set->stencils[r].node[NODE_HERE];
        const double pressure = self->nodes.now.pressure[q] * contact->hertz_pressure;
        system->right[i] += factor * set->weight[r] * self->nodes.now.film[q] *
                            lubricant_density(&contact->lubricant, pressure);
    }
}

/* Adds factor * D X d(rho H)/dX to the right side. d(rho H)/dX is the difference between the
 * residuals of the rows without entrainment and with an entrainment of 1. */
static void add_slope(reduced_tangent *self, const ehd_contact *contact, double factor) {
    const row_set *set = &self->model->rows;
    row_system *system = &self->system;

    for (int i = 0; i < 2; i++) {
        ehd_contact entrained = *contact;
        entrained.entrainment = i;
        evaluate(self, &(reduced_equations){&entrained, NULL}, false);
        system_list_active(system, &self->nodes, self->with_cell ? self->state.exit - 1 : NO_NODE);
        for (size_t k = 0; k < system->num_active; k++) {
            const size_t r = system->active[k];
            system->right[k] += (i ? -factor : factor) * set->weight[r] *
                                grid_x(&self->model->grid, set->node[r]) * system->rows[r].residual;
        }
    }
}

/* Returns the change of the approach in `change` that the remaining least-squares residual causes,
 * as functionals_film_error does for a film. `change` must be the solution for
 * self->system.right. */
static double bound_of_approach(reduced_tangent *self, const reduced_change *change) {
    const row_system *system = &self->system;
    const size_t n = self->model->num_unknowns, num_rows = self->num_rows;
    double *left = self->rights, *moves = self->rights + system_max_rows(self->model), sum = 0;
    double *gradient = self->coordinates;

    memset(gradient, 0, n * sizeof *gradient);
    gradient[n - 1] = 1;
    functionals_moves(moves, gradient, system->factors, system->matrix, num_rows, n);
    functionals_left(left, system->right, system->matrix, change->coordinates, num_rows, n);
    for (size_t i = 0; i < num_rows; i++)
        sum += pow(left[i] * moves[i], 2);
    return sqrt(sum);
}

ehd_status reduced_tangent_slow(reduced_change *slow, double *bound, reduced_tangent *self,
                                const reduced_change *change, const ehd_contact *contact,
                                const reduced_motion *motion, ehd_error *error) {
    memset(self->system.right, 0, self->num_rows * sizeof(double));
    add_slope(self, contact, (motion->half_width[1] - motion->half_width[0]) / motion->distance);
    for (int i = 0; i < 2; i++)
        add_mass(self, change, (i - 0.5) * motion->distance, &motion->contacts[i],
                 (i ? -1 : 1) * motion->film_scale[i] / motion->distance);
    const ehd_status status = solve(slow, self->slow, self, self->system.right, error);
    if (!status) *bound = bound_of_approach(self, slow);
    return status;
}

// ---- scalars

static double exit_of(reduced_tangent *self, const reduced_change *change, double distance,
                      const reduced_equations *beside) {
    reduced_state moved = self->state;

    if (self->with_cell) {
        moved.exit_offset += distance * change->exit_offset;
    } else if (self->at_place) {
        moved.coordinates = self->coordinates;
        moved.exit_offset =
            exits_place(&self->exits, &self->nodes, &moved, beside->contact, beside->squeeze);
    }
    return self->with_cell || self->at_place ? reduced_exit_position(&moved, self->model) : NAN;
}

reduced_quantities reduced_tangent_quantities(reduced_tangent *self, const reduced_change *change,
                                              double distance, const reduced_equations *beside) {
    const double *z = self->coordinates;
    reduced_quantities found;

    move_along(self, change, distance);
    const double exit = exit_of(self, change, distance, beside);
    found.scalars = nodes_scalars(&self->nodes, z, exit, beside->contact);
    found.peak_pressure =
        fmax(nodes_pressure_range(&self->nodes, z).largest, found.scalars.central_pressure);
    return found;
}
