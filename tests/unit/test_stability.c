/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "deimselect/stability.h"
#include "tests/unit/allocation.h"
#include "tests/unit/check.h"

#include <cblas.h>
#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { NUM_NODES = 70, NUM_MODES = 9, NUM_ROWS = 30 };
static const size_t exits[] = {31, 44, 60};
enum { NUM_EXITS = sizeof exits / sizeof *exits };

/* The same number of nodes on NUM_LINES grid lines, each with an exit. Of any two exit lines, each
 * lies upstream of the other one on some grid line. */
enum { NUM_LINES = 5, WIDTH = NUM_NODES / NUM_LINES };
static const size_t exit_lines[NUM_EXITS][NUM_LINES] = {
    {10, 9, 8, 9, 4}, {11, 12, 7, 3, 13}, {12, 8, 14, 13, 12}};

/* Replaces the columns [num_modes, num_nodes] by the factor Q of their QR factorisation. */
static void make_orthonormal(double *modes, size_t num_modes, size_t num_nodes) {
    const int columns = (int)num_modes, length = (int)num_nodes;
    double scales[NUM_MODES];
    assert_int_equal(LAPACKE_dgeqrf(LAPACK_COL_MAJOR, length, columns, modes, length, scales), 0);
    assert_int_equal(
        LAPACKE_dorgqr(LAPACK_COL_MAJOR, length, columns, columns, modes, length, scales), 0);
}

/* Makes modes that are peaks at centres from left to right, like residuals along a contact. */
static void make_modes(double modes[NUM_MODES][NUM_NODES], double shift) {
    for (size_t j = 0; j < NUM_MODES; j++)
        for (size_t i = 0; i < NUM_NODES; i++) {
            const double x = ((double)i - shift - 7.0 * (double)j) / 6.0;
            modes[j][i] = exp(-x * x) + 0.1 * sin(0.3 * (double)(i * (j + 1)));
        }
    make_orthonormal(modes[0], NUM_MODES, NUM_NODES);
}

static double sample[2][NUM_MODES][NUM_NODES];

static selection_bases make_bases(void) {
    make_modes(sample[0], 3);
    make_modes(sample[1], 6);
    const selection_bases bases = {.num_nodes = NUM_NODES,
                                   .num_modes = {NUM_MODES, NUM_MODES},
                                   .modes = {sample[0][0], sample[1][0]},
                                   .num_leading = NUM_MODES - 1,
                                   .num_exits = NUM_EXITS,
                                   .exits = exits};
    return bases;
}

/* Returns the bases of make_bases, with exits on several grid lines. */
static selection_bases make_bases_on_lines(void) {
    selection_bases bases = make_bases();

    bases.num_lines = NUM_LINES;
    bases.exits = exit_lines[0];
    return bases;
}

static const struct {
    selection_bases (*make)(void);
} layouts[] = {{make_bases}, {make_bases_on_lines}};
enum { NUM_LAYOUTS = sizeof layouts / sizeof *layouts };

/* Checks whether a node lies before the exit. Every node lies before exit number num_exits. */
static bool is_before(const selection_bases *bases, size_t exit, size_t node) {
    if (exit == bases->num_exits) return true;
    if (bases->num_lines == 0) return node < bases->exits[exit];
    return node % WIDTH < bases->exits[exit * NUM_LINES + node / WIDTH];
}

/* Makes the part of a basis before an exit orthonormal, and returns sigma_min of the selected rows
 * of this part. `at_nodes` [NUM_NODES] receives the worst direction: the combination of modes that
 * the rows determine worst. It is zero behind the exit. */
static double naive_sigma_min(double *at_nodes, const selection_bases *bases, size_t basis,
                              size_t exit, const size_t *rows, size_t num_rows) {
    double before[NUM_MODES * NUM_NODES], sampled[NUM_NODES * NUM_MODES] = {0};
    double values[NUM_MODES], left[1], right[NUM_MODES * NUM_MODES];
    size_t num_modes = bases->num_leading;
    for (size_t j = 0; j < num_modes; j++)
        for (size_t i = 0; i < NUM_NODES; i++)
            before[j * NUM_NODES + i] =
                is_before(bases, exit, i) ? bases->modes[basis][j * NUM_NODES + i] : 0;
    make_orthonormal(before, num_modes, NUM_NODES);
    // rows that are not selected are set to zero, so that there are never fewer rows than columns
    for (size_t n = 0; n < num_rows; n++)
        for (size_t j = 0; j < num_modes; j++)
            sampled[j * NUM_NODES + rows[n]] = before[j * NUM_NODES + rows[n]];
    assert_int_equal(LAPACKE_dgesvd(LAPACK_COL_MAJOR, 'N', 'A', NUM_NODES, (int)num_modes, sampled,
                                    NUM_NODES, values, left, 1, right, (int)num_modes,
                                    (double[NUM_MODES]){0}),
                     0);
    cblas_dgemv(CblasColMajor, CblasNoTrans, NUM_NODES, (int)num_modes, 1, before, NUM_NODES,
                right + num_modes - 1, (int)num_modes, 0, at_nodes, 1);
    return values[num_modes - 1];
}

/* Returns the smallest sigma_min of all exits and bases. *row: the unselected row at which the
 * worst direction is largest. */
static double naive_worst(size_t *row, const selection_bases *bases, const size_t *rows,
                          size_t num_rows) {
    double worst = INFINITY, at_nodes[NUM_NODES];
    for (size_t b = 0; b < 2 * (bases->num_exits + 1); b++) {
        const double sigma = naive_sigma_min(at_nodes, bases, b % 2, b / 2, rows, num_rows);
        if (sigma >= worst) continue;
        worst = sigma;
        for (size_t n = 0; n < num_rows; n++)
            at_nodes[rows[n]] = 0;
        *row = cblas_idamax(NUM_NODES, at_nodes, 1);
    }
    return worst;
}

static void all_rows_have_one(void **state) {
    (void)state;
    size_t rows[NUM_NODES];
    for (size_t i = 0; i < NUM_NODES; i++)
        rows[i] = i;
    for (size_t l = 0; l < NUM_LAYOUTS; l++) {
        const selection_bases bases = layouts[l].make();
        double inverse;
        assert_int_equal(row_stability_of(&inverse, &bases, rows, NUM_NODES, NULL), EHD_OK);
        check_close(inverse, 1.0, 1e-10, 0.0);
    }
}

static void equals_singular_values_from_scratch(void **state) {
    (void)state;
    size_t rows[NUM_ROWS], ignored;
    for (size_t i = 0; i < NUM_ROWS; i++)
        rows[i] = (i * 11) % NUM_NODES;
    for (size_t l = 0; l < NUM_LAYOUTS; l++)
        for (size_t num_rows = 18; num_rows <= NUM_ROWS; num_rows += 4) {
            const selection_bases bases = layouts[l].make();
            double inverse;
            assert_int_equal(row_stability_of(&inverse, &bases, rows, num_rows, NULL), EHD_OK);
            check_close(inverse, 1 / naive_worst(&ignored, &bases, rows, num_rows), 1e-8, 0.0);
        }
}

/* If all rows before the second exit are selected, only directions with values behind this exit are
 * determined badly. The third exit shows this. */
static void looks_at_later_exits_too(void **state) {
    (void)state;
    const selection_bases bases = make_bases();
    size_t rows[NUM_NODES], ignored;
    double inverse;
    for (size_t i = 0; i < exits[1]; i++)
        rows[i] = i;
    assert_int_equal(row_stability_of(&inverse, &bases, rows, exits[1], NULL), EHD_OK);
    assert_true(inverse > 1.5);
    check_close(inverse, 1 / naive_worst(&ignored, &bases, rows, exits[1]), 1e-8, 0.0);
}

static void too_few_rows_before_an_exit_are_not_stable(void **state) {
    (void)state;
    const selection_bases bases = make_bases();
    size_t rows[NUM_NODES], num_rows = 0;
    for (size_t i = 24; i < NUM_NODES; i++)
        rows[num_rows++] = i; // only seven rows before the first exit, for eight modes
    double inverse;
    assert_int_equal(row_stability_of(&inverse, &bases, rows, num_rows, NULL), EHD_OK);
    assert_true(isinf(inverse));
    rows[num_rows++] = 3;
    assert_int_equal(row_stability_of(&inverse, &bases, rows, num_rows, NULL), EHD_OK);
    assert_true(isfinite(inverse));
}

/* A mode that is zero before an exit need not be determined by the rows before this exit. */
static void leaves_out_what_vanishes_before_an_exit(void **state) {
    (void)state;
    double modes[2][NUM_NODES] = {{0}};
    const size_t exit = 10, rows[] = {5, 20};
    const selection_bases bases = {.num_nodes = NUM_NODES,
                                   .num_modes = {1, 1},
                                   .modes = {modes[0], modes[1]},
                                   .num_leading = 1,
                                   .num_exits = 1,
                                   .exits = &exit};
    modes[0][5] = modes[0][20] = sqrt(0.5);
    modes[1][20] = 1;
    double inverse;
    assert_int_equal(row_stability_of(&inverse, &bases, rows, 2, NULL), EHD_OK);
    check_close(inverse, 1.0, 1e-10, 0.0);
}

/* Like leaves_out_what_vanishes_before_an_exit, but only round-off of some modes is left before the
 * exit. The modes are unit vectors of nodes on both sides of the exit, multiplied by a rotation. */
static void leaves_out_rounding_errors_before_an_exit(void **state) {
    (void)state;
    enum { NUM_BEFORE = NUM_MODES / 2 };
    double rotation[NUM_MODES][NUM_MODES], modes[NUM_MODES][NUM_NODES] = {{0}};
    size_t rows[NUM_MODES];
    const size_t exit = 40;
    for (size_t i = 0; i < NUM_MODES; i++)
        for (size_t j = 0; j < NUM_MODES; j++)
            rotation[i][j] = sin((double)((i + 1) * (i + j + 2)));
    make_orthonormal(rotation[0], NUM_MODES, NUM_MODES);
    for (size_t j = 0; j < NUM_MODES; j++) {
        rows[j] = j < NUM_BEFORE ? 7 * j : exit + j;
        for (size_t i = 0; i < NUM_MODES; i++)
            modes[i][rows[j]] = rotation[i][j];
    }
    const selection_bases bases = {.num_nodes = NUM_NODES,
                                   .num_modes = {NUM_MODES, NUM_MODES},
                                   .modes = {modes[0], modes[0]},
                                   .num_leading = NUM_MODES,
                                   .num_exits = 1,
                                   .exits = &exit};
    double inverse;
    assert_int_equal(row_stability_of(&inverse, &bases, rows, NUM_MODES, NULL), EHD_OK);
    check_close(inverse, 1.0, 1e-10, 0.0);
}

/* A mode that is small but not zero before an exit must be determined. The worst exit of the lower
 * loaded region has such a mode. */
static void keeps_what_is_small_before_an_exit(void **state) {
    (void)state;
    const double part = 1e-4;
    double mode[NUM_NODES] = {[5] = part, [20] = sqrt(1 - part * part)};
    const size_t exit = 10, rows[] = {20, 5};
    const selection_bases bases = {.num_nodes = NUM_NODES,
                                   .num_modes = {1, 1},
                                   .modes = {mode, mode},
                                   .num_leading = 1,
                                   .num_exits = 1,
                                   .exits = &exit};
    double inverse;
    assert_int_equal(row_stability_of(&inverse, &bases, rows, 1, NULL), EHD_OK);
    assert_true(isinf(inverse));
    assert_int_equal(row_stability_of(&inverse, &bases, rows, 2, NULL), EHD_OK);
    check_close(inverse, 1.0, 1e-10, 0.0);
}

static void exits_begin_with_the_joint_rows(void **state) {
    (void)state;
    const selection_bases bases = make_bases(), leading = selection_leading(&bases);
    size_t rows[NUM_ROWS], joint[NUM_MODES - 1];
    assert_int_equal(selection_exits(rows, &bases, NUM_ROWS, NULL), EHD_OK);
    assert_int_equal(selection_joint(joint, &leading, NUM_MODES - 1, NULL), EHD_OK);
    assert_memory_equal(rows, joint, sizeof joint);
}

static void exits_take_the_row_that_the_worst_exit_needs(void **state) {
    (void)state;
    // absolute error of singular values, which may be zero; the columns have norm 1
    const double rounding = 1e-14;
    for (size_t l = 0; l < NUM_LAYOUTS; l++) {
        const selection_bases bases = layouts[l].make();
        size_t rows[NUM_ROWS], expected = 0;
        double before = 0;
        assert_int_equal(selection_exits(rows, &bases, NUM_ROWS, NULL), EHD_OK);
        for (size_t n = 8; n < NUM_ROWS; n++) {
            const double sigma_min = naive_worst(&expected, &bases, rows, n);
            // if sigma_min is zero, the worst direction is not unique, so any row may be next
            if (sigma_min > 1e-6) assert_int_equal(rows[n], expected);
            assert_true(sigma_min >= before * (1 - 1e-9) - rounding);
            before = sigma_min;
        }
        assert_true(before > 1e-2);
    }
}

static void fewest_is_the_smallest_prefix(void **state) {
    (void)state;
    const selection_bases bases = make_bases();
    const double limits[] = {1e6, 30, 8, 4};
    size_t rows[NUM_ROWS], fewest, ignored;
    assert_int_equal(selection_exits(rows, &bases, NUM_ROWS, NULL), EHD_OK);
    for (size_t i = 0; i < sizeof limits / sizeof *limits; i++) {
        assert_int_equal(row_stability_fewest(&fewest, &bases, rows, NUM_ROWS, limits[i], NULL),
                         EHD_OK);
        assert_in_range(fewest, NUM_MODES - 1, NUM_ROWS);
        assert_true(1 / naive_worst(&ignored, &bases, rows, fewest) <= limits[i]);
        assert_true(1 / naive_worst(&ignored, &bases, rows, fewest - 1) > limits[i]);
    }
    assert_int_equal(row_stability_fewest(&fewest, &bases, rows, NUM_ROWS, 1, NULL), EHD_OK);
    assert_int_equal(fewest, NUM_ROWS + 1);
}

static void survives_failing_allocations(void **state) {
    (void)state;
    const selection_bases bases = make_bases();
    size_t rows[12], call;
    for (call = 0;; call++) {
        allocation_fail_at(call);
        const ehd_status status = selection_exits(rows, &bases, 12, NULL);
        if (!allocation_failed()) break;
        assert_int_equal(status, EHD_MEMORY);
    }
    assert_true(call > 10);
    double inverse;
    for (call = 0;; call++) {
        allocation_fail_at(call);
        const ehd_status status = row_stability_of(&inverse, &bases, rows, 12, NULL);
        if (!allocation_failed()) break;
        assert_int_equal(status, EHD_MEMORY);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_rows_have_one),
        cmocka_unit_test(equals_singular_values_from_scratch),
        cmocka_unit_test(looks_at_later_exits_too),
        cmocka_unit_test(too_few_rows_before_an_exit_are_not_stable),
        cmocka_unit_test(leaves_out_what_vanishes_before_an_exit),
        cmocka_unit_test(leaves_out_rounding_errors_before_an_exit),
        cmocka_unit_test(keeps_what_is_small_before_an_exit),
        cmocka_unit_test(exits_begin_with_the_joint_rows),
        cmocka_unit_test(exits_take_the_row_that_the_worst_exit_needs),
        cmocka_unit_test(fewest_is_the_smallest_prefix),
        cmocka_unit_test(survives_failing_allocations),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
