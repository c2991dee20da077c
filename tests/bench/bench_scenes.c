/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures the online solver over many scenes: iterations, times of guess and solution, deviation
 * of the film.
 *
 *     bench_scenes MODEL.h5 SCENE.yml repeats tolerance modes rows <LIST
 *
 * A line of LIST is "M L H_c": values of moes.M and moes.L, and a central film to compare with,
 * such as the film that `snapgen check-plan.yml` finds. Tolerance, modes and rows are as in
 * bench_online. The time of a scene is the median of its repeats. With one repeat, callgrind counts
 * instructions with --toggle-collect=reduced_solve, or =reduced_guess. */
#include "common/program/program.h"
#include "common/settings/scene_contact.h"
#include "romrun/model/model_file.h"
#include "romrun/solve/guess.h"
#include "romrun/solve/reduced_solver.h"
#include "tests/bench/measure.h"

#include <cblas.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { MOST_SCENES = 1000 };

static int compare(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;

    return (x > y) - (x < y);
}

typedef struct samples {
    double solve[MOST_SCENES], start[MOST_SCENES], deviation[MOST_SCENES]; // s, s, dimensionless
    double iterations, seconds;                                            // sums over all scenes
    size_t count, num_failed;
} samples;

static void read_contact(ehd_contact *contact, const char *path, const char *M, const char *L) {
    char overrides[2][80];
    const char *const both[] = {overrides[0], overrides[1]};
    scene given;
    ehd_error error;

    snprintf(overrides[0], sizeof overrides[0], "moes.M=%s", M);
    snprintf(overrides[1], sizeof overrides[1], "moes.L=%s", L);
    must(scene_read(&given, path, both, 2, &error), &error);
    must(scene_contact(contact, &given, &error), &error);
}

static void measure(samples *self, reduced_state *state, const reduced_model *model,
                    reduced_solver *solver, const ehd_contact *contact, size_t repeats,
                    double central_film) {
    double *solve = must_allocate(repeats * sizeof *solve);
    double *start = must_allocate(repeats * sizeof *start);
    reduced_info info = {0};
    ehd_error error;

    for (size_t i = 0; i < repeats; i++) {
        const double before = program_seconds();
        reduced_guess(state, model, contact_place_of(contact));
        start[i] = program_seconds() - before;
        must(reduced_solve(&info, state, solver, contact, NULL, &error), &error);
        solve[i] = info.seconds.total;
    }
    self->solve[self->count] = spread_of(solve, repeats).median;
    self->start[self->count] = spread_of(start, repeats).median;
    self->deviation[self->count] = fabs(info.scalars.central_film_thickness / central_film - 1);
    self->seconds += self->solve[self->count];
    self->iterations += (double)info.iterations;
    self->num_failed += info.status != EHD_OK;
    self->count++;
    free(solve);
    free(start);
}

static void print(samples *self) {
    const size_t n = self->count, half = n / 2, most = n * 95 / 100;

    qsort(self->solve, n, sizeof *self->solve, compare);
    qsort(self->start, n, sizeof *self->start, compare);
    qsort(self->deviation, n, sizeof *self->deviation, compare);
    printf("%zu scenes, %zu failed, %.2f iterations; solution median %.0f, mean %.0f, worst %.0f "
           "us, start %.0f us; H_c off by median %.1e, 95 %% %.1e, worst %.1e\n",
           n, self->num_failed, self->iterations / (double)n, self->solve[half] * 1e6,
           self->seconds / (double)n * 1e6, self->solve[n - 1] * 1e6, self->start[half] * 1e6,
           self->deviation[half], self->deviation[most], self->deviation[n - 1]);
}

int main(int argc, char **argv) {
    static samples all;
    reduced_settings settings = reduced_defaults;
    reduced_model model;
    reduced_solver *solver;
    reduced_state state;
    ehd_contact contact;
    ehd_error error;
    char line[256], M[64], L[64];
    double central_film;

    if (argc != 7) {
        fprintf(stderr,
                "usage: bench_scenes MODEL.h5 SCENE.yml repeats tolerance modes rows <LIST\n");
        return 64;
    }
    openblas_set_num_threads(1);
    const size_t repeats = strtoul(argv[3], NULL, 10);
    settings.tolerance = strtod(argv[4], NULL);
    const model_sizes sizes = {.pressure_modes = strtoul(argv[5], NULL, 10),
                               .rows = strtoul(argv[6], NULL, 10)};
    must(model_read(&model, argv[1], &sizes, &error), &error);
    must(reduced_solver_create(&solver, &model, &settings, &error), &error);
    must(reduced_state_init(&state, &model, &error), &error);
    while (all.count < MOST_SCENES && fgets(line, sizeof line, stdin)) {
        if (sscanf(line, "%63s %63s %lf", M, L, &central_film) != 3) {
            fprintf(stderr, "bench_scenes: found line %s, expected M L H_c\n", line);
            return 65;
        }
        read_contact(&contact, argv[2], M, L);
        measure(&all, &state, &model, solver, &contact, repeats, central_film);
    }
    if (all.count > 0) print(&all);
    reduced_state_free(&state);
    reduced_solver_free(solver);
    reduced_model_free(&model);
    return all.num_failed > 0;
}
