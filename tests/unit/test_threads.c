/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Repeatability of the library. Its caller chooses the number of OpenBLAS threads; the programs use
 * one thread. With one thread a repeated computation gives the same bits. With two threads the
 * difference is below a tolerance. */
#include "common/program/openblas.h"
#include "common/program/program.h"
#include "fullrun/full_solver.h"
#include "podbuild/pod.h"
#include "romrun/solve/least_squares.h"
#include "tests/unit/check.h"
#include "tests/unit/random.h"
#include "tests/unit/sample.h"

#include <cblas.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

enum { NUM_STATES = 160, NUM_NODES = 1201, NUM_MODES = 40, NUM_ROWS = 400, NUM_COLUMNS = 120 };

static double *numbers(size_t count) {
    double *values = calloc(count, sizeof *values);
    assert_non_null(values);
    return values;
}

/* Returns the next number of a reproducible sequence, uniform on -0.5 … 0.5. */
static double noise(uint64_t *seed) {
    return random_next(seed) - 0.5;
}

// ---- repeated computations, which fill `result` with `count` numbers

typedef struct repeated {
    const char *name;
    size_t count;
    void (*run)(double *result);
    double tolerance; // largest difference with two threads, relative to the largest number
} repeated;

/* Computes pressure and approach of a cold start. */
static void run_full(double *result) {
    const full_settings settings = full_default_settings();
    ehd_contact contact = sample_contact("barus", "dowson-higginson", 40, 12, 0.005);
    full_solver *solver;
    full_state state;
    full_info info;

    assert_int_equal(full_solver_create(&solver, contact.kind, &contact.grid, &settings, NULL),
                     EHD_OK);
    assert_int_equal(full_state_init(&state, &contact.grid, NULL), EHD_OK);
    assert_int_equal(full_solve_cold(&info, &state, solver, &contact, NULL), EHD_OK);
    assert_int_equal(info.status, EHD_OK);
    memcpy(result, state.pressure, contact.grid.num_nodes * sizeof(double));
    result[contact.grid.num_nodes] = state.rigid_approach;
    full_state_free(&state);
    full_solver_free(solver);
}

/* Computes singular values of travelling humps, and the projected snapshots. */
static void run_pod(double *result) {
    const pod_settings settings = {.num_modes = NUM_MODES};
    double *snapshots = numbers(NUM_STATES * NUM_NODES);
    double *coordinates = numbers(NUM_STATES * NUM_MODES);
    uint64_t seed = 1;
    pod_basis basis;

    for (size_t s = 0; s < NUM_STATES; s++)
        for (size_t k = 0; k < NUM_NODES; k++) {
            double x = ((double)k / NUM_NODES - (double)s / NUM_STATES) / 0.1;
            snapshots[s * NUM_NODES + k] = exp(-x * x) + 1e-6 * noise(&seed);
        }
    assert_int_equal(pod_build(&basis, snapshots, NUM_STATES, NUM_NODES, &settings, NULL), EHD_OK);
    memcpy(result, basis.singular_values, NUM_MODES * sizeof(double));
    // compare projected snapshots, because modes with close singular values may rotate
    for (size_t s = 0; s < NUM_STATES; s++)
        for (size_t m = 0; m < NUM_MODES; m++)
            for (size_t k = 0; k < NUM_NODES; k++)
                coordinates[s * NUM_MODES + m] +=
                    snapshots[s * NUM_NODES + k] * basis.modes[m * NUM_NODES + k];
    for (size_t s = 0; s < NUM_STATES; s++)
        for (size_t k = 0; k < NUM_NODES; k++)
            for (size_t m = 0; m < NUM_MODES; m++)
                result[NUM_MODES + s * NUM_NODES + k] +=
                    coordinates[s * NUM_MODES + m] * basis.modes[m * NUM_NODES + k];
    pod_free(&basis);
    free(snapshots);
    free(coordinates);
}

/* Solves a system like the system of an iteration of the online solver. */
static void run_least_squares(double *result) {
    least_squares *workspace = least_squares_create(NUM_ROWS, NUM_COLUMNS);
    double *matrix = numbers(NUM_ROWS * NUM_COLUMNS), *right = numbers(NUM_ROWS);
    uint64_t seed = 2;

    assert_non_null(workspace);
    for (size_t i = 0; i < NUM_ROWS * NUM_COLUMNS; i++)
        matrix[i] = noise(&seed) * pow(10, -(double)(i % NUM_COLUMNS) / 20);
    for (size_t i = 0; i < NUM_ROWS; i++)
        right[i] = noise(&seed);
    assert_int_equal(least_squares_solve(result, workspace, matrix, right, NUM_ROWS), EHD_OK);
    least_squares_free(workspace);
    free(matrix);
    free(right);
}

static const repeated parts[] = {
    {"full solution", NUM_NODES + 3, run_full, 1e-9},
    {"POD", NUM_MODES + NUM_STATES *NUM_NODES, run_pod, 1e-11},
    {"least squares", NUM_COLUMNS, run_least_squares, 1e-11},
};
enum { NUM_PARTS = sizeof parts / sizeof *parts };

static double *run_with(const repeated *part, int num_threads) {
    double *result = numbers(part->count);

    openblas_set_num_threads(num_threads);
    part->run(result);
    openblas_set_num_threads(1);
    return result;
}

static double largest(const double *values, size_t count) {
    double most = 0;
    for (size_t i = 0; i < count; i++)
        most = fmax(most, fabs(values[i]));
    return most;
}

static void one_thread_gives_the_same_bits(void **state) {
    (void)state;
    for (size_t p = 0; p < NUM_PARTS; p++) {
        double *first = run_with(&parts[p], 1), *again = run_with(&parts[p], 1);
        assert_memory_equal(first, again, parts[p].count * sizeof *first);
        free(first);
        free(again);
    }
}

// ---- threads of the caller

enum { NUM_CALLERS = 3, NUM_CALLS = 10000, ORDER = 40, HEIGHT = 60 };

static double triangle[ORDER * ORDER], right[HEIGHT * ORDER];

/* Makes calls for which OpenBLAS needs work space. */
static void call_blas(double *solved, double *product) {
    memcpy(solved, right, sizeof right);
    cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasUnit, HEIGHT, ORDER, 1,
                triangle, ORDER, solved, HEIGHT);
    cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, HEIGHT, HEIGHT, ORDER, 1, solved, HEIGHT,
                right, HEIGHT, 0, product, HEIGHT);
}

/* Returns the number of results that differ from the expected one. */
static void *call_often(void *expected) {
    double *found = numbers(HEIGHT * (ORDER + HEIGHT));
    size_t *bad = calloc(1, sizeof *bad);

    assert_non_null(bad);
    for (size_t i = 0; i < NUM_CALLS; i++) {
        call_blas(found, found + HEIGHT * ORDER);
        *bad += memcmp(found, expected, HEIGHT * (ORDER + HEIGHT) * sizeof *found) != 0;
    }
    free(found);
    return bad;
}

static void several_threads_may_call_openblas(void **state) {
    (void)state;
    double *expected = numbers(HEIGHT * (ORDER + HEIGHT));
    uint64_t seed = 3;
    pthread_t threads[NUM_CALLERS];

    assert_int_equal(openblas_take_buffers(NUM_CALLERS), NUM_CALLERS);
    for (size_t i = 0; i < ORDER * ORDER; i++)
        triangle[i] = noise(&seed);
    for (size_t i = 0; i < HEIGHT * ORDER; i++)
        right[i] = noise(&seed);
    call_blas(expected, expected + HEIGHT * ORDER);
    for (size_t t = 0; t < NUM_CALLERS; t++)
        assert_int_equal(pthread_create(&threads[t], NULL, call_often, expected), 0);
    for (size_t t = 0; t < NUM_CALLERS; t++) {
        void *bad;
        assert_int_equal(pthread_join(threads[t], &bad), 0);
        assert_int_equal(*(size_t *)bad, 0);
        free(bad);
    }
    free(expected);
}

static void two_threads_agree_with_one(void **state) {
    (void)state;
#ifdef __SANITIZE_THREAD__
    skip(); // OpenBLAS is built without the sanitizer, which does not see its synchronisation
#endif
    for (size_t p = 0; p < NUM_PARTS; p++) {
        double *one = run_with(&parts[p], 1), *two = run_with(&parts[p], 2);
        double scale = largest(one, parts[p].count);
        assert_true(scale > 0);
        check_close_array_at(two, one, parts[p].count, 0, parts[p].tolerance * scale, parts[p].name,
                             __FILE__, __LINE__);
        free(one);
        free(two);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_thread_gives_the_same_bits),
        cmocka_unit_test(several_threads_may_call_openblas),
        cmocka_unit_test(two_threads_agree_with_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
