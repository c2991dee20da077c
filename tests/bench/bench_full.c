/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compares the full-order solver with Newton on dense matrices, and measures how time and memory
 * grow with the number of nodes.
 *
 *     bench_full [repeats] */
#include "tests/bench/cold.h"
#include "tests/unit/dense.h"
#include "tests/unit/sample.h"

#include <cblas.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double LEAST_RATIO = 10, MOST_EXPONENT = 1.3;

// ---- n = 3001 against the dense Newton

/* Runs Newton from a copy of `start`; returns its time in seconds. */
static double time_newton(full_info *info, full_state *work, const full_state *start,
                          full_solver *solver, const ehd_contact *contact) {
    ehd_error error;

    full_state_copy(work, start, &contact->grid);
    must(full_solve(info, work, solver, contact, NULL, &error), &error);
    must_converge(info);
    return info->seconds.total;
}

static int bench_dense(size_t repeats) {
    ehd_contact contact =
        sample_published(sample_contact("no1", "dowson-higginson", 100, 10, 0.002));
    ehd_contact neighbour = contact;
    full_settings settings = full_default_settings(), dense_settings = settings;
    full_solver *solver, *dense_solver;
    full_state start, work;
    full_info info, dense_info;
    ehd_error error;
    double *times = malloc(repeats * sizeof *times);

    if (!times) abort();
    dense_settings.solve_linear = dense_solve;
    contact_set_moes(&neighbour, 102, 9);
    must(full_solver_create(&solver, contact.kind, &contact.grid, &settings, &error), &error);
    must(full_solver_create(&dense_solver, contact.kind, &contact.grid, &dense_settings, &error),
         &error);
    must(full_state_init(&start, &contact.grid, &error), &error);
    must(full_state_init(&work, &contact.grid, &error), &error);
    must(full_solve_cold(&info, &start, solver, &neighbour, &error), &error);
    must_converge(&info);

    for (size_t i = 0; i < repeats; i++)
        times[i] = time_newton(&info, &work, &start, solver, &contact);
    double film = full_evaluate_scalars(&work, &contact).central_film_thickness;
    double dense_seconds = time_newton(&dense_info, &work, &start, dense_solver, &contact);
    double dense_film = full_evaluate_scalars(&work, &contact).central_film_thickness;
    const spread seconds = spread_of(times, repeats);
    double ratio = dense_seconds / seconds.median;
    char text[SPREAD_TEXT];
    printf("full solve, n = %zu, from a neighbour: %s ms (%zu Newton, %zu GMRES), dense Newton "
           "%.1f ms (%zu Newton), ratio %.1f (at least %g), H_c %.10f and %.10f\n",
           contact.grid.num_inner, spread_text(text, &seconds, 1e-3, 1), info.newton_iterations,
           info.gmres_iterations, 1e3 * dense_seconds, dense_info.newton_iterations, ratio,
           LEAST_RATIO, film, dense_film);

    full_state_free(&work);
    full_state_free(&start);
    full_solver_free(dense_solver);
    full_solver_free(solver);
    free(times);
    return ratio >= LEAST_RATIO ? 0 : 1;
}

// ---- growth with the nodes

static int bench_growth(size_t repeats) {
    enum { NUM_SIZES = 5 };
    double nodes[NUM_SIZES], seconds[NUM_SIZES], megabytes[NUM_SIZES], idle;
    cold_task task = {.settings = full_default_settings()};
    cold_record record = {0};
    char text[SPREAD_TEXT];

    run_apart(&record, sizeof record, &idle, cold_solve, &task);
    task.repeats = repeats;
    for (size_t i = 0; i < NUM_SIZES; i++) {
        double step = 0.005 / (double)(1 << i);
        task.contact = sample_published(sample_contact("no1", "dowson-higginson", 12, 12, step));
        nodes[i] = (double)task.contact.grid.num_inner;
        run_apart(&record, sizeof record, &megabytes[i], cold_solve, &task);
        seconds[i] = record.seconds.median;
        megabytes[i] -= idle;
        printf("cold solve, n = %5.0f: %s ms, %zu Newton, %zu GMRES, peak memory %.1f MB "
               "above the %.1f of the program\n",
               nodes[i], spread_text(text, &record.seconds, 1e-3, 1), record.newton, record.gmres,
               megabytes[i], idle);
    }
    double time_exponent = growth_exponent(nodes, seconds, NUM_SIZES);
    double memory_exponent = growth_exponent(nodes, megabytes, NUM_SIZES);
    printf("growth with n: time n^%.2f, memory n^%.2f (at most n^%g)\n", time_exponent,
           memory_exponent, MOST_EXPONENT);
    return time_exponent <= MOST_EXPONENT && memory_exponent <= MOST_EXPONENT ? 0 : 1;
}

int main(int argc, char **argv) {
    size_t repeats = argc > 1 ? strtoul(argv[1], NULL, 10) : 7;

    if (repeats == 0) abort();
    openblas_set_num_threads(1);
    int slow = bench_growth(repeats); // first, so that children are forked from a small process
    slow |= bench_dense(repeats);
    return slow;
}
