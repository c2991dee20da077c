/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/time/bdf.h"

#include "common/algebra/rounding.h"

#include <math.h>
#include <string.h>

// Source: 1 + sqrt(2), the bound of zero-stability (README.md, BDF2)
const double bdf_most_growth = 1 + 1.4142135623730951;

/* Returns the largest sum of the magnitudes of a predictor's weights. The error of a prediction is
 * at most this sum times the largest error of the states. The sum is that of a predictor of second
 * degree if each step is bdf_most_growth times as long as the step before. */
static double most_enlarged(void) {
    const double growth = bdf_most_growth;

    return (1 + ROUNDING) * (1 + 2 * growth * (1 + growth * (1 + growth)));
}

/* A step of first order is predicted from the slope between the two known states. This constant is
 * the largest ratio of such a step to the time between these states. The iteration leaves an error
 * of 1e-8 to 1e-5 of a film in each state. In a longer step the slope may consist mostly of these
 * errors, so the prediction is the last state (test_bdf.c,
 * a_step_much_longer_than_the_last_is_of_lower_order). */
static const double MOST_EXTRAPOLATED = 100;

/* Sets the weights with which the polynomial through the chosen previous states predicts the new
 * state. `ago` is the time from each previous state to the new state. */
static void set_predictor(bdf_formula *formula, const double *ago, const size_t *chosen,
                          size_t count) {
    memset(formula->predictor, 0, sizeof formula->predictor);
    formula->degree = count - 1;
    for (size_t k = 0; k < count; k++) {
        double *weight = &formula->predictor[chosen[k]];
        *weight = 1;
        for (size_t m = 0; m < count; m++)
            if (m != k) *weight *= ago[chosen[m]] / (ago[chosen[m]] - ago[chosen[k]]);
    }
}

static double enlarged(const bdf_formula *formula) {
    double sum = 0;

    for (size_t i = 0; i < BDF_PREVIOUS; i++)
        sum += fabs(formula->predictor[i]);
    return sum;
}

/* Sets a formula of first order. The prediction is the straight line through the last and the
 * oldest state. For long steps it is the last state. */
static void set_first_order(bdf_formula *formula, double step, const double *ago,
                            size_t num_previous) {
    const size_t oldest = num_previous - 1, chosen[] = {0, oldest};
    const bool has_slope = oldest > 0 && step <= MOST_EXTRAPOLATED * (ago[oldest] - step);

    formula->order = formula->num_weighted = 1;
    formula->rate = 1 / step;
    formula->weight[0] = -1 / step;
    set_predictor(formula, ago, chosen, has_slope ? 2 : 1);
    formula->error = has_slope ? step / ago[oldest] : oldest > 0 ? 1 : 0;
}

/* Sets a formula of second order, which uses the last state and the state `second` states before
 * it. Formula and prediction both neglect the third derivative, so the error of the formula follows
 * from the error of the prediction. Without a usable third state the prediction neglects the second
 * derivative, and the error estimate is too large. */
static void set_second_order(bdf_formula *formula, double step, const double *ago, size_t second,
                             double interval, size_t num_previous) {
    const double ratio = step / interval;
    size_t chosen[BDF_PREVIOUS] = {0, second};

    formula->order = 2;
    formula->num_weighted = second + 1;
    formula->interval = interval;
    formula->rate = (1 + 2 * ratio) / ((1 + ratio) * step);
    formula->weight[0] = -(1 + ratio) / step;
    formula->weight[second] = ratio * ratio / ((1 + ratio) * step);
    for (size_t third = second + 1; third < num_previous; third++) {
        chosen[2] = third;
        set_predictor(formula, ago, chosen, 3);
        formula->error = step * ago[second] / ((step + ago[second]) * ago[third]);
        if (enlarged(formula) <= most_enlarged()) return;
    }
    set_predictor(formula, ago, chosen, 2);
    formula->error = step / ago[second];
}

bdf_formula bdf_step(double step, const double *intervals, size_t num_previous) {
    bdf_formula formula = {.order = 0};
    double ago[BDF_PREVIOUS] = {step}; // time from each previous state to the new state
    double interval = 0;               // time from state i to the last state

    for (size_t i = 1; i < num_previous; i++)
        ago[i] = ago[i - 1] + intervals[i - 1];
    for (size_t i = 1; i < num_previous && formula.order == 0; i++) {
        interval += intervals[i - 1];
        if (step <= bdf_most_growth * interval)
            set_second_order(&formula, step, ago, i, interval, num_previous);
    }
    if (formula.order == 0) set_first_order(&formula, step, ago, num_previous);
    return formula;
}

// ---- the ring of states

bdf_ring bdf_ring_empty(void) {
    bdf_ring ring = {.num_previous = 0};

    for (size_t i = 0; i < BDF_STATES; i++)
        ring.place[i] = i;
    return ring;
}

static double interval(const bdf_ring *ring, size_t i) {
    return ring->time[ring->place[i]] - ring->time[ring->place[i + 1]];
}

bdf_formula bdf_ring_formula(const bdf_ring *ring, double step) {
    double intervals[BDF_PREVIOUS];

    for (size_t i = 1; i < ring->num_previous; i++)
        intervals[i - 1] = interval(ring, i);
    return bdf_step(step, intervals, ring->num_previous);
}

static void swap(bdf_ring *ring, size_t i, size_t k) {
    const size_t place = ring->place[i];

    ring->place[i] = ring->place[k];
    ring->place[k] = place;
}

/* Checks whether the state being solved, at `time`, is passing (bdf_ring). While steps grow, as
 * after a start, no state is passing. */
static bool is_passing(const bdf_ring *ring, double time, double least) {
    // Smallest ratio of a step to the step before it at which steps are taken as growing. In a
    // march a step is at most twice the step before it (test_bdf.c,
    // states_that_follow_too_soon_are_passing).
    const double grown = 1.5;
    const double step = time - ring->time[ring->place[1]];

    return ring->num_previous == BDF_PREVIOUS && step < least * (1 - ROUNDING) &&
           step < grown * interval(ring, 1);
}

void bdf_ring_accept(bdf_ring *ring, double time, double least) {
    const size_t oldest = ring->place[BDF_PREVIOUS];

    ring->passing = is_passing(ring, time, least);
    ring->time[ring->place[0]] = time;
    if (ring->passing) {
        swap(ring, 0, BDF_STATES - 1);
        return;
    }
    memmove(ring->place + 1, ring->place, BDF_PREVIOUS * sizeof *ring->place);
    ring->place[0] = oldest;
    if (ring->num_previous < BDF_PREVIOUS) ring->num_previous++;
}

size_t bdf_ring_accepted(const bdf_ring *ring, size_t steps) {
    if (!ring->passing || steps == 0) return ring->place[steps];
    return ring->place[steps == 1 ? BDF_STATES - 1 : steps - 1];
}

void bdf_ring_keep(bdf_ring *ring, size_t num_states) {
    ring->num_previous = num_states;
    ring->passing = false;
}

void bdf_ring_promote(bdf_ring *ring) {
    const size_t passing = ring->place[BDF_STATES - 1];

    memmove(ring->place + 2, ring->place + 1, BDF_PREVIOUS * sizeof *ring->place);
    ring->place[1] = passing;
    ring->passing = false;
}

void bdf_ring_restart(bdf_ring *ring) {
    if (ring->passing) swap(ring, 1, BDF_STATES - 1);
    bdf_ring_keep(ring, 1);
}
