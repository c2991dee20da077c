/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/trust/functionals.h"

#include "common/algebra/product.h"
#include "common/algebra/vectors.h"
#include "common/physics/far_field.h"
#include "romrun/solve/row_system.h"
#include "romrun/solve/solved_system.h"
#include "romrun/state/node_traction.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK = 32 }; // largest number of quantities whose errors are computed together

/* Changes of a film that an error of 1 in each row causes. They are valid while gradient and matrix
 * stay the same. With kept factors this is often so for many time steps. */
typedef struct film_moves {
    size_t matrix_number; // number of the kept matrix with which `moves` was computed; 0: `moves`
                          // cannot be used again
    double *gradient;     // [num_unknowns]
    double *moves;        // [system_max_rows]
} film_moves;

struct functionals {
    const reduced_model *model;
    solved_system solved; // the last solution
    double *unsolved;     // [system_max_rows] square of the residual after the last Newton step,
                          // plus the squared change by the iterations that were not made
    double *square;       // [system_max_rows] `unsolved` plus the squares of control residuals
    double *gradients;    // [BLOCK, num_unknowns]
    double *moves;        // [system_max_rows]
    film_moves films[NUM_REDUCED_FILMS];
    double *band_influence; // [nodes of the band] work of functionals_friction_error
    double *exit_risk;      // [num_lines]
    arena memory;
};

functionals *functionals_free(functionals *self) {
    if (self) arena_free(&self->memory);
    free(self);
    return NULL;
}

functionals *functionals_create(const reduced_model *model) {
    const size_t max_rows = system_max_rows(model), n = model->num_unknowns;
    functionals *self = calloc(1, sizeof *self);

    if (!self) return NULL;
    arena *memory = &self->memory;
    self->model = model;
    self->unsolved = arena_array(memory, max_rows, sizeof(double));
    self->square = arena_array(memory, max_rows, sizeof(double));
    self->gradients = arena_array(memory, n, BLOCK * sizeof(double));
    self->moves = arena_array(memory, max_rows, sizeof(double));
    for (int q = 0; q < NUM_REDUCED_FILMS; q++) {
        self->films[q].gradient = arena_array(memory, n, sizeof(double));
        self->films[q].moves = arena_array(memory, max_rows, sizeof(double));
    }
    self->band_influence = arena_array(memory, model->band.num_nodes + 1, sizeof(double));
    self->exit_risk = arena_array(memory, model->band.num_lines, sizeof(double));
    return memory->failed ? functionals_free(self) : self;
}

// ---- from gradients and residuals to errors

void functionals_left(double *left, const double *right, const double *matrix, const double *step,
                      size_t num_rows, size_t num_columns) {
    memcpy(left, right, num_rows * sizeof *left);
    add_product(left, matrix, num_columns, num_rows, num_columns, step);
}

/* Computes J times the dual of a gradient (least_squares.h). */
static void moves_of_dual(double *moves, const double *dual, const double *matrix, size_t num_rows,
                          size_t num_columns) {
    memset(moves, 0, num_rows * sizeof *moves);
    add_product(moves, matrix, num_columns, num_rows, num_columns, dual);
}

void functionals_moves(double *moves, double *gradient, least_squares *factors,
                       const double *matrix, size_t num_rows, size_t num_columns) {
    least_squares_duals(gradient, factors, 1);
    moves_of_dual(moves, gradient, matrix, num_rows, num_columns);
}

/* Takes the last solution of a solver. If this solution is new, computes its residuals. */
static const solved_system *take_solution(functionals *self, reduced_solver *solver) {
    solved_system *solved = &self->solved;
    const solved_system known = *solved;

    *solved = reduced_solved_system(solver);
    if (solved->nodes != known.nodes) // another solver, which numbers its own matrices
        for (int q = 0; q < NUM_REDUCED_FILMS; q++)
            self->films[q].matrix_number = 0;
    else if (solved->solution_number == known.solution_number)
        return solved;
    functionals_left(self->unsolved, solved->right, solved->matrix, solved->step, solved->num_rows,
                     self->model->num_unknowns);
    for (size_t i = 0; i < solved->num_rows; i++) {
        const double left = self->unsolved[i];
        self->unsolved[i] = pow(left, 2) + pow(solved->remaining * (left - solved->right[i]), 2);
    }
    return solved;
}

static double error_of(const double *moves, const double *square, size_t num_rows) {
    double sum = 0;

    for (size_t i = 0; i < num_rows; i++)
        sum += square[i] * pow(moves[i], 2);
    return sqrt(sum);
}

/* Computes the errors of `num` quantities from self->gradients, which it overwrites. */
static void find_errors(double *errors, functionals *self, size_t num, const double *added) {
    const solved_system *solved = &self->solved;
    const size_t num_rows = solved->num_rows, n = self->model->num_unknowns;

    for (size_t i = 0; i < num_rows; i++)
        self->square[i] =
            self->unsolved[i] + (i < solved->num_reynolds ? added[solved->row[i]] : 0);
    least_squares_duals(self->gradients, solved->factors, num);
    for (size_t k = 0; k < num; k++) {
        moves_of_dual(self->moves, self->gradients + k * n, solved->matrix, num_rows, n);
        errors[k] = error_of(self->moves, self->square, num_rows);
    }
}

// ---- gradients

/* Sets a gradient for the next call of find_errors to zero and returns it. */
static double *clear_gradient(functionals *self, size_t number) {
    const size_t n = self->model->num_unknowns;

    return memset(self->gradients + number * n, 0, n * sizeof *self->gradients);
}

/* Adds the derivatives of the deflection at X = 0. */
static void add_central_film(double *gradient, const node_state *nodes) {
    const centre_nodes *centre = &nodes->model->centre;

    for (size_t i = 0; i < 4; i++)
        if (centre->weight[i] != 0)
            nodes_add_film_row(gradient, centre->weight[i], nodes, centre->index[i]);
}

static void add_central_pressure(double *gradient, const node_state *nodes) {
    const centre_nodes *centre = &nodes->model->centre;
    const size_t num_pressure = nodes->model->num_pressure;

    for (size_t i = 0; i < 4; i++)
        if (centre->weight[i] != 0 && nodes->pressurised[centre->index[i]])
            nodes_add_row(gradient, centre->weight[i],
                          nodes->model->rows.pressure + centre->index[i] * num_pressure,
                          num_pressure);
}

/* Adds the derivatives of the load divided by the reference load. */
static void add_load(double *gradient, const node_state *nodes, const reduced_state *state,
                     const ehd_contact *contact) {
    const reduced_model *model = nodes->model;
    const double unit = 1 / model->kind->load;
    const double approach = state->coordinates[model->num_unknowns - 1];

    nodes_add_cut_row(gradient, unit, nodes, model->cut.num_rows - 1); // row of the load
    gradient[model->num_unknowns - 1] = unit * far_field_load(contact, approach).by_approach;
}

/* Returns the needed node with pressure at which the film is lowest, or NO_NODE. */
static size_t lowest_node(const node_state *nodes) {
    size_t lowest = NO_NODE;
    double least = INFINITY;

    for (size_t q = 0; q < nodes->model->rows.num_needed; q++) {
        if (!nodes->pressurised[q]) continue;
        if (lowest == NO_NODE) lowest = 0;
        if (nodes->now.film[q] < least) least = nodes->now.film[lowest = q];
    }
    return lowest;
}

// ---- films

/* Returns the changes of a film by an error of 1 in each row. Computes them only if the gradient or
 * the matrix has changed. */
static const double *find_film_moves(functionals *self, reduced_film film, double *gradient) {
    const solved_system *solved = &self->solved;
    const size_t n = self->model->num_unknowns, bytes = n * sizeof *gradient;
    film_moves *known = &self->films[film];

    if (solved->matrix_number > 0 && solved->matrix_number == known->matrix_number &&
        memcmp(gradient, known->gradient, bytes) == 0)
        return known->moves;
    known->matrix_number = solved->matrix_number;
    memcpy(known->gradient, gradient, bytes);
    functionals_moves(known->moves, gradient, solved->factors, solved->matrix, solved->num_rows, n);
    return known->moves;
}

double functionals_film_error(double *influence, functionals *self, reduced_solver *solver,
                              reduced_film film) {
    const solved_system *solved = take_solution(self, solver);
    const size_t lowest = lowest_node(solved->nodes);
    double *gradient = clear_gradient(self, 0);

    if (lowest == NO_NODE) return NAN;
    gradient[self->model->num_unknowns - 1] = 1;
    if (film == REDUCED_CENTRAL_FILM)
        add_central_film(gradient, solved->nodes);
    else
        nodes_add_film_row(gradient, 1, solved->nodes, lowest);
    const double *moves = find_film_moves(self, film, gradient);
    if (influence) {
        memset(influence, 0, self->model->rows.num_rows * sizeof *influence);
        for (size_t i = 0; i < solved->num_reynolds; i++)
            influence[solved->row[i]] = moves[i];
    }
    return error_of(moves, self->unsolved, solved->num_rows);
}

// ---- other quantities

/* Returns the largest error of P or H over the nodes of the rows before the exit. Needed nodes
 * without a row are left out, because all of them are near a node with a row. */
static double largest_field_error(functionals *self, bool of_film, const double *added) {
    const reduced_model *model = self->model;
    const node_state *nodes = self->solved.nodes;
    const size_t num_pressure = model->num_pressure;
    double errors[BLOCK], largest = 0;
    size_t count = 0;

    for (size_t r = 0; r < model->rows.num_rows; r++) {
        const size_t q = model->rows.stencils[r].node[NODE_HERE];
        const bool is_last = r + 1 == model->rows.num_rows;
        if (nodes->pressurised[q]) {
            double *gradient = clear_gradient(self, count++);
            if (of_film) {
                gradient[model->num_unknowns - 1] = 1;
                nodes_add_film_row(gradient, 1, nodes, q);
            } else {
                memcpy(gradient, model->rows.pressure + q * num_pressure,
                       num_pressure * sizeof(double));
            }
        }
        if (count == 0 || (count < BLOCK && !is_last)) continue;
        find_errors(errors, self, count, added);
        for (size_t k = 0; k < count; k++)
            if (!(errors[k] <= largest)) largest = errors[k];
        count = 0;
    }
    return largest;
}

reduced_errors functionals_other_errors(functionals *self, reduced_solver *solver,
                                        const reduced_state *state, const ehd_contact *contact,
                                        const double *added) {
    enum { CENTRAL_PRESSURE, LOAD, EXIT, NUM_SCALARS };
    const solved_system *solved = take_solution(self, solver);
    double errors[NUM_SCALARS], *offset = clear_gradient(self, EXIT);

    add_central_pressure(clear_gradient(self, CENTRAL_PRESSURE), solved->nodes);
    add_load(clear_gradient(self, LOAD), solved->nodes, state, contact);
    if (solved->offset) memcpy(offset, solved->offset, self->model->num_unknowns * sizeof *offset);
    find_errors(errors, self, NUM_SCALARS, added);
    return (reduced_errors){.central_pressure = errors[CENTRAL_PRESSURE],
                            .load = errors[LOAD],
                            .exit_position =
                                solved->offset ? self->model->grid.step * errors[EXIT] : NAN,
                            .pressure = largest_field_error(self, false, added),
                            .film = largest_field_error(self, true, added)};
}

double functionals_peak_error(functionals *self, reduced_solver *solver, const double *added) {
    const node_state *nodes = take_solution(self, solver)->nodes;
    const reduced_model *model = self->model;
    const double *pressure = nodes->now.values.pressure;
    double error = NAN;
    size_t peak = NO_NODE;

    for (size_t r = 0; r < model->rows.num_rows; r++) {
        const size_t q = model->rows.stencils[r].node[NODE_HERE];
        if (!nodes->pressurised[q]) continue;
        if (peak == NO_NODE || pressure[q] > pressure[peak]) peak = q;
    }
    if (peak == NO_NODE) return NAN;
    memcpy(clear_gradient(self, 0), model->rows.pressure + peak * model->num_pressure,
           model->num_pressure * sizeof(double));
    find_errors(&error, self, 1, added);
    return error;
}

// ---- friction

/* Computes self->exit_risk, the risk that the exit of a grid line is wrong by one node. In a point
 * contact the risk is the error of the pressure at the line's last node with pressure, divided by
 * the margin of the exit (exits_margins), and at most 1. In a line contact the risk is 1. */
static void find_exit_risks(functionals *self, const reduced_state *state,
                            const ehd_contact *contact, const double *added) {
    const reduced_model *model = self->model;
    const solved_system *solved = &self->solved;
    const size_t num_lines = model->band.num_lines;
    double *risk = self->exit_risk, errors[BLOCK];
    size_t line[BLOCK], count = 0;

    risk[0] = 1;
    if (num_lines == 1) return;
    exits_margins(risk, solved->exits, solved->nodes, state->coordinates, contact);
    for (size_t l = 0; l < num_lines; l++) {
        if (isfinite(risk[l])) {
            const band_line *band = &model->band.lines[l];
            const size_t last = band->offset + solved->nodes->exit[l] - 1 - band->begin;
            memcpy(clear_gradient(self, count), model->band.pressure + last * model->num_pressure,
                   model->num_pressure * sizeof(double));
            line[count++] = l;
        }
        if (count == 0 || (count < BLOCK && l + 1 < num_lines)) continue;
        find_errors(errors, self, count, added);
        for (size_t k = 0; k < count; k++)
            // an error is NaN if residuals are NaN; the bound is then NaN anyway
            risk[line[k]] = errors[k] < risk[line[k]] ? errors[k] / risk[line[k]] : 1;
        count = 0;
    }
}

double functionals_friction_error(functionals *self, reduced_solver *solver,
                                  const reduced_state *state, const ehd_contact *contact,
                                  const double *added) {
    const solved_system *solved = take_solution(self, solver);
    const double *z = state->coordinates;
    double error;

    nodes_move_exit(solved->nodes, reduced_state_exits(state));
    nodes_expand_state(solved->nodes, NULL, z);
    nodes_add_friction(clear_gradient(self, 0), self->band_influence, solved->nodes, z, contact);
    find_errors(&error, self, 1, added);
    if (!solved->offset) {
        find_exit_risks(self, state, contact, added);
        error += nodes_friction_of_exits(solved->nodes, z, contact, self->exit_risk);
    }
    return error / contact->kind->load;
}
