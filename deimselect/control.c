/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "deimselect/control.h"

#include "common/algebra/lapack.h"

#include <cblas.h>
#include <lapacke.h>
#include <stdlib.h>

/* Samples vectors, [num_vectors, num_inner], at the rows. Column k of the result is vector k. */
static void sample(double *sampled, const double *vectors, size_t num_vectors, size_t num_inner,
                   const size_t *rows, size_t num_rows) {
    for (size_t k = 0; k < num_vectors; k++)
        for (size_t r = 0; r < num_rows; r++)
            sampled[k * num_rows + r] = vectors[k * num_inner + rows[r]];
}

/* Subtracts the prediction: remainder -= modes a, where a = argmin |modes a - remainder| at the
 * selected rows. Sets the remainder to zero at these rows. */
static ehd_status subtract_predicted(double *remainder, size_t num_residuals, size_t num_inner,
                                     const double *modes, size_t num_modes, const size_t *rows,
                                     size_t num_rows, ehd_error *error) {
    double *matrix = malloc(num_rows * num_modes * sizeof *matrix);
    double *fit = malloc(num_rows * num_residuals * sizeof *fit);
    ehd_status status = matrix && fit ? EHD_OK : ehd_no_memory(error, "control rows");

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
                remainder[k * num_inner + rows[r]] = 0; // so that no selected row becomes a pivot
    }
    free(fit);
    free(matrix);
    return status;
}

/* Limits the number of control rows. Fails if the number was given and exceeds the limit. */
static ehd_status limit_control(size_t *num_control, size_t max_control, bool given,
                                ehd_error *error) {
    if (*num_control > max_control && given)
        return ehd_fail(error, EHD_DATA,
                        "--control: found %zu, expected at most %zu, as many as there are "
                        "converged stationary solutions and rows that are not selected",
                        *num_control, max_control);
    if (*num_control > max_control) *num_control = max_control;
    return EHD_OK;
}

ehd_status control_choose(size_t *control, size_t *num_control, bool given,
                          const residual_snapshots *snapshots, size_t num_inner,
                          const double *modes, size_t num_modes, const size_t *rows,
                          size_t num_rows, ehd_error *error) {
    const size_t num_converged = residual_snapshots_converged(snapshots);
    const size_t not_selected = num_inner - num_rows;
    double *remainder = NULL;
    size_t num_remainders;
    ehd_status status = limit_control(
        num_control, not_selected < num_converged ? not_selected : num_converged, given, error);
    if (status || *num_control == 0) return status;

    status = residual_snapshots_unit(&remainder, &num_remainders, snapshots, num_inner, error);
    if (!status) status = limit_control(num_control, num_remainders, given, error);
    if (!status)
        status = subtract_predicted(remainder, num_remainders, num_inner, modes, num_modes, rows,
                                    num_rows, error);
    const selection_bases bases = {
        .num_nodes = num_inner, .num_modes = {num_remainders, 0}, .modes = {remainder, NULL}};
    if (!status) status = selection_pivoted_qr(control, &bases, *num_control, error);
    free(remainder);
    return status;
}
