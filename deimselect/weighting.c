/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "deimselect/weighting.h"

#include <cblas.h>
#include <math.h>
#include <stdlib.h>

const weighting weightings[] = {
    {"quadrature", weighting_quadrature,
     "factors with which the rows stand for all rows in the least squares"},
    {"plain", weighting_plain, "one for every row, as published"},
    {NULL, NULL, NULL},
};

ehd_status weighting_plain(double *factors, const double *modes, size_t num_modes, size_t num_nodes,
                           const size_t *rows, size_t num_rows, ehd_error *error) {
    (void)modes, (void)num_modes, (void)num_nodes, (void)rows, (void)error;
    for (size_t r = 0; r < num_rows; r++)
        factors[r] = 1;
    return EHD_OK;
}

/* Modes sampled at the rows, [num_rows, num_modes]. */
static void sample_modes(double *sampled, const double *modes, size_t num_modes, size_t num_nodes,
                         const size_t *rows, size_t num_rows) {
    for (size_t r = 0; r < num_rows; r++)
        for (size_t j = 0; j < num_modes; j++)
            sampled[r * num_modes + j] = modes[j * num_nodes + rows[r]];
}

/* min w^T C w / 2 - g^T w with w >= least, by projected Gauss-Seidel: convex, so that it converges,
 * and good to two digits after some hundred sweeps, which is more than the weights matter. */
static void solve_bounded(double *w, const double *matrix, const double *right, size_t size,
                          double least) {
    const size_t most_sweeps = 2000;
    const double enough = 1e-6; // of the largest weight
    double change = INFINITY, largest = 0;

    for (size_t sweep = 0; sweep < most_sweeps && change > enough * largest; sweep++) {
        change = largest = 0;
        for (size_t r = 0; r < size; r++) {
            const double *row = matrix + r * size;
            if (!(row[r] > 0)) continue;
            double gradient = cblas_ddot((int)size, row, 1, w, 1) - right[r];
            double next = fmax(least, w[r] - gradient / row[r]);
            change = fmax(change, fabs(next - w[r]));
            largest = fmax(largest, next);
            w[r] = next;
        }
    }
}

ehd_status weighting_quadrature(double *factors, const double *modes, size_t num_modes,
                                size_t num_nodes, const size_t *rows, size_t num_rows,
                                ehd_error *error) {
    const double least = 0.05; // no row loses its say, since the exit may take others away
    double *sampled = malloc(num_rows * num_modes * sizeof *sampled);
    double *gram = malloc(num_rows * num_rows * sizeof *gram);
    double *right = malloc(num_rows * sizeof *right);
    ehd_status status = EHD_OK;

    if (!sampled || !gram || !right)
        status = ehd_fail(error, EHD_MEMORY, "weights: found no memory for %zu rows", num_rows);
    if (!status) {
        sample_modes(sampled, modes, num_modes, num_nodes, rows, num_rows);
        cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasTrans, (int)num_rows, (int)num_rows,
                    (int)num_modes, 1, sampled, (int)num_modes, sampled, (int)num_modes, 0, gram,
                    (int)num_rows);
        // <q_r q_r^T, q_s q_s^T> = (q_r . q_s)^2 and <q_r q_r^T, 1> = |q_r|^2
        for (size_t r = 0; r < num_rows; r++) {
            right[r] = gram[r * num_rows + r];
            factors[r] = 1;
        }
        for (size_t i = 0; i < num_rows * num_rows; i++)
            gram[i] *= gram[i];
        solve_bounded(factors, gram, right, num_rows, least);
        for (size_t r = 0; r < num_rows; r++)
            factors[r] = sqrt(factors[r]);
    }
    free(sampled);
    free(gram);
    free(right);
    return status;
}
