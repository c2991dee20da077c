/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures the full-order solver on a point contact: M = 20, L = 10, Barus, incompressible, cold
 * start, half domain, one thread. For the same grids, Venner and Lubrecht published times of their
 * multigrid program (Multilevel Methods in Lubrication, Elsevier 2000). The unit of time is a
 * product of two matrices of 2000 rows. With 257 nodes across, their program takes 46 units to
 * converge, and 4.7 units to reach the truncation error.
 *
 *     bench_point [repeats [largest number of cells]] */
#include "common/program/program.h"
#include "tests/bench/cold.h"
#include "tests/unit/sample.h"

#include <cblas.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { FEWEST_CELLS = 64, MOST_CELLS = 512, COMPARED_CELLS = 256, NUM_SIZES = 4 };
static const double MOST_CONVERGED = 46, MOST_TRUNCATED = 3 * 4.7; // in products of matrices
static const double MOST_TIME_EXPONENT = 1.5, MOST_MEMORY_EXPONENT = 1.3;
// at this scaled residual the error of the iteration is below the discretisation error
static const double TRUNCATED = 1e-3;

// ---- the unit of time: a product of matrices

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

// ---- one grid

static cold_task task_of(size_t cells, double tolerance, size_t repeats) {
    cold_task task = {
        sample_published(sample_point("barus", "incompressible", 20, 10, cells, true)),
        full_default_settings(), repeats};
    task.settings.tolerance = tolerance;
    return task;
}

static double in_moes(double film, const cold_task *task) {
    return film * pow(1.5 * task->contact.moes_M, 2. / 3);
}

static void print_record(const char *what, const cold_record *record, const cold_task *task,
                         double product) {
    size_t across = task->contact.grid.inner_x + 2;
    char text[SPREAD_TEXT];

    printf("%s, %zu by %zu nodes (half of it solved): %s s, %.1f products, %zu Newton, %zu GMRES, "
           "H_c %.4f, H_m %.4f",
           what, across, across, spread_text(text, &record->seconds, 1, 2),
           record->seconds.median / product, record->newton, record->gmres,
           in_moes(record->scalars.central_film_thickness, task),
           in_moes(record->scalars.minimum_film_thickness, task));
}

// ---- all grids

static int compare_truncated(const cold_record *converged, double product, size_t repeats) {
    const cold_task task = task_of(COMPARED_CELLS, TRUNCATED, repeats);
    const double finer = 4.801; // H_c of the multigrid program with twice the cells
    cold_record record = {0};

    cold_solve(&record, &task);
    double units = record.seconds.median / product;
    double central = in_moes(converged->scalars.central_film_thickness, &task);
    double error = fabs(in_moes(record.scalars.central_film_thickness, &task) - central);
    double truncation = fabs(finer - central);
    print_record("to the truncation error", &record, &task, product);
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
    // children are forked first, while this process is small
    cold_task task = task_of(FEWEST_CELLS, full_default_settings().tolerance, 0);
    run_apart(&record, sizeof record, &idle, cold_solve, &task);
    for (size_t cells = FEWEST_CELLS; cells <= most && count < NUM_SIZES; cells *= 2, count++) {
        task = task_of(cells, task.settings.tolerance, repeats);
        run_apart(&record, sizeof record, &megabytes[count], cold_solve, &task);
        nodes[count] = (double)task.contact.grid.num_inner;
        seconds[count] = record.seconds.median;
        megabytes[count] -= idle;
        print_record("cold solve", &record, &task, time_product(3));
        printf(", peak memory %.0f MB\n", megabytes[count]);
        if (cells == COMPARED_CELLS) compared = record;
    }
    double time_exponent = growth_exponent(nodes, seconds, count);
    double memory_exponent = growth_exponent(nodes, megabytes, count);
    printf("growth with the nodes N: time N^%.2f (at most %g), memory N^%.2f (at most %g)\n",
           time_exponent, MOST_TIME_EXPONENT, memory_exponent, MOST_MEMORY_EXPONENT);
    int slow = time_exponent > MOST_TIME_EXPONENT || memory_exponent > MOST_MEMORY_EXPONENT;
    return compared.newton > 0 ? compare_truncated(&compared, time_product(5), repeats) | slow
                               : slow;
}
