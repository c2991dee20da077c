/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures the online solver: the time of a scene when the model is already open, the parts of this
 * time, and the change of the film that one more iteration causes.
 *
 *     bench_online MODEL.h5 SCENE.yml repeats tolerance modes rows [key=value ...]
 *
 * `tolerance` is the member of reduced_settings. If `modes` or `rows` is 0, the solver uses all
 * modes or rows of the model. With repeats = 0 the program solves once, from the trained solution
 * nearest to the scene. Use repeats = 0 to count instructions by callgrind with
 * --toggle-collect=reduced_solve. */
#include "common/program/program.h"
#include "common/settings/scene_contact.h"
#include "romrun/model/model_file.h"
#include "romrun/solve/guess.h"
#include "romrun/solve/reduced_solver.h"
#include "romrun/trust/indicator.h"
#include "tests/bench/measure.h"

#include <cblas.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Makes one more iteration; returns the relative change of the central film. */
static double another_iteration(const reduced_state *solution, const reduced_info *info,
                                const reduced_model *model, const ehd_contact *contact) {
    reduced_settings once = reduced_defaults;
    reduced_solver *solver;
    reduced_state state = {.coordinates = malloc(model->num_unknowns * sizeof(double)),
                           .exit = solution->exit,
                           .exit_offset = solution->exit_offset};
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

/* Solves once, from the trained solution nearest to the scene. */
static void solve_once(reduced_state *state, const reduced_model *model, reduced_solver *solver,
                       const ehd_contact *contact) {
    reduced_info info;
    ehd_error error;

    reduced_neighbour(state, model, contact_place_of(contact));
    double start = grid_x(&model->grid, state->exit);
    must(reduced_solve(&info, state, solver, contact, NULL, &error), &error);
    printf("n %zu, %zu unknowns, %zu rows, %zu needed nodes: %s, %zu iterations, exit %.4f "
           "to %.4f, H_c %.8f\n",
           model->grid.num_inner, model->num_unknowns, model->rows.num_rows, model->rows.num_needed,
           info.status ? "NOT CONVERGED" : "converged", info.iterations, start,
           info.scalars.exit_position, info.scalars.central_film_thickness);
}

enum { ALL, ROWS, LEAST_SQUARES, EXIT, OTHER, INDICATOR, NUM_PARTS };

static reduced_info measure(double *seconds[NUM_PARTS], size_t i, reduced_state *state,
                            const reduced_model *model, reduced_solver *solver, indicator *indicate,
                            const ehd_contact *contact) {
    reduced_info info;
    ehd_error error;

    reduced_guess(state, model, contact_place_of(contact));
    must(reduced_solve(&info, state, solver, contact, NULL, &error), &error);
    double start = program_seconds();
    indicator_bound(indicate, solver, state, contact, &info.scalars);
    seconds[INDICATOR][i] = program_seconds() - start;
    seconds[ALL][i] = info.seconds.total;
    seconds[ROWS][i] = info.seconds.rows;
    seconds[LEAST_SQUARES][i] = info.seconds.linear;
    seconds[EXIT][i] = info.seconds.exit;
    seconds[OTHER][i] =
        info.seconds.total - info.seconds.rows - info.seconds.linear - info.seconds.exit;
    return info;
}

static void solve_often(reduced_state *state, const reduced_model *model, reduced_solver *solver,
                        const ehd_contact *contact, size_t repeats) {
    double *seconds[NUM_PARTS];
    spread spent[NUM_PARTS];
    reduced_info info = {0};
    indicator *indicate = indicator_create(model);
    char text[SPREAD_TEXT];

    if (!indicate) exit(71);
    for (int part = 0; part < NUM_PARTS; part++)
        seconds[part] = must_allocate(repeats * sizeof(double));
    for (size_t i = 0; i < repeats; i++)
        info = measure(seconds, i, state, model, solver, indicate, contact);
    for (int part = 0; part < NUM_PARTS; part++) {
        spent[part] = spread_of(seconds[part], repeats);
        free(seconds[part]);
    }
    printf(
        "M = %-4g L = %-3g H_c %.8f %s, %zu iterations: %s ms = rows %.3f + least squares %.3f + "
        "exit %.3f + other %.3f; indicator %.3f; another iteration changes H_c by %.1e\n",
        contact->moes_M, contact->moes_L, info.scalars.central_film_thickness,
        info.status ? "NOT CONVERGED" : "converged", info.iterations,
        spread_text(text, &spent[ALL], 1e-3, 3), spent[ROWS].median * 1e3,
        spent[LEAST_SQUARES].median * 1e3, spent[EXIT].median * 1e3, spent[OTHER].median * 1e3,
        spent[INDICATOR].median * 1e3, another_iteration(state, &info, model, contact));
    indicator_free(indicate);
}

int main(int argc, char **argv) {
    reduced_settings settings = reduced_defaults;
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
    const model_sizes sizes = {.pressure_modes = strtoul(argv[5], NULL, 10),
                               .rows = strtoul(argv[6], NULL, 10)};
    must(scene_read(&given, argv[2], (const char *const *)argv + 7, num_overrides, &error), &error);
    must(scene_contact(&contact, &given, &error), &error);
    must(model_read(&model, argv[1], &sizes, &error), &error);
    must(reduced_solver_create(&solver, &model, &settings, &error), &error);
    reduced_state state = {.coordinates = must_allocate(model.num_unknowns * sizeof(double)),
                           .exit_offset = NAN};
    if (repeats == 0)
        solve_once(&state, &model, solver, &contact);
    else
        solve_often(&state, &model, solver, &contact, repeats);
    free(state.coordinates);
    reduced_solver_free(solver);
    reduced_model_free(&model);
    return 0;
}
