/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes backward differences of order one and two with variable step (BDF2: Hairer, Norsett,
 * Wanner, Solving Ordinary Differential Equations I, section III.5), and manages the few states
 * that they use. Steps may have any lengths, in any order (README.md, BDF2).
 * Called by bdf_march.c for each step. */
#ifndef EHD_BDF_H
#define EHD_BDF_H

#include <stdbool.h>
#include <stddef.h>

// number of previous states that a step uses: two for the formula, a third for the error estimate
enum { BDF_PREVIOUS = 3 };

/* Formula of one time step, for the new state y: dy/dT = rate y + sum of weight[i] y_i. y_0 is the
 * last state and y_1 the state before it. The prediction of y is the sum of predictor[i] y_i. The
 * local error is `error` times the difference between y and its prediction. */
typedef struct bdf_formula {
    size_t order;
    size_t num_weighted;            // number of states from y_0 to the oldest state with a weight
    size_t degree;                  // degree of the prediction, a polynomial in time
    double rate;                    // 1 / time
    double weight[BDF_PREVIOUS];    // 1 / time
    double predictor[BDF_PREVIOUS]; // dimensionless
    double error;                   // dimensionless; 0: too few previous states for an estimate
    double interval;                // time between the two states with a weight; 0: first order
} bdf_formula;

/* Largest ratio r of a step of BDF2 to the time between the two previous states of its formula. If
 * y' = 0, the new state differs from the last state by r^2 / (1 + 2 r) times the difference of
 * these two states. This factor is at most 1 up to r = 1 + sqrt(2). */
extern const double bdf_most_growth;

/* Returns the formula for a step of length `step` from the last state. The number of previous
 * states, `num_previous`, is 1 to BDF_PREVIOUS. intervals[i] is the time between states i and i +
 * 1. A formula of second order uses the last state and the latest earlier state that precedes it by
 * at least step / bdf_most_growth. If there is no such state, the formula is of first order. */
bdf_formula bdf_step(double step, const double *intervals, size_t num_previous);

enum { BDF_STATES = BDF_PREVIOUS + 2 };

/* Indices (places) of the states in an array of BDF_STATES states. place[0] is the index of the
 * state being solved. place[i] is the index of the i-th state before it, for i from 1 to
 * num_previous. A state that is accepted too soon after the state at place[1] is called passing.
 * Its index is place[BDF_STATES - 1]. The next step begins at the state at place[1] again. */
typedef struct bdf_ring {
    size_t place[BDF_STATES];
    size_t num_previous;
    bool passing;            // the last accepted state is passing
    double time[BDF_STATES]; // time of the state at each place
} bdf_ring;

/* Returns a ring that holds no states. */
bdf_ring bdf_ring_empty(void);

/* Returns the formula for a step from the state at place[1]. */
bdf_formula bdf_ring_formula(const bdf_ring *ring, double step);

/* Makes the state being solved the last accepted state. This state is passing if its step is
 * shorter than `least`. While steps grow, or with fewer than BDF_PREVIOUS previous states, no state
 * is passing. */
void bdf_ring_accept(bdf_ring *ring, double time, double least);

/* Returns the place of the accepted state that is `steps` (0 to num_previous) steps before the
 * state being solved. A passing state counts as the last accepted state. */
size_t bdf_ring_accepted(const bdf_ring *ring, size_t steps);

/* Makes the passing state a regular state, so that the next time step begins at it. Drops the
 * oldest state. */
void bdf_ring_promote(bdf_ring *ring);

/* Drops all accepted states except the last one. */
void bdf_ring_restart(bdf_ring *ring);

/* Keeps only the states at place[1] to place[num_states]. */
void bdf_ring_keep(bdf_ring *ring, size_t num_states);

#endif
