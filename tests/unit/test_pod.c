/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "podbuild/pod.h"
#include "tests/unit/allocation.h"
#include "tests/unit/check.h"
#include "tests/unit/random.h"

#include <cblas.h>
#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Returns reproducible numbers in [-1, 1). */
static double next_random(void) {
    static uint64_t seed = 1;
    return 2 * random_next(&seed) - 1;
}

/* Returns snapshots whose singular values decrease, each by about the factor `decay`. */
static double *graded_snapshots(size_t num_states, size_t num_nodes, double decay) {
    const size_t num_terms = num_states < num_nodes ? num_states : num_nodes;
    double *snapshots = calloc(num_states * num_nodes, sizeof *snapshots);
    double *shape = malloc(num_nodes * sizeof *shape);
    assert_non_null(snapshots);
    assert_non_null(shape);
    for (size_t term = 0; term < num_terms; term++) {
        for (size_t node = 0; node < num_nodes; node++)
            shape[node] = pow(decay, (double)term) * next_random();
        for (size_t state = 0; state < num_states; state++) {
            const double weight = next_random();
            for (size_t node = 0; node < num_nodes; node++)
                snapshots[state * num_nodes + node] += weight * shape[node];
        }
    }
    free(shape);
    return snapshots;
}

static void check_orthonormal(const pod_basis *basis, double tolerance) {
    for (size_t i = 0; i < basis->num_modes; i++)
        for (size_t j = 0; j <= i; j++) {
            double product = 0.0;
            for (size_t node = 0; node < basis->num_nodes; node++)
                product += basis->modes[i * basis->num_nodes + node] *
                           basis->modes[j * basis->num_nodes + node];
            check_close(product, i == j ? 1.0 : 0.0, 0.0, tolerance);
        }
}

/* Returns the sum of the squared distances of all snapshots from the span of the modes. */
static double projection_error(const pod_basis *basis, const double *snapshots, size_t num_states) {
    const size_t num_nodes = basis->num_nodes;
    double sum = 0.0;
    double *rest = malloc(num_nodes * sizeof *rest);
    assert_non_null(rest);
    for (size_t state = 0; state < num_states; state++) {
        memcpy(rest, snapshots + state * num_nodes, num_nodes * sizeof *rest);
        for (size_t mode = 0; mode < basis->num_modes; mode++) {
            const double *shape = basis->modes + mode * num_nodes;
            double amplitude = 0.0;
            for (size_t node = 0; node < num_nodes; node++)
                amplitude += shape[node] * rest[node];
            for (size_t node = 0; node < num_nodes; node++)
                rest[node] -= amplitude * shape[node];
        }
        for (size_t node = 0; node < num_nodes; node++)
            sum += rest[node] * rest[node];
    }
    free(rest);
    return sum;
}

static void exact_small_example(void **state) {
    (void)state;
    // two snapshots along (3, 4, 0)/5 and one along (0, 0, 1): singular values 5 sqrt(2) and 2
    const double snapshots[] = {3, 4, 0, -3, -4, 0, 0, 0, -2};
    pod_basis basis;
    ehd_error error;
    assert_int_equal(pod_build(&basis, snapshots, 3, 3, &(pod_settings){.num_modes = 2}, &error),
                     EHD_OK);
    assert_int_equal(basis.num_modes, 2);
    assert_int_equal(basis.num_nodes, 3);
    assert_int_equal(basis.num_singular_values, 3);
    check_close_array(basis.singular_values, ((double[]){5.0 * sqrt(2.0), 2.0, 0.0}), 3, 1e-14,
                      1e-14);
    check_close_array(basis.modes, ((double[]){0.6, 0.8, 0, 0, 0, 1}), 6, 1e-14, 1e-14);
    pod_free(&basis);
    assert_null(basis.modes);
    pod_free(&basis); // freeing twice is harmless
}

static void compare_with_dgesdd(size_t num_states, size_t num_nodes) {
    const size_t num_values = num_states < num_nodes ? num_states : num_nodes;
    double *snapshots = graded_snapshots(num_states, num_nodes, 0.5);
    double *matrix = malloc(num_states * num_nodes * sizeof *matrix);
    double *values = malloc(num_values * sizeof *values);
    double *left = malloc(num_nodes * num_values * sizeof *left);
    double *right = malloc(num_values * num_states * sizeof *right);
    pod_basis basis;
    ehd_error error;
    assert_true(matrix && values && left && right);
    memcpy(matrix, snapshots, num_states * num_nodes * sizeof *matrix);
    assert_int_equal(LAPACKE_dgesdd(LAPACK_COL_MAJOR, 'S', (int)num_nodes, (int)num_states, matrix,
                                    (int)num_nodes, values, left, (int)num_nodes, right,
                                    (int)num_values),
                     0);
    assert_int_equal(pod_build(&basis, snapshots, num_states, num_nodes,
                               &(pod_settings){.num_modes = 12}, &error),
                     EHD_OK);
    assert_int_equal(basis.num_singular_values, num_values);
    // an SVD is accurate to epsilon times the first singular value
    check_close_array(basis.singular_values, values, num_values, 0.0, 1e-14 * values[0]);
    check_orthonormal(&basis, 1e-14);
    for (size_t mode = 0; mode < basis.num_modes; mode++) {
        double *expected = left + mode * num_nodes;
        const double *found = basis.modes + mode * num_nodes;
        const double sign = expected[0] * found[0] < 0.0 ? -1.0 : 1.0;
        for (size_t node = 0; node < num_nodes; node++)
            check_close(found[node], sign * expected[node], 0.0,
                        1e-14 * values[0] / values[mode] + 1e-14);
    }
    free(snapshots);
    free(matrix);
    free(values);
    free(left);
    free(right);
    pod_free(&basis);
}

static void equals_dgesdd_with_more_nodes(void **state) {
    (void)state;
    compare_with_dgesdd(20, 131);
}

static void equals_dgesdd_with_more_states(void **state) {
    (void)state;
    compare_with_dgesdd(117, 24);
}

static void equals_dgesdd_when_square(void **state) {
    (void)state;
    compare_with_dgesdd(30, 30);
}

/* The projection error of the snapshots is the energy of the omitted modes (Eckart and Young). */
static void energy_left_out_is_that_of_the_singular_values(void **state) {
    (void)state;
    const size_t num_states = 40, num_nodes = 150;
    double *snapshots = graded_snapshots(num_states, num_nodes, 0.6);
    ehd_error error;
    for (size_t num_modes = 1; num_modes <= 16; num_modes += 5) {
        pod_basis basis;
        double left_out = 0.0;
        assert_int_equal(pod_build(&basis, snapshots, num_states, num_nodes,
                                   &(pod_settings){.num_modes = num_modes}, &error),
                         EHD_OK);
        for (size_t i = num_modes; i < basis.num_singular_values; i++)
            left_out += basis.singular_values[i] * basis.singular_values[i];
        check_close(projection_error(&basis, snapshots, num_states), left_out, 1e-9, 0.0);
        pod_free(&basis);
    }
    free(snapshots);
}

static size_t modes_chosen(const double *snapshots, size_t num_states, size_t num_nodes,
                           double discarded_energy) {
    pod_basis basis;
    ehd_error error;
    assert_int_equal(pod_build(&basis, snapshots, num_states, num_nodes,
                               &(pod_settings){.discarded_energy = discarded_energy}, &error),
                     EHD_OK);
    const size_t num_modes = basis.num_modes;
    pod_free(&basis);
    return num_modes;
}

static void chooses_the_smallest_number_for_an_energy(void **state) {
    (void)state;
    // singular values 4, 2, 1: energies 16, 4, 1 of 21
    const double snapshots[] = {4, 0, 0, 0, 0, 2, 0, 0, 0, 0, -1, 0};
    assert_int_equal(modes_chosen(snapshots, 3, 4, 0.0), 3);
    assert_int_equal(modes_chosen(snapshots, 3, 4, 0.99 / 21), 3);
    assert_int_equal(modes_chosen(snapshots, 3, 4, 1.01 / 21), 2);
    assert_int_equal(modes_chosen(snapshots, 3, 4, 4.99 / 21), 2);
    assert_int_equal(modes_chosen(snapshots, 3, 4, 5.01 / 21), 1);
    assert_int_equal(modes_chosen(snapshots, 3, 4, 1.0), 1);
    // no energy may be left out, but the second mode is round-off
    assert_int_equal(modes_chosen((double[]){1, 1, 1, 1, 1 + 1e-16, 1}, 2, 3, 0.0), 1);
}

static void does_not_depend_on_scale(void **state) {
    (void)state;
    const double factors[] = {1e-130, 1e130};
    for (size_t i = 0; i < 2; i++) {
        const double snapshots[] = {4 * factors[i], 0, 0, 2 * factors[i]};
        assert_int_equal(modes_chosen(snapshots, 2, 2, 0.19), 2);
        assert_int_equal(modes_chosen(snapshots, 2, 2, 0.21), 1);
    }
}

/* pod_build finds singular values that a Gram matrix would lose, below 1e-8 of the first value. */
static void finds_modes_far_below_the_first(void **state) {
    (void)state;
    const double small = 1e-13;
    const double snapshots[] = {1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0, small, -small, small, -small};
    pod_basis basis;
    ehd_error error;
    assert_int_equal(pod_build(&basis, snapshots, 4, 4, &(pod_settings){.num_modes = 2}, &error),
                     EHD_OK);
    check_close(basis.singular_values[0], 2.0 * sqrt(2.0), 1e-14, 0.0);
    check_close(basis.singular_values[1], 2.0 * small, 1e-2, 0.0);
    check_close_array(basis.modes + 4, ((double[]){0.5, -0.5, 0.5, -0.5}), 4, 0.0, 1e-2);
    check_orthonormal(&basis, 1e-14);
    pod_free(&basis);
}

static void largest_entry_of_each_mode_is_positive(void **state) {
    (void)state;
    const size_t num_states = 25, num_nodes = 80;
    double *snapshots = graded_snapshots(num_states, num_nodes, 0.8);
    pod_basis basis, mirrored;
    ehd_error error;
    assert_int_equal(pod_build(&basis, snapshots, num_states, num_nodes,
                               &(pod_settings){.num_modes = 20}, &error),
                     EHD_OK);
    for (size_t mode = 0; mode < basis.num_modes; mode++) {
        const double *shape = basis.modes + mode * num_nodes;
        double least = 0.0, most = 0.0;
        for (size_t node = 0; node < num_nodes; node++) {
            least = fmin(least, shape[node]);
            most = fmax(most, shape[node]);
        }
        assert_true(most > -least);
    }
    for (size_t i = 0; i < num_states * num_nodes; i++)
        snapshots[i] = -snapshots[i];
    assert_int_equal(pod_build(&mirrored, snapshots, num_states, num_nodes,
                               &(pod_settings){.num_modes = 20}, &error),
                     EHD_OK);
    check_close_array(mirrored.modes, basis.modes, 20 * num_nodes, 0.0, 1e-12);
    pod_free(&basis);
    pod_free(&mirrored);
    free(snapshots);
}

static void gives_the_same_bits_again(void **state) {
    (void)state;
    const size_t num_states = 60, num_nodes = 200;
    double *snapshots = graded_snapshots(num_states, num_nodes, 0.7);
    const pod_settings settings = {.num_modes = 40};
    pod_basis first, second;
    ehd_error error;
    assert_int_equal(pod_build(&first, snapshots, num_states, num_nodes, &settings, &error),
                     EHD_OK);
    assert_int_equal(pod_build(&second, snapshots, num_states, num_nodes, &settings, &error),
                     EHD_OK);
    assert_memory_equal(first.modes, second.modes, 40 * num_nodes * sizeof *first.modes);
    assert_memory_equal(first.singular_values, second.singular_values,
                        num_states * sizeof *first.singular_values);
    pod_free(&first);
    pod_free(&second);
    free(snapshots);
}

/* Expects a refusal whose text contains `words`, and an empty basis. */
static void check_refused(const double *snapshots, size_t num_states, size_t num_nodes,
                          pod_settings settings, const char *words) {
    pod_basis basis;
    ehd_error error = {0};
    assert_int_equal(pod_build(&basis, snapshots, num_states, num_nodes, &settings, &error),
                     EHD_DATA);
    if (!strstr(error.text, words)) fail_msg("found \"%s\", expected \"%s\"", error.text, words);
    assert_null(basis.modes);
    assert_null(basis.singular_values);
}

static void refuses_bad_input(void **state) {
    (void)state;
    const pod_settings one = {.num_modes = 1};
    const double rank_one[] = {1, 2, 3, 2, 4, 6};
    check_refused(rank_one, 2, 3, (pod_settings){.num_modes = 2}, "found 2, expected at most 1");
    check_refused(rank_one, 2, 3, (pod_settings){.num_modes = 3}, "found 3, expected at most 1");
    check_refused(rank_one, 2, 3, (pod_settings){.discarded_energy = NAN}, "discarded energy");
    check_refused(rank_one, 2, 3, (pod_settings){.discarded_energy = -1e-3}, "discarded energy");
    check_refused(rank_one, 0, 3, one, "found 0 states");
    check_refused(rank_one, 2, 0, one, "0 nodes");
    check_refused((double[]){0, 0, 0, 0}, 2, 2, one, "only zeros");
    check_refused((double[]){1, 2, 3, NAN}, 2, 2, one, "snapshot 1 at node 1");
    check_refused((double[]){1, 2, INFINITY, 1}, 2, 2, one, "snapshot 1 at node 0");
}

/* Checks the distance of each snapshot from the span of the other snapshots, relative to the norm
 * of the snapshot. The first two snapshots, (1, 0, 0, 0) and (1, 1e-3, 0, 0), have nearly the same
 * direction. The third snapshot is orthogonal to both. */
static void tells_what_the_others_leave_out(void **state) {
    const double snapshots[] = {1, 0, 0, 0, 1, 1e-3, 0, 0, 0, 0, 3, 4};
    const pod_settings settings = {.num_modes = 3};
    pod_basis basis;
    double distance[3], coordinates[3 * 5]; // three modes, then other unknowns
    (void)state;
    assert_int_equal(pod_build(&basis, snapshots, 3, 4, &settings, NULL), EHD_OK);
    for (size_t s = 0; s < 3; s++)
        for (size_t m = 0; m < 3; m++)
            coordinates[5 * s + m] = cblas_ddot(4, basis.modes + 4 * m, 1, snapshots + 4 * s, 1);
    pod_left_out(distance, &basis, coordinates, 5, 3);
    const double length = hypot(1, 1e-3);
    check_close(distance[0], 1e-3 / length, 1e-9, 0);
    check_close(distance[1], 1e-3 / length, 1e-9, 0);
    check_close(distance[2], 1, 1e-12, 0);
    pod_free(&basis);
}

static void survives_failing_allocations(void **state) {
    (void)state;
    const double tall[] = {1, 2, 3, 2, 5, 6};
    pod_basis basis;
    ehd_error error;
    size_t call = 0;
    for (;; call++) {
        allocation_fail_at(call);
        const ehd_status status = pod_build(&basis, tall, 2, 3, &(pod_settings){0}, &error);
        if (!allocation_failed()) break;
        assert_int_equal(status, EHD_MEMORY);
        assert_null(basis.modes);
    }
    assert_true(call >= 6);
    assert_int_equal(basis.num_modes, 2);
    pod_free(&basis);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exact_small_example),
        cmocka_unit_test(equals_dgesdd_with_more_nodes),
        cmocka_unit_test(equals_dgesdd_with_more_states),
        cmocka_unit_test(equals_dgesdd_when_square),
        cmocka_unit_test(energy_left_out_is_that_of_the_singular_values),
        cmocka_unit_test(chooses_the_smallest_number_for_an_energy),
        cmocka_unit_test(does_not_depend_on_scale),
        cmocka_unit_test(finds_modes_far_below_the_first),
        cmocka_unit_test(largest_entry_of_each_mode_is_positive),
        cmocka_unit_test(gives_the_same_bits_again),
        cmocka_unit_test(refuses_bad_input),
        cmocka_unit_test(tells_what_the_others_leave_out),
        cmocka_unit_test(survives_failing_allocations),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
