/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "podbuild/compress.h"
#include "podbuild/pod.h"
#include "tests/unit/allocation.h"
#include "tests/unit/check.h"

#include <cblas.h>
#include <malloc.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Returns the first num_waves rows of the orthonormal cosine transform (DCT-II) of `length` points. */
static double *cosines(size_t num_waves, size_t length) {
    double *waves = malloc(num_waves * length * sizeof *waves);
    assert_non_null(waves);
    for (size_t j = 0; j < num_waves; j++)
        for (size_t i = 0; i < length; i++)
            waves[j * length + i] = sqrt((j ? 2.0 : 1.0) / (double)length) *
                                    cos(M_PI / (double)length * ((double)i + 0.5) * (double)j);
    return waves;
}

/* Returns snapshots with singular values decay^j and cosines as singular vectors, so no SVD is
 * needed. Every block of them has all the directions, in other proportions. */
static double *known_snapshots(size_t num_snapshots, size_t num_nodes, size_t rank, double decay) {
    double *snapshots = malloc(num_snapshots * num_nodes * sizeof *snapshots);
    double *amplitudes = cosines(rank, num_snapshots), *shapes = cosines(rank, num_nodes);
    assert_non_null(snapshots);
    for (size_t j = 0; j < rank; j++)
        cblas_dscal((int)num_snapshots, pow(decay, (double)j), amplitudes + j * num_snapshots, 1);
    cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, (int)num_snapshots, (int)num_nodes,
                (int)rank, 1, amplitudes, (int)num_snapshots, shapes, (int)num_nodes, 0, snapshots,
                (int)num_nodes);
    free(amplitudes);
    free(shapes);
    return snapshots;
}

/* Returns a hump that travels once over the nodes and changes its width. Each block has directions
 * of its own. */
static double *travelling_snapshots(size_t num_snapshots, size_t num_nodes) {
    double *snapshots = malloc(num_snapshots * num_nodes * sizeof *snapshots);
    assert_non_null(snapshots);
    for (size_t s = 0; s < num_snapshots; s++) {
        const double centre = (double)s / (double)num_snapshots;
        const double width = 0.05 + 0.02 * sin(0.3 * (double)s);
        for (size_t k = 0; k < num_nodes; k++)
            snapshots[s * num_nodes + k] =
                exp(-pow(((double)k / (double)num_nodes - centre) / width, 2));
    }
    return snapshots;
}

static snapshot_compressor *create(size_t num_nodes, compressor_settings settings) {
    snapshot_compressor *compressor;
    ehd_error error;
    assert_int_equal(compressor_create(&compressor, num_nodes, &settings, &error), EHD_OK);
    return compressor;
}

static void add(snapshot_compressor *compressor, const double *snapshots, size_t count) {
    ehd_error error;
    assert_int_equal(compressor_add(compressor, snapshots, count, &error), EHD_OK);
}

static compressed_set finish(const snapshot_compressor *compressor) {
    compressed_set set;
    ehd_error error;
    assert_int_equal(compressor_finish(&set, compressor, &error), EHD_OK);
    return set;
}

/* Compresses all snapshots, in calls of `chunk` snapshots. */
static compressed_set compress(const double *snapshots, size_t num_snapshots, size_t num_nodes,
                               compressor_settings settings, size_t chunk) {
    snapshot_compressor *compressor = create(num_nodes, settings);
    for (size_t s = 0; s < num_snapshots; s += chunk)
        add(compressor, snapshots + s * num_nodes,
            num_snapshots - s < chunk ? num_snapshots - s : chunk);
    const compressed_set set = finish(compressor);
    compressor_free(compressor);
    return set;
}

static void check_same_bits(const compressed_set *a, const compressed_set *b) {
    assert_int_equal(a->rank, b->rank);
    assert_int_equal(a->num_nodes, b->num_nodes);
    assert_int_equal(a->num_snapshots, b->num_snapshots);
    assert_memory_equal(&a->energy, &b->energy, sizeof a->energy);
    assert_memory_equal(&a->energy_discarded, &b->energy_discarded, sizeof a->energy_discarded);
    assert_memory_equal(a->singular_values, b->singular_values, a->rank * sizeof(double));
    assert_memory_equal(a->rows, b->rows, a->rank * a->num_nodes * sizeof(double));
}

static double energy_of(const double *values, size_t length) {
    double sum = 0;
    for (size_t i = 0; i < length; i++)
        sum += values[i] * values[i];
    return sum;
}

/* Returns an upper bound (Frobenius norm) of the sine of the largest angle between the leading rows
 * of the set and the span of as many orthonormal modes [num_modes, num_nodes]. */
static double sine_of_angle(const compressed_set *set, const double *modes, size_t num_modes) {
    const int num_nodes = (int)set->num_nodes;
    double *rest = malloc(set->num_nodes * sizeof *rest);
    double sum = 0;
    assert_non_null(rest);
    for (size_t i = 0; i < num_modes; i++) {
        cblas_dcopy(num_nodes, set->rows + i * set->num_nodes, 1, rest, 1);
        cblas_dscal(num_nodes, 1 / set->singular_values[i], rest, 1);
        for (size_t j = 0; j < num_modes; j++) {
            const double *mode = modes + j * set->num_nodes;
            cblas_daxpy(num_nodes, -cblas_ddot(num_nodes, mode, 1, rest, 1), mode, 1, rest, 1);
        }
        sum += energy_of(rest, set->num_nodes);
    }
    free(rest);
    return sqrt(sum);
}

/* Checks C C^T = diag(sigma^2), to 1e-13 of the product of both singular values. */
static void check_rows_orthogonal(const compressed_set *set) {
    const double *sigma = set->singular_values;
    for (size_t i = 0; i < set->rank; i++)
        for (size_t j = 0; j <= i; j++) {
            const double product = cblas_ddot((int)set->num_nodes, set->rows + i * set->num_nodes,
                                              1, set->rows + j * set->num_nodes, 1);
            check_close(product / (sigma[i] * sigma[j]), i == j ? 1 : 0, 0, 1e-13);
        }
}

/* Compresses thousands of snapshots over twelve decades, in blocks of 64 and seven levels. Every
 * singular value is right to 1e-14 of the first one plus the loss by truncation. The leading modes,
 * down to 1e-8 of the first one, are right to the angle that such errors cause. */
static void twelve_decades_equal_the_known_svd(void **state) {
    (void)state;
    enum { NUM_SNAPSHOTS = 5000, NUM_NODES = 200, RANK = 121 };
    const double decay = pow(10, -0.1);
    double *snapshots = known_snapshots(NUM_SNAPSHOTS, NUM_NODES, RANK, decay);
    double *modes = cosines(RANK, NUM_NODES);
    compressed_set set = compress(snapshots, NUM_SNAPSHOTS, NUM_NODES,
                                  (compressor_settings){1e-22, 64, 0}, NUM_SNAPSHOTS);
    const double lost = set.energy_discarded * set.energy;

    // the energy behind rank r is decay^2r, so 1e-22 keeps 110
    assert_in_range(set.rank, 110, 112);
    assert_int_equal(set.num_snapshots, NUM_SNAPSHOTS);
    for (size_t j = 0; j < set.rank; j++)
        check_close(set.singular_values[j], pow(decay, (double)j), 0,
                    1e-14 + lost / pow(decay, (double)j));
    check_rows_orthogonal(&set);
    for (size_t count = 1; count <= 81; count += 8) {
        const double weakest = pow(decay, (double)count - 1), gap = weakest * (1 - decay);
        const double sine = sine_of_angle(&set, modes, count);
        if (!(sine <= 1e-14 / gap + 1e-14)) fail_msg("%zu modes: sine %g", count, sine);
    }
    compressed_set_free(&set);
    free(modes);
    free(snapshots);
}

/* Compresses a hump whose directions come and go, and compares with pod_build of all snapshots in
 * one piece. */
static void travelling_hump_equals_one_piece(void **state) {
    (void)state;
    enum { NUM_SNAPSHOTS = 2000, NUM_NODES = 201, NUM_MODES = 40 };
    double *snapshots = travelling_snapshots(NUM_SNAPSHOTS, NUM_NODES);
    compressed_set set = compress(snapshots, NUM_SNAPSHOTS, NUM_NODES,
                                  (compressor_settings){1e-22, 100, 0}, NUM_SNAPSHOTS);
    pod_basis whole, again;
    ehd_error error;

    assert_int_equal(pod_build(&whole, snapshots, NUM_SNAPSHOTS, NUM_NODES,
                               &(pod_settings){.num_modes = NUM_MODES}, &error),
                     EHD_OK);
    const double first = whole.singular_values[0];
    // truncation is bounded by sqrt(1e-22); strong modes have smaller errors, from round-off
    check_close_array(set.singular_values, whole.singular_values, set.rank, 0, 1e-11 * first);
    check_close_array(set.singular_values, whole.singular_values, NUM_MODES, 0, 1e-13 * first);
    check_close(sine_of_angle(&set, whole.modes, NUM_MODES), 0, 0,
                1e-13 * first /
                    (whole.singular_values[NUM_MODES - 1] - whole.singular_values[NUM_MODES]));

    // a later stage may use the rows instead of the snapshots
    assert_int_equal(pod_build(&again, set.rows, set.rank, NUM_NODES,
                               &(pod_settings){.num_modes = NUM_MODES}, &error),
                     EHD_OK);
    check_close_array(again.singular_values, whole.singular_values, NUM_MODES, 0, 1e-13 * first);
    check_close(fabs(cblas_ddot(NUM_NODES, again.modes, 1, whole.modes, 1)), 1, 0, 1e-12);
    pod_free(&again);
    pod_free(&whole);
    compressed_set_free(&set);
    free(snapshots);
}

static void exact_rank_is_found(void **state) {
    (void)state;
    // rows (1,2,0,0,2)/3 and (0,0,3,4,0)/5 times 3 and 5; 400 snapshots of each, with changing signs
    double snapshots[800 * 5] = {0};
    for (size_t s = 0; s < 800; s++) {
        const double sign = s % 3 ? 1 : -1;
        memcpy(snapshots + 5 * s,
               s % 2 ? (double[]){sign, 2 * sign, 0, 0, 2 * sign}
                     : (double[]){0, 0, 3 * sign, 4 * sign, 0},
               5 * sizeof *snapshots);
    }
    for (int tolerated = 0; tolerated < 2; tolerated++) {
        compressed_set set =
            compress(snapshots, 800, 5, (compressor_settings){tolerated ? 1e-22 : 0, 7, 0}, 800);
        assert_int_equal(set.rank, 2);
        check_close_array(set.singular_values, ((double[]){100, 60}), 2, 1e-13, 0);
        check_close_array(set.rows, ((double[]){0, 0, 60, 80, 0, 20, 40, 0, 0, 40}), 10, 1e-13,
                          1e-11);
        check_close(set.energy, 400 * (9 + 25), 0, 0);
        check_close(set.energy_discarded, 0, 0, 1e-26);
        compressed_set_free(&set);
    }
}

/* Returns the sum of the squared distances of all snapshots to the span of the rows. */
static double squared_distance(const double *snapshots, const compressed_set *set) {
    double *rest = malloc(set->num_nodes * sizeof *rest);
    double sum = 0;
    assert_non_null(rest);
    for (size_t s = 0; s < set->num_snapshots; s++) {
        memcpy(rest, snapshots + s * set->num_nodes, set->num_nodes * sizeof *rest);
        for (size_t i = 0; i < set->rank; i++) {
            const double *row = set->rows + i * set->num_nodes;
            const double amplitude =
                cblas_ddot((int)set->num_nodes, row, 1, rest, 1) / pow(set->singular_values[i], 2);
            cblas_daxpy((int)set->num_nodes, -amplitude, row, 1, rest, 1);
        }
        sum += energy_of(rest, set->num_nodes);
    }
    free(rest);
    return sum;
}

/* Kept and discarded energy add up to the total. The allowance is used but not exceeded. The
 * discarded energy bounds the loss of each singular value and the distance of the snapshots. */
static void energy_adds_up(void **state) {
    (void)state;
    enum { NUM_SNAPSHOTS = 1500, NUM_NODES = 120 };
    double *snapshots = travelling_snapshots(NUM_SNAPSHOTS, NUM_NODES);
    const double energy = energy_of(snapshots, NUM_SNAPSHOTS * NUM_NODES);
    const double allowed[] = {1e-2, 1e-4, 1e-8};
    pod_basis whole;
    ehd_error error;

    assert_int_equal(pod_build(&whole, snapshots, NUM_SNAPSHOTS, NUM_NODES,
                               &(pod_settings){.num_modes = 1}, &error),
                     EHD_OK);
    for (size_t i = 0; i < 3; i++) {
        compressed_set set = compress(snapshots, NUM_SNAPSHOTS, NUM_NODES,
                                      (compressor_settings){allowed[i], 32, 0}, NUM_SNAPSHOTS);
        const double lost = set.energy_discarded * energy;
        check_close(set.energy, energy, 1e-13, 0);
        check_close(energy_of(set.singular_values, set.rank), energy - lost, 1e-13, 0);
        assert_true(set.energy_discarded <= allowed[i]);
        assert_true(set.energy_discarded >= 0.1 * allowed[i]);
        assert_true(squared_distance(snapshots, &set) <= lost);
        for (size_t j = 0; j < set.rank; j++) {
            const double loss = pow(whole.singular_values[j], 2) - pow(set.singular_values[j], 2);
            assert_true(loss <= lost);
            assert_true(loss >= -1e-13 * energy);
        }
        compressed_set_free(&set);
    }
    pod_free(&whole);
    free(snapshots);
}

static void rank_has_a_bound(void **state) {
    (void)state;
    enum { NUM_SNAPSHOTS = 600, NUM_NODES = 50 };
    double *snapshots = known_snapshots(NUM_SNAPSHOTS, NUM_NODES, 30, 0.5);
    compressed_set set = compress(snapshots, NUM_SNAPSHOTS, NUM_NODES,
                                  (compressor_settings){1e-22, 40, 5}, NUM_SNAPSHOTS);
    assert_int_equal(set.rank, 5);
    check_rows_orthogonal(&set);
    // the optimal loss is 4^-5 of the energy; each level may lose as much, and reports it
    assert_true(set.energy_discarded >= pow(4, -5));
    assert_true(set.energy_discarded <= 6 * pow(4, -5));
    check_close(energy_of(set.singular_values, 5) / set.energy, 1 - set.energy_discarded, 1e-13, 0);
    compressed_set_free(&set);
    free(snapshots);
}

static void calls_do_not_matter(void **state) {
    (void)state;
    enum { NUM_SNAPSHOTS = 700, NUM_NODES = 90 };
    const size_t chunks[] = {1, 7, 32, 33, 500};
    const compressor_settings settings = {1e-22, 32, 0};
    double *snapshots = travelling_snapshots(NUM_SNAPSHOTS, NUM_NODES);
    compressed_set whole = compress(snapshots, NUM_SNAPSHOTS, NUM_NODES, settings, NUM_SNAPSHOTS);
    for (size_t i = 0; i < sizeof chunks / sizeof *chunks; i++) {
        compressed_set set = compress(snapshots, NUM_SNAPSHOTS, NUM_NODES, settings, chunks[i]);
        check_same_bits(&set, &whole);
        compressed_set_free(&set);
    }
    compressed_set_free(&whole);
    free(snapshots);
}

static void goes_on_after_finish(void **state) {
    (void)state;
    enum { NUM_SNAPSHOTS = 300, NUM_NODES = 60, BLOCK = 32 };
    const compressor_settings settings = {1e-22, BLOCK, 0};
    double *snapshots = travelling_snapshots(NUM_SNAPSHOTS, NUM_NODES);
    compressed_set expected = compress(snapshots, NUM_SNAPSHOTS, NUM_NODES, settings, 300);
    snapshot_compressor *compressor = create(NUM_NODES, settings);
    for (size_t s = 0; s < NUM_SNAPSHOTS; s += 50) {
        add(compressor, snapshots + s * NUM_NODES, 50);
        compressed_set so_far = finish(compressor);
        assert_int_equal(so_far.num_snapshots, s + 50);
        compressed_set_free(&so_far);
    }
    compressed_set set = finish(compressor);
    check_same_bits(&set, &expected);
    compressed_set_free(&set);
    compressor_free(compressor);
    compressed_set_free(&expected);
    free(snapshots);
}

/* Compresses three trajectories of unequal length, merges them and then adds 500 snapshots. */
static compressed_set merge_three(const double *snapshots, size_t num_nodes,
                                  compressor_settings settings) {
    const size_t lengths[] = {700, 90, 210};
    snapshot_compressor *compressor = create(num_nodes, settings);
    ehd_error error;
    for (size_t i = 0; i < 3; i++) {
        compressed_set set = compress(snapshots, lengths[i], num_nodes, settings, lengths[i]);
        assert_int_equal(compressor_merge(compressor, &set, &error), EHD_OK);
        compressed_set_free(&set);
        snapshots += lengths[i] * num_nodes;
    }
    add(compressor, snapshots, 500);
    const compressed_set merged = finish(compressor);
    compressor_free(compressor);
    return merged;
}

static void merging_equals_adding(void **state) {
    (void)state;
    enum { NUM_SNAPSHOTS = 1500, NUM_NODES = 150, NUM_MODES = 30 };
    const compressor_settings settings = {1e-22, 64, 0};
    double *snapshots = travelling_snapshots(NUM_SNAPSHOTS, NUM_NODES);
    compressed_set whole = compress(snapshots, NUM_SNAPSHOTS, NUM_NODES, settings, NUM_SNAPSHOTS);
    compressed_set merged = merge_three(snapshots, NUM_NODES, settings);
    compressed_set again = merge_three(snapshots, NUM_NODES, settings);
    const double *sigma = whole.singular_values;
    double *modes = malloc(NUM_MODES * NUM_NODES * sizeof *modes);
    assert_non_null(modes);

    check_same_bits(&again, &merged);
    assert_int_equal(merged.num_snapshots, NUM_SNAPSHOTS);
    check_close(merged.energy, whole.energy, 1e-13, 0);
    check_close_array(merged.singular_values, sigma, NUM_MODES, 0, 1e-13 * sigma[0]);
    for (size_t i = 0; i < NUM_MODES; i++)
        for (size_t k = 0; k < NUM_NODES; k++)
            modes[i * NUM_NODES + k] = whole.rows[i * NUM_NODES + k] / sigma[i];
    check_close(sine_of_angle(&merged, modes, NUM_MODES), 0, 0,
                1e-13 * sigma[0] / (sigma[NUM_MODES - 1] - sigma[NUM_MODES]));
    free(modes);
    compressed_set_free(&again);
    compressed_set_free(&merged);
    compressed_set_free(&whole);
    free(snapshots);
}

/* Losses of merged sets are counted, and do not use up the allowance. */
static void merging_inherits_losses(void **state) {
    (void)state;
    enum { NUM_SNAPSHOTS = 1500, NUM_NODES = 150 };
    double *snapshots = travelling_snapshots(NUM_SNAPSHOTS, NUM_NODES);
    const double energy = energy_of(snapshots, NUM_SNAPSHOTS * NUM_NODES);
    compressed_set merged = merge_three(snapshots, NUM_NODES, (compressor_settings){1e-3, 64, 0});

    check_close(merged.energy, energy, 1e-13, 0);
    check_close(energy_of(merged.singular_values, merged.rank),
                energy * (1 - merged.energy_discarded), 1e-13, 0);
    assert_true(merged.energy_discarded > 1e-3);
    assert_true(merged.energy_discarded <= 2e-3);
    assert_true(squared_distance(snapshots, &merged) <= merged.energy_discarded * energy);
    compressed_set_free(&merged);
    free(snapshots);
}

static void zeros_and_nothing_have_rank_zero(void **state) {
    (void)state;
    const double zeros[30] = {0}, one[] = {0, 3, 4};
    snapshot_compressor *compressor = create(3, (compressor_settings){1e-22, 4, 0});
    ehd_error error;
    compressed_set set = finish(compressor);
    assert_int_equal(set.rank, 0);
    assert_int_equal(set.num_snapshots, 0);
    assert_null(set.rows);
    assert_int_equal(compressor_merge(compressor, &set, &error), EHD_OK);
    compressed_set_free(&set);

    add(compressor, zeros, 10);
    set = finish(compressor);
    assert_int_equal(set.rank, 0);
    assert_int_equal(set.num_snapshots, 10);
    check_close(set.energy, 0, 0, 0);
    check_close(set.energy_discarded, 0, 0, 0);
    compressed_set_free(&set);

    add(compressor, one, 1);
    add(compressor, zeros, 10);
    set = finish(compressor);
    assert_int_equal(set.rank, 1);
    assert_int_equal(set.num_snapshots, 21);
    check_close_array(set.rows, one, 3, 1e-14, 1e-14);
    compressed_set_free(&set);
    assert_null(set.rows);
    compressed_set_free(&set); // freeing twice is harmless
    assert_null(compressor_free(compressor));
    assert_null(compressor_free(NULL));
}

/* Returns the bytes in use by the whole process. */
#ifdef __SANITIZE_ADDRESS__
// from the sanitizer's own allocator; Debian packs no header
size_t __sanitizer_get_current_allocated_bytes(void);
static size_t bytes_in_use(void) {
    return __sanitizer_get_current_allocated_bytes();
}
#else
static size_t bytes_in_use(void) {
    const struct mallinfo2 info = mallinfo2();
    return info.uordblks + info.hblkhd;
}
#endif

/* Returns the most bytes held between two calls while num_blocks blocks are added. */
static size_t most_bytes(const double *snapshots, size_t block, size_t num_nodes,
                         size_t num_blocks) {
    snapshot_compressor *compressor = create(num_nodes, (compressor_settings){1e-22, block, 0});
    size_t most = 0;
    for (size_t i = 0; i < num_blocks; i++) {
        add(compressor, snapshots, block);
        const size_t now = bytes_in_use();
        if (now > most) most = now;
    }
    compressor_free(compressor);
    return most;
}

/* Each doubling of the blocks adds one part of the same rank and nothing else. */
static void memory_grows_with_the_logarithm(void **state) {
    (void)state;
    enum { BLOCK = 32, NUM_NODES = 500, RANK = 10 };
    double *snapshots = known_snapshots(BLOCK, NUM_NODES, RANK, 0.5);
    most_bytes(snapshots, BLOCK, NUM_NODES, 1); // libraries allocate what they keep
    const size_t before = bytes_in_use();
    const size_t few = most_bytes(snapshots, BLOCK, NUM_NODES, 4) - before;
    const size_t many = most_bytes(snapshots, BLOCK, NUM_NODES, 1024) - before;
    const size_t part = RANK * NUM_NODES * sizeof(double);
    assert_in_range(few, BLOCK * NUM_NODES * sizeof(double) + 2 * part,
                    BLOCK * NUM_NODES * sizeof(double) + 3 * part);
    assert_in_range(many, few + 7 * part, few + 9 * part); // not 1020 blocks more
    assert_int_equal(bytes_in_use(), before);
    free(snapshots);
}

/* Adds seven blocks and a rest, merges and finishes; each allocation may fail. */
static ehd_status compress_and_merge(compressed_set *set, const double *snapshots,
                                     const compressed_set *other) {
    snapshot_compressor *compressor;
    ehd_error error;
    ehd_status status =
        compressor_create(&compressor, 6, &(compressor_settings){1e-22, 4, 0}, &error);
    *set = (compressed_set){0};
    if (!status) status = compressor_add(compressor, snapshots, 30, &error);
    if (!status) status = compressor_merge(compressor, other, &error);
    if (!status) status = compressor_finish(set, compressor, &error);
    compressor_free(compressor);
    return status;
}

static void survives_failing_allocations(void **state) {
    (void)state;
    double *snapshots = travelling_snapshots(30, 6);
    compressed_set other = compress(snapshots, 30, 6, (compressor_settings){1e-22, 8, 0}, 30), set;
    size_t call = 0;
    bool failed;
    do {
        allocation_fail_at(call);
        const ehd_status status = compress_and_merge(&set, snapshots, &other);
        failed = allocation_failed();
        assert_int_equal(status, failed ? EHD_MEMORY : EHD_OK);
        assert_true(failed == !set.rows);
        compressed_set_free(&set);
    } while (failed && ++call < 1000);
    assert_in_range(call, 50, 999);
    compressed_set_free(&other);
    free(snapshots);
}

static void check_settings_refused(size_t num_nodes, compressor_settings settings,
                                   const char *words) {
    snapshot_compressor *compressor;
    ehd_error error = {0};
    assert_int_equal(compressor_create(&compressor, num_nodes, &settings, &error), EHD_DATA);
    assert_null(compressor);
    assert_non_null(strstr(error.text, words));
}

static void bad_settings_are_refused(void **state) {
    (void)state;
    check_settings_refused(0, (compressor_settings){0}, "found 0 nodes");
    check_settings_refused((size_t)1 << 31, (compressor_settings){0}, "found 2147483648 nodes");
    check_settings_refused(3, (compressor_settings){.block = (size_t)1 << 31}, "block: found");
    check_settings_refused(3, (compressor_settings){NAN, 4, 0}, "discarded energy: found");
    check_settings_refused(3, (compressor_settings){-1e-30, 4, 0},
                           "discarded energy: found -1e-30");
    check_settings_refused(3, (compressor_settings){1, 4, 0}, "discarded energy: found 1");
}

static void bad_snapshots_change_nothing(void **state) {
    (void)state;
    const double bad[] = {NAN, INFINITY, -INFINITY, 1e200};
    const char *const words[] = {"found nan", "found inf", "found -inf", "found 1e+200"};
    const compressor_settings settings = {1e-22, 3, 0};
    double *snapshots = travelling_snapshots(8, 5);
    compressed_set expected = compress(snapshots, 8, 5, settings, 8);
    snapshot_compressor *compressor = create(5, settings);
    ehd_error error;

    add(compressor, snapshots, 2);
    for (size_t i = 0; i < 4; i++) {
        double spoilt[6 * 5] = {0};
        spoilt[5 * 5 + 2] = bad[i]; // in the third block
        assert_int_equal(compressor_add(compressor, spoilt, 6, &error), EHD_DATA);
        assert_non_null(strstr(error.text, words[i]));
        assert_non_null(strstr(error.text, "in snapshot 5 at node 2"));
    }
    add(compressor, snapshots + 2 * 5, 6);
    compressed_set set = finish(compressor);
    check_same_bits(&set, &expected);
    compressed_set_free(&set);
    compressor_free(compressor);
    compressed_set_free(&expected);
    free(snapshots);
}

static void bad_sets_are_refused(void **state) {
    (void)state;
    double rows[] = {1, 2, 3}, spoilt[] = {1, NAN, 3}, values[] = {1};
    const compressed_set good = {1, 3, rows, values, 1, 14, 0};
    struct {
        compressed_set set;
        const char *words;
    } cases[] = {{good, "found 3 nodes, expected 4"}, {good, "found nan in snapshot 0 at node 1"},
                 {good, "found energy nan"},          {good, "found energy -1"},
                 {good, "part discarded 1.5"},        {good, "part discarded nan"}};
    cases[1].set.rows = spoilt;
    cases[2].set.energy = NAN;
    cases[3].set.energy = -1;
    cases[4].set.energy_discarded = 1.5;
    cases[5].set.energy_discarded = NAN;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        snapshot_compressor *compressor = create(i == 0 ? 4 : 3, (compressor_settings){0});
        ehd_error error;
        assert_int_equal(compressor_merge(compressor, &cases[i].set, &error), EHD_DATA);
        assert_non_null(strstr(error.text, cases[i].words));
        compressed_set set = finish(compressor);
        assert_int_equal(set.num_snapshots, 0);
        compressed_set_free(&set);
        compressor_free(compressor);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(twelve_decades_equal_the_known_svd),
        cmocka_unit_test(travelling_hump_equals_one_piece),
        cmocka_unit_test(exact_rank_is_found),
        cmocka_unit_test(energy_adds_up),
        cmocka_unit_test(rank_has_a_bound),
        cmocka_unit_test(calls_do_not_matter),
        cmocka_unit_test(goes_on_after_finish),
        cmocka_unit_test(merging_equals_adding),
        cmocka_unit_test(merging_inherits_losses),
        cmocka_unit_test(zeros_and_nothing_have_rank_zero),
        cmocka_unit_test(memory_grows_with_the_logarithm),
        cmocka_unit_test(survives_failing_allocations),
        cmocka_unit_test(bad_settings_are_refused),
        cmocka_unit_test(bad_snapshots_change_nothing),
        cmocka_unit_test(bad_sets_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
