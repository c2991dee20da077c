/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "podbuild/pod_stream.h"
#include "tests/unit/allocation.h"
#include "tests/unit/check.h"
#include "tests/unit/random.h"

#include <cblas.h>
#include <lapacke.h>
#include <malloc.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// Largest distance of a snapshot from the directions of a stream, as a fraction of the square root
// of the allowed energy; the same value as in podbuild.
static const double LOCAL = 0.05;

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

/* Snapshots with known singular values, each 0.7 times the previous one, plus noise of 1e-9. */
typedef struct known {
    size_t num_snapshots, num_nodes;
    double *snapshots; // [num_snapshots, num_nodes]
    double *values;    // [num_nodes]
    double energy;
} known;

static known noisy_snapshots(size_t num_snapshots, size_t num_nodes) {
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

/* Returns the first num_waves rows of the orthonormal cosine transform (DCT-II) of `length`
 * points. */
static double *cosines(size_t num_waves, size_t length) {
    double *waves = numbers(num_waves * length);
    for (size_t j = 0; j < num_waves; j++)
        for (size_t i = 0; i < length; i++)
            waves[j * length + i] = sqrt((j ? 2.0 : 1.0) / (double)length) *
                                    cos(M_PI / (double)length * ((double)i + 0.5) * (double)j);
    return waves;
}

/* Returns snapshots with singular values decay^j and cosines as singular vectors, so that no SVD
 * is needed. Every block of these snapshots contains all directions, in different proportions. */
static double *known_snapshots(size_t num_snapshots, size_t num_nodes, size_t rank, double decay) {
    double *snapshots = numbers(num_snapshots * num_nodes);
    double *amplitudes = cosines(rank, num_snapshots), *shapes = cosines(rank, num_nodes);
    for (size_t j = 0; j < rank; j++)
        cblas_dscal((int)num_snapshots, pow(decay, (double)j), amplitudes + j * num_snapshots, 1);
    cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, (int)num_snapshots, (int)num_nodes,
                (int)rank, 1, amplitudes, (int)num_snapshots, shapes, (int)num_nodes, 0, snapshots,
                (int)num_nodes);
    free(amplitudes);
    free(shapes);
    return snapshots;
}

/* Returns a hump that travels once over the nodes while its width changes. Each block contains new
 * directions. */
static double *travelling_snapshots(size_t num_snapshots, size_t num_nodes) {
    double *snapshots = numbers(num_snapshots * num_nodes);
    for (size_t s = 0; s < num_snapshots; s++) {
        const double centre = (double)s / (double)num_snapshots;
        const double width = 0.05 + 0.02 * sin(0.3 * (double)s);
        for (size_t k = 0; k < num_nodes; k++)
            snapshots[s * num_nodes + k] =
                exp(-pow(((double)k / (double)num_nodes - centre) / width, 2));
    }
    return snapshots;
}

static pod_stream_settings settings_for(double energy, size_t block, size_t max_rank) {
    return (pod_stream_settings){LOCAL * LOCAL * energy, 0.2 * energy, block, max_rank};
}

/* Returns the settings of the streams that snapgen uses for trajectories. */
static pod_stream_settings little(size_t block) {
    return (pod_stream_settings){.local_energy = 0.25e-22, .block = block};
}

static const pod_settings little_in_all = {.discarded_energy = 1e-22};

static pod_stream *create(size_t num_nodes, pod_stream_settings settings) {
    pod_stream *stream;
    ehd_error error;
    assert_int_equal(pod_stream_create(&stream, num_nodes, &settings, &error), EHD_OK);
    return stream;
}

static void add(pod_stream *stream, const double *snapshots, size_t count) {
    ehd_error error;
    assert_int_equal(pod_stream_add(stream, snapshots, count, &error), EHD_OK);
}

static pod_basis finish(pod_stream *stream, pod_settings wanted) {
    pod_basis basis;
    ehd_error error;
    assert_int_equal(pod_stream_finish(&basis, stream, &wanted, &error), EHD_OK);
    assert_null(pod_stream_free(stream));
    return basis;
}

static ehd_status stream(pod_basis *basis, const double *snapshots, size_t num_snapshots,
                         size_t num_nodes, pod_stream_settings settings, pod_settings wanted,
                         ehd_error *error) {
    pod_stream *self = NULL;
    ehd_status status = pod_stream_create(&self, num_nodes, &settings, error);
    *basis = (pod_basis){0};
    if (!status) status = pod_stream_add(self, snapshots, num_snapshots, error);
    if (!status) status = pod_stream_finish(basis, self, &wanted, error);
    assert_null(pod_stream_free(self));
    return status;
}

/* Streams all snapshots, in calls of `chunk` snapshots. */
static pod_basis stream_in(size_t chunk, const double *snapshots, size_t num_snapshots,
                           size_t num_nodes, pod_stream_settings settings, pod_settings wanted) {
    pod_stream *self = create(num_nodes, settings);
    for (size_t s = 0; s < num_snapshots; s += chunk)
        add(self, snapshots + s * num_nodes, num_snapshots - s < chunk ? num_snapshots - s : chunk);
    return finish(self, wanted);
}

/* Returns |S - S Pᵀ P|, the part of all snapshots that the modes do not represent. */
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

static double bound_of(const pod_basis *basis) {
    return sqrt(basis->tail) + basis->distance;
}

static void check_orthonormal(const pod_basis *basis) {
    const int num_nodes = (int)basis->num_nodes;
    for (size_t i = 0; i < basis->num_modes; i++)
        for (size_t j = 0; j <= i; j++)
            check_close(cblas_ddot(num_nodes, basis->modes + i * basis->num_nodes, 1,
                                   basis->modes + j * basis->num_nodes, 1),
                        i == j ? 1 : 0, 0, 1e-13);
}

static void check_same_bits(const pod_basis *a, const pod_basis *b) {
    assert_int_equal(a->num_modes, b->num_modes);
    assert_int_equal(a->num_snapshots, b->num_snapshots);
    assert_int_equal(a->num_singular_values, b->num_singular_values);
    assert_memory_equal(&a->energy, &b->energy, sizeof a->energy);
    assert_memory_equal(&a->tail, &b->tail, sizeof a->tail);
    assert_memory_equal(a->singular_values, b->singular_values,
                        a->num_singular_values * sizeof(double));
    assert_memory_equal(a->modes, b->modes, a->num_modes * a->num_nodes * sizeof(double));
}

/* Returns an upper bound (Frobenius norm) of the sine of the largest angle between the first
 * num_modes modes of the set and the span of other orthonormal modes [num_modes, num_nodes]. */
static double sine_of_angle(const pod_basis *set, const double *modes, size_t num_modes) {
    const int num_nodes = (int)set->num_nodes;
    double *rest = numbers(set->num_nodes);
    double sum = 0;
    for (size_t i = 0; i < num_modes; i++) {
        cblas_dcopy(num_nodes, set->modes + i * set->num_nodes, 1, rest, 1);
        for (size_t j = 0; j < num_modes; j++) {
            const double *mode = modes + j * set->num_nodes;
            cblas_daxpy(num_nodes, -cblas_ddot(num_nodes, mode, 1, rest, 1), mode, 1, rest, 1);
        }
        sum += cblas_ddot(num_nodes, rest, 1, rest, 1);
    }
    free(rest);
    return sqrt(sum);
}

static void one_block_has_the_bits_of_its_pod(void **state) {
    (void)state;
    enum { NUM_SNAPSHOTS = 90, NUM_NODES = 60 };
    double *snapshots = travelling_snapshots(NUM_SNAPSHOTS, NUM_NODES);
    const pod_settings wanted = {.discarded_energy = 1e-6};
    pod_basis direct;
    ehd_error error;
    assert_int_equal(pod_build(&direct, snapshots, NUM_SNAPSHOTS, NUM_NODES, &wanted, &error),
                     EHD_OK);
    for (size_t block = NUM_SNAPSHOTS; block < NUM_SNAPSHOTS + 2; block++) {
        pod_basis streamed =
            stream_in(7, snapshots, NUM_SNAPSHOTS, NUM_NODES, settings_for(1e-6, block, 3), wanted);
        check_same_bits(&streamed, &direct);
        check_close(streamed.distance, 0, 0, 0);
        pod_free(&streamed);
    }
    pod_free(&direct);
    free(snapshots);
}

/* The error is below its bound, and the bound is below the allowed error. The stream has at most
 * one mode more than a direct SVD whose allowed error is smaller by the fraction 2 LOCAL. */
static void error_is_within_the_bound(void **state) {
    (void)state;
    enum { NUM_SNAPSHOTS = 900, NUM_NODES = 150 };
    const double energies[] = {1e-3, 1e-6, 1e-10, 1e-13};
    const size_t blocks[] = {1, 7, 64, 2000};
    known all = noisy_snapshots(NUM_SNAPSHOTS, NUM_NODES);
    for (size_t e = 0; e < 4; e++)
        for (size_t b = 0; b < 4; b++) {
            const double whole = sqrt(energies[e] * all.energy);
            pod_basis basis;
            ehd_error error;
            assert_int_equal(stream(&basis, all.snapshots, NUM_SNAPSHOTS, NUM_NODES,
                                    settings_for(energies[e], blocks[b], NUM_NODES),
                                    (pod_settings){.discarded_energy = energies[e]}, &error),
                             EHD_OK);
            const double bound = bound_of(&basis);
            const double distance = distance_to(&basis, all.snapshots, NUM_SNAPSHOTS);
            check_orthonormal(&basis);
            check_close(basis.energy, all.energy, 1e-12, 0);
            assert_true((basis.distance > 0) == (blocks[b] < NUM_SNAPSHOTS));
            assert_true(basis.distance <= LOCAL * whole);
            assert_true(distance <= (1 + 1e-6) * bound); // equal for one block
            assert_true(distance >= 0.01 * bound);
            assert_true(bound <= whole);
            for (size_t i = 0; i < basis.num_singular_values; i++)
                check_close(basis.singular_values[i], all.values[i], 0, basis.distance + 1e-14);
            double tail = 0;
            size_t direct = NUM_NODES;
            while (direct > 0 && sqrt(tail) <= (1 - 2 * LOCAL) * whole) {
                direct--;
                tail += all.values[direct] * all.values[direct];
            }
            assert_true(basis.num_modes <= direct + 1);
            pod_free(&basis);
        }
    known_free(&all);
}

static void little_left_out_equals_the_direct_svd(void **state) {
    (void)state;
    enum { NUM_SNAPSHOTS = 1000, NUM_NODES = 201, NUM_MODES = 40 };
    double *snapshots = travelling_snapshots(NUM_SNAPSHOTS, NUM_NODES);
    const pod_settings wanted = {.num_modes = NUM_MODES};
    pod_basis direct, streamed;
    ehd_error error;
    assert_int_equal(pod_build(&direct, snapshots, NUM_SNAPSHOTS, NUM_NODES, &wanted, &error),
                     EHD_OK);
    assert_int_equal(stream(&streamed, snapshots, NUM_SNAPSHOTS, NUM_NODES,
                            (pod_stream_settings){1e-22, 0, 32, NUM_NODES}, wanted, &error),
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

/* The snapshots have more than 40 directions. With max_rank = 40 the stream drops weak directions.
 * With max_rank = 20 it would have to drop more than the allowed energy, and fails. */
static void weak_directions_give_way(void **state) {
    (void)state;
    enum { NUM_SNAPSHOTS = 900, NUM_NODES = 150 };
    known all = noisy_snapshots(NUM_SNAPSHOTS, NUM_NODES);
    const double energy = 1e-10;
    const pod_settings wanted = {.discarded_energy = energy};
    pod_basis basis;
    ehd_error error;

    // the first snapshots have less energy than all snapshots, so the stream may omit less
    pod_stream_settings tight = settings_for(energy, 4, 40);
    tight.local_energy = 1e-14;
    assert_int_equal(stream(&basis, all.snapshots, NUM_SNAPSHOTS, NUM_NODES, tight, wanted, &error),
                     EHD_OK);
    check_orthonormal(&basis);
    assert_true(distance_to(&basis, all.snapshots, NUM_SNAPSHOTS) <= bound_of(&basis));
    assert_true(bound_of(&basis) <= sqrt(energy * all.energy));
    pod_free(&basis);

    tight.max_rank = 20;
    assert_int_equal(stream(&basis, all.snapshots, NUM_SNAPSHOTS, NUM_NODES, tight, wanted, &error),
                     EHD_MEMORY);
    assert_non_null(strstr(error.text, "found more than 20 directions in the first"));
    assert_null(basis.modes);
    known_free(&all);
}

/* Streams thousands of snapshots, in blocks of 64, with singular values over twelve decades. Every
 * singular value is accurate to 2e-13 of the first value, plus the loss by truncation. The leading
 * modes, whose singular values are at least 1e-8 of the first, are accurate to the angle that such
 * errors cause. */
static void twelve_decades_equal_the_known_svd(void **state) {
    (void)state;
    enum { NUM_SNAPSHOTS = 5000, NUM_NODES = 200, RANK = 121 };
    const double decay = pow(10, -0.1);
    double *snapshots = known_snapshots(NUM_SNAPSHOTS, NUM_NODES, RANK, decay);
    double *modes = cosines(RANK, NUM_NODES);
    pod_basis set =
        stream_in(NUM_SNAPSHOTS, snapshots, NUM_SNAPSHOTS, NUM_NODES, little(64), little_in_all);
    const double lost = pod_discarded(&set) * set.energy;

    // without the first r modes the energy is decay^(2r): the limit 1e-22 keeps 110 modes, and a
    // fourth of this limit keeps 113
    assert_in_range(set.num_modes, 110, 114);
    assert_int_equal(set.num_snapshots, NUM_SNAPSHOTS);
    for (size_t j = 0; j < set.num_modes; j++)
        check_close(set.singular_values[j], pow(decay, (double)j), 0,
                    2e-13 + lost / pow(decay, (double)j));
    check_orthonormal(&set);
    for (size_t count = 1; count <= 81; count += 8) {
        const double weakest = pow(decay, (double)count - 1), gap = weakest * (1 - decay);
        const double sine = sine_of_angle(&set, modes, count);
        if (!(sine <= 2e-13 / gap + 1e-14)) fail_msg("%zu modes: sine %g", count, sine);
    }
    pod_free(&set);
    free(modes);
    free(snapshots);
}

static void calls_do_not_matter(void **state) {
    (void)state;
    enum { NUM_SNAPSHOTS = 700, NUM_NODES = 90 };
    const size_t chunks[] = {1, 7, 32, 33, 500};
    double *snapshots = travelling_snapshots(NUM_SNAPSHOTS, NUM_NODES);
    pod_basis whole =
        stream_in(NUM_SNAPSHOTS, snapshots, NUM_SNAPSHOTS, NUM_NODES, little(32), little_in_all);
    for (size_t i = 0; i < sizeof chunks / sizeof *chunks; i++) {
        pod_basis again =
            stream_in(chunks[i], snapshots, NUM_SNAPSHOTS, NUM_NODES, little(32), little_in_all);
        check_same_bits(&again, &whole);
        pod_free(&again);
    }
    pod_free(&whole);
    free(snapshots);
}

/* Streams three trajectories of unequal length, merges their PODs, and then adds 500 snapshots. */
static pod_basis merge_three(const double *snapshots, size_t num_nodes, pod_settings wanted,
                             pod_stream_settings settings) {
    const size_t lengths[] = {700, 90, 210};
    pod_stream *all = create(num_nodes, settings);
    ehd_error error;
    for (size_t i = 0; i < 3; i++) {
        pod_basis part = stream_in(lengths[i], snapshots, lengths[i], num_nodes, settings, wanted);
        assert_int_equal(pod_stream_merge(all, &part, &error), EHD_OK);
        pod_free(&part);
        snapshots += lengths[i] * num_nodes;
    }
    add(all, snapshots, 500);
    return finish(all, wanted);
}

static void merging_equals_adding(void **state) {
    (void)state;
    enum { NUM_SNAPSHOTS = 1500, NUM_NODES = 150, NUM_MODES = 30 };
    double *snapshots = travelling_snapshots(NUM_SNAPSHOTS, NUM_NODES);
    pod_basis whole =
        stream_in(NUM_SNAPSHOTS, snapshots, NUM_SNAPSHOTS, NUM_NODES, little(64), little_in_all);
    pod_basis merged = merge_three(snapshots, NUM_NODES, little_in_all, little(64));
    pod_basis again = merge_three(snapshots, NUM_NODES, little_in_all, little(64));
    const double *sigma = whole.singular_values;

    check_same_bits(&again, &merged);
    assert_int_equal(merged.num_snapshots, NUM_SNAPSHOTS);
    check_close(merged.energy, whole.energy, 1e-13, 0);
    check_close_array(merged.singular_values, sigma, NUM_MODES, 0, 1e-13 * sigma[0]);
    check_close(sine_of_angle(&merged, whole.modes, NUM_MODES), 0, 0,
                1e-12 * sigma[0] / (sigma[NUM_MODES - 1] - sigma[NUM_MODES]));
    pod_free(&again);
    pod_free(&merged);
    pod_free(&whole);
    free(snapshots);
}

/* Tests that the energy that merged PODs have omitted increases the error bound. This energy does
 * not reduce the energy that the stream itself may omit. */
static void merging_inherits_losses(void **state) {
    (void)state;
    enum { NUM_SNAPSHOTS = 1500, NUM_NODES = 150 };
    double *snapshots = travelling_snapshots(NUM_SNAPSHOTS, NUM_NODES);
    pod_basis merged = merge_three(snapshots, NUM_NODES, (pod_settings){.discarded_energy = 1e-3},
                                   settings_for(1e-3, 64, 0));

    assert_true(pod_discarded(&merged) > 1e-3);
    assert_true(pod_discarded(&merged) <= 4e-3);
    assert_true(distance_to(&merged, snapshots, NUM_SNAPSHOTS) <= bound_of(&merged));
    pod_free(&merged);
    free(snapshots);
}

static void exact_rank_is_found(void **state) {
    (void)state;
    // 400 copies each of (0,0,3,4,0), with norm 5, of (1,2,0,0,2), with norm 3, and of zero
    double *snapshots = numbers(1200 * 5);
    for (size_t s = 0; s < 800; s++)
        memcpy(snapshots + 5 * (s + s / 2),
               s % 2 ? (double[]){1, 2, 0, 0, 2} : (double[]){0, 0, 3, 4, 0},
               5 * sizeof *snapshots);
    for (int exact = 0; exact < 2; exact++) {
        pod_basis basis;
        ehd_error error;
        assert_int_equal(stream(&basis, snapshots, 1200, 5,
                                (pod_stream_settings){exact ? 1e-28 : 1e-16, 1e-16, 7, 5},
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

/* Returns the bytes in use by the whole process. */
#ifdef __SANITIZE_ADDRESS__
// declared here, because Debian has no package with the header of this function
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

/* Returns the largest number of bytes in use after a call, while num_blocks blocks are added. */
static size_t most_bytes(const double *snapshots, size_t block, size_t num_nodes,
                         size_t num_blocks) {
    pod_stream *self = create(num_nodes, little(block));
    size_t most = 0;
    for (size_t i = 0; i < num_blocks; i++) {
        add(self, snapshots, block);
        const size_t now = bytes_in_use();
        if (now > most) most = now;
    }
    pod_stream_free(self);
    return most;
}

/* The memory of a stream does not grow: it holds only one block, the directions and the triangular
 * factor. */
static void memory_does_not_grow(void **state) {
    (void)state;
    enum { BLOCK = 32, NUM_NODES = 500, RANK = 10 };
    double *snapshots = known_snapshots(BLOCK, NUM_NODES, RANK, 0.5);
    most_bytes(snapshots, BLOCK, NUM_NODES, 1024); // in this call libraries allocate their buffers
    const size_t before = bytes_in_use();
    const size_t few = most_bytes(snapshots, BLOCK, NUM_NODES, 4) - before;
    const size_t many = most_bytes(snapshots, BLOCK, NUM_NODES, 1024) - before;
    const size_t held = (BLOCK + RANK) * NUM_NODES * sizeof(double);
    assert_in_range(few, held, held + 8 * NUM_NODES * sizeof(double));
    assert_in_range(many, held, few + NUM_NODES * sizeof(double));
    assert_int_equal(bytes_in_use(), before);
    free(snapshots);
}

static void bad_settings_are_refused(void **state) {
    (void)state;
    const pod_stream_settings good = {1e-16, 1e-16, 3, 4};
    const pod_stream_settings wrong[] = {{1e-16, 1e-16, 0, 4},
                                         {1e-16, 1e-16, (size_t)1 << 31, 4},
                                         {1e-16, 1e-16, 3, (size_t)1 << 31},
                                         {NAN, 1e-16, 3, 4},
                                         {-1, 1e-16, 3, 4},
                                         {1, 1e-16, 3, 4},
                                         {1e-16, 1, 3, 4},
                                         {1e-16, NAN, 3, 4}};
    const size_t wrong_nodes[] = {0, (size_t)1 << 31};
    pod_stream *self;
    ehd_error error;
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        assert_int_equal(pod_stream_create(&self, 4, &wrong[i], &error), EHD_DATA);
        assert_null(self);
    }
    for (size_t i = 0; i < 2; i++)
        assert_int_equal(pod_stream_create(&self, wrong_nodes[i], &good, &error), EHD_DATA);
    assert_null(pod_stream_free(NULL));
}

static void bad_snapshots_change_nothing(void **state) {
    (void)state;
    const double bad[] = {NAN, INFINITY, -INFINITY, 1e200};
    const char *const words[] = {"found nan", "found inf", "found -inf", "found 1e+200"};
    double *snapshots = travelling_snapshots(8, 5);
    pod_basis expected = stream_in(8, snapshots, 8, 5, little(3), little_in_all);
    pod_stream *self = create(5, little(3));
    ehd_error error;

    add(self, snapshots, 2);
    for (size_t i = 0; i < 4; i++) {
        double spoilt[6 * 5] = {0};
        spoilt[5 * 5 + 2] = bad[i]; // in the third block
        assert_int_equal(pod_stream_add(self, spoilt, 6, &error), EHD_DATA);
        assert_non_null(strstr(error.text, words[i]));
        assert_non_null(strstr(error.text, "in snapshot 7 at node 2"));
    }
    add(self, snapshots + 2 * 5, 6);
    pod_basis found = finish(self, little_in_all);
    check_same_bits(&found, &expected);
    pod_free(&found);
    pod_free(&expected);
    free(snapshots);
}

static void zeros_and_nothing_have_no_modes(void **state) {
    (void)state;
    const double zeros[30] = {0}, one[] = {0, 3, 4};
    pod_basis basis;
    ehd_error error;
    for (size_t count = 0; count <= 10; count += 5) {
        assert_int_equal(stream(&basis, zeros, count, 3, little(4), little_in_all, &error),
                         EHD_DATA);
        assert_non_null(strstr(error.text, count ? "only zeros" : "found 0 states"));
        assert_null(basis.modes);
    }
    pod_stream *self = create(3, little(4));
    add(self, zeros, 10);
    check_close(pod_stream_energy(self), 0, 0, 0);
    add(self, one, 1);
    check_close(pod_stream_energy(self), 25, 0, 0);
    add(self, zeros, 10);
    basis = finish(self, little_in_all);
    assert_int_equal(basis.num_modes, 1);
    assert_int_equal(basis.num_snapshots, 21);
    double row[3];
    pod_row(row, &basis, 0);
    check_close_array(row, one, 3, 1e-14, 1e-14);
    pod_free(&basis);
}

static void survives_failing_allocations(void **state) {
    (void)state;
    known all = noisy_snapshots(40, 12);
    size_t call = 0;
    double tail = 0;
    bool failed;
    do {
        pod_basis basis;
        ehd_error error;
        allocation_fail_at(call);
        // these settings drop weak directions
        const ehd_status status =
            stream(&basis, all.snapshots, 40, 12, (pod_stream_settings){1e-4, 0.1, 4, 9},
                   (pod_settings){.discarded_energy = 0.2}, &error);
        failed = allocation_failed();
        if (!status) tail = basis.tail;
        // if shortening the array fails, the modes stay in the longer array
        if (!(failed && status == EHD_OK && basis.modes))
            assert_int_equal(status, failed ? EHD_MEMORY : EHD_OK);
        assert_true((status == EHD_OK) == (basis.modes != NULL));
        pod_free(&basis);
    } while (failed && ++call < 1000);
    assert_in_range(call, 30, 999);
    assert_true(tail > 0);
    known_free(&all);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_block_has_the_bits_of_its_pod),
        cmocka_unit_test(error_is_within_the_bound),
        cmocka_unit_test(little_left_out_equals_the_direct_svd),
        cmocka_unit_test(weak_directions_give_way),
        cmocka_unit_test(twelve_decades_equal_the_known_svd),
        cmocka_unit_test(calls_do_not_matter),
        cmocka_unit_test(merging_equals_adding),
        cmocka_unit_test(merging_inherits_losses),
        cmocka_unit_test(exact_rank_is_found),
        cmocka_unit_test(memory_does_not_grow),
        cmocka_unit_test(bad_settings_are_refused),
        cmocka_unit_test(bad_snapshots_change_nothing),
        cmocka_unit_test(zeros_and_nothing_have_no_modes),
        cmocka_unit_test(survives_failing_allocations),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
