/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/model/start_shift.h"

#include "common/algebra/cholesky.h"
#include "common/algebra/product.h"

#include <math.h>
#include <string.h>

// ---- tables

/* Finds the needed nodes behind X = 0. They are the last nodes of the ascending list. */
static void list_nodes(start_shift *self, const reduced_model *model) {
    const row_set *rows = &model->rows;

    self->first = rows->num_needed;
    while (self->first > 0 && grid_x(&model->grid, rows->needed_node[self->first - 1]) > 0)
        self->first--;
    self->num_nodes = rows->num_needed - self->first;
}

static void place_nodes(start_shift *self, const reduced_model *model) {
    const row_set *rows = &model->rows;

    for (size_t q = 0; q < self->num_nodes; q++)
        self->x[q] = grid_x(&model->grid, rows->needed_node[self->first + q]);
}

/* Returns the slope, at node q, of the parabola through the pressures at node q and its
 * neighbours. */
static double slope_at(const double *x, const double *pressure, size_t q) {
    const double before = x[q] - x[q - 1], after = x[q + 1] - x[q];
    const double slope_before = (pressure[q] - pressure[q - 1]) / before;
    const double slope_after = (pressure[q + 1] - pressure[q]) / after;

    return (after * slope_before + before * slope_after) / (before + after);
}

static void fill_slopes(double *slope, const double *x, const double *pressure, size_t num) {
    slope[0] = (pressure[1] - pressure[0]) / (x[1] - x[0]);
    slope[num - 1] = (pressure[num - 1] - pressure[num - 2]) / (x[num - 1] - x[num - 2]);
    for (size_t q = 1; q + 1 < num; q++)
        slope[q] = slope_at(x, pressure, q);
}

static double curvature_at(const double *x, const double *pressure, size_t q) {
    const double before = x[q] - x[q - 1], after = x[q + 1] - x[q];

    return 2 *
           ((pressure[q] - pressure[q - 1]) / before - (pressure[q + 1] - pressure[q]) / after) /
           (before + after);
}

/* Returns the X at which the pressure is most curved. This is the tip of a spike, or of what
 * remains of a spike. A parabola is laid through the largest curvature at a node and the curvatures
 * at the neighbours of this node. The result is the X of its maximum. */
static double place_of_spike(const double *x, const double *pressure, size_t num) {
    size_t best = 1;

    for (size_t q = 1; q + 1 < num; q++)
        if (curvature_at(x, pressure, q) > curvature_at(x, pressure, best)) best = q;
    if (best == 1 || best + 2 >= num) return x[best];
    double left = x[best] - x[best - 1], right = x[best + 1] - x[best];
    double here = curvature_at(x, pressure, best);
    double fall_left = (here - curvature_at(x, pressure, best - 1)) / left;
    double fall_right = (here - curvature_at(x, pressure, best + 1)) / right;
    double place = (fall_left * right - fall_right * left) / (2 * (fall_left + fall_right));
    return fall_left + fall_right > 0 ? x[best] + fmin(fmax(place, -left), right) : x[best];
}

/* Computes the matrix (V^T V)^-1 V^T, which gives the coordinates that fit pressures at the needed
 * nodes by least squares. Keeps the columns of the nodes behind X = 0. */
static bool fill_fit(start_shift *self, const reduced_model *model, double *gram) {
    const size_t n = model->num_pressure;
    const double *modes = model->rows.pressure;

    gram_matrix(gram, modes, model->rows.num_needed, n);
    if (!cholesky_factorise(gram, n)) return false;
    memcpy(self->fit, modes + self->first * n, self->num_nodes * n * sizeof(double));
    for (size_t q = 0; q < self->num_nodes; q++)
        cholesky_solve(self->fit + q * n, gram, n);
    return true;
}

/* Interpolates the pressure at a place by the cubic through pressures and slopes at the two nodes
 * around it. Beyond the first or last node it returns the pressure of this node. `q`: on entry 0,
 * or the result of a call for a smaller X; on return the node before the place. */
static double pressure_at(const double *x, const double *pressure, const double *slope, size_t num,
                          double place, size_t *q) {
    while (*q + 2 < num && x[*q + 1] <= place)
        (*q)++;
    const size_t a = *q, b = *q + 1;
    const double width = x[b] - x[a], t = fmin(fmax((place - x[a]) / width, 0), 1);
    const double rise = pressure[b] - pressure[a];
    const double bend_a = slope[a] * width - rise, bend_b = rise - slope[b] * width;

    return pressure[a] + t * rise + t * (1 - t) * ((1 - t) * bend_a + t * bend_b);
}

/* Returns the coordinate (start_shift.h) of a place X, in spacings of the profile. */
static double point_of(const start_shift *self, double x, double spike) {
    return (x < spike ? x / spike : 1 + x - spike) / self->spacing;
}

/* A place in a profile between the points k and k + 1, with the weights of the cubic through values
 * and slopes at both points. */
typedef struct profile_place {
    size_t k;
    double weight[4]; // weights of value and slope at k, then at k + 1
} profile_place;

static profile_place place_at(const start_shift *self, double point) {
    const size_t last = self->num_points - 2, k = (size_t)point < last ? (size_t)point : last;
    const double t = fmin(point - (double)k, 1), u = 1 - t;

    return (profile_place){k, {u * u * (1 + 2 * t), u * u * t, t * t * (1 + 2 * u), -t * t * u}};
}

static inline double profile_at(const start_shift *self, size_t s, const profile_place *at) {
    const double *profile = self->profile + 2 * (s * self->num_points + at->k);

    return at->weight[0] * profile[0] + at->weight[1] * profile[1] + at->weight[2] * profile[2] +
           at->weight[3] * profile[3];
}

/* Fills the profile of a state: pressure and slope along the coordinate. Then replaces `pressure`
 * by the values of the profile at the nodes, so that start_shift_apply does not change a state
 * whose spike does not move. */
static void fill_profile(start_shift *self, size_t s, double *slope) {
    double *pressure = self->pressure + s * self->num_nodes;
    double *profile = self->profile + 2 * s * self->num_points;
    size_t before = 0;

    fill_slopes(slope, self->x, pressure, self->num_nodes);
    for (size_t k = 0; k < self->num_points; k++) {
        const double along = (double)k * self->spacing;
        const double place = along < 1 ? along * self->spike[s] : self->spike[s] + along - 1;
        profile[2 * k] = pressure_at(self->x, pressure, slope, self->num_nodes, place, &before);
    }
    for (size_t k = 1; k + 1 < self->num_points; k++)
        profile[2 * k + 1] = (profile[2 * k + 2] - profile[2 * k - 2]) / 2;
    for (size_t q = 0; q < self->num_nodes; q++) {
        const profile_place at = place_at(self, point_of(self, self->x[q], self->spike[s]));
        pressure[q] = profile_at(self, s, &at);
    }
}

/* Computes the states' pressures at the nodes, and the places of their spikes. */
static void fill_states(start_shift *self, const reduced_model *model) {
    const size_t n = model->num_pressure;

    for (size_t s = 0; s < model->states.num_states; s++) {
        double *pressure = self->pressure + s * self->num_nodes;
        memset(pressure, 0, self->num_nodes * sizeof *pressure);
        add_product(pressure, model->rows.pressure + self->first * n, n, self->num_nodes, n,
                    model->states.coordinates + s * model->num_unknowns);
        self->spike[s] = place_of_spike(self->x, pressure, self->num_nodes);
    }
}

static bool allocate(start_shift *self, const reduced_model *model, arena *memory) {
    const size_t num_states = model->states.num_states;

    self->x = arena_array(memory, self->num_nodes, sizeof(double));
    self->pressure = arena_array(memory, num_states * self->num_nodes, sizeof(double));
    self->fit = arena_array(memory, self->num_nodes * model->num_pressure, sizeof(double));
    self->spike = arena_array(memory, num_states, sizeof(double));
    self->profile = arena_array(memory, num_states * self->num_points, 2 * sizeof(double));
    return !memory->failed;
}

ehd_status start_shift_build(reduced_model *model, ehd_error *error) {
    const size_t n = model->num_pressure;
    start_shift *self = &model->shift;
    arena work = {0};

    *self = (start_shift){0};
    if (model->band.num_lines > 1 || model->deformation != DEFORMATION_COUPLED) return EHD_OK;
    list_nodes(self, model);
    if (self->num_nodes < 3) self->num_nodes = 0; // a curvature needs three nodes
    if (self->num_nodes == 0) return EHD_OK;
    // the grid does not resolve details below half of its step
    self->spacing = model->grid.step / 2;
    // a profile is longest if the spike is at X = 0; the profile ends at the last needed node
    const size_t last = model->rows.needed_node[model->rows.num_needed - 1];
    self->num_points = (size_t)((1 + grid_x(&model->grid, last)) / self->spacing) + 2;
    double *gram = arena_array(&work, n * n, sizeof(double));
    double *slope = arena_array(&work, self->num_nodes, sizeof(double));
    bool allocated = allocate(self, model, &model->memory) && !work.failed;
    if (allocated) {
        place_nodes(self, model);
        fill_states(self, model);
        if (!fill_fit(self, model, gram)) self->num_nodes = 0;
        for (size_t s = 0; s < model->states.num_states && self->num_nodes > 0; s++)
            fill_profile(self, s, slope);
    }
    arena_free(&work);
    return allocated ? EHD_OK : ehd_no_memory(error, "reduced model");
}

// ---- the sum

/* Returns the change of a weighted sum of the states' pressures at a node: the sum of pressures at
 * equal coordinates (start_shift.h) minus the sum of pressures at equal X. */
static double change_at(const start_shift *self, size_t q, double spike, const size_t *states,
                        const double *weights, size_t count) {
    const profile_place at = place_at(self, point_of(self, self->x[q], spike));
    double sum = 0;

    for (size_t i = 0; i < count; i++)
        sum += weights[i] *
               (profile_at(self, states[i], &at) - self->pressure[states[i] * self->num_nodes + q]);
    return sum;
}

void start_shift_apply(double *coordinates, const reduced_model *model, const size_t *states,
                       const double *weights, size_t count) {
    enum { BLOCK = 64 };
    const start_shift *self = &model->shift;
    const size_t n = model->num_pressure;
    double spike = 0, change[BLOCK];

    if (self->num_nodes == 0) return;
    for (size_t i = 0; i < count; i++)
        spike += weights[i] * self->spike[states[i]];
    if (!(spike > 0)) return;
    for (size_t first = 0; first < self->num_nodes; first += BLOCK) {
        const size_t left = self->num_nodes - first, num = left < BLOCK ? left : BLOCK;
        for (size_t q = 0; q < num; q++)
            change[q] = change_at(self, first + q, spike, states, weights, count);
        add_transposed_product(coordinates, 1, self->fit + first * n, num, n, change);
    }
}
