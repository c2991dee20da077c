/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Selects rows by column-pivoted QR (Drmac and Gugercin, SIAM J. Sci. Comput. 2016) of both bases
 * side by side. The part that earlier pivots explain is removed from each row. The next pivot is
 * the row with the largest remainder.
 * Called by row_choice.c for --method qr, by s_opt.c as a start, and by control.c. */
#include "common/algebra/lapack.h"
#include "common/program/arena.h"
#include "deimselect/selection.h"

#include <lapacke.h>

/* Copies both bases side by side: column `node` of the result contains the entries of all modes of
 * both bases at this node. */
static void put_side_by_side(double *both, const selection_bases *bases) {
    const size_t num_modes = bases->num_modes[0] + bases->num_modes[1];
    for (size_t basis = 0; basis < 2; basis++) {
        double *first = both + (basis == 0 ? 0 : bases->num_modes[0]);
        for (size_t mode = 0; mode < bases->num_modes[basis]; mode++)
            for (size_t node = 0; node < bases->num_nodes; node++)
                first[node * num_modes + mode] =
                    bases->modes[basis][mode * bases->num_nodes + node];
    }
}

ehd_status selection_pivoted_qr(size_t *rows, const selection_bases *bases, size_t num_rows,
                                ehd_error *error) {
    const size_t num_nodes = bases->num_nodes;
    const size_t num_modes = bases->num_modes[0] + bases->num_modes[1];
    const size_t max_rows = num_modes < num_nodes ? num_modes : num_nodes;
    arena memory = {0};
    if (num_rows > max_rows)
        return ehd_fail(error, EHD_DATA,
                        "rows: found %zu, expected at most %zu, the modes of both bases together",
                        num_rows, max_rows);
    if (num_rows == 0) return EHD_OK;

    double *both = arena_table(&memory, num_modes, num_nodes, sizeof *both);
    double *scales = arena_array(&memory, max_rows, sizeof *scales);
    // 0: LAPACK may move the column
    lapack_int *pivots = arena_array(&memory, num_nodes, sizeof *pivots);
    ehd_status status = memory.failed ? ehd_no_memory(error, "row selection") : EHD_OK;
    if (!status) {
        put_side_by_side(both, bases);
        status = lapack_outcome("dgeqp3",
                                LAPACKE_dgeqp3(LAPACK_COL_MAJOR, (int)num_modes, (int)num_nodes,
                                               both, (int)num_modes, pivots, scales),
                                error);
    }
    for (size_t n = 0; n < num_rows && !status; n++)
        rows[n] = (size_t)pivots[n] - 1; // Fortran counts from one
    arena_free(&memory);
    return status;
}
