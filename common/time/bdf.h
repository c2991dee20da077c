/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Backward differences of order one and two with variable step (BDF2: Hairer, Norsett, Wanner,
 * Solving Ordinary Differential Equations I, section III.5), and the few states that they look
 * at. Steps may have any lengths, in any order (README.md, BDF2). */
#ifndef EHD_BDF_H
#define EHD_BDF_H

#include <stdbool.h>
#include <stddef.h>

enum {
    BDF_PREVIOUS = 3
}; // previous states that a step looks at: two for the formula, one more for
    // the estimate of its error

/* One step: dy/dT = rate y + sum of weight[i] y_i, where y_0 is the last state, y_1 the one before
 * … The local error is `error` times y minus its prediction, the sum of predictor[i] y_i. */
typedef struct bdf_formula {
    size_t order;
    size_t num_weighted;            // states from the last one on, up to the last with a weight
    size_t degree;                  // of the prediction, a polynomial in time
    double rate;                    // 1 / time
    double weight[BDF_PREVIOUS];    // 1 / time
    double predictor[BDF_PREVIOUS]; // 1
    double error;                   // 1; 0 where there are too few previous states to tell
    double interval;                // time between the two states of second order; 0: first order
} bdf_formula;

/* Largest ratio r of a step of BDF2 to the distance in time of the two states before it. With y' = 0 a
 * step multiplies the difference of these states by r^2 / (1 + 2 r), which is at most 1 up to
 * r = 1 + sqrt(2). */
extern const double bdf_most_growth;

/* Formula for a step of length `step` from the last state, which `num_previous` (1 … BDF_PREVIOUS)
 * states lead up to: intervals[i] lies between states i and i + 1. It is of second order with the
 * latest state that is far enough from the last one for the step, or else of first order. */
bdf_formula bdf_step(double step, const double *intervals, size_t num_previous);

enum { BDF_STATES = BDF_PREVIOUS + 2 };

/* Which of BDF_STATES states is which: place[0] is the one being solved, place[i] the i-th before it, of which the first
 * num_previous count. A state that is accepted too soon after place[1] is passing: it lies at the last place, and the next
 * step begins at place[1] again. */
typedef struct bdf_ring {
    size_t place[BDF_STATES];
    size_t num_previous;
    bool passing;            // the last accepted state
    double time[BDF_STATES]; // of the states, by place
} bdf_ring;

/* A ring that holds no states. */
bdf_ring bdf_ring_empty(void);

/* Formula for a step from the last state. */
bdf_formula bdf_ring_formula(const bdf_ring *ring, double step);

/* Makes the state being solved the last one. It is passing if it is less than `least` after the state that its step began at,
 * unless steps grow or there are fewer than BDF_PREVIOUS states yet. */
void bdf_ring_accept(bdf_ring *ring, double time, double least);

/* Place of the accepted state `steps` (0 … num_previous) before the one being solved; a passing state is the last of them. */
size_t bdf_ring_accepted(const bdf_ring *ring, size_t steps);

/* Lets the next step begin at the passing state after all. The oldest state is left out. */
void bdf_ring_promote(bdf_ring *ring);

/* Makes the last accepted state the only one. */
void bdf_ring_restart(bdf_ring *ring);

/* Keeps the states at place[1] to place[num_states] alone. */
void bdf_ring_keep(bdf_ring *ring, size_t num_states);

#endif
