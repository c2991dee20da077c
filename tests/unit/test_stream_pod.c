/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "podbuild/stream_pod.h"
#include "tests/unit/allocation.h"
#include "tests/unit/check.h"
#include "tests/unit/random.h"

#include <cblas.h>
#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// shares of the error for the first root and for the distance, as in podbuild
static const double OMEGA = 0.9, LOCAL = 0.05;

static double *numbers(size_t count) {
    double *values = calloc(count, sizeof *values);
    assert_non_null(values);
    return values;
}

/* Returns orthonormal rows [num, length] in random directions. */
static double *random_rows(size_t num, size_t length, uint64_t seed) {
    double *rows = numbers(num * length), *scales = numbers(num);
    for (size_t i = 0; i < num * length; i++) {
        rows[i] = random_next(&seed) - 0.5;
    }
    assert_int_equal(
        LAPACKE_dgeqrf(LAPACK_COL_MAJOR, (int)length, (int)num, rows, (int)length, scales), 0);
    assert_int_equal(LAPACKE_dorgqr(LAPACK_COL_MAJOR, (int)length, (int)num, (int)num, rows,
                                    (int)length, scales),
                     0);
    free(scales);
    return rows;
}

/* Snapshots with known singular values: each is seven tenths of the one before, with noise of 1e-9
 * in all directions. */
typedef struct known {
    size_t num_snapshots, num_nodes;
    double *snapshots; // [num_snapshots, num_nodes]
    double *values;    // [num_nodes]
    double energy;
} known;

static known known_snapshots(size_t num_snapshots, size_t num_nodes) {
    known self = {num_snapshots, num_nodes, numbers(num_snapshots * num_nodes), numbers(num_nodes),
                  0};
    double *left = random_rows(num_nodes, num_snapshots, 1);
    double *right = random_rows(num_nodes, num_nodes, 2);
    for (size_t j = 0; j < num_nodes; j++) {
        self.values[j] = fmax(pow(0.7, (double)j), 1e-9 * (2 - (double)j / (double)num_nodes));
        self.energy += self.values[j] * self.values[j];
        cblas_dscal((int)num_snapshots, self.values[j], left + j * num_snapshots, 1);
    }
    cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, (int)num_snapshots, (int)num_nodes,
                (int)num_nodes, 1, left, (int)num_snapshots, right, (int)num_nodes, 0,
                self.snapshots, (int)num_nodes);
    free(left);
    free(right);
    return self;
}

static void known_free(known *self) {
    free(self->snapshots);
    free(self->values);
}

/* Returns a hump that travels once over the nodes; each block has directions of its own. */
static double *travelling_snapshots(size_t num_snapshots, size_t num_nodes) {
    double *snapshots = numbers(num_snapshots * num_nodes);
    for (size_t s = 0; s < num_snapshots; s++)
        for (size_t k = 0; k < num_nodes; k++)
            snapshots[s * num_nodes + k] = exp(-pow(
                ((double)k / (double)num_nodes - (double)s / (double)num_snapshots) / 0.03, 2));
    return snapshots;
}

static stream_settings settings_for(double energy, size_t block, size_t max_rank) {
    return (stream_settings){LOCAL * LOCAL * energy, 0.25 * OMEGA * OMEGA * energy, block,
                             max_rank};
}

static ehd_status stream(pod_basis *basis, stream_error *bound, const double *snapshots,
                         size_t num_snapshots, size_t num_nodes, stream_settings settings,
                         pod_settings wanted, ehd_error *error) {
    stream_pod *self = NULL;
    ehd_status status = stream_pod_create(&self, num_nodes, &settings, error);
    *basis = (pod_basis){0};
    for (size_t s = 0; s < num_snapshots && !status; s++)
        status = stream_pod_add(self, snapshots + s * num_nodes, error);
    if (!status) status = stream_pod_finish(basis, bound, self, &wanted, error);
    assert_null(stream_pod_free(self));
    return status;
}

/* Returns |S - S Pᵀ P|, by Gram-Schmidt row by row. */
static double distance_to(const pod_basis *basis, const double *snapshots, size_t num_snapshots) {
    const int num_nodes = (int)basis->num_nodes;
    double *rest = numbers(basis->num_nodes), sum = 0;
    for (size_t s = 0; s < num_snapshots; s++) {
        cblas_dcopy(num_nodes, snapshots + s * basis->num_nodes, 1, rest, 1);
        for (size_t i = 0; i < basis->num_modes; i++) {
            const double *mode = basis->modes + i * basis->num_nodes;
            cblas_daxpy(num_nodes, -cblas_ddot(num_nodes, mode, 1, rest, 1), mode, 1, rest, 1);
        }
        sum += cblas_ddot(num_nodes, rest, 1, rest, 1);
    }
    free(rest);
    return sqrt(sum);
}

static double bound_of(const pod_basis *basis, const stream_error *error) {
    double tail = error->truncated;
    for (size_t i = basis->num_modes; i < basis->num_singular_values; i++)
        tail += basis->singular_values[i] * basis->singular_values[i];
    return sqrt(tail) + sqrt(error->distance);
}

static void check_orthonormal(const pod_basis *basis) {
    const int num_nodes = (int)basis->num_nodes;
    for (size_t i = 0; i < basis->num_modes; i++)
        for (size_t j = 0; j <= i; j++)
            check_close(cblas_ddot(num_nodes, basis->modes + i * basis->num_nodes, 1,
                                   basis->modes + j * basis->num_nodes, 1),
                        i == j ? 1 : 0, 0, 1e-13);
}

/* The error is below its stated bound, and the bound below the allowed error. There are no more
 * modes than a direct SVD needs for the share of the first root less the distance. */
static void error_is_within_the_bound(void **state) {
    (void)state;
    enum { NUM_SNAPSHOTS = 900, NUM_NODES = 150 };
    const double energies[] = {1e-3, 1e-6, 1e-10, 1e-13};
    const size_t blocks[] = {1, 7, 64, 2000};
    known all = known_snapshots(NUM_SNAPSHOTS, NUM_NODES);
    for (size_t e = 0; e < 4; e++)
        for (size_t b = 0; b < 4; b++) {
            const double whole = sqrt(energies[e] * all.energy);
            pod_basis basis;
            stream_error found;
            ehd_error error;
            assert_int_equal(stream(&basis, &found, all.snapshots, NUM_SNAPSHOTS, NUM_NODES,
                                    settings_for(energies[e], blocks[b], NUM_NODES),
                                    (pod_settings){.discarded_energy = OMEGA * OMEGA * energies[e]},
                                    &error),
                             EHD_OK);
            const double bound = bound_of(&basis, &found);
            const double distance = distance_to(&basis, all.snapshots, NUM_SNAPSHOTS);
            check_orthonormal(&basis);
            check_close(found.energy, all.energy, 1e-12, 0);
            assert_true(found.distance > 0);
            assert_true(found.distance <= LOCAL * LOCAL * energies[e] * all.energy);
            assert_true(distance <= bound);
            assert_true(distance >= 0.01 * bound);
            assert_true(bound <= whole);
            for (size_t i = 0; i < basis.num_singular_values; i++)
                check_close(basis.singular_values[i], all.values[i], 0,
                            sqrt(found.distance) + 1e-14);
            double tail = 0;
            size_t direct = NUM_NODES;
            while (direct > 0 && sqrt(tail) <= (OMEGA - LOCAL) * whole) {
                direct--;
                tail += all.values[direct] * all.values[direct];
            }
            assert_true(basis.num_modes <= direct + 1);
            pod_free(&basis);
        }
    known_free(&all);
}

/* If almost nothing is left out, the result is that of a direct SVD. */
static void little_left_out_equals_the_direct_svd(void **state) {
    (void)state;
    enum { NUM_SNAPSHOTS = 1000, NUM_NODES = 201, NUM_MODES = 40 };
    double *snapshots = travelling_snapshots(NUM_SNAPSHOTS, NUM_NODES);
    const pod_settings wanted = {.num_modes = NUM_MODES};
    pod_basis direct, streamed;
    stream_error found;
    ehd_error error;
    assert_int_equal(pod_build(&direct, snapshots, NUM_SNAPSHOTS, NUM_NODES, &wanted, &error),
                     EHD_OK);
    assert_int_equal(stream(&streamed, &found, snapshots, NUM_SNAPSHOTS, NUM_NODES,
                            (stream_settings){1e-22, 0, 32, NUM_NODES}, wanted, &error),
                     EHD_OK);
    const double first = direct.singular_values[0];
    const double gap = direct.singular_values[NUM_MODES - 1] - direct.singular_values[NUM_MODES];
    assert_int_equal(streamed.num_modes, NUM_MODES);
    check_close_array(streamed.singular_values, direct.singular_values, NUM_MODES, 0,
                      1e-11 * first);
    check_close(distance_to(&streamed, direct.modes, NUM_MODES), 0, 0,
                1e-11 * first * sqrt(NUM_MODES) / gap);
    pod_free(&direct);
    pod_free(&streamed);
    free(snapshots);
}

/* The limit of directions is below their number, but above the number that needs to be kept. Weak
 * directions are dropped, within their share of the energy. With too low a limit the stream ends
 * with an error. */
static void weak_directions_give_way(void **state) {
    (void)state;
    enum { NUM_SNAPSHOTS = 900, NUM_NODES = 150 };
    known all = known_snapshots(NUM_SNAPSHOTS, NUM_NODES);
    const double energy = 1e-10;
    const pod_settings wanted = {.discarded_energy = OMEGA * OMEGA * energy};
    pod_basis basis;
    stream_error found;
    ehd_error error;

    // the first snapshots have less energy than all together and may leave out less; they come in blocks of one
    stream_settings tight = settings_for(energy, 4, 40);
    tight.local_energy = 1e-14;
    assert_int_equal(
        stream(&basis, &found, all.snapshots, NUM_SNAPSHOTS, NUM_NODES, tight, wanted, &error),
        EHD_OK);
    assert_true(found.truncated > 0);
    assert_true(found.truncated <= tight.root_energy * all.energy);
    check_orthonormal(&basis);
    assert_true(distance_to(&basis, all.snapshots, NUM_SNAPSHOTS) <= bound_of(&basis, &found));
    assert_true(bound_of(&basis, &found) <= sqrt(energy * all.energy));
    pod_free(&basis);

    tight.max_rank = 20;
    assert_int_equal(
        stream(&basis, &found, all.snapshots, NUM_SNAPSHOTS, NUM_NODES, tight, wanted, &error),
        EHD_MEMORY);
    assert_non_null(strstr(error.text, "found more than 20 directions in the first"));
    assert_null(basis.modes);
    known_free(&all);
}

static void the_same_snapshots_give_the_same_bits(void **state) {
    (void)state;
    enum { NUM_SNAPSHOTS = 300, NUM_NODES = 80 };
    double *snapshots = travelling_snapshots(NUM_SNAPSHOTS, NUM_NODES);
    const pod_settings wanted = {.discarded_energy = 1e-12};
    pod_basis one, other;
    stream_error found;
    ehd_error error;
    // a limit above the number of directions changes nothing
    assert_int_equal(stream(&one, &found, snapshots, NUM_SNAPSHOTS, NUM_NODES,
                            settings_for(1e-13, 32, 80), wanted, &error),
                     EHD_OK);
    assert_int_equal(stream(&other, &found, snapshots, NUM_SNAPSHOTS, NUM_NODES,
                            settings_for(1e-13, 32, 80), wanted, &error),
                     EHD_OK);
    assert_int_equal(one.num_modes, other.num_modes);
    assert_memory_equal(one.modes, other.modes, one.num_modes * NUM_NODES * sizeof(double));
    assert_memory_equal(one.singular_values, other.singular_values,
                        one.num_singular_values * sizeof(double));
    pod_free(&one);
    pod_free(&other);
    free(snapshots);
}

static void exact_rank_is_found(void **state) {
    (void)state;
    // rows (1,2,0,0,2)/3 and (0,0,3,4,0)/5 times 3 and 5; 400 snapshots of each, and zeros between them
    double *snapshots = numbers(1200 * 5);
    for (size_t s = 0; s < 800; s++)
        memcpy(snapshots + 5 * (s + s / 2),
               s % 2 ? (double[]){1, 2, 0, 0, 2} : (double[]){0, 0, 3, 4, 0},
               5 * sizeof *snapshots);
    for (int exact = 0; exact < 2; exact++) {
        pod_basis basis;
        stream_error found;
        ehd_error error;
        assert_int_equal(stream(&basis, &found, snapshots, 1200, 5,
                                (stream_settings){exact ? 1e-28 : 1e-16, 1e-16, 7, 5},
                                (pod_settings){.discarded_energy = 1e-13}, &error),
                         EHD_OK);
        assert_int_equal(basis.num_modes, 2);
        check_close_array(basis.singular_values, ((double[]){100, 60}), 2, 1e-13, 0);
        check_close_array(basis.modes,
                          ((double[]){0, 0, 0.6, 0.8, 0, 1 / 3., 2 / 3., 0, 0, 2 / 3.}), 10, 1e-13,
                          1e-13);
        pod_free(&basis);
    }
    free(snapshots);
}

static void nothing_and_what_is_not_finite_are_refused(void **state) {
    (void)state;
    const double zeros[8] = {0}, bad[] = {NAN, INFINITY, -1e200};
    const stream_settings good = {1e-16, 1e-16, 3, 4};
    stream_pod *self;
    pod_basis basis;
    stream_error found;
    ehd_error error;

    for (size_t i = 0; i < 3; i++) {
        const double snapshots[] = {1, 2, 3, 4, 1, 2, bad[i], 4};
        assert_int_equal(stream(&basis, &found, snapshots, 2, 4, good, (pod_settings){0}, &error),
                         EHD_DATA);
        assert_non_null(strstr(error.text, "in snapshot 1 at node 2"));
    }
    assert_int_equal(stream(&basis, &found, zeros, 2, 4, good, (pod_settings){0}, &error),
                     EHD_DATA);
    assert_non_null(strstr(error.text, "only zeros"));
    const stream_settings wrong[] = {{1e-16, 1e-16, 0, 4}, {1e-16, 1e-16, 3, 0},
                                     {NAN, 1e-16, 3, 4},   {-1, 1e-16, 3, 4},
                                     {1e-16, 1, 3, 4},     {1e-16, NAN, 3, 4}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        assert_int_equal(stream_pod_create(&self, 4, &wrong[i], &error), EHD_DATA);
        assert_null(self);
    }
    assert_int_equal(stream_pod_create(&self, 0, &good, &error), EHD_DATA);
}

static void survives_failing_allocations(void **state) {
    (void)state;
    known all = known_snapshots(40, 12);
    size_t call = 0;
    double truncated = 0;
    bool failed;
    do {
        pod_basis basis;
        stream_error found;
        ehd_error error;
        allocation_fail_at(call);
        // with weak directions that are dropped
        const ehd_status status =
            stream(&basis, &found, all.snapshots, 40, 12, (stream_settings){1e-4, 0.1, 4, 9},
                   (pod_settings){.discarded_energy = 0.2}, &error);
        failed = allocation_failed();
        if (!status) truncated = found.truncated;
        // without memory to shorten the array, the modes stay as they are
        if (!(failed && status == EHD_OK && basis.modes))
            assert_int_equal(status, failed ? EHD_MEMORY : EHD_OK);
        assert_true((status == EHD_OK) == (basis.modes != NULL));
        pod_free(&basis);
    } while (failed && ++call < 1000);
    assert_in_range(call, 30, 999);
    assert_true(truncated > 0);
    known_free(&all);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(error_is_within_the_bound),
        cmocka_unit_test(little_left_out_equals_the_direct_svd),
        cmocka_unit_test(weak_directions_give_way),
        cmocka_unit_test(the_same_snapshots_give_the_same_bits),
        cmocka_unit_test(exact_rank_is_found),
        cmocka_unit_test(nothing_and_what_is_not_finite_are_refused),
        cmocka_unit_test(survives_failing_allocations),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
