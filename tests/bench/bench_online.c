/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Online solver: time of a scene with the model open, where it goes, and what one more iteration would
 * change.
 *
 *     bench_online MODEL.h5 SCENE.yml repeats tolerance modes rows [key=value ...]
 *
 * Tolerance as in reduced_settings; 0 modes or rows: all of the model. With repeats = 0 it solves once, from the trained solution nearest to the scene: for counting
 * instructions by callgrind with --toggle-collect=reduced_solve. */
#include "common/program/program.h"
#include "romrun/model_file.h"
#include "romrun/reduced_solver.h"

#include <cblas.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void must(ehd_status status, const ehd_error *error) {
    if (status == EHD_OK) return;
    fprintf(stderr, "bench_online: %s\n", error->text);
    exit(1);
}

static int compare_infos(const void *a, const void *b) {
    double p = ((const reduced_info *)a)->seconds, q = ((const reduced_info *)b)->seconds;
    return (p > q) - (p < q);
}

/* Relative change of the central film by one more iteration from the solution. */
static double another_iteration(const reduced_state *solution, const reduced_info *info,
                                const reduced_model *model, const ehd_contact *contact) {
    reduced_settings once = reduced_default_settings();
    reduced_solver *solver;
    reduced_state state = {malloc(model->num_unknowns * sizeof(double)), solution->exit};
    reduced_info more;
    ehd_error error;

    memcpy(state.coordinates, solution->coordinates, model->num_unknowns * sizeof(double));
    once.max_iterations = 1;
    must(reduced_solver_create(&solver, model, &once, &error), &error);
    must(reduced_solve(&more, &state, solver, contact, NULL, &error), &error);
    reduced_solver_free(solver);
    free(state.coordinates);
    return fabs(more.scalars.central_film_thickness / info->scalars.central_film_thickness - 1);
}

int main(int argc, char **argv) {
    reduced_settings settings = reduced_default_settings();
    scene given;
    ehd_contact contact;
    reduced_model model;
    reduced_solver *solver;
    ehd_error error;

    if (argc < 7) {
        fprintf(stderr, "usage: bench_online MODEL.h5 SCENE.yml repeats tolerance modes rows "
                        "[key=value ...]\n");
        return 64;
    }
    openblas_set_num_threads(1);
    size_t repeats = strtoul(argv[3], NULL, 10), num_overrides = (size_t)argc - 7;
    settings.tolerance = strtod(argv[4], NULL);
    const ehdrom_sizes sizes = {.pressure_modes = strtoul(argv[5], NULL, 10),
                                .rows = strtoul(argv[6], NULL, 10)};
    must(scene_read(&given, argv[2], (const char *const *)argv + 7, num_overrides, &error), &error);
    must(contact_init(&contact, &given, &error), &error);
    must(model_read(&model, argv[1], &sizes, &error), &error);
    must(reduced_solver_create(&solver, &model, &settings, &error), &error);
    reduced_state state = {malloc(model.num_unknowns * sizeof(double)), 0};
    reduced_info *infos = calloc(repeats + 1, sizeof *infos);
    if (!state.coordinates || !infos) return 71;

    if (repeats == 0) {
        reduced_neighbour(&state, &model, contact.moes_M, contact.alpha_p_H);
        double start = grid_x(&model.grid, state.exit);
        must(reduced_solve(&infos[0], &state, solver, &contact, NULL, &error), &error);
        printf("n %zu, %zu unknowns, %zu rows, %zu needed nodes: %s, %zu iterations, exit %.4f "
               "to %.4f, H_c %.8f\n",
               model.grid.num_inner, model.num_unknowns, model.num_rows, model.num_needed,
               infos[0].status ? "NOT CONVERGED" : "converged", infos[0].iterations, start,
               infos[0].scalars.exit_position, infos[0].scalars.central_film_thickness);
    } else {
        for (size_t i = 0; i < repeats; i++) {
            reduced_guess(&state, &model, contact.moes_M, contact.alpha_p_H);
            must(reduced_solve(&infos[i], &state, solver, &contact, NULL, &error), &error);
        }
        double change = another_iteration(&state, &infos[0], &model, &contact);
        qsort(infos, repeats, sizeof *infos, compare_infos);
        const reduced_info *median = &infos[repeats / 2];
        double other =
            median->seconds - median->seconds_rows - median->seconds_linear - median->seconds_exit;
        printf(
            "M = %-4g L = %-3g H_c %.8f %s, %zu iterations: %.3f ms (%.3f to %.3f) = rows %.3f + "
            "least squares %.3f + exit %.3f + other %.3f; another iteration changes H_c by %.1e\n",
            contact.moes_M, contact.moes_L, median->scalars.central_film_thickness,
            median->status ? "NOT CONVERGED" : "converged", median->iterations,
            median->seconds * 1e3, infos[0].seconds * 1e3, infos[repeats - 1].seconds * 1e3,
            median->seconds_rows * 1e3, median->seconds_linear * 1e3, median->seconds_exit * 1e3,
            other * 1e3, change);
    }
    free(infos);
    free(state.coordinates);
    reduced_solver_free(solver);
    reduced_model_free(&model);
    return 0;
}
