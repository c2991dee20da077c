/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computing times of a solution, which both models measure and results contain. */
#ifndef EHD_SOLVE_SECONDS_H
#define EHD_SOLVE_SECONDS_H

/* Seconds; NaN: not measured. */
typedef struct solve_seconds {
    double total;  // without reading and writing; contains the next three times
    double rows;   // rows, with the deflection or the reduced Jacobian
    double linear; // linear systems or least squares
    double exit;   // search for the exit boundary, and updates after it has moved
} solve_seconds;

static inline void solve_seconds_add(solve_seconds *sum, const solve_seconds *part) {
    sum->total += part->total;
    sum->rows += part->rows;
    sum->linear += part->linear;
    sum->exit += part->exit;
}

#endif
