/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "deimselect/cubature.h"

#include "common/algebra/nnls.h"
#include "common/physics/deflection.h"
#include "common/physics/laws.h"

#include <cblas.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

// ---- integrands

/* A shear stress that is integrated over the contact, up to a factor that is equal at all nodes.
 * The only lubricant property in the stress is the rise of the viscosity in the training state.
 * `ratio` is the ratio c of the Newtonian stress at P = 0 and H = 1 to the Eyring or limiting
 * stress of the law. */
typedef struct integrand {
    const lubricant_law *law; // law with an Eyring stress or limiting stress of 1
    double ratio;             // c
} integrand;

static const integrand integrands[] = {
    {&shear_newtonian, 1},   {&shear_eyring, 1e-6},   {&shear_eyring, 1e-5},
    {&shear_eyring, 1e-4},   {&shear_eyring, 1e-3},   {&shear_eyring, 1e-2},
    {&shear_eyring, 1e-1},   {&shear_limiting, 1e-6}, {&shear_limiting, 1e-5},
    {&shear_limiting, 1e-4}, {&shear_limiting, 1e-3}, {&shear_limiting, 1e-2},
    {&shear_limiting, 1e-1}};
enum {
    NUM_INTEGRANDS = sizeof integrands / sizeof *integrands,
    MAX_STATES = 120, // largest number of states in the tables (romrun/solve/README.md, Traction)
    // Largest number of candidate nodes in the tables, which then take 200 MB. If all 3600 nodes of
    // a point contact are candidates, the errors are 9e-6. If only every second node is a
    // candidate, non-negative weights give errors of 10 %, because nodes on ridges of Newtonian
    // stress are missing (romrun/solve/README.md, Traction).
    MAX_CANDIDATES = 8000
};

static double stress_of(integrand self, double rise, double pressure, double film) {
    static const ehd_lubricant of_ones = {.shear_constants = {1}};
    const double viscous = self.ratio * exp(rise * pressure) / film;

    return self.law->shear ? self.law->shear(&of_ones, viscous, pressure) : viscous;
}

/* Least-squares problem for the weights. A row belongs to a state and an integrand, a column to a
 * node. An entry is the stress at the node divided by the integral of the stress. The right side is
 * 1. */
typedef struct cubature_fit {
    const reduced_basis *basis;
    ehd_deflection *deflection;
    size_t num_nodes;             // candidate nodes
    size_t *node;                 // [num_nodes]
    size_t num_rows;              // number of rows in use, at most MAX_STATES * NUM_INTEGRANDS
    double *friction, *dry;       // [num_rows, num_nodes] tables: whole contact, dry contact
    double *pressure, *film;      // [nodes of the grid] of the current state
    bool *before_exit;            // [nodes of the grid] nodes before the exit of the state
    double *ones;                 // [num_rows]
    double *of_friction, *of_dry; // [num_nodes] weights
    double dry_area;
    arena memory;
} cubature_fit;

/* Computes pressure and film of a state at all nodes. Truncated modes give negative pressures far
 * out in the inlet. These pressures are set to zero. */
static void expand_state(cubature_fit *self, size_t state) {
    const reduced_basis *basis = self->basis;
    const reduced_states *states = &basis->states;
    const size_t num = basis->num_pressure, width = grid_width(&basis->grid);
    const double *z = states->coordinates + state * states->num_unknowns;
    const size_t *exit = states->exit + state * states->num_lines;

    cblas_dgemv(CblasRowMajor, CblasNoTrans, (int)basis->grid.num_nodes, (int)num, 1,
                basis->pressure, (int)num, z, 1, 0, self->pressure, 1);
    for (size_t k = 0; k < basis->grid.num_nodes; k++) {
        self->before_exit[k] = k % width < exit[k / width];
        if (!self->before_exit[k]) self->pressure[k] = 0;
    }
    deflection_apply(self->film, self->deflection, self->pressure);
    for (size_t k = 0; k < basis->grid.num_nodes; k++)
        self->film[k] += z[states->num_unknowns - 1] + grid_gap(&basis->grid, k);
    for (size_t k = 0; k < basis->grid.num_nodes; k++)
        self->pressure[k] = fmax(self->pressure[k], 0);
}

/* Returns the number of training states that the fit uses. These states are evenly spread over all
 * states of the basis (used_state). */
static size_t num_used_states(const reduced_basis *basis) {
    return basis->states.num_states < MAX_STATES ? basis->states.num_states : MAX_STATES;
}

static size_t used_state(const reduced_basis *basis, size_t i) {
    return i * basis->states.num_states / num_used_states(basis);
}

double cubature_bytes(const reduced_basis *basis) {
    const double rows = (double)(num_used_states(basis) * NUM_INTEGRANDS);
    const double inner = (double)basis->grid.num_inner;

    // two tables here, and one table in nnls.c
    return 8 * (3 * rows * fmin(inner, MAX_CANDIDATES) + 16 * inner);
}

/* Lists the candidates: inner nodes at which any state has pressure. If there are more than
 * MAX_CANDIDATES such nodes, lists evenly spread nodes among them. */
static ehd_status list_nodes(cubature_fit *self, ehd_error *error) {
    const ehd_grid *grid = &self->basis->grid;
    bool *has_pressure = arena_array(&self->memory, grid->num_nodes, sizeof *has_pressure);
    size_t count = 0, listed = 0;

    if (!has_pressure) return ehd_no_memory(error, "nodes of the traction");
    for (size_t i = 0; i < num_used_states(self->basis); i++) {
        expand_state(self, used_state(self->basis, i));
        for (size_t k = 0; k < grid->num_nodes; k++)
            has_pressure[k] = has_pressure[k] || self->pressure[k] > 0;
    }
    for (size_t r = 0; r < grid->num_inner; r++)
        count += has_pressure[grid_node_of_row(grid, r)];
    self->node = arena_array(&self->memory, MAX_CANDIDATES, sizeof *self->node);
    if (!self->node) return ehd_no_memory(error, "nodes of the traction");
    for (size_t r = 0; r < grid->num_inner; r++) {
        const size_t k = grid_node_of_row(grid, r);
        if (!has_pressure[k]) continue;
        const size_t most = count < MAX_CANDIDATES ? count : MAX_CANDIDATES;
        if (listed++ * most % count < most) self->node[self->num_nodes++] = k;
    }
    return EHD_OK;
}

static ehd_status fit_init(cubature_fit *self, ehd_error *error) {
    const ehd_grid *grid = &self->basis->grid;
    const size_t num_rows = num_used_states(self->basis) * NUM_INTEGRANDS;
    arena *memory = &self->memory;

    self->deflection = deflection_create(self->basis->kind, grid);
    self->pressure = arena_array(memory, grid->num_nodes, sizeof(double));
    self->film = arena_array(memory, grid->num_nodes, sizeof(double));
    self->before_exit = arena_array(memory, grid->num_nodes, sizeof *self->before_exit);
    if (!self->deflection || memory->failed) return ehd_no_memory(error, "nodes of the traction");
    ehd_status status = list_nodes(self, error);
    if (status) return status;
    self->friction = arena_table(memory, num_rows, self->num_nodes, sizeof(double));
    self->dry = arena_table(memory, num_rows, self->num_nodes, sizeof(double));
    self->ones = arena_array(memory, num_rows, sizeof(double));
    self->of_friction = arena_array(memory, self->num_nodes, sizeof(double));
    self->of_dry = arena_array(memory, self->num_nodes, sizeof(double));
    if (memory->failed) return ehd_no_memory(error, "nodes of the traction");
    for (size_t i = 0; i < num_rows; i++)
        self->ones[i] = 1;
    for (size_t r = 0; r < grid->num_inner; r++) {
        const size_t k = grid_node_of_row(grid, r);
        self->dry_area += grid_load_weight(grid, k) * grid_dry_share(grid, k);
    }
    return EHD_OK;
}

static void fit_free(cubature_fit *self) {
    deflection_free(self->deflection);
    arena_free(&self->memory);
}

/* Sums an integrand over the nodes before the exit (*whole), and over the part of this area inside
 * the dry contact (*dry). The stresses that contact_traction_of adds behind the last node with
 * pressure are not included. */
static void integrate(double *whole, double *dry, const cubature_fit *self, integrand of,
                      double rise) {
    const ehd_grid *grid = &self->basis->grid;

    *whole = *dry = 0;
    for (size_t r = 0; r < grid->num_inner; r++) {
        const size_t k = grid_node_of_row(grid, r);
        if (!self->before_exit[k]) continue;
        const double weight = grid_load_weight(grid, k);
        const double part = weight * stress_of(of, rise, self->pressure[k], self->film[k]);
        *whole += part;
        *dry += grid_dry_share(grid, k) * part;
    }
}

/* Adds the rows of a training state to both tables. An integrand whose integral is not positive and
 * finite adds no row. */
static void add_state(cubature_fit *self, double rise) {
    for (size_t i = 0; i < NUM_INTEGRANDS; i++) {
        double whole, dry;
        integrate(&whole, &dry, self, integrands[i], rise);
        if (!(whole > 0 && dry > 0 && isfinite(whole) && isfinite(dry))) continue;
        double *friction = self->friction + self->num_rows * self->num_nodes;
        double *of_dry = self->dry + self->num_rows * self->num_nodes;
        for (size_t q = 0; q < self->num_nodes; q++) {
            const size_t k = self->node[q];
            const double stress = self->before_exit[k] ? stress_of(integrands[i], rise,
                                                                   self->pressure[k], self->film[k])
                                                       : 0;
            friction[q] = stress / whole;
            of_dry[q] =
                grid_dry_share(&self->basis->grid, k) > 0 ? stress / dry * self->dry_area : 0;
        }
        self->num_rows++;
    }
}

static void add_states(cubature_fit *self) {
    const reduced_states *states = &self->basis->states;

    for (size_t i = 0; i < num_used_states(self->basis); i++) {
        const size_t s = used_state(self->basis, i);
        const double known = states->rises[s].of[RISE_VISCOSITY];
        expand_state(self, s);
        add_state(self, isnan(known) ? states->alpha_p_H[s] : known);
    }
}

// ---- weights

/* Largest accepted relative error of a row of the fit. If the error of any row is larger, the model
 * gets no weights, and romrun sums the stresses over the whole grid (romrun/solve/README.md,
 * Traction). */
static const double MOST_OFF = 5e-4;

/* Computes non-negative weights. EHD_NOT_CONVERGED: no weights give errors of at most MOST_OFF in
 * all rows. */
static ehd_status solve_weights(double *weights, const cubature_fit *self, const double *values,
                                ehd_error *error) {
    const size_t num = self->num_nodes;
    ehd_status status = nnls_solve(weights, values, self->ones, self->num_rows, num,
                                   node_cubature_tolerance, error);

    for (size_t i = 0; i < self->num_rows && !status; i++)
        if (!(fabs(cblas_ddot((int)num, values + i * num, 1, weights, 1) - 1) <= MOST_OFF))
            status = EHD_NOT_CONVERGED;
    return status;
}

typedef struct node_weights {
    double friction, dry;
    bool kept;
} node_weights;

static bool any_thinned(const reduced_states *states) {
    for (size_t s = 0; s < states->num_states; s++)
        if (states->thinning[s].gradient > 0) return true;
    return false;
}

/* Adds the nodes whose weight is not zero to the model. If stresses depend on the pressure
 * gradient, also adds the neighbours of these nodes along X, with weights of zero. */
static ehd_status add_chosen(reduced_model *model, cubature_fit *self, ehd_error *error) {
    const ehd_grid *grid = &self->basis->grid;
    const bool with_beside = any_thinned(&self->basis->states);
    node_weights *weights = arena_array(&self->memory, grid->num_nodes, sizeof *weights);
    size_t *node = arena_array(&self->memory, grid->num_inner, sizeof *node), count = 0;
    double *friction = arena_array(&self->memory, grid->num_inner, sizeof *friction);
    double *dry = arena_array(&self->memory, grid->num_inner, sizeof *dry);

    if (self->memory.failed) return ehd_no_memory(error, "nodes of the traction");
    for (size_t q = 0; q < self->num_nodes; q++) {
        if (self->of_friction[q] == 0 && self->of_dry[q] == 0) continue;
        node_weights *of = weights + self->node[q];
        of->friction = self->of_friction[q];
        of->dry = self->of_dry[q];
        of->kept = true;
        if (with_beside) of[-1].kept = of[1].kept = true;
    }
    for (size_t r = 0; r < grid->num_inner; r++) {
        const size_t k = grid_node_of_row(grid, r);
        if (!weights[k].kept) continue;
        node[count] = k;
        friction[count] = weights[k].friction;
        dry[count++] = weights[k].dry;
    }
    return reduced_model_add_cubature(model, self->basis, node, friction, dry, count, error);
}

ehd_status cubature_train(reduced_model *model, const reduced_basis *basis, ehd_error *error) {
    cubature_fit fit = {.basis = basis};
    ehd_status status = fit_init(&fit, error);

    if (!status) {
        add_states(&fit);
        status = solve_weights(fit.of_friction, &fit, fit.friction, error);
    }
    if (!status) status = solve_weights(fit.of_dry, &fit, fit.dry, error);
    if (!status && fit.num_rows > 0) status = add_chosen(model, &fit, error);
    fit_free(&fit);
    return status == EHD_NOT_CONVERGED ? EHD_OK : status;
}
