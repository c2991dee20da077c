/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Full-order solver of a point contact: M = 20, L = 10, Barus, incompressible, cold start, half domain, one
 * thread, on the grids for which Venner and Lubrecht's multigrid program is known (257 nodes across: 46 times
 * a product of two matrices of 2000 rows to be converged, 4.7 times it to the truncation error).
 *
 *     bench_point [repeats [largest number of cells]] */
#include "common/program/program.h"
#include "fullrun/full_solver.h"
#include "tests/bench/measure.h"
#include "tests/unit/sample.h"

#include <cblas.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { FEWEST_CELLS = 64, MOST_CELLS = 512, COMPARED_CELLS = 256, NUM_SIZES = 4 };
static const double MOST_CONVERGED = 46, MOST_TRUNCATED = 3 * 4.7; // products
static const double MOST_TIME_EXPONENT = 1.5, MOST_MEMORY_EXPONENT = 1.3;
static const double TRUNCATED = 1e-3; // scaled residual at which the error is that of the grid

// ---- the unit

static double time_product(size_t repeats) {
    enum { ROWS = 2000 };
    double *a = must_allocate(3 * ROWS * ROWS * sizeof *a), *b = a + ROWS * ROWS;
    double *times = must_allocate(repeats * sizeof *times);

    for (size_t i = 0; i < 2 * ROWS * ROWS; i++)
        a[i] = (double)(i % 7);
    for (size_t i = 0; i < repeats; i++) {
        double before = program_seconds();
        cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, ROWS, ROWS, ROWS, 1, a, ROWS, b,
                    ROWS, 0, b + ROWS * ROWS, ROWS);
        times[i] = program_seconds() - before;
    }
    double median = spread_of(times, repeats).median;
    free(times);
    free(a);
    return median;
}

// ---- one size

typedef struct cold_task {
    size_t cells; // 0: nothing is solved, which shows what the program itself takes
    size_t repeats;
    double tolerance;
} cold_task;

typedef struct cold_record {
    spread seconds;
    size_t nodes, newton, gmres; // iterations on the finest grid
    double central, minimum;     // film in Moes units
} cold_record;

static void solve_once(cold_record *record, double *seconds, const cold_task *task) {
    const ehd_contact contact = sample_point("barus", "incompressible", 20, 10, task->cells, true);
    const double unit = pow(1.5 * contact.moes_M, 2. / 3);
    full_settings settings = full_default_settings();
    full_solver *solver;
    full_state state;
    full_info info;
    ehd_error error;
    double before = program_seconds();

    settings.tolerance = task->tolerance;
    must(full_solver_create(&solver, contact.kind, &contact.grid, &settings, &error), &error);
    must(full_state_init(&state, &contact.grid, &error), &error);
    must(full_solve_cold(&info, &state, solver, &contact, &error), &error);
    *seconds = program_seconds() - before;
    if (info.status != EHD_OK) {
        fprintf(stderr, "bench_point: %s\n", info.reason);
        exit(1);
    }
    contact_scalars scalars = full_evaluate_scalars(&state, &contact);
    record->nodes = contact.grid.num_inner;
    record->newton = info.newton_iterations;
    record->gmres = info.gmres_iterations;
    record->central = scalars.central_film_thickness * unit;
    record->minimum = scalars.minimum_film_thickness * unit;
    full_state_free(&state);
    full_solver_free(solver);
}

static void solve_cold(void *result, const void *given) {
    const cold_task *task = given;
    cold_record *record = result;
    double *seconds = must_allocate((task->repeats + 1) * sizeof *seconds);

    for (size_t i = 0; i < task->repeats && task->cells > 0; i++)
        solve_once(record, &seconds[i], task);
    if (task->cells > 0) record->seconds = spread_of(seconds, task->repeats);
    free(seconds);
}

static void print_record(const char *what, const cold_record *record, size_t cells,
                         double product) {
    char text[SPREAD_TEXT];

    printf("%s, %zu by %zu nodes (half of it solved): %s s, %.1f products, %zu Newton, %zu GMRES, "
           "H_c %.4f, H_m %.4f",
           what, cells + 1, cells + 1, spread_text(text, &record->seconds, 1, 2),
           record->seconds.median / product, record->newton, record->gmres, record->central,
           record->minimum);
}

// ---- all

static int compare_truncated(const cold_record *converged, double product, size_t repeats) {
    const cold_task task = {COMPARED_CELLS, repeats, TRUNCATED};
    const double finer = 4.801; // H_c of twice the cells (model.md, section 6)
    cold_record record = {0};

    solve_cold(&record, &task);
    double units = record.seconds.median / product;
    double error = fabs(record.central - converged->central);
    double truncation = fabs(finer - converged->central);
    print_record("to the truncation error", &record, COMPARED_CELLS, product);
    printf(", off by %.1e of the converged one, truncation %.1e\n", error, truncation);
    printf("products: converged %.1f (at most %g), to the truncation error %.1f (at most %g)\n",
           converged->seconds.median / product, MOST_CONVERGED, units, MOST_TRUNCATED);
    return converged->seconds.median <= MOST_CONVERGED * product && units <= MOST_TRUNCATED &&
                   error < truncation
               ? 0
               : 1;
}

int main(int argc, char **argv) {
    size_t repeats = argc > 1 ? strtoul(argv[1], NULL, 10) : 3;
    size_t most = argc > 2 ? strtoul(argv[2], NULL, 10) : MOST_CELLS;
    double nodes[NUM_SIZES], seconds[NUM_SIZES], megabytes[NUM_SIZES], idle;
    cold_record record = {0}, compared = {0};
    size_t count = 0;

    if (repeats == 0) abort();
    openblas_set_num_threads(1);
    // children first: they start from a small process
    run_apart(&record, sizeof record, &idle, solve_cold, &(cold_task){0, 0, 0});
    for (size_t cells = FEWEST_CELLS; cells <= most && count < NUM_SIZES; cells *= 2, count++) {
        const cold_task task = {cells, repeats, full_default_settings().tolerance};
        run_apart(&record, sizeof record, &megabytes[count], solve_cold, &task);
        nodes[count] = (double)record.nodes;
        seconds[count] = record.seconds.median;
        megabytes[count] -= idle;
        print_record("cold solve", &record, cells, time_product(3));
        printf(", peak memory %.0f MB\n", megabytes[count]);
        if (cells == COMPARED_CELLS) compared = record;
    }
    double time_exponent = growth_exponent(nodes, seconds, count);
    double memory_exponent = growth_exponent(nodes, megabytes, count);
    printf("growth with the nodes N: time N^%.2f (at most %g), memory N^%.2f (at most %g)\n",
           time_exponent, MOST_TIME_EXPONENT, memory_exponent, MOST_MEMORY_EXPONENT);
    int slow = time_exponent > MOST_TIME_EXPONENT || memory_exponent > MOST_MEMORY_EXPONENT;
    return compared.nodes > 0 ? compare_truncated(&compared, time_product(5), repeats) | slow
                              : slow;
}
