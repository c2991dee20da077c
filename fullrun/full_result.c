/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fullrun/full_result.h"

#include <stdlib.h>

run_result full_result(const full_info *info, const full_state *state, const ehd_contact *contact,
                       bool with_fields) {
    return (run_result){.pressure = with_fields ? state->pressure : NULL,
                        .film = with_fields ? state->film : NULL,
                        .scalars = full_evaluate_scalars(state, contact),
                        .newton_iterations = info->newton_iterations,
                        .residual = info->residual,
                        .seconds = info->seconds};
}

ehd_status full_exits(double **exits, const full_state *state, const ehd_grid *grid,
                      ehd_error *error) {
    *exits = NULL;
    if (grid->inner_lines == 1) return EHD_OK;
    size_t *columns = malloc(grid_lines(grid) * sizeof *columns);
    *exits = malloc(grid_whole(grid).inner_lines * sizeof **exits);
    const ehd_status status = columns && *exits ? EHD_OK : ehd_no_memory(error, "exit");
    if (!status) {
        grid_exit_columns(columns, state->pressure, grid);
        grid_exits(*exits, columns, grid);
    }
    free(columns);
    return status;
}

static int compare_seconds(const void *left, const void *right) {
    const double a = ((const full_info *)left)->seconds.total;
    const double b = ((const full_info *)right)->seconds.total;

    return (a > b) - (a < b);
}

full_info full_median_run(full_info *runs, size_t count) {
    qsort(runs, count, sizeof *runs, compare_seconds);
    return runs[count / 2];
}
