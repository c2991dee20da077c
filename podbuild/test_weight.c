/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the weight D of the Reynolds rows, one number for each node. The test basis is
 * W = D² J V, eq. (27) of Maier et al. 2015. The weight `row-norm` and the smallest value of the
 * weight `mode` (WEIGHT_FLOOR) are not in the paper.
 * Called by bases.c for the default weight `mode`, and by main.c for --weight. */
#include "podbuild/test_weight.h"

#include "romrun/solve/reduced_solver.h"

#include <cblas.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const test_weight test_weights[] = {
    {"mode", test_weight_mode, false, "the absolute first pressure mode, as published"},
    {"identity", test_weight_identity, false, "one for every row"},
    {"row-norm", test_weight_row_norm, true,
     "one over the norm of the row of the reduced Jacobian, root mean square over the training; "
     "needs --plan"},
    {NULL, NULL, false, NULL},
};

/* Smallest value of the weight `mode`. The first pressure mode vanishes at the inlet and beyond the
 * trained exits, so rows there would have no weight. Least squares need weights of about one over
 * the residual that truncated modes leave in a row. Upstream of X = -1.3, a smallest value of 1e-3
 * would exceed these weights (README.md, The floor; test_test_weight.c,
 * mode_is_that_of_the_basis). */
static const double WEIGHT_FLOOR = 1e-4; // as a fraction of the largest value of the weight

ehd_status test_weight_mode(double *weight, const reduced_basis *basis, const ehd_contact *contacts,
                            size_t num_contacts, ehd_error *error) {
    double largest = 0;
    (void)contacts, (void)num_contacts, (void)error;

    for (size_t k = 0; k < basis->grid.num_nodes; k++)
        largest = fmax(largest, fabs(basis->pressure[k * basis->num_pressure]));
    for (size_t k = 0; k < basis->grid.num_nodes; k++)
        weight[k] = fmax(fabs(basis->pressure[k * basis->num_pressure]), WEIGHT_FLOOR * largest);
    return EHD_OK;
}

ehd_status test_weight_identity(double *weight, const reduced_basis *basis,
                                const ehd_contact *contacts, size_t num_contacts,
                                ehd_error *error) {
    (void)contacts, (void)num_contacts, (void)error;
    for (size_t k = 0; k < basis->grid.num_nodes; k++)
        weight[k] = 1;
    return EHD_OK;
}

// ---- row norms

/* Sums of the squared norms of the rows of the reduced Jacobian, at the grid nodes. */
typedef struct row_squares {
    const reduced_model *model;
    reduced_solver *solver;
    double *sum;   // [num_nodes]
    size_t *count; // [num_nodes] number of states whose exit is behind the row
    size_t num_states;
} row_squares;

/* Adds the squared norms of the rows of the reduced Jacobian to the sums. The reduced solver calls
 * this function in place of its least-squares solver. The return value EHD_NOT_CONVERGED ends the
 * iteration. */
static ehd_status add_squares(double *step, void *context, const double *matrix,
                              const double *right, size_t num_equations, size_t num_unknowns) {
    row_squares *self = context;
    size_t num_rows;
    const size_t *rows = reduced_system_rows(&num_rows, self->solver);
    (void)step, (void)right, (void)num_equations;

    for (size_t i = 0; i < num_rows; i++) {
        const size_t node = self->model->rows.node[rows[i]];
        const double *row = matrix + i * num_unknowns;
        const double norm =
            cblas_dnrm2((int)num_unknowns, row, 1) / self->model->rows.weight[rows[i]];
        self->sum[node] += norm * norm;
        self->count[node]++;
    }
    return EHD_NOT_CONVERGED;
}

static const ehd_contact *contact_of(const reduced_states *states, size_t s,
                                     const ehd_contact *contacts, size_t num_contacts) {
    for (size_t i = 0; i < num_contacts; i++)
        if (reduced_state_is_of(states, s, &contacts[i])) return &contacts[i];
    return NULL;
}

/* Sums up the row norms at each stationary training solution whose contact is given. */
static ehd_status visit_states(row_squares *squares, const ehd_contact *contacts,
                               size_t num_contacts, ehd_error *error) {
    const reduced_states *states = &squares->model->states;
    // the exit is at a node, so that all rows before the exit are Reynolds rows
    const reduced_settings once = {.max_iterations = 1,
                                   .exit_at_node = true,
                                   .solve_linear = add_squares,
                                   .linear_context = squares};
    reduced_state state = {0};
    ehd_status status = reduced_solver_create(&squares->solver, squares->model, &once, error);

    if (!status) status = reduced_state_init(&state, squares->model, error);
    for (size_t s = 0; s < states->num_states && !status; s++) {
        const ehd_contact *contact = contact_of(states, s, contacts, num_contacts);
        reduced_info ignored;
        if (!states->stationary[s] || !contact) continue;
        squares->num_states++;
        reduced_state_set_exits(&state, squares->model, states->exit + s * states->num_lines);
        memcpy(state.coordinates, states->coordinates + s * states->num_unknowns,
               states->num_unknowns * sizeof(double));
        status = reduced_solve(&ignored, &state, squares->solver, contact, NULL, error);
    }
    if (!status && squares->num_states == 0)
        status = ehd_fail(error, EHD_DATA,
                          "--plan: found none of the stationary training points, expected the plan "
                          "that they were solved for");
    reduced_state_free(&state);
    reduced_solver_free(squares->solver);
    return status;
}

/* Turns norms into weights: one over the root mean square. A row behind the exit of any solution
 * gets at most the weight of the last row before all exits. The norms of such rows are small, and
 * one over the norm grows towards the exit farthest downstream. If it were the weight, the exit of
 * many solutions would not settle. */
static void turn_over(double *weight, const row_squares *squares, size_t num_nodes) {
    double last = 1;

    for (size_t k = 0; k < num_nodes; k++) {
        const double own = squares->count[k] > 0 && squares->sum[k] > 0
                               ? sqrt((double)squares->count[k] / squares->sum[k])
                               : last;
        weight[k] = k > 1 && squares->count[k] < squares->num_states ? fmin(own, last) : own;
        if (squares->count[k] == squares->num_states) last = own;
    }
    weight[0] = weight[1]; // the boundary has no row
}

ehd_status test_weight_row_norm(double *weight, const reduced_basis *basis,
                                const ehd_contact *contacts, size_t num_contacts,
                                ehd_error *error) {
    const size_t num_nodes = basis->grid.num_nodes;
    reduced_model model = {0};
    row_squares squares = {.model = &model,
                           .sum = calloc(num_nodes, sizeof(double)),
                           .count = calloc(num_nodes, sizeof(size_t))};
    ehd_status status = squares.sum && squares.count
                            ? reduced_model_build(&model, basis, NULL, 0, error)
                            : ehd_no_memory(error, "row norms");

    if (!status) status = visit_states(&squares, contacts, num_contacts, error);
    if (!status) turn_over(weight, &squares, num_nodes);
    free(squares.sum);
    free(squares.count);
    reduced_model_free(&model);
    return status;
}
