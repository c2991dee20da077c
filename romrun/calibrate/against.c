/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/calibrate/against.h"

#include "romrun/calibrate/time_compare.h"

#include <math.h>
#include <stdio.h>

static void print_deviation(const char *name, double reduced, double full) {
    if (isfinite(full) && full != 0)
        printf("  %-24s %13.8g against %13.8g  %+.4f permille\n", name, reduced, full,
               (reduced / full - 1) * 1e3);
}

/* Largest difference of a field at a grid's nodes from one at the whole grid's inner nodes. */
static double field_difference(const double *nodes, const double *inner, const ehd_grid *grid) {
    size_t num_inner = grid_whole(grid).num_inner;
    double largest = 0;

    for (size_t i = 0; i < num_inner; i++) {
        size_t node = grid_node_of_row(grid, grid_row_of_whole(grid, i));
        largest = fmax(largest, fabs(nodes[node] - inner[i]));
    }
    return largest;
}

ehd_status against_check(double moes_M, double alpha_p_H, double hertz_pressure, const char *path,
                         const ehd_contact *contact, ehd_error *error) {
    const double slack = 1e-6;

    if (fabs(moes_M - contact->moes_M) <= slack * contact->moes_M &&
        fabs(hertz_pressure - contact->hertz_pressure) <=
            slack * fmax(contact->hertz_pressure, 1) &&
        fabs(alpha_p_H - contact->alpha_p_H) <= slack * fmax(contact->alpha_p_H, 1))
        return EHD_OK;
    return ehd_fail(error, EHD_DATA,
                    "%s: found a result of M = %g, alpha p_H = %g, %.6g GPa, expected the scene's "
                    "M = %g, alpha p_H = %g, %.6g GPa",
                    path, moes_M, alpha_p_H, hertz_pressure * 1e-9, contact->moes_M,
                    contact->alpha_p_H, contact->hertz_pressure * 1e-9);
}

void against_print(const run_result *result, const stored_result *stored, const char *path,
                   const ehd_contact *contact) {
    const ehd_grid *grid = &contact->grid;
    size_t num_inner = grid_whole(grid).num_inner;

    printf("against %s:\n", path);
    print_deviation("central film thickness", result->central_film_thickness,
                    stored->central_film_thickness);
    print_deviation("minimum film thickness", result->minimum_film_thickness,
                    stored->minimum_film_thickness);
    print_deviation("central pressure", result->central_pressure, stored->central_pressure);
    print_deviation("exit position", result->exit_position, stored->exit_position);
    if (result->pressure && stored->pressure && stored->num_inner == num_inner)
        printf("  %-24s %.2e of the Hertz pressure\n", "largest pressure error",
               field_difference(result->pressure, stored->pressure, grid));
    if (result->film && stored->film && stored->num_inner == num_inner)
        printf("  %-24s %.2e\n", "largest film error",
               field_difference(result->film, stored->film, grid));
}

ehd_status against_print_in_time(const time_trace *trace, const time_series *full, const char *path,
                                 ehd_error *error) {
    const struct {
        const char *name;
        const double *reduced, *full;
    } quantities[] = {
        {"central film thickness", trace->central_film_thickness, full->central_film_thickness},
        {"central pressure", trace->central_pressure, full->central_pressure}};
    ehd_error cause = {""};

    printf("against %s:\n", path);
    for (size_t i = 0; i < sizeof quantities / sizeof *quantities; i++) {
        time_deviation deviation;
        ehd_status status =
            time_compare(&deviation, trace->time, quantities[i].reduced, trace->count, full->time,
                         quantities[i].full, full->num_times, &cause);
        if (status) return ehd_fail(error, status, "%s: %s", path, cause.text);
        printf("  %-24s at most %.3g %% off, at T = %.6g; %.2g %% in the mean\n",
               quantities[i].name, deviation.largest * 100, deviation.at, deviation.mean * 100);
    }
    return EHD_OK;
}
