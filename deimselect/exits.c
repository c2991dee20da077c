/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Selects rows that remain stable when the exit moves. The joint greedy method selects as many rows
 * as there are leading modes. Each further row improves the direction (combination of modes) that
 * the rows determine worst, at the worst exit of training. This direction is the eigenvector of the
 * smallest eigenvalue of the Gram matrix of the selected rows (E-optimal design).
 * GappyPOD+E is this method without exits (Peherstorfer, Drmac and Gugercin, SIAM J. Sci. Comput.
 * 2020).
 * Called by row_choice.c for --method exits. */
#include "deimselect/selection.h"
#include "deimselect/stability.h"

ehd_status selection_exits(size_t *rows, const selection_bases *bases, size_t num_rows,
                           ehd_error *error) {
    const selection_bases leading = selection_leading(bases);
    const int poorer = leading.num_modes[1] < leading.num_modes[0];
    const size_t max_joint = leading.num_modes[poorer];
    const size_t num_joint = num_rows < max_joint ? num_rows : max_joint;
    row_stability *stability = NULL;

    if (num_rows > bases->num_nodes)
        return ehd_fail(error, EHD_DATA, "rows: found %zu, expected at most %zu, the nodes",
                        num_rows, bases->num_nodes);
    ehd_status status = selection_joint(rows, &leading, num_joint, error);
    if (!status && num_rows > num_joint) status = row_stability_create(&stability, bases, error);
    for (size_t n = 0; n < num_joint && stability; n++)
        row_stability_add(stability, rows[n]);
    for (size_t n = num_joint; n < num_rows && !status; n++) {
        double sigma_min;
        status = row_stability_worst(&sigma_min, &rows[n], stability, error);
        if (!status) row_stability_add(stability, rows[n]);
    }
    row_stability_free(stability);
    return status;
}
