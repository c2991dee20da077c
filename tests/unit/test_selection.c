/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "deimselect/selection.h"
#include "tests/unit/allocation.h"
#include "tests/unit/check.h"
#include "tests/unit/random.h"

#include <cblas.h>
#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static double next_random(uint64_t *seed) {
    return 2 * random_next(seed) - 1;
}

/* Returns random orthonormal modes [num_modes, num_nodes]. */
static double *random_basis(size_t num_modes, size_t num_nodes, uint64_t seed) {
    const int modes = (int)num_modes, nodes = (int)num_nodes;
    double *basis = malloc(num_modes * num_nodes * sizeof *basis);
    double *scales = malloc(num_modes * sizeof *scales);
    assert_true(basis && scales);
    for (size_t i = 0; i < num_modes * num_nodes; i++)
        basis[i] = next_random(&seed);
    assert_int_equal(LAPACKE_dgeqrf(LAPACK_COL_MAJOR, nodes, modes, basis, nodes, scales), 0);
    assert_int_equal(LAPACKE_dorgqr(LAPACK_COL_MAJOR, nodes, modes, modes, basis, nodes, scales),
                     0);
    free(scales);
    return basis;
}

static void check_distinct(const size_t *rows, size_t num_rows, size_t num_nodes) {
    for (size_t i = 0; i < num_rows; i++) {
        assert_true(rows[i] < num_nodes);
        for (size_t j = 0; j < i; j++)
            assert_int_not_equal(rows[i], rows[j]);
    }
}

static void check_rows(const size_t *actual, const size_t *expected, size_t num_rows) {
    for (size_t i = 0; i < num_rows; i++)
        assert_int_equal(actual[i], expected[i]);
}

static void joint_hand_worked_example(void **state) {
    (void)state;
    const double residual_modes[] = {0.6, 0.8, 0, -0.8, 0.6, 0};
    const double jacobian_modes[] = {0, 0.6, 0.8, 0, -0.8, 0.6};
    const selection_bases bases = {
        .num_nodes = 3, .num_modes = {2, 2}, .modes = {residual_modes, jacobian_modes}};
    // Row 1 is selected first: the sums of squares of the three rows are 0.36, 1 and 0.64. To fit
    // the second mode at row 1, the first mode is multiplied by 3/4 (residual basis) and -4/3
    // (Jacobian basis). The errors of the fits are (-5/4, 0, 0) and (0, 0, 5/3). The largest error
    // is at row 2, which is selected next.
    size_t rows[2];
    assert_int_equal(selection_joint(rows, &bases, 2, NULL), EHD_OK);
    check_rows(rows, (size_t[]){1, 2}, 2);
    // if both bases are the residual basis, the second row is 0 instead of 2
    const selection_bases twice = {
        .num_nodes = 3, .num_modes = {2, 2}, .modes = {residual_modes, residual_modes}};
    assert_int_equal(selection_joint(rows, &twice, 2, NULL), EHD_OK);
    check_rows(rows, (size_t[]){1, 0}, 2);
}

/* Computes phi of Fig. A1 of Maier et al. (2015) directly: least squares on the selected rows by
 * dgelsd. */
static void naive_residual(double *residual, const double *modes, size_t num_nodes, size_t size,
                           const size_t *rows) {
    const double *next = modes + size * num_nodes;
    memcpy(residual, next, num_nodes * sizeof *residual);
    if (size == 0) return;
    double *matrix = malloc(size * size * sizeof *matrix);
    double *solution = malloc(size * sizeof *solution);
    double *values = malloc(size * sizeof *values);
    lapack_int rank;
    assert_true(matrix && solution && values);
    for (size_t column = 0; column < size; column++)
        for (size_t row = 0; row < size; row++)
            matrix[column * size + row] = modes[column * num_nodes + rows[row]];
    for (size_t row = 0; row < size; row++)
        solution[row] = next[rows[row]];
    assert_int_equal(LAPACKE_dgelsd(LAPACK_COL_MAJOR, (int)size, (int)size, 1, matrix, (int)size,
                                    solution, (int)size, values, -1.0, &rank),
                     0);
    for (size_t column = 0; column < size; column++)
        cblas_daxpy((int)num_nodes, -solution[column], modes + column * num_nodes, 1, residual, 1);
    free(matrix);
    free(solution);
    free(values);
}

static void naive_joint(size_t *rows, const selection_bases *bases, size_t num_rows) {
    const size_t num_nodes = bases->num_nodes;
    double *phi_f = malloc(num_nodes * sizeof *phi_f), *phi_J = malloc(num_nodes * sizeof *phi_J);
    assert_true(phi_f && phi_J);
    for (size_t n = 0; n < num_rows; n++) {
        double largest = -1.0;
        naive_residual(phi_f, bases->modes[0], num_nodes, n, rows);
        naive_residual(phi_J, bases->modes[1], num_nodes, n, rows);
        for (size_t i = 0; i < num_nodes; i++) {
            bool selected = false;
            for (size_t k = 0; k < n; k++)
                selected = selected || rows[k] == i;
            if (selected || phi_f[i] * phi_f[i] + phi_J[i] * phi_J[i] <= largest) continue;
            largest = phi_f[i] * phi_f[i] + phi_J[i] * phi_J[i];
            rows[n] = i;
        }
    }
    free(phi_f);
    free(phi_J);
}

static void joint_equals_solving_from_scratch(void **state) {
    (void)state;
    enum { NUM_NODES = 230, NUM_ROWS = 45 };
    for (uint64_t seed = 1; seed <= 10; seed += 2) {
        double *residual_modes = random_basis(NUM_ROWS + 3, NUM_NODES, seed);
        double *jacobian_modes = random_basis(NUM_ROWS, NUM_NODES, seed + 1);
        const selection_bases bases = {.num_nodes = NUM_NODES,
                                       .num_modes = {NUM_ROWS + 3, NUM_ROWS},
                                       .modes = {residual_modes, jacobian_modes}};
        size_t rows[NUM_ROWS], expected[NUM_ROWS];
        assert_int_equal(selection_joint(rows, &bases, NUM_ROWS, NULL), EHD_OK);
        naive_joint(expected, &bases, NUM_ROWS);
        check_rows(rows, expected, NUM_ROWS);
        free(residual_modes);
        free(jacobian_modes);
    }
}

/* Selects pivots by Gram-Schmidt. The values of all modes at a node are a column. The next row is
 * the longest column after the selected columns have been projected out. */
static void naive_pivoted_qr(size_t *rows, const selection_bases *bases, size_t num_rows) {
    const size_t num_nodes = bases->num_nodes, num_first = bases->num_modes[0];
    const size_t num_modes = num_first + bases->num_modes[1];
    double *columns = malloc(num_modes * num_nodes * sizeof *columns);
    double *pivot = malloc(num_modes * sizeof *pivot);
    assert_true(columns && pivot);
    for (size_t i = 0; i < num_nodes; i++)
        for (size_t mode = 0; mode < num_modes; mode++)
            columns[i * num_modes + mode] =
                mode < num_first ? bases->modes[0][mode * num_nodes + i]
                                 : bases->modes[1][(mode - num_first) * num_nodes + i];
    for (size_t n = 0; n < num_rows; n++) {
        double longest = -1.0;
        rows[n] = 0;
        for (size_t i = 0; i < num_nodes; i++) {
            const double length = cblas_dnrm2((int)num_modes, columns + i * num_modes, 1);
            if (length <= longest) continue;
            longest = length;
            rows[n] = i;
        }
        memcpy(pivot, columns + rows[n] * num_modes, num_modes * sizeof *pivot);
        cblas_dscal((int)num_modes, 1.0 / longest, pivot, 1);
        for (size_t i = 0; i < num_nodes; i++) {
            double *column = columns + i * num_modes;
            const double part = cblas_ddot((int)num_modes, pivot, 1, column, 1);
            cblas_daxpy((int)num_modes, -part, pivot, 1, column, 1);
        }
    }
    free(columns);
    free(pivot);
}

static void pivoted_qr_takes_the_longest_remaining_row(void **state) {
    (void)state;
    enum { NUM_NODES = 120, NUM_ROWS = 25 };
    double *residual_modes = random_basis(20, NUM_NODES, 3);
    double *jacobian_modes = random_basis(10, NUM_NODES, 4);
    const selection_bases bases = {
        .num_nodes = NUM_NODES, .num_modes = {20, 10}, .modes = {residual_modes, jacobian_modes}};
    size_t rows[NUM_ROWS], expected[NUM_ROWS];
    assert_int_equal(selection_pivoted_qr(rows, &bases, NUM_ROWS, NULL), EHD_OK);
    naive_pivoted_qr(expected, &bases, NUM_ROWS);
    check_rows(rows, expected, NUM_ROWS);
    free(residual_modes);
    free(jacobian_modes);
}

/* Returns log S of a basis sampled at the rows (s_opt.c), with the determinant from singular
 * values. With fewer rows than modes, only the nonzero singular values are used. This is the limit
 * for a small ridge, without the constant factor that the ridge itself contributes. */
static double naive_log_s(const double *modes, size_t num_modes, size_t num_nodes,
                          const size_t *rows, size_t num_rows) {
    double *sampled = malloc(num_rows * num_modes * sizeof *sampled);
    double *values = malloc(num_modes * sizeof *values), sum = 0;
    const size_t rank = num_rows < num_modes ? num_rows : num_modes;
    assert_true(sampled && values);
    for (size_t j = 0; j < num_modes; j++) {
        for (size_t n = 0; n < num_rows; n++)
            sampled[j * num_rows + n] = modes[j * num_nodes + rows[n]];
        sum -= log(cblas_dnrm2((int)num_rows, sampled + j * num_rows, 1));
    }
    assert_int_equal(LAPACKE_dgesdd(LAPACK_COL_MAJOR, 'N', (int)num_rows, (int)num_modes, sampled,
                                    (int)num_rows, values, NULL, 1, NULL, 1),
                     0);
    for (size_t j = 0; j < rank; j++)
        sum += log(values[j]);
    free(sampled);
    free(values);
    return sum / (double)num_modes;
}

/* Returns the row that maximises S of both bases, with all determinants computed anew. */
static size_t naive_s_opt_row(const selection_bases *bases, size_t *rows, size_t num_rows) {
    size_t best = bases->num_nodes;
    double largest = -INFINITY;
    for (size_t i = 0; i < bases->num_nodes; i++) {
        bool selected = false;
        for (size_t n = 0; n < num_rows; n++)
            selected = selected || rows[n] == i;
        if (selected) continue;
        double sum = 0;
        rows[num_rows] = i;
        for (int basis = 0; basis < 2; basis++)
            sum += naive_log_s(bases->modes[basis], bases->num_modes[basis], bases->num_nodes, rows,
                               num_rows + 1);
        if (!(sum > largest)) continue;
        largest = sum;
        best = i;
    }
    return best;
}

static void s_opt_takes_the_row_of_the_largest_determinant(void **state) {
    (void)state;
    enum { NUM_NODES = 60, NUM_MODES = 7, NUM_ROWS = 25 };
    for (uint64_t seed = 21; seed < 27; seed += 2) {
        double *residual_modes = random_basis(NUM_MODES, NUM_NODES, seed);
        double *jacobian_modes = random_basis(NUM_MODES + 1, NUM_NODES, seed + 1);
        const selection_bases bases = {.num_nodes = NUM_NODES,
                                       .num_modes = {NUM_MODES, NUM_MODES + 1},
                                       .modes = {residual_modes, jacobian_modes}};
        size_t rows[NUM_ROWS], expected[NUM_ROWS];
        assert_int_equal(selection_s_opt(rows, &bases, NUM_ROWS, NULL), EHD_OK);
        check_distinct(rows, NUM_ROWS, NUM_NODES);
        // with fewer rows than modes the ridge must be small, but above round-off
        for (size_t n = (NUM_MODES + 1) / 2; n < NUM_ROWS; n++) {
            memcpy(expected, rows, n * sizeof *rows);
            assert_int_equal(rows[n], naive_s_opt_row(&bases, expected, n));
        }
        free(residual_modes);
        free(jacobian_modes);
    }
}

static void s_opt_starts_with_pivots(void **state) {
    (void)state;
    enum { NUM_NODES = 40, NUM_MODES = 9, NUM_START = 5 };
    double *residual_modes = random_basis(NUM_MODES, NUM_NODES, 31);
    double *jacobian_modes = random_basis(NUM_MODES, NUM_NODES, 32);
    const selection_bases bases = {.num_nodes = NUM_NODES,
                                   .num_modes = {NUM_MODES, NUM_MODES},
                                   .modes = {residual_modes, jacobian_modes}};
    const selection_bases half = {.num_nodes = NUM_NODES,
                                  .num_modes = {NUM_START, NUM_START},
                                  .modes = {residual_modes, jacobian_modes}};
    size_t rows[NUM_MODES], pivots[NUM_START];
    assert_int_equal(selection_s_opt(rows, &bases, NUM_MODES, NULL), EHD_OK);
    assert_int_equal(selection_pivoted_qr(pivots, &half, NUM_START, NULL), EHD_OK);
    check_rows(rows, pivots, NUM_START);
    free(residual_modes);
    free(jacobian_modes);
}

static void every_prefix_is_a_selection(void **state) {
    (void)state;
    enum { NUM_NODES = 150, NUM_ROWS = 30 };
    double *residual_modes = random_basis(NUM_ROWS, NUM_NODES, 5);
    double *jacobian_modes = random_basis(NUM_ROWS, NUM_NODES, 6);
    const selection_bases bases = {.num_nodes = NUM_NODES,
                                   .num_modes = {NUM_ROWS, NUM_ROWS},
                                   .modes = {residual_modes, jacobian_modes}};
    for (const selection_method *method = selection_methods; method->name; method++) {
        size_t all[NUM_ROWS], fewer[NUM_ROWS];
        assert_int_equal(method->select(all, &bases, NUM_ROWS, NULL), EHD_OK);
        check_distinct(all, NUM_ROWS, NUM_NODES);
        for (size_t num_rows = 0; num_rows < NUM_ROWS; num_rows += 7) {
            assert_int_equal(method->select(fewer, &bases, num_rows, NULL), EHD_OK);
            check_rows(fewer, all, num_rows);
        }
    }
    free(residual_modes);
    free(jacobian_modes);
}

static void all_nodes_can_be_selected(void **state) {
    (void)state;
    enum { NUM_NODES = 24 };
    double *residual_modes = random_basis(NUM_NODES, NUM_NODES, 7);
    double *jacobian_modes = random_basis(NUM_NODES, NUM_NODES, 8);
    const selection_bases bases = {.num_nodes = NUM_NODES,
                                   .num_modes = {NUM_NODES, NUM_NODES},
                                   .modes = {residual_modes, jacobian_modes}};
    for (const selection_method *method = selection_methods; method->name; method++) {
        size_t rows[NUM_NODES];
        assert_int_equal(method->select(rows, &bases, NUM_NODES, NULL), EHD_OK);
        check_distinct(rows, NUM_NODES, NUM_NODES);
    }
    free(residual_modes);
    free(jacobian_modes);
}

/* At each node one of the two bases is zero, so a row that is selected for one basis is zero in the
 * other basis. All methods must still select different rows. */
static void survives_singular_systems(void **state) {
    (void)state;
    enum { NUM_NODES = 40, HALF = NUM_NODES / 2, NUM_ROWS = 16 };
    double *small = random_basis(NUM_ROWS, HALF, 9);
    double residual_modes[NUM_ROWS * NUM_NODES] = {0}, jacobian_modes[NUM_ROWS * NUM_NODES] = {0};
    for (size_t mode = 0; mode < NUM_ROWS; mode++) {
        memcpy(residual_modes + mode * NUM_NODES, small + mode * HALF, HALF * sizeof *small);
        memcpy(jacobian_modes + mode * NUM_NODES + HALF, small + mode * HALF, HALF * sizeof *small);
    }
    const selection_bases bases = {.num_nodes = NUM_NODES,
                                   .num_modes = {NUM_ROWS, NUM_ROWS},
                                   .modes = {residual_modes, jacobian_modes}};
    for (const selection_method *method = selection_methods; method->name; method++) {
        size_t rows[NUM_ROWS];
        assert_int_equal(method->select(rows, &bases, NUM_ROWS, NULL), EHD_OK);
        // NaN would select row 0 repeatedly, because comparisons with NaN are false
        check_distinct(rows, NUM_ROWS, NUM_NODES);
    }
    free(small);
}

/* The modes are unit vectors. A row that is zero in one basis must not disturb the order of the
 * rows of the other basis. */
static void skips_what_a_zero_row_leaves_open(void **state) {
    (void)state;
    // residual basis e0, e1, e2; Jacobian basis 0.9 e3, 0.9 e4, 0.9 e5
    double residual_modes[18] = {0}, jacobian_modes[18] = {0};
    for (size_t mode = 0; mode < 3; mode++) {
        residual_modes[mode * 6 + mode] = 1.0;
        jacobian_modes[mode * 6 + 3 + mode] = 0.9;
    }
    const selection_bases bases = {
        .num_nodes = 6, .num_modes = {3, 3}, .modes = {residual_modes, jacobian_modes}};
    size_t rows[3];
    assert_int_equal(selection_joint(rows, &bases, 3, NULL), EHD_OK);
    check_rows(rows, (size_t[]){0, 1, 2}, 3);
}

/* If no error is left, any row may be selected next, but no row twice. */
static void goes_on_when_nothing_is_left_to_explain(void **state) {
    (void)state;
    const double modes[12] = {0, 1, 0, 0}; // two modes of zeros follow
    const selection_bases bases = {.num_nodes = 4, .num_modes = {3, 3}, .modes = {modes, modes}};
    size_t rows[3];
    assert_int_equal(selection_joint(rows, &bases, 3, NULL), EHD_OK);
    check_rows(rows, (size_t[]){1, 0, 2}, 3);
}

/* Expects a refusal whose text contains `words`. */
static void check_refused(selection_function *select, const selection_bases *bases, size_t num_rows,
                          const char *words) {
    size_t rows[16];
    ehd_error error = {0};
    assert_int_equal(select(rows, bases, num_rows, &error), EHD_DATA);
    if (!strstr(error.text, words)) fail_msg("found \"%s\", expected \"%s\"", error.text, words);
}

static void refuses_more_rows_than_it_can_give(void **state) {
    (void)state;
    double *six = random_basis(6, 8, 10), *five = random_basis(5, 8, 11);
    const selection_bases bases = {.num_nodes = 8, .num_modes = {6, 5}, .modes = {six, five}};
    const selection_bases swapped = {.num_nodes = 8, .num_modes = {5, 6}, .modes = {five, six}};
    check_refused(selection_joint, &bases, 6, "found 6, expected at most 5");
    check_refused(selection_joint, &bases, 6, "Jacobian basis");
    check_refused(selection_joint, &swapped, 6, "residual basis");
    check_refused(selection_pivoted_qr, &bases, 9, "found 9, expected at most 8");
    const selection_bases one = {.num_nodes = 8, .num_modes = {1, 1}, .modes = {six, five}};
    check_refused(selection_pivoted_qr, &one, 3, "found 3, expected at most 2");
    check_refused(selection_s_opt, &bases, 9, "found 9, expected at most 8");
    check_refused(selection_exits, &bases, 9, "found 9, expected at most 8");
    free(six);
    free(five);
}

static void sigma_min_of_sampled_modes(void **state) {
    (void)state;
    enum { NUM_NODES = 30 };
    const double modes[] = {3, 9, 0, 0, 9, 4}; // [2, 3]
    const size_t two[] = {0, 2};
    double sigma_min = -1.0;
    assert_int_equal(selection_sigma_min(&sigma_min, modes, 2, 3, two, 2, NULL), EHD_OK);
    check_close(sigma_min, 3.0, 1e-14, 0.0);
    assert_int_equal(selection_sigma_min(&sigma_min, modes, 1, 3, two, 1, NULL), EHD_OK);
    check_close(sigma_min, 3.0, 1e-14, 0.0);
    assert_int_equal(selection_sigma_min(&sigma_min, modes, 2, 3, two, 1, NULL), EHD_OK);
    check_close(sigma_min, 0.0, 0.0, 0.0);
    assert_int_equal(selection_sigma_min(&sigma_min, modes, 0, 3, two, 2, NULL), EHD_DATA);

    // with all rows of orthonormal modes the value is 1
    double *basis = random_basis(7, NUM_NODES, 12);
    size_t all[NUM_NODES];
    for (size_t i = 0; i < NUM_NODES; i++)
        all[i] = NUM_NODES - 1 - i;
    assert_int_equal(selection_sigma_min(&sigma_min, basis, 7, NUM_NODES, all, NUM_NODES, NULL),
                     EHD_OK);
    check_close(sigma_min, 1.0, 1e-13, 0.0);
    free(basis);
}

static void survives_failing_allocations(void **state) {
    (void)state;
    double *first = random_basis(3, 8, 13), *second = random_basis(3, 8, 14);
    const selection_bases bases = {.num_nodes = 8, .num_modes = {3, 3}, .modes = {first, second}};
    size_t rows[3], call = 0;
    double sigma_min;
    for (const selection_method *method = selection_methods; method->name; method++)
        for (call = 0;; call++) {
            allocation_fail_at(call);
            const ehd_status status = method->select(rows, &bases, 3, NULL);
            if (!allocation_failed()) break;
            assert_int_equal(status, EHD_MEMORY);
        }
    for (call = 0;; call++) {
        allocation_fail_at(call);
        const ehd_status status = selection_sigma_min(&sigma_min, first, 3, 8, rows, 3, NULL);
        if (!allocation_failed()) break;
        assert_int_equal(status, EHD_MEMORY);
    }
    assert_int_equal(call, 2);
    free(first);
    free(second);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(joint_hand_worked_example),
        cmocka_unit_test(joint_equals_solving_from_scratch),
        cmocka_unit_test(pivoted_qr_takes_the_longest_remaining_row),
        cmocka_unit_test(s_opt_takes_the_row_of_the_largest_determinant),
        cmocka_unit_test(s_opt_starts_with_pivots),
        cmocka_unit_test(every_prefix_is_a_selection),
        cmocka_unit_test(all_nodes_can_be_selected),
        cmocka_unit_test(survives_singular_systems),
        cmocka_unit_test(skips_what_a_zero_row_leaves_open),
        cmocka_unit_test(goes_on_when_nothing_is_left_to_explain),
        cmocka_unit_test(refuses_more_rows_than_it_can_give),
        cmocka_unit_test(sigma_min_of_sampled_modes),
        cmocka_unit_test(survives_failing_allocations),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
