/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fullrun/full_result.h"

#include <stdlib.h>

run_result full_result(const full_info *info, const full_state *state, const ehd_contact *contact,
                       bool with_fields) {
    const contact_scalars scalars = full_evaluate_scalars(state, contact);

    return (run_result){.pressure = with_fields ? state->pressure : NULL,
                        .film = with_fields ? state->film : NULL,
                        .central_film_thickness = scalars.central_film_thickness,
                        .minimum_film_thickness = scalars.minimum_film_thickness,
                        .central_pressure = scalars.central_pressure,
                        .rigid_approach = scalars.rigid_approach,
                        .exit_position = scalars.exit_position,
                        .load = scalars.load,
                        .newton_iterations = info->newton_iterations,
                        .residual = info->residual,
                        .seconds = info->seconds,
                        .seconds_rows = info->seconds_rows,
                        .seconds_linear = info->seconds_linear,
                        .seconds_exit = NAN};
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
    const double a = ((const full_info *)left)->seconds, b = ((const full_info *)right)->seconds;

    return (a > b) - (a < b);
}

full_info full_median_run(full_info *runs, size_t count) {
    qsort(runs, count, sizeof *runs, compare_seconds);
    return runs[count / 2];
}
