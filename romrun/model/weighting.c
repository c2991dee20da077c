/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/model/weighting.h"

#include "common/algebra/product.h"
#include "common/algebra/vectors.h"
#include "common/program/arena.h"

#include <math.h>
#include <string.h>

const weighting weightings[] = {
    {"quadrature", weighting_quadrature,
     "factors with which the rows stand for all rows in the least squares"},
    {"plain", weighting_plain, "one for every row, as published"},
    {NULL, NULL, NULL},
};

ehd_status weighting_plain(double *factors, const double *sampled, size_t num_rows,
                           size_t num_modes, ehd_error *error) {
    (void)sampled, (void)num_modes, (void)error;
    for (size_t r = 0; r < num_rows; r++)
        factors[r] = 1;
    return EHD_OK;
}

/* Solves min w^T C w / 2 - g^T w with w >= min_weight by projected Gauss-Seidel, which converges
 * because the problem is convex. On the models of the examples, the sweeps after the tenth change
 * the largest film error by less than 1 %. The loop ends after 20 to 600 sweeps. Only one selection
 * (112 rows of a line contact, method `exits`) would take 5000 sweeps. `w`: initial values, then
 * the solution. `slope`: C w - g, which is updated only when a weight changes, so that rows that
 * stay at the bound cost nothing. */
static void solve_bounded(double *w, double *slope, const double *matrix, size_t size,
                          double min_weight) {
    // `enough`: the sweeps end when the largest change of a weight, divided by the largest weight,
    // is at most this number. `max_sweeps`: largest number of sweeps. If `enough` is 0.1, or if
    // there are only two sweeps, the result is not the minimum (test_weighting.c,
    // weights_are_those_of_the_minimum).
    const double enough = 1e-6;
    const size_t max_sweeps = 2000;
    double change = INFINITY, largest = 0;

    for (size_t sweep = 0; sweep < max_sweeps && change > enough * largest; sweep++) {
        change = largest = 0;
        for (size_t r = 0; r < size; r++) {
            const double *row = matrix + r * size;
            if (!(row[r] > 0)) continue;
            double next = fmax(min_weight, w[r] - slope[r] / row[r]), step = next - w[r];
            change = fmax(change, fabs(step));
            largest = fmax(largest, next);
            if (step == 0) continue;
            axpy(slope, step, row, size);
            w[r] = next;
        }
    }
}

ehd_status weighting_quadrature(double *factors, const double *sampled, size_t num_rows,
                                size_t num_modes, ehd_error *error) {
    // Smallest weight. It is above 0, because every row is needed when the exit deactivates other
    // rows. Every smallest weight from 1e-6 to 0.2 gives the same worst error, in four digits
    // (test_weighting.c, weights_stay_positive).
    const double min_weight = 0.05;
    arena memory = {0};
    double *gram = arena_table(&memory, num_rows, num_rows, sizeof *gram);
    double *slope = arena_array(&memory, num_rows, sizeof *slope);
    ehd_status status = memory.failed ? ehd_no_memory(error, "weights") : EHD_OK;

    if (!status) {
        for (size_t r = 0; r < num_rows; r++)
            add_product(gram + r * num_rows, sampled, num_modes, num_rows, num_modes,
                        sampled + r * num_modes);
        // q_r is row r of `sampled`, the modes at the selected rows. The matrix C has the entries
        // (q_r . q_s)^2, the products <q_r q_r^T, q_s q_s^T>. The vector g has the entries |q_r|^2,
        // the products of q_r q_r^T with the unit matrix. The weights start at 1, where the slope
        // is C w - g.
        for (size_t r = 0; r < num_rows; r++) {
            factors[r] = 1;
            slope[r] = -gram[r * num_rows + r];
        }
        for (size_t r = 0; r < num_rows; r++)
            for (size_t s = r * num_rows; s < (r + 1) * num_rows; s++) {
                gram[s] *= gram[s];
                slope[r] += gram[s];
            }
        solve_bounded(factors, slope, gram, num_rows, min_weight);
        for (size_t r = 0; r < num_rows; r++)
            factors[r] = sqrt(factors[r]);
    }
    arena_free(&memory);
    return status;
}
