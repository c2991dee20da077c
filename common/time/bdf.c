/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/time/bdf.h"

#include <string.h>

/* Weights of the polynomial through the previous states, taken a step later. */
static void set_predictor(bdf_formula *formula, const double *ago, size_t num_previous) {
    for (size_t i = 0; i < num_previous; i++) {
        formula->predictor[i] = 1;
        for (size_t j = 0; j < num_previous; j++)
            if (j != i) formula->predictor[i] *= ago[j] / (ago[j] - ago[i]);
    }
}

bdf_formula bdf_step(double step, const double *intervals, size_t num_previous) {
    bdf_formula formula = {.order = num_previous > 1 ? 2 : 1};
    double ago[BDF_PREVIOUS] = {step}; // of the previous states, seen from the new time

    for (size_t i = 1; i < num_previous; i++)
        ago[i] = ago[i - 1] + intervals[i - 1];
    set_predictor(&formula, ago, num_previous);
    if (formula.order == 1) {
        formula.rate = 1 / step;
        formula.weight[0] = -1 / step;
        return formula;
    }
    double ratio = step / intervals[0];
    formula.rate = (1 + 2 * ratio) / ((1 + ratio) * step);
    formula.weight[0] = -(1 + ratio) / step;
    formula.weight[1] = ratio * ratio / ((1 + ratio) * step);
    // what the formula leaves out, by what the prediction does: third derivatives both; with one
    // state less the first-order formula's second derivatives, which is on the safe side
    if (num_previous > 2)
        formula.error = step * ago[1] / ((step + ago[1]) * ago[2]);
    else
        formula.error = step / ago[1];
    return formula;
}

// ---- the ring of states

bdf_ring bdf_ring_empty(void) {
    bdf_ring ring = {.num_previous = 0};

    for (size_t i = 0; i <= BDF_PREVIOUS; i++)
        ring.place[i] = i;
    return ring;
}

/* Between the states i and i + 1 steps before the one being solved. */
static double interval(const bdf_ring *ring, size_t i) {
    return ring->time[ring->place[i]] - ring->time[ring->place[i + 1]];
}

bdf_formula bdf_ring_formula(const bdf_ring *ring, double step) {
    double intervals[BDF_PREVIOUS];

    for (size_t i = 1; i < ring->num_previous; i++)
        intervals[i - 1] = interval(ring, i);
    return bdf_step(step, intervals, ring->num_previous);
}

void bdf_ring_accept(bdf_ring *ring, double time) {
    size_t oldest = ring->place[BDF_PREVIOUS];

    ring->time[ring->place[0]] = time;
    memmove(ring->place + 1, ring->place, BDF_PREVIOUS * sizeof *ring->place);
    ring->place[0] = oldest;
    if (ring->num_previous < BDF_PREVIOUS) ring->num_previous++;
}
