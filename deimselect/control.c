/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "deimselect/control.h"

#include "common/algebra/lapack.h"

#include <cblas.h>
#include <lapacke.h>
#include <stdlib.h>
#include <string.h>

/* The last iteration of a state, where its residual is that of the converged reduced solution. */
static bool is_last(const residual_snapshots *snapshots, size_t i) {
    return snapshots->state[i] >= 0 &&
           (i + 1 == snapshots->count || snapshots->state[i + 1] != snapshots->state[i]);
}

static size_t count_converged(const residual_snapshots *snapshots) {
    size_t count = 0;

    for (size_t i = 0; i < snapshots->count; i++)
        count += is_last(snapshots, i);
    return count;
}

/* Converged residuals, each of unit norm. */
static void gather_converged(double *converged, const residual_snapshots *snapshots,
                             size_t num_inner) {
    for (size_t i = 0; i < snapshots->count; i++) {
        if (!is_last(snapshots, i)) continue;
        memcpy(converged, snapshots->residuals + i * num_inner, num_inner * sizeof(double));
        double norm = cblas_dnrm2((int)num_inner, converged, 1);
        if (norm > 0) cblas_dscal((int)num_inner, 1 / norm, converged, 1);
        converged += num_inner;
    }
}

/* Columns of the result are the vectors, [num_vectors, num_inner], at the rows. */
static void sample(double *sampled, const double *vectors, size_t num_vectors, size_t num_inner,
                   const size_t *rows, size_t num_rows) {
    for (size_t k = 0; k < num_vectors; k++)
        for (size_t r = 0; r < num_rows; r++)
            sampled[k * num_rows + r] = vectors[k * num_inner + rows[r]];
}

/* remainder -= modes a with a = argmin |modes a - remainder| at the rows, where then nothing
 * remains. */
static ehd_status subtract_predicted(double *remainder, size_t num_residuals, size_t num_inner,
                                     const double *modes, size_t num_modes, const size_t *rows,
                                     size_t num_rows, ehd_error *error) {
    double *matrix = malloc(num_rows * num_modes * sizeof *matrix);
    double *fit = malloc(num_rows * num_residuals * sizeof *fit);
    ehd_status status =
        matrix && fit ? EHD_OK
                      : ehd_fail(error, EHD_MEMORY,
                                 "control rows: found no memory for %zu residuals", num_residuals);

    if (!status) {
        sample(matrix, modes, num_modes, num_inner, rows, num_rows);
        sample(fit, remainder, num_residuals, num_inner, rows, num_rows);
        status = lapack_outcome("dgels",
                                LAPACKE_dgels(LAPACK_COL_MAJOR, 'N', (int)num_rows, (int)num_modes,
                                              (int)num_residuals, matrix, (int)num_rows, fit,
                                              (int)num_rows),
                                error);
    }
    if (!status) {
        cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, (int)num_inner, (int)num_residuals,
                    (int)num_modes, -1, modes, (int)num_inner, fit, (int)num_rows, 1, remainder,
                    (int)num_inner);
        for (size_t k = 0; k < num_residuals; k++)
            for (size_t r = 0; r < num_rows; r++)
                remainder[k * num_inner + rows[r]] = 0; // pivots are other rows
    }
    free(fit);
    free(matrix);
    return status;
}

ehd_status control_choose(size_t *control, size_t *num_control, bool given,
                          const residual_snapshots *snapshots, size_t num_inner,
                          const double *modes, size_t num_modes, const size_t *rows,
                          size_t num_rows, ehd_error *error) {
    size_t num_converged = count_converged(snapshots), max_control = num_inner - num_rows;
    if (max_control > num_converged) max_control = num_converged;
    if (*num_control > max_control && given)
        return ehd_fail(error, EHD_DATA,
                        "--control: found %zu, expected at most %zu, as many as there are "
                        "converged stationary solutions and rows that are not selected",
                        *num_control, max_control);
    if (*num_control > max_control) *num_control = max_control;
    if (*num_control == 0) return EHD_OK;

    double *remainder = malloc(num_converged * num_inner * sizeof *remainder);
    if (!remainder)
        return ehd_fail(error, EHD_MEMORY, "control rows: found no memory for %zu residuals",
                        num_converged);
    gather_converged(remainder, snapshots, num_inner);
    ehd_status status = subtract_predicted(remainder, num_converged, num_inner, modes, num_modes,
                                           rows, num_rows, error);
    const selection_bases bases = {
        .num_nodes = num_inner, .num_modes = {num_converged, 0}, .modes = {remainder, NULL}};
    if (!status) status = selection_pivoted_qr(control, &bases, *num_control, error);
    free(remainder);
    return status;
}
