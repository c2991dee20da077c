/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "deimselect/selection.h"

#include "common/algebra/lapack.h"
#include "common/program/arena.h"

#include <lapacke.h>

const selection_method selection_methods[] = {
    {"joint", selection_joint, 1, 0, false,
     "greedy on the interpolation errors of both bases (Maier et al. 2015, Fig. A1); at most as "
     "many rows as "
     "the "
     "smaller basis has modes"},
    {"qr", selection_pivoted_qr, 2, 2, false,
     "column-pivoted QR of both bases side by side; at most as many rows as both have modes"},
    {"sopt", selection_s_opt, 0, 1, false,
     "oversampled S-OPT: largest product of the determinants of both bases sampled at the rows, "
     "over the norms of "
     "their columns; any number of rows"},
    {"exits", selection_exits, 0, 0, true,
     "joint up to as many rows as pressure modes, then the row that helps the worst exit of "
     "training "
     "most; any number of rows"},
    {NULL, NULL, 0, 0, false, NULL},
};

selection_bases selection_leading(const selection_bases *bases) {
    selection_bases leading = *bases;

    for (int i = 0; i < 2; i++)
        if (bases->num_leading > 0 && leading.num_modes[i] > bases->num_leading)
            leading.num_modes[i] = bases->num_leading;
    return leading;
}

ehd_status selection_sigma_min(double *sigma_min, const double *modes, size_t num_columns,
                               size_t num_nodes, const size_t *rows, size_t num_rows,
                               ehd_error *error) {
    arena memory = {0};
    *sigma_min = 0.0;
    if (num_columns == 0)
        return ehd_fail(error, EHD_DATA, "sigma_min: found no columns, expected at least one");
    if (num_rows < num_columns) return EHD_OK;

    double *sampled = arena_table(&memory, num_rows, num_columns, sizeof *sampled);
    double *values = arena_array(&memory, num_columns, sizeof *values);
    ehd_status status = memory.failed ? ehd_no_memory(error, "sigma_min") : EHD_OK;
    for (size_t column = 0; column < num_columns && !status; column++)
        for (size_t n = 0; n < num_rows; n++)
            sampled[column * num_rows + n] = modes[column * num_nodes + rows[n]];
    // 'N' computes no singular vectors; their leading dimensions only have to be positive
    if (!status)
        status =
            lapack_outcome("dgesdd",
                           LAPACKE_dgesdd(LAPACK_COL_MAJOR, 'N', (int)num_rows, (int)num_columns,
                                          sampled, (int)num_rows, values, NULL, 1, NULL, 1),
                           error);
    if (!status) *sigma_min = values[num_columns - 1];
    arena_free(&memory);
    return status;
}
