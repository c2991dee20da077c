/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures cold solutions of large point contacts with the full model: M = 20, L = 10, Barus,
 * compressible, accurate discretisation, far field, half domain, on one thread or several. Prints
 * processor time, time, memory and iterations of the finest grid (fullrun/README.md, Large point
 * contacts). Fails if 1024 cells take more than MOST_SECONDS or MOST_MEGABYTES.
 *
 *     bench_large [smallest number of cells [largest number of cells [M [L [threads]]]]] */
#include "common/program/program.h"
#include "tests/bench/cold.h"
#include "tests/bench/measure.h"
#include "tests/unit/sample.h"

#include <cblas.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { HELD_CELLS = 1024 };
static const double MOST_SECONDS = 60, MOST_MEGABYTES = 1000;

typedef struct large_task {
    size_t cells, threads;
    double moes_M, moes_L;
} large_task;

typedef struct large_record {
    size_t across, lines, nodes, newton, gmres;
    double seconds, bytes; // processor time of all threads, s; memory stated by full_solver_bytes
    double elapsed;
    contact_scalars scalars;
} large_record;

static double processor_seconds(void) {
    return (double)clock() / CLOCKS_PER_SEC;
}

/* Prints each iteration, including those on coarser grids, if the environment variable
 * LARGE_VERBOSE is set. */
static void show(void *context, const ehd_grid *grid, size_t iteration, double residual) {
    (void)context;
    printf("    %zu by %zu, iteration %zu, residual %.2e, after %.2f s\n", grid->inner_x,
           grid->inner_lines, iteration, residual, processor_seconds());
    fflush(stdout);
}

static void solve(void *result, const void *given) {
    const large_task *task = given;
    large_record *record = result;
    ehd_contact contact =
        sample_point("barus", "dowson-higginson", task->moes_M, task->moes_L, task->cells, true);
    const ehd_grid *grid = &contact.grid;
    full_settings settings = full_default_settings();
    full_solver *solver;
    full_state state;
    full_info info;
    ehd_error error;
    const double before = processor_seconds(), began = program_seconds();
    team *threads = settings.threads = team_create(task->threads);

    if (getenv("LARGE_VERBOSE")) settings.watcher = show;
    must(full_solver_create(&solver, contact.kind, grid, &settings, &error), &error);
    must(full_state_init(&state, grid, &error), &error);
    must(full_solve_cold(&info, &state, solver, &contact, &error), &error);
    must_converge(&info);
    *record = (large_record){.across = grid->inner_x,
                             .lines = grid->inner_lines,
                             .nodes = grid->num_inner,
                             .newton = info.newton_iterations,
                             .gmres = info.gmres_iterations,
                             .seconds = processor_seconds() - before,
                             .elapsed = program_seconds() - began,
                             .bytes = full_solver_bytes(grid),
                             .scalars = full_evaluate_scalars(&state, &contact)};
    full_state_free(&state);
    full_solver_free(solver);
    team_free(threads);
}

int main(int argc, char **argv) {
    const size_t least = argc > 1 ? strtoul(argv[1], NULL, 10) : 128;
    const size_t most = argc > 2 ? strtoul(argv[2], NULL, 10) : 512;
    large_task task = {.moes_M = argc > 3 ? strtod(argv[3], NULL) : 20,
                       .moes_L = argc > 4 ? strtod(argv[4], NULL) : 10,
                       .threads = argc > 5 ? strtoul(argv[5], NULL, 10) : 1};
    large_record record = {0};
    double megabytes;
    int failed = 0;

    openblas_set_num_threads(1);
    for (task.cells = least; task.cells <= most && task.cells > 0; task.cells *= 2) {
        run_apart(&record, sizeof record, &megabytes, solve, &task);
        printf("%zu by %zu nodes solved: %.3f s, %.3f s of the processor, %.1f us a node, %.0f MB "
               "(stated %.0f), %.0f bytes a node, %zu Newton, %zu GMRES, H_c %.10f, H_m %.10f\n",
               record.across, record.lines, record.elapsed, record.seconds,
               1e6 * record.seconds / (double)record.nodes, megabytes, record.bytes / 1e6,
               1e6 * megabytes / (double)record.nodes, record.newton, record.gmres,
               record.scalars.central_film_thickness, record.scalars.minimum_film_thickness);
        fflush(stdout);
        if (task.cells == HELD_CELLS &&
            !(record.seconds <= MOST_SECONDS && megabytes <= MOST_MEGABYTES))
            failed = 1;
    }
    return failed;
}
